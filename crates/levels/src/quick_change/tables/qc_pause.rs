//! QC-PAUSE: do nothing but look.

use rcs_core::{
    interface::quick_change::QuickChangeReport::{Executing, Locked, SensorMalfunction, Stuck, Unlocked},
    old_table,
};

use super::{Action, Id, Step};
use crate::quick_change::Ring;

old_table! {
    /// QC-PAUSE (VI.2.1): do nothing; the sensors are checked for the status. Watches after the end of the other commands too: a
    /// failure of theirs is reported until the next command.
    pub QC_PAUSE: fn qc_pause(step: Step, ring: Ring, id: Id) -> (Action, Step) {
        //   step           ring                          id          action                      next
        1: ( Stuck        , _                           , _       ) => Report(Stuck)             , Stuck  ;
        2: ( Faulty       , _                           , _       ) => Report(SensorMalfunction) , Faulty ;
        3: ( Watch | Turn , Unread                      , _       ) => Report(Executing)         , Watch  ;
        4: ( Watch | Turn , Both                        , _       ) => Report(SensorMalfunction) , Watch  ;
        5: ( Watch | Turn , Locked | Unlocked | Between , Illegal ) => Report(SensorMalfunction) , Watch  ;
        6: ( Watch | Turn , Locked                      , Legal   ) => Report(Locked)            , Watch  ;
        7: ( Watch | Turn , Unlocked                    , Legal   ) => Report(Unlocked)          , Watch  ;
        8: ( Watch | Turn , Between                     , Legal   ) => Report(Stuck)             , Watch  ;
    }
}
