//! Tests of the task data, in one program, because each program takes a while to link.

mod chains;
mod commands;
mod data;
mod faults;
mod figures;
mod generations;
mod guarded;
mod job_lines;
mod lookups;
mod mistakes;
mod print;
