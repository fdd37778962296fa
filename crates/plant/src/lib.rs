//! The simulated cell: robot controller, arm, gripper, trays, vise, camera and parts, in rapier.
//!
//! [`Cell::step`] takes what the controller wrote to its devices in a tick and gives what it will read from them in the
//! next; between the two the cell advances by exactly 40 ms. What a person, a job file or a test does beside the robot goes
//! through [`Cell::workstation`]; what happens that should not comes out of [`Cell::events`].

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod arm;
pub mod camera;
pub mod cell;
pub mod clearance;
pub mod convert;
pub mod description;
pub mod gripper;
pub mod hold;
pub mod noise;
pub mod part;
pub mod scene;
pub mod squeeze;
pub mod t3;
pub mod vise;

pub use cell::{Cell, CellError, CellEvent, Link, Placement, WorkstationAction, WorkstationError, part_link};
pub use description::CellDescription;
pub use part::PartState;
pub use t3::Button;
