//! The changes for a part of another size: numbers in the forms of its family, and vise or nests of the cell.

use geometry::movetable::MovetableLine;
use plant::description::PartType;
use rcs_core::name::Name16;
use taskdata::load::entries::{GripEntry, Typed};

use super::change::Change;
use crate::rcs_run::error::Error;

/// Computes the numbers of a family whose parts have other sizes.
pub trait Numbers {
    fn parts(&self) -> &[PartType];

    /// The new grips that replace a grip: their places, and the lines of their movetables.
    fn grips(&self, grip: &GripEntry) -> Result<Vec<(Typed, Vec<MovetableLine>)>, Error>;

    /// Approach and grasp openings, force and depart opening of an object, in 0.01 in and lb.
    fn openings(&self, object: &Name16, values: [i32; 4]) -> [i32; 4];

    /// Numbers of an object at the pedestal: approach, grasp, force, release, table, flip.
    fn pedestal(&self, _object: &Name16, values: [i32; 6]) -> [i32; 6] {
        values
    }

    /// The range of a view, mm.
    fn range(&self, _object: &Name16, range: i32) -> i32 {
        range
    }

    /// Add the vise's program or the nests to the cell description.
    fn places(&self, change: &mut Change) -> Result<Places, Error>;
}

pub struct Places {
    pub chosen: Vec<(&'static str, String)>,
    pub to_teach: Vec<String>,
    pub others: bool, // true if other parts must be tried, too
}
