use interfaces::Unconfirmed;

use crate::goal::{Goal, Sensor};

pub static REST: Goal = Goal {
    holds: "the fingers are at rest",
    sensors: &[Sensor::Fingers],
    tolerance: "4 counts (0.007 in) in 4 ticks",
    age: 0,
    unconfirmed: &[],
};

pub static CLOSED: Goal = Goal {
    holds: "the fingers are at the commanded size, or closed",
    sensors: &[Sensor::Fingers],
    tolerance: "0.10 in",
    age: 0,
    unconfirmed: &[Unconfirmed::GraspForce],
};

/// Goal of VG-RELEASE, TG-RELEASE, VGRIP-POSE and TGRIP-POSE.
pub static OPENED: Goal = Goal {
    holds: "the fingers are at the commanded size, or open",
    sensors: &[Sensor::Fingers],
    tolerance: "0.10 in",
    age: 0,
    unconfirmed: &[],
};
