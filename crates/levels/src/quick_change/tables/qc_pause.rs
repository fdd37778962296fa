//! QC-PAUSE: do nothing but look.

use rcs_core::{coded_enum, decision_table, interface::quick_change::QuickChangeReport};

use super::{Action, Id};
use crate::quick_change::Ring;

coded_enum! {
    /// Reference action of QC-PAUSE.
    pub enum Step {
        /// Watching the sensors.
        Watch = "watch",
    }
}

decision_table! {
    /// QC-PAUSE (VI.2.1): do nothing; the sensors are checked for the status.
    pub QC_PAUSE: fn qc_pause(ring: Ring, id: Id) -> (Action, Step) {
        //   ring                          id          action                                         next
        1: ( Unread                      , _       ) => Report(QuickChangeReport::Executing)         , Watch ;
        2: ( Both                        , _       ) => Report(QuickChangeReport::SensorMalfunction) , Watch ;
        3: ( Locked | Unlocked | Between , Illegal ) => Report(QuickChangeReport::SensorMalfunction) , Watch ;
        4: ( Locked                      , Legal   ) => Report(QuickChangeReport::Locked)            , Watch ;
        5: ( Unlocked                    , Legal   ) => Report(QuickChangeReport::Unlocked)          , Watch ;
        6: ( Between                     , Legal   ) => Report(QuickChangeReport::Stuck)             , Watch ;
    }
}
