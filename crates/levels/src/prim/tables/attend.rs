//! The table of every tick for finished commands.

use rcs_core::{Actions, Plain, decision_table};

/// What happens with the tables of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Attention {
    /// They are not consulted.
    Leave,
    /// They are not consulted; a motion ramps down.
    Halt,
    /// They are consulted, from the first step.
    Begin,
    /// They are consulted.
    Continue,
    /// They are consulted once more, and what the command has reported does not count any more.
    Resume,
}

decision_table! {
    /// ATTEND (III.3.3): are the tables of the current command consulted, and with which outcome? An outcome
    /// stays until a new command comes, except that the joystick box can change it. PAUSE never ends: while
    /// it stands, the operator may take the robot and give it back. And the robot may still fly on after a
    /// motion that is done: the operator can stop it, and E-move must learn of it.
    pub ATTEND: fn attend(crate::execution::Outcome, super::Attendance) -> Attention {
        any {
            1:  course: Begin                                => Begin;
            2:  course: Continue                             => Continue;
            3:  course: Refuse                               => Halt;
        }
        Done {
            4:  course: Rest, kind: Lasting                  => Resume  -> Executing;
            5:  course: Rest, kind: Motion, operator: Moves  => Resume  -> Executing;
            6:  course: Rest, kind: Motion, operator: Idle   => Leave;
            7:  course: Rest, kind: Single                   => Leave;
        }
        Joystick {
            8:  course: Rest, kind: Lasting                  => Resume  -> Executing;
            9:  course: Rest, kind: Motion | Single          => Leave;
        }
        Idle | Executing | Error {
            10: course: Rest                                 => Leave;
        }
    }
}
