//! Sensors: models from the true value to the word. The words have the names of [`interfaces::point`].
//!
//! A chain of small models converts the true value to a word:
//!
//! ```text
//!   truth -- Analog (offset, scale, noise, converter) or resolver or Switch (hysteresis) --> word
//!         -- DeadTimes --> late word -- crate::fault --> what the controller reads
//! ```
//!
//! The camera has its own models ([`crate::camera`]).

mod analog;
mod delay;
pub mod resolver;
mod switch;

pub use analog::Analog;
pub use delay::{DeadTimes, DelayLine};
pub use switch::Switch;
