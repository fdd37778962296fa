//! Kinds of locations.

use rcs_core::Plain;

/// `locpt-type`: what a location is (VII.3 to VII.5; SPECNOTES.md, contradiction 26).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LocationKind {
    /// No location.
    #[text = ""]
    None,
    /// `lpt`: a location point.
    #[text = "lpt"]
    Point,
    /// `arr`: a sector of an array.
    #[text = "arr"]
    Array,
    /// `own`: an owner.
    #[text = "own"]
    Owner,
}
