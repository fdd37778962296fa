use crate::goal::{Goal, Sensor};

pub static REST: Goal = Goal {
    holds: "the last position is repeated, and the controller has acknowledged it; without a link T3I sends nothing",
    sensors: &[Sensor::Link],
    tolerance: "",
    age: 0,
    unconfirmed: &[],
};

pub static RESTARTED: Goal = Goal {
    holds: "the controller has reported a position",
    sensors: &[Sensor::Link],
    tolerance: "",
    age: 0,
    unconfirmed: &[],
};

pub static SENT: Goal = Goal {
    holds: "the controller has acknowledged the last point of the queue",
    sensors: &[Sensor::Link],
    tolerance: "",
    age: 0,
    unconfirmed: &[],
};
