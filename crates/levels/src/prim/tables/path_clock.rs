//! The path clock: the table of every tick, whatever the command.
//!
//! Time on the path is counted in points, not in ticks: when T3I has enough of them the path stands still,
//! and nothing is lost or hurried afterwards. So the clock goes on after a GO-THRU is done, and while an
//! error ramps down.

use rcs_core::{Plain, old_table};

use super::{Health, Pace, Posture};

/// The path clock in the last tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Clock {
    /// It stood.
    Stands,
    /// It ran.
    Runs,
}

/// What happens on the path in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// The last command to T3I is repeated under its number.
    Repeat,
    /// The next point is sent.
    Advance,
    /// The motion is forgotten, and T3I told to PAUSE.
    Abandon,
}

old_table! {
    /// PATH-CLOCK
    /// (docs/design/link.md "Path clock"): is the next point sent? A robot that does not follow must not be
    /// asked to jump, so that a lost link leaves no motion behind.
    pub PATH_CLOCK: fn path_clock(posture: Posture, health: Health, pace: Pace) -> (Flow, Clock) {
        //   posture             health                                   pace                   flow      clock
        1: ( Unpositioned      , _                                      , _                 ) => Repeat  , Stands ;
        2: ( _                 , LinkOff | LinkError | Refused | Silent , _                 ) => Abandon , Stands ;
        3: ( Moving            , _                                      , Wanted | Finished ) => Advance , Runs   ;
        4: ( Moving            , _                                      , Busy              ) => Repeat  , Stands ;
        5: ( Ending | Standing , _                                      , _                 ) => Repeat  , Stands ;
    }
}
