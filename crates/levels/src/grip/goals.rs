use crate::goal::{Goal, Sensor};

pub static REST: Goal = Goal {
    holds: "the fingers are at rest, or their time is over; without the gripper the valves are off",
    sensors: &[Sensor::Fingers],
    tolerance: "6 counts per tick for 5 ticks",
    age: 0,
    unconfirmed: &[],
};

pub static OPENING: Goal = Goal {
    holds: "the settled opening is the commanded one",
    sensors: &[Sensor::Fingers],
    tolerance: "0.016 in",
    age: 0,
    unconfirmed: &[],
};

pub static FORCE: Goal = Goal {
    holds: "both fingers have the commanded force, or they have passed the grasp size without force",
    sensors: &[Sensor::StrainGages, Sensor::Fingers],
    tolerance: "2 lb; contact above 1 lb",
    age: 0,
    unconfirmed: &[],
};

pub static CALIBRATED: Goal = Goal {
    holds: "the readings at both ends of travel and without force are plausible",
    sensors: &[Sensor::Fingers, Sensor::StrainGages],
    tolerance: "steady for 12 ticks",
    age: 0,
    unconfirmed: &[],
};
