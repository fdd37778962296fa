//! Standard output, standard error, files and the allocator for the programs of this project.
//!
//! A terminal can be closed, a pipe can lose its reader, a disk can be full: `println!` then panics, and would end a
//! run in the middle of a motion. Programs write through [`console`], which does not panic, and read files with
//! [`files`]. [`alloc`] counts allocations in sections of a program.

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
