//! VG-PAUSE, TG-PAUSE: do nothing but look.

use rcs_core::{interface::jaws::JawsReport, old_table};

use super::{Action, Gripper, Motion, Size, Step, Stop};

old_table! {
    /// VG-PAUSE, TG-PAUSE (VI.4.1): the valves stay as they are; the potentiometer is read for the status. Without the gripper
    /// there is nothing to read.
    pub PAUSE: fn pause(gripper: Gripper, motion: Motion, stop: Stop, size: Size) -> (Action, Step) {
        //   gripper    motion              stop      size          action                           next
        1: ( Detached , _                 , _       , _         ) => Report(JawsReport::Idle)        , Start ;
        2: ( Attached , Moving            , _       , _         ) => Wait                            , Start ;
        3: ( Attached , Stopped | Endless , Closed  , _         ) => Report(JawsReport::Closed)      , Start ;
        4: ( Attached , Stopped | Endless , Opened  , _         ) => Report(JawsReport::Opened)      , Start ;
        5: ( Attached , Stopped | Endless , Between , Commanded ) => Report(JawsReport::AtPosition)  , Start ;
        6: ( Attached , Stopped | Endless , Between , Other     ) => Wrong(JawsReport::Stuck)        , Start ;
    }
}
