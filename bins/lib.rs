//! The library of the programs.
//!
//! Each program is a directory with its `main.rs`. The modules of `rcs-cell`, `rcs-log` and `rcs-neighbour` belong to
//! these programs alone. This library has what several programs or tests use: [`pages`], [`shipped`], and all of
//! `rcs-run` and `rcs-console` except their `main`.

pub mod pages;
#[path = "rcs-console/src/mod.rs"]
pub mod rcs_console;
#[path = "rcs-run/src/mod.rs"]
pub mod rcs_run;
pub mod shipped;
