//! VG-RELEASE, VGRIP-POSE, TG-RELEASE, TGRIP-POSE: open the fingers.

use rcs_core::{
    interface::{
        Reason::{JawsStuck, WrongGripper},
        jaws::JawsReport,
    },
    old_table,
};

use super::{Action, Gripper, Motion, Size, Step, Stop};

old_table! {
    /// VG-RELEASE, VGRIP-POSE, TG-RELEASE, TGRIP-POSE (VI.4.1): open the fingers and see where they stop. At `commanded-size`
    /// counts as opened.
    pub RELEASE: fn release(step: Step, gripper: Gripper, motion: Motion, stop: Stop, size: Size) -> (Action, Step) {
        //   step    gripper    motion              stop      size          action                       next
        1: ( _     , Detached , _                 , _       , _         ) => Fail(WrongGripper)          , Start ;
        2: ( Start , Attached , _                 , _       , _         ) => Open                        , Move  ;
        3: ( Move  , Attached , Moving            , _       , _         ) => Open                        , Move  ;
        4: ( Move  , Attached , Endless           , _       , _         ) => Fail(JawsStuck)             , Start ;
        5: ( Move  , Attached , Stopped           , Opened  , _         ) => Report(JawsReport::Opened)  , Start ;
        6: ( Move  , Attached , Stopped , Between | Closed  , Commanded ) => Report(JawsReport::Opened)  , Start ;
        7: ( Move  , Attached , Stopped           , Between , Other     ) => Wrong(JawsReport::Stuck)    , Start ;
        8: ( Move  , Attached , Stopped           , Closed  , Other     ) => Wrong(JawsReport::Closed)   , Start ;
    }
}
