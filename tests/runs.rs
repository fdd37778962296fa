//! Runs of the whole system in one program: only its tests use all processors while one of them waits.

mod boards;
mod command_lines;
mod contacts;
mod drum;
mod egm;
mod ends;
mod estop;
mod faults;
mod finished;
mod found;
mod jobs;
mod jogs;
mod last_lines;
mod linkbar;
mod live;
mod neighbours;
mod operator;
mod output;
mod readme;
mod remedies;
mod replays;
mod seeds;
mod survival;
mod traces;
mod two_programs;
mod why;
