//! Orders to the attached gripper, independent of its kind.

use rcs_core::Plain;

/// What is asked of the attached gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FingerVerb {
    /// Nothing yet.
    #[text = ""]
    None,
    /// Leave the fingers as they are.
    Pause,
    /// Bring the fingers to an opening, nothing between them.
    Stand,
    /// Open and let go.
    Release,
    /// Close on an object.
    Grasp,
    /// Calibrate the sensors.
    Calibrate,
}

/// An [`FingerVerb`] with what goes with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FingerOrder {
    /// What to do.
    pub order: FingerVerb,
    /// Opening, or size of the object, 0.01 in.
    pub opening: i32,
    /// Force of a grasp, lb.
    pub force: i32,
}

impl FingerOrder {
    /// A request that needs an opening and no force.
    #[must_use]
    pub const fn to(order: FingerVerb, opening: i32) -> Self {
        Self { order, opening, force: 0 }
    }
}
