//! The decision of a tick about the line that is executed.

use rcs_core::{Actions, Plain, Variables, decision_table};

/// The devices of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Devices {
    /// None of them is tripped.
    Released,
    /// One of them is tripped: its outputs are safe until an operator releases it.
    Tripped,
}

/// Whether the line shows that its device has taken the order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Start {
    /// It has conditions `begun`.
    Shown,
    /// It has none.
    Hidden,
}

/// Conditions of the line, read by inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Held {
    /// All hold.
    Yes,
    /// One does not hold.
    No,
    /// An input is late, and no other one breaks a condition.
    Late,
}

/// The conditions that the line must not lose or meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Watched {
    /// No fresh input is as it must not be.
    Kept,
    /// A fresh input is as it must not be.
    Broken,
}

/// The conditions `done`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Done {
    /// They hold, and not because of the last cycle.
    Reached,
    /// They hold, but may hold since the last cycle.
    Unproven,
    /// One does not hold, or its input is late.
    Missing,
}

/// A time limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Time {
    /// Time is left.
    Left,
    /// The time is over.
    Over,
}

/// What the inputs show in this tick.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The devices of the line.
    pub devices: Devices,
    /// Whether the line has conditions `begun`.
    pub start: Start,
    /// The inputs of `fault`.
    pub fault: Watched,
    /// The conditions of `while`.
    pub during: Watched,
    /// The conditions of `needs`.
    pub needs: Held,
    /// The conditions of `begun`.
    pub begun: Held,
    /// The conditions of `done`.
    pub done: Done,
    /// The time in which the device must take the order.
    pub start_time: Time,
    /// The time in which the line must end.
    pub time: Time,
}

/// Why a line fails. [`super::Why`] adds the point or the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Cause {
    /// A device is tripped; the line can begin again.
    Tripped,
    /// A device has tripped before the line had begun, so it is unknown whether the line has begun.
    Unknown,
    /// A device has tripped after the line had begun.
    Interrupted,
    /// The device reports a fault.
    Fault,
    /// A condition of `while` is lost.
    Lost,
    /// A condition of `needs` does not hold.
    Needs,
    /// A condition of `begun` did not hold in time.
    NotBegun,
    /// A condition of `done` did not hold in time.
    NotDone,
}

/// The actions of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// The outputs stay.
    Wait,
    /// Set the outputs of the line.
    Set,
    /// The device has taken the order: set the outputs `then`.
    Begin,
    /// Set the outputs `then`; the line has ended.
    End,
    /// Set the outputs `then`, and those that may not be on at rest to their safe value, if they were set. The line has
    /// failed.
    Fail(Cause),
}

decision_table! {
    /// LINE (extension): a line of a job that devices of the workstation execute. A late input neither fulfils nor
    /// breaks a condition.
    pub LINE: fn line(enum Phase, Situation) -> Action {
        /// The outputs are not set.
        Checking {
            1:  devices: Tripped                 => Fail(Tripped);
        }
        /// The outputs are set; the device has not shown yet that it has taken the order.
        Setting {
            2:  devices: Tripped                 => Fail(Unknown);
        }
        /// The device has taken the order, or does not show it.
        Running {
            3:  devices: Tripped, start: Hidden  => Fail(Tripped);
            4:  devices: Tripped, start: Shown   => Fail(Interrupted);
        }
        any {
            5:  fault: Broken                    => Fail(Fault);
        }
        Setting | Running {
            6:  during: Broken                   => Fail(Lost);
        }
        Checking {
            7:  needs: No                        => Fail(Needs);
            8:  needs: Yes, start: Shown         => Set    -> Setting;
            9:  needs: Yes, start: Hidden        => Set    -> Running;
            10: time: Over                       => Fail(Needs);
            11: time: Left                       => Wait;
        }
        Setting {
            12: begun: Yes                       => Begin  -> Running;
        }
        Setting | Running {
            13: done: Reached                    => End;
        }
        Setting {
            14: start_time: Over                 => Fail(NotBegun);
        }
        Setting | Running {
            15: time: Over, done: Missing        => Fail(NotDone);
            16: otherwise                        => Wait;
        }
    }
}
