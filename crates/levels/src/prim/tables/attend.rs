//! The table that is consulted in every tick, also for finished commands.

use rcs_core::{Actions, Plain, decision_table};

/// What happens with the tables of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Attention {
    /// The tables are not consulted.
    Leave,
    /// The tables are not consulted; a motion ramps down.
    Halt,
    /// The tables are consulted, from the first step.
    Begin,
    /// The tables are consulted.
    Continue,
    /// The tables are consulted again, and the report of the command is withdrawn.
    Resume,
}

decision_table! {
    /// ATTEND (III.3.3): decides whether the tables of the current command are consulted, and with which outcome.
    /// An outcome stays until a new command arrives; only the joystick box can change it. PAUSE never ends: during
    /// it the operator may take the robot and return it. After a motion is done the robot may still move: the
    /// operator can stop it, and E-move must be informed.
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
