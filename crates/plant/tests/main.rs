//! Tests of the simulated cell, in one program because linking is slow.

mod closed_forms;
mod description;
mod determinism;
mod devices;
mod drum;
mod faults;
mod fixtures;
mod grip;
mod hydraulics;
mod ideal;
mod lines;
mod linkbar;
mod look;
mod numbers;
mod pedestal;
mod quick_change;
mod rest;
mod rig;
mod sensors;
mod strides;
mod urdf;
mod vise;
