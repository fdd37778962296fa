//! PAUSE (VI.3.1).

use rcs_core::decision_table;

decision_table! {
    /// PAUSE (VI.3.1): the valves stay as they are; without the gripper they are off.
    pub PAUSE: fn pause(super::Situation) -> super::Action {
        1:  gripper: Attached       => Pause;
        2:  gripper: Detached       => Finish;
    }
}
