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
//!
//! * [`options`]: parses `egm:[ADDRESS:]PORT[,OPTION...]`;
//! * [`placement`]: the frames of the robot, which connect the T3's world with its work object, from a file;
//! * [`arm`]: the kinematics of the robot, from the same file, to check reach and axis speeds beforehand;
//! * [`bridge`]: the adapter between the DEPC function and the robot;
//! * [`exchange`]: orders and reports between them;
//! * [`mod@line`]: the host with a socket ([`udp`]) or with an emulated robot ([`simulated`]);
//! * [`emulator`]: an emulated EGM robot with the arm of the T3; [`network`]: simulated faults of UDP.

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
