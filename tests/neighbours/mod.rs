//! Neighbours in other processes: the process that commands the robot can be replaced, and no other commands it.
//!
//! Nearly all of it in fast clock, where the tick waits for its neighbours: nothing depends on how fast the machine is.

mod bench;
mod data_system;
mod ends;
mod hung;
mod loading;
mod operators;
mod pedestal;
mod python;
mod silent;
mod strangers;
mod switching;
mod taking_over;
mod together;
mod vision;
mod workstation;
