//! The goal of a command: the condition at its end, and the sensors that confirm it (V: execution depends on
//! "whether any subgoals of the command have been achieved", and on "what sensory values are being observed").
//!
//! `commands!` requires a goal for each command. [`CONFIRM`](crate::confirm::CONFIRM) compares it with the sensors
//! when a row reports the end. In Grip, V-Grip, Tool-Grip, Quick Change and the rotary table the rows that end a
//! command test the readings of the same tick, so CONFIRM is not consulted.

use interfaces::Unconfirmed;
use rcs_core::Plain;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Sensor {
    /// The resolvers of the robot.
    Resolvers,
    /// The commanded motion of the process itself.
    #[text = "commanded motion"]
    Command,
    /// The acknowledgements and reports of the robot controller.
    #[text = "DEPC answers"]
    Link,
    /// The sensor that the guarded move names.
    #[text = "sensor of the guarded move"]
    Guard,
    /// The force sensor at the wrist.
    #[text = "force sensor"]
    Force,
    /// The potentiometer of the fingers.
    #[text = "potentiometer of the fingers"]
    Fingers,
    /// The strain gages of the fingers.
    #[text = "strain gages"]
    StrainGages,
    /// The id pins of the quick change.
    #[text = "id pins"]
    IdPins,
    /// The two sensors of the locking ring.
    #[text = "ring sensors"]
    RingSensors,
    /// The four sensors of a holster.
    #[text = "holster sensors"]
    HolsterSensors,
    /// The vision system.
    Camera,
    /// Potentiometer and strain gages of the pedestal's hand.
    #[text = "sensors of the pedestal's hand"]
    Hand,
    /// Counter and potentiometer of the rotary table.
    #[text = "counter and potentiometer of the table"]
    Table,
    /// The answers of the Data System.
    #[text = "Data System"]
    DataSystem,
    /// The statuses of the processes below.
    #[text = "statuses from below"]
    Below,
}

#[derive(Debug)]
pub struct Goal {
    pub holds: &'static str,
    pub sensors: &'static [Sensor],
    /// The tolerance, with its unit; empty if the reading has two values.
    pub tolerance: &'static str,
    /// Greatest age of a reading at the end of the command, in ticks: one for each hop from the sensor up the ladder.
    /// The process waits this long for a newer reading before the command fails.
    pub age: u8,
    /// The part without a sensor, which the status names.
    pub unconfirmed: &'static [Unconfirmed],
}

#[derive(Clone, Copy, Debug)]
pub struct Declared {
    /// The command, as the manual writes it; empty for the state before the first one.
    pub command: &'static str,
    pub goal: &'static Goal,
}

pub trait Goals {
    const GOALS: &'static [Declared];
}

/// Tolerance of positions that Prim confirms.
pub const AT_POINT: &str = "0.02 in, 0.1 degree for 3 ticks";
/// Tolerance of positions that E-move and the processes above it confirm.
pub const AT_PLACE: &str = "0.05 in, 0.25 degree";
