//! Check of a report of the robot controller: a table of every tick, for all commands.

use rcs_core::{Actions, Plain, decision_table};

/// What happens to the words that a report is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Comparison {
    /// They stay those of the last point and of the one before.
    Keep,
    /// They become those of the position that is repeated.
    TakeRepeated,
}

decision_table! {
    /// REPORT (A 2.3): is the robot where it was sent? When an answer is lost, the robot may have gone to the
    /// last words, or not, or be between them. A robot that is elsewhere was moved by other means, and so may
    /// have been one whose controller was off: a person decides. The first point that is sent then, which is
    /// after ROBOT-INIT, ends the doubt.
    pub REPORT: fn report(interfaces::t3i::ReportCheck, super::Answer) -> Comparison {
        any {
            1:  dtr: Off, words: Sent                      => Keep  -> Elsewhere;
        }
        NoReport | AsSent {
            2:  dtr: Off, words: Nothing                   => Keep  -> NoReport;
            3:  start: Begun                               => Keep  -> NoReport;
            4:  start: Reported, words: Nothing            => Keep  -> AsSent;
            5:  start: Reported, words: Sent, place: Near  => Keep  -> AsSent;
            6:  start: Reported, words: Sent, place: Far   => Keep  -> Elsewhere;
        }
        NoReport {
            7:  start: Over                                => Keep;
        }
        AsSent {
            8:  start: Over, before: Nothing | Point       => Keep;
            9:  start: Over, before: Repeated              => TakeRepeated;
        }
        Elsewhere {
            10: before: Nothing | Repeated                 => Keep;
            11: before: Point                              => Keep  -> AsSent;
        }
    }
}
