//! ABB Externally Guided Motion (EGM) in pose mode: the host's side of the UDP link over which an ABB robot
//! controller asks for a Cartesian target every 4 ms.
//!
//! This crate does no I/O, reads no clock and does not allocate. The owner of a socket passes each datagram to
//! [`Host::receive`] with the time, and sends the returned datagram back:
//!
//! ```text
//!   points, one every 40 ms ──► Host ──► Sample: state, feedback, target
//!                                │  ▲
//!                      EgmSensor ▼  │ EgmRobot, every 4 ms
//!                           robot controller
//! ```
//!
//! * [`message`]: the messages of `egm.proto`, one per file; decoding checks what the schema requires;
//! * [`wire`]: their protocol-buffer encoding;
//! * [`pose`]: positions in mm, unit quaternions, and computations with them;
//! * [`session`]: whether the robot is connected and follows, and which messages are new;
//! * [`spline`], [`path`]: compute a target for any time from the points, smooth to the second derivative;
//! * [`limits`]: limits of every target;
//! * [`host`]: the host, made of these modules.
//!
//! Times are ns of one monotonic clock, positions mm, speeds mm/s and rad/s; only messages use degrees.

#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(
    not(test),
    deny(
        clippy::as_conversions,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic
    )
)]

pub mod error;
pub mod host;
pub mod limits;
pub mod message;
pub mod path;
pub mod pose;
pub mod session;
pub mod spline;
pub mod wire;

pub use self::{
    error::Error,
    host::{Host, Sample},
    limits::Limits,
    pose::{Pose, Twist},
    session::{LinkState, NotFollowing},
};
