//! Search for the place of the robot.

use rcs_core::{Actions, decision_table};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Look {
    /// Do not search.
    Rest,
    /// Search more location points for the one at which the robot is.
    Look,
}

decision_table! {
    /// SEARCH: during E-PAUSE, search the location points for the one at which the robot is. Preprocess consults this
    /// table in every tick, because other tables read the result. Headers do not name its rows.
    pub SEARCH: fn search(super::Watch) -> Look {
        1: place: Known | Unknown                                               => Rest;
        2: place: Searching, pause: Other                                       => Rest;
        3: place: Searching, pause: UnderWay | Standing, resolvers: Unknown     => Rest;
        4: place: Searching, pause: UnderWay | Standing, outcome: Idle | Error  => Rest;
        5: place: Searching, outcome: Executing | Done | Joystick               => Look;
    }
}
