//! Standard output, standard error and files, as the programs use them.
//!
//! A terminal can be closed, a pipe can lose its reader, a disk can be full. `println!` and `eprintln!` panic
//! then, and a panic ends a run in the middle of a motion. All programs write through [`console`], which does
//! not panic; clippy denies the macros of the standard library elsewhere. All readers of files that a person
//! names go through [`files`].

#![forbid(unsafe_code)]

pub mod carried;
pub mod console;
pub mod files;
