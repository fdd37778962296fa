//! The view of the couplers and their points for screens: published after each tick of a run with field I/O.
//!
//! It is not an input of the controller. A log has the words of the couplers on `/field`, from which the same view is
//! made.

use rcs_core::{Plain, name::Name16, tick::Tick};

use super::text::Text;

pub(super) const FIELD: &str = "field";
pub const DEVICES: usize = 8; // greatest number of couplers in the view
pub const POINTS: usize = 192; // greatest number of points in the view

/// The view of all couplers and points.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct FieldView {
    /// The tick after which it was taken; [`Tick::BEFORE_START`] if there is none yet.
    pub tick: Tick,
    /// Number of couplers of the mapping; the view has the first [`DEVICES`].
    pub device_count: u32,
    /// The couplers, in the order of the mapping.
    pub devices: [CouplerView; DEVICES],
    /// Number of points of the mapping; the view has the first [`POINTS`].
    pub point_count: u32,
    /// Inputs, then outputs, in the order of the mapping.
    pub points: [PointView; POINTS],
}

/// A coupler.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct CouplerView {
    /// Its name in the mapping.
    pub name: Name16,
    /// `starting`, `running`, `stale`, `tripped`, `silent` or `ended`.
    pub state: Name16,
    /// Age of its inputs, ms.
    pub age_ms: u32,
    /// Number of requests and connections that failed.
    pub failures: u32,
    /// Number of times that its outputs were made safe until a release.
    pub trips: u32,
}

/// A point of the mapping.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PointView {
    /// Its name.
    pub name: Text<32>,
    /// Its coupler, by the order in the view; `None` for a fixed value.
    pub device: Option<u8>,
    /// An output; else an input.
    pub is_output: bool,
    /// Input: the raw value of the coupler. Output: the commanded value. A whole number.
    pub raw: f64,
    /// Input: the value in the controller, or the raw value of a point of the workstation. Output: the value that the
    /// coupler acknowledged last. A whole number.
    pub value: f64,
}
