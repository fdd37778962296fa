//! Neighbours in other processes: the commanding process can be replaced, and no other process commands the robot.
//!
//! Nearly all tests run in fast clock, where the tick waits for its neighbours: the machine's speed has no effect.

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
