//! An EGM robot in the place of a T3: connects the controller's side of DEPC to ABB's Externally Guided Motion.
//!
//! ```text
//!   host (T3 Interface, or any other)
//!     │ bytes, once a tick of 40 ms
//!   bridge::Bridge: depc::Controller, which moves ...
//!     │ orders, at most one per tick           ▲ samples
//!   line::Line: egm::Host, in its own thread or in simulated time
//!     │ EgmSensor                              ▲ EgmRobot, every 4 ms
//!   robot controller, or emulator::EgmRobot
//! ```

pub mod arm;
pub mod bridge;
pub mod emulator;
pub mod exchange;
pub mod line;
pub mod network;
pub mod options;
pub mod placement;
mod pose_entry;
pub mod simulated;
pub mod udp;

pub use self::{
    bridge::{Bridge, BridgeOutputs},
    exchange::{Cause, Order, Refusals, Refused, Report},
    line::Line,
    options::{EgmOptions, Peer},
    placement::{Placement, RobotFile},
};
