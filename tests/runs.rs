//! Runs of the whole system, in one program: each program takes a while to link.

mod contacts;
mod egm;
mod estop;
mod faults;
mod finished;
mod jobs;
mod linkbar;
mod traces;
mod why;
