//! PAUSE: do nothing.

use rcs_core::old_table;

use super::{Action, Gripper};
use crate::grip::Step;

old_table! {
    /// PAUSE (VI.3.1): the valves stay as they were; without the gripper they are off.
    pub PAUSE: fn pause(gripper: Gripper) -> (Action, Step) {
        //   gripper       action   next
        1: ( Attached ) => Pause  , Start ;
        2: ( Detached ) => Finish , Start ;
    }
}
