//! Field I/O: the points of a cell on the words of its couplers.
//!
//! A [`Mapping`] is read from a file, `data/field/NAME.toml`, and checked whole: every mistake has its line, and
//! nothing is sent before the file is right. It says at which word of which device each point of
//! [`interfaces::point`] is.
//!
//! ```text
//!   DeviceOutputs --collect--> words --> coupler --> valves          the controller's side
//!   DeviceInputs  <--apply---  words <-- coupler <-- sensors         with ages: FieldHealth
//!
//!   DeviceOutputs <--spread--  words                                 the side of an emulated cell
//!   DeviceInputs  --sample-->  words
//! ```
//!
//! [`Lines`] executes the `**` lines of a job by the points of vise, machine, drum and trays.
//!
//! The state of a device and of its connection is in [`couplers`], which a device's [`Plan`](couplers::Plan) goes to.
//! There are no sockets, threads and clocks here, and after the start no allocation: ages are given in milliseconds.
//! An input that is older than its `stale_ms` keeps its last value, or gets its value `then`, and its group is reported
//! as not fresh ([`interfaces::device::FieldHealth`]): an old value is never replaced by zero.

#![forbid(unsafe_code)]

mod image;
mod lines;
mod mapping;
mod scale;

pub use self::{
    image::{SAFETY, Seen},
    lines::{Condition, Failure, Lines, Sequence, Setting, Why},
    mapping::{Device, InPoint, Mapping, OutPoint, Presence, Target},
    scale::{Format, Line},
};
