//! VG-GRASP, TG-GRASP: close the fingers.

use rcs_core::{
    Plain,
    interface::{
        Reason::{JawsStuck, WrongGripper},
        jaws::JawsReport,
    },
    old_table,
};

use super::{Action, Gripper, Motion, Size, Stop};

/// Reference action of a command that moves the fingers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Not begun.
    Start,
    /// The fingers have air.
    Move,
}

old_table! {
    /// VG-GRASP, TG-GRASP (VI.4.1): close the fingers and see where they stop. At `commanded-size` counts as closed.
    pub GRASP: fn grasp(step: Step, gripper: Gripper, motion: Motion, stop: Stop, size: Size) -> (Action, Step) {
        //   step    gripper    motion              stop      size          action                       next
        1: ( _     , Detached , _                 , _       , _         ) => Fail(WrongGripper)          , Start ;
        2: ( Start , Attached , _                 , _       , _         ) => Close                       , Move  ;
        3: ( Move  , Attached , Moving            , _       , _         ) => Close                       , Move  ;
        4: ( Move  , Attached , Endless           , _       , _         ) => Fail(JawsStuck)             , Start ;
        5: ( Move  , Attached , Stopped           , Closed  , _         ) => Report(JawsReport::Closed)  , Start ;
        6: ( Move  , Attached , Stopped , Between | Opened  , Commanded ) => Report(JawsReport::Closed)  , Start ;
        7: ( Move  , Attached , Stopped           , Between , Other     ) => Wrong(JawsReport::Stuck)    , Start ;
        8: ( Move  , Attached , Stopped           , Opened  , Other     ) => Wrong(JawsReport::Opened)   , Start ;
    }
}
