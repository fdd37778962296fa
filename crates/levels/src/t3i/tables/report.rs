//! Check of a report of the robot controller: a table of every tick, for all commands.

use rcs_core::{Actions, Plain, decision_table};

/// Update of the words with which a report is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Comparison {
    /// The words stay those of the last point and the one before.
    Keep,
    /// The words become those of the repeated position.
    TakeRepeated,
}

decision_table! {
    /// REPORT (A 2.3): decides whether the robot is at its commanded position. When an answer is lost, the robot
    /// may be at the last words, at the previous ones, or between them. Elsewhere it was moved by other means; so
    /// it may have been if its controller was off. Then the operator decides, and the first point sent afterwards,
    /// after ROBOT-INIT, ends the uncertainty.
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
