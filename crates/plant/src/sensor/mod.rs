//! Sensors: names of their words, and models from the true value to the word.
//!
//! A device gives the true value (an opening, a force, a distance), and a chain of small models turns it into a word:
//!
//! ```text
//!   truth -- Analog (offset, scale, noise, converter) or resolver or Switch (hysteresis) --> word
//!         -- DeadTimes --> late word -- crate::fault --> what the controller reads
//! ```
//!
//! The cell description has scales and offsets with the devices, and common values of each kind of sensor in
//! `[sensors]`. The camera has its own models ([`crate::camera`]).

mod analog;
mod delay;
mod name;
pub mod resolver;
mod switch;
mod word;

pub use analog::Analog;
pub use delay::{DeadTimes, DelayLine};
pub use name::{Group, Sensor};
pub use switch::Switch;
pub(crate) use word::Word;
