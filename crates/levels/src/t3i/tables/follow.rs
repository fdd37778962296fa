//! Supervision of the robot's motion: a table of every tick, for all commands.

use rcs_core::{Actions, Plain, decision_table};

/// What happens to the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Supervision {
    /// The motion continues.
    Continue,
    /// The queue is emptied, nothing more is sent, and the controller stops the robot.
    Stop,
}

decision_table! {
    /// FOLLOW (docs/design/link.md "Following"): decides whether the robot is on its path. A robot that is off its
    /// path is stopped where it is; only a RESTART, which Prim sends for ROBOT-INIT, ends that. After a start of
    /// the link the resolvers have a second to come near the reported position: those of the simulated cell follow
    /// a robot at a serial port, which they then see for the first time.
    pub FOLLOW: fn follow(interfaces::t3i::Following, super::Feedback) -> Supervision {
        any {
            1: restart: Asked                               => Continue  -> Joining;
        }
        Joining {
            2: restart: Before, place: Unknown              => Continue;
            3: restart: Before, place: Near                 => Continue  -> OnPath;
            4: restart: Before, place: Far, grace: Running  => Continue;
            5: restart: Before, place: Far, grace: Over     => Stop      -> OffPath;
        }
        OnPath {
            6: restart: Before, place: Unknown | Near       => Continue;
            7: restart: Before, place: Far                  => Stop      -> OffPath;
        }
        OffPath {
            8: restart: Before                              => Continue;
        }
    }
}
