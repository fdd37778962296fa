//! Search for the place of the robot.

use rcs_core::{Actions, decision_table};

/// What is done about where the robot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Look {
    /// Nothing.
    Rest,
    /// Look at some more location points for the one at which the robot stands.
    Look,
}

decision_table! {
    /// SEARCH: while E-PAUSE is the command, the location points are looked through for the one at which the
    /// robot stands. Preprocess consults it every tick, because the tables ask for what it finds; no header
    /// names its rows.
    pub SEARCH: fn search(super::Watch) -> Look {
        1: place: Known | Unknown                                               => Rest;
        2: place: Searching, pause: Other                                       => Rest;
        3: place: Searching, pause: UnderWay | Standing, resolvers: Unknown     => Rest;
        4: place: Searching, pause: UnderWay | Standing, outcome: Idle | Error  => Rest;
        5: place: Searching, outcome: Executing | Done | Joystick               => Look;
    }
}
