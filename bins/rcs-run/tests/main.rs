//! The program `rcs-run` as its users start it.

mod campaign;
mod command_line;
mod common;
mod console;
mod database;
mod io;
mod odd_files;
mod wiring;
