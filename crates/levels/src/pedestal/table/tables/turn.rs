//! TURN: turn to an absolute angle.

use rcs_core::{Plain, interface::Reason::TableStuck, old_table};

use super::{Action, Clock, Motor, Place};

/// Reference action of a command to the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// No turn ordered yet.
    Start,
    /// The turn is ordered.
    Turning,
}

old_table! {
    /// TURN: turn to the commanded angle, which counter and potentiometer must both show in the end.
    pub TURN: fn turn(step: Step, motor: Motor, place: Place, clock: Clock) -> (Action, Step) {
        //   step              motor               place       clock        action              next
        1: ( _               , Silent            , _         , _       ) => Lose(TableStuck) , Start   ;
        2: ( Start | Turning , Pending | Turning , _         , Expired ) => Lose(TableStuck) , Start   ;
        3: ( Start           , Pending           , _         , Running ) => Wait             , Start   ;
        4: ( Start           , Turning           , _         , Running ) => Stop             , Start   ;
        5: ( Start           , Standing          , Elsewhere , _       ) => Turn             , Turning ;
        6: ( Turning         , Pending | Turning , _         , Running ) => Wait             , Turning ;
        7: ( Start | Turning , Standing          , There     , _       ) => Finish           , Start   ;
        8: ( Turning         , Standing          , Elsewhere , _       ) => Lose(TableStuck) , Start   ;
    }
}
