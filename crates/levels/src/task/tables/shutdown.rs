//! SHUTDOWN (V.4.1).

use rcs_core::{Plain, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, DataBase, Situation};

/// Reference action of SHUTDOWN.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// Abort was sent.
    Aborting,
}

old_table! {
    /// SHUTDOWN (V.4.1): disconnect the Data System with an Abort. It counts as gone from the first tick,
    /// whatever it answers.
    pub SHUTDOWN: fn shutdown(step: Step, data_base: DataBase) -> (Action, Step) {
        //    step       data base    action                         next
        1: ( Start    , _         ) => Disconnect                   , Aborting ;
        2: ( Aborting , Executing ) => Wait                         , Aborting ;
        3: ( Aborting , Overdue   ) => AskAgain                     , Aborting ;
        4: ( Aborting , Done      ) => Finish                       , Start    ;
        5: ( Aborting , Refused   ) => Fail(Reason::DataBase)       , Start    ;
        6: ( Aborting , Silent    ) => Fail(Reason::DataBaseSilent) , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = shutdown(step, s.data_base);
    Choice { table: &SHUTDOWN, row, action, step: next.code() }
}
