//! CALIBRATE: find the + limit and set the counter.

use rcs_core::{interface::Reason::TableStuck, old_table};

use super::{Action, Clock, Motor, Place};
use crate::pedestal::table::Phase;

old_table! {
    /// CALIBRATE (IV.1 step 3, IV.5.1 step 10): turn to the + limit and give the counter the angle of the limit. Runs by itself
    /// when the table is booted, and before the first command that turns it.
    pub CALIBRATE: fn calibrate(phase: Phase, motor: Motor, place: Place, clock: Clock) -> (Action, Phase) {
        //   phase                                motor               place       clock        action              next
        1: ( Missing | Deferred | Valid | Failed , _                 , _         , _       ) => SeekLimit        , Seeking ;
        2: ( Seeking | Setting                   , Silent            , _         , _       ) => Lose(TableStuck) , Failed  ;
        3: ( Seeking                             , Pending | Turning , _         , Running ) => Wait             , Seeking ;
        4: ( Setting                             , Pending | Turning , _         , Running ) => Wait             , Setting ;
        5: ( Seeking | Setting                   , Pending | Turning , _         , Expired ) => Lose(TableStuck) , Failed  ;
        6: ( Seeking                             , Standing          , There     , _       ) => SetCounter       , Setting ;
        7: ( Setting                             , Standing          , There     , _       ) => Calibrated       , Valid   ;
        8: ( Seeking | Setting                   , Standing          , Elsewhere , _       ) => Lose(TableStuck) , Failed  ;
    }
}
