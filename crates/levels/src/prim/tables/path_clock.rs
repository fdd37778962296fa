//! The path clock: a table of every tick, for all commands.
//!
//! Time on the path is counted in points, not in ticks. When T3I has enough points the path stops, and later no
//! time is lost or made up for. The clock continues after a GO-THRU is done, and during the ramp after an error.

use rcs_core::{Actions, Plain, decision_table};

/// What happens on the path in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum PathProgress {
    /// The last command to T3I is repeated under its number.
    Repeat,
    /// The next point is sent.
    Advance,
    /// PAUSE to T3I; the motion is discarded.
    Abandon,
}

decision_table! {
    /// PATH-CLOCK (docs/design/link.md "Path clock"): decides whether the next point is sent. A robot that does not
    /// follow must not be commanded to jump, so a lost link and a robot off its path end the motion.
    pub PATH_CLOCK: fn path_clock(super::Path) -> PathProgress {
        1: first_pause: Due                                                    => Abandon;
        2: posture: Unpositioned                                               => Repeat;
        3: t3i: Silent | LinkOff | LinkSilent | LinkError | OffPath | Refused  => Abandon;
        4: posture: Moving, t3i: Ready | Finished                              => Advance;
        5: posture: Moving, t3i: Busy                                          => Repeat;
        6: posture: Ending | Standing                                          => Repeat;
    }
}
