//! Geometry of the RCS-II/T3 controller, in inches and radians: frames, poses and movetables in the manual's
//! integers (VII.1, VII.2), and the kinematics of the Cincinnati Milacron T3.
//!
//! Nothing here allocates, panics on input, or depends on the platform's mathematics library.

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

pub mod frame;
pub mod kinematics;
pub mod movetable;
pub mod pose;
pub mod units;
