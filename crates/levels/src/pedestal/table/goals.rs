use crate::goal::{Goal, Sensor};

pub static REST: Goal = Goal {
    holds: "the motor is at rest, or does not answer",
    sensors: &[Sensor::Table],
    tolerance: "no step in 3 ticks",
    age: 0,
    unconfirmed: &[],
};

pub static CALIBRATED: Goal = Goal {
    holds: "the table is at the + limit with the counter at zero, and then at -20.00 degrees",
    sensors: &[Sensor::Table],
    tolerance: "0.05 degree on the counter, 12 counts on the potentiometer",
    age: 0,
    unconfirmed: &[],
};

pub static TURNED: Goal = Goal {
    holds: "the table is at the angle",
    sensors: &[Sensor::Table],
    tolerance: "0.05 degree on the counter, 12 counts on the potentiometer",
    age: 0,
    unconfirmed: &[],
};
