//! QC-UNLOCK: turn the ring until it is unlocked.

use rcs_core::{
    interface::quick_change::QuickChangeReport::{Executing, SensorMalfunction, Stuck, Unlocked},
    old_table,
};

use super::{Action, Clock, Step};
use crate::quick_change::Ring;

old_table! {
    /// QC-UNLOCK (VI.2.1): unlock, and check that neither ring nor sensors fail. Done at once if it is unlocked. The id counts for
    /// nothing: its contacts part while the gripper drops.
    pub QC_UNLOCK: fn qc_unlock(ring: Ring, clock: Clock) -> (Action, Step) {
        //   ring               clock        action                    next
        1: ( Unread           , _       ) => Report(Executing)       , Watch  ;
        2: ( Both             , _       ) => Fail(SensorMalfunction) , Faulty ;
        3: ( Unlocked         , _       ) => Report(Unlocked)        , Watch  ;
        4: ( Locked | Between , Running ) => Unlock                  , Turn   ;
        5: ( Locked | Between , Expired ) => Fail(Stuck)             , Stuck  ;
    }
}
