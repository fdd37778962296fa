//! The console: its screens as text, and the program in a terminal.

mod band;
mod points;
mod procedures;
mod screens;
mod stage;
mod terminal;
