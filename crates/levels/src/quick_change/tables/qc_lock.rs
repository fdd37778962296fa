//! QC-LOCK: turn the ring until it is locked.

use rcs_core::{
    interface::quick_change::QuickChangeReport::{Executing, Locked, SensorMalfunction, Stuck},
    old_table,
};

use super::{Action, Clock, Id, Step};
use crate::quick_change::Ring;

old_table! {
    /// QC-LOCK (VI.2.1): lock, check that the ring did not get stuck, disable the control port. Done at once if it is locked.
    pub QC_LOCK: fn qc_lock(ring: Ring, id: Id, clock: Clock) -> (Action, Step) {
        //   ring                 id        clock        action                    next
        1: ( Unread             , _       , _       ) => Report(Executing)       , Watch  ;
        2: ( Both               , _       , _       ) => Fail(SensorMalfunction) , Faulty ;
        3: ( Locked             , Illegal , _       ) => Fail(SensorMalfunction) , Faulty ;
        4: ( Locked             , Legal   , _       ) => Report(Locked)          , Watch  ;
        5: ( Unlocked | Between , _       , Running ) => Lock                    , Turn   ;
        6: ( Unlocked | Between , _       , Expired ) => Fail(Stuck)             , Stuck  ;
    }
}
