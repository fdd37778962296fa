use crate::goal::{Goal, Sensor};

pub static REST: Goal = Goal {
    holds: "the ring has no air",
    sensors: &[Sensor::Command],
    tolerance: "",
    age: 0,
    unconfirmed: &[],
};

pub static LOCKED: Goal = Goal {
    holds: "the ring is locked, and the id pins read a legal id",
    sensors: &[Sensor::RingSensors, Sensor::IdPins],
    tolerance: "",
    age: 0,
    unconfirmed: &[],
};

pub static UNLOCKED: Goal = Goal {
    holds: "the ring is unlocked",
    sensors: &[Sensor::RingSensors],
    tolerance: "",
    age: 0,
    unconfirmed: &[],
};
