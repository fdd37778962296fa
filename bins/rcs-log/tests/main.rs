//! The program `rcs-log` as its users start it.

mod command_line;
mod damaged;
mod fork;
mod serve;
mod tables;
