//! Field I/O: the points of a cell on the words of its couplers.
//!
//! A [`Mapping`] is a file, `data/field/NAME.toml`, that says at which word of which device each point of
//! [`interfaces::point`] is. All mistakes are reported with their lines before anything is sent.
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
//! [`couplers`] has the state of a device and of its connection, by the device's [`Plan`](couplers::Plan). There are
//! no sockets, threads and clocks here, and after the start no allocation: ages are in ms. An input older than its
//! `stale_ms` keeps its last value, or gets its value `then`, and its group is not fresh
//! ([`interfaces::device::FieldHealth`]): an old value is never replaced by zero.

#![forbid(unsafe_code)]

mod image;
mod lines;
mod mapping;
mod scale;

pub use self::{
    image::{SAFETY, Seen},
    lines::{Condition, Failure, Lines, Sequence, Setting, Why, outputs_after},
    mapping::{Device, Holds, InPoint, Mapping, OutPoint, Presence, Target},
    scale::{Format, Line},
};
