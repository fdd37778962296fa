//! Neighbours in other processes. The commanding neighbour can be replaced, and no other one commands the robot. Nearly
//! all tests run in fast clock, where the tick waits, so that the machine's speed has no effect.

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
