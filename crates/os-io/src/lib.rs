//! Standard output, standard error, files and the allocator for the programs of this project.
//!
//! A terminal can be closed, a pipe can lose its reader, a disk can be full. In these cases `println!` and `eprintln!`
//! panic, and a panic would end a run in the middle of a motion. All programs write through [`console`], which does not
//! panic; clippy denies the macros of the standard library elsewhere. Everything that reads a file named by a person
//! uses [`files`]. [`alloc`] counts what is allocated in sections of a program.

#![warn(missing_docs)]
#![deny(unsafe_code)]

pub mod alloc;
pub mod browser;
pub mod carried;
pub mod console;
pub mod files;
pub mod replace;
pub mod shell;
pub mod text;
pub mod units;
