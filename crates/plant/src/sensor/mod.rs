//! Sensors: what their words are called, and what lies between the truth and the word.
//!
//! A device says what is true (an opening, a force, a distance), and small models in a row make a word of it:
//!
//! ```text
//!   truth -- Analog (offset, scale, noise, converter) or resolver or Switch (hysteresis) --> word
//!         -- DeadTimes --> late word -- crate::fault --> what the controller reads
//! ```
//!
//! Scales and offsets stand with their devices in the cell description, what is common to kinds of sensors in `[sensors]`.
//! The camera has its own models ([`crate::camera`]).

mod analog;
mod delay;
mod name;
pub mod resolver;
mod switch;

pub use analog::Analog;
pub use delay::{DeadTimes, DelayLine};
pub use name::{Group, Sensor};
pub use switch::Switch;
