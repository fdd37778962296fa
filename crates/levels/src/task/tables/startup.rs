//! STARTUP (V.4.1, IV.4.2).

use rcs_core::{Plain, interface::Reason, old_table, table::Decision};

use super::{Action, Books, Choice, DataBase, Situation};

/// Reference action of STARTUP; three of them are what the terminal showed (IV.4.2 step 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// Abort was sent.
    Aborting,
    /// Initiate was sent.
    Initiating,
    /// Startup was sent.
    Connecting,
    /// An earlier update is told again.
    Settling,
}

old_table! {
    /// STARTUP (V.4.1): connect the Data System: Abort, Initiate, Startup, and the update that it did not
    /// take before, if there is one.
    pub STARTUP: fn startup(step: Step, data_base: DataBase, books: Books) -> (Action, Step) {
        //     step                                            data base   books            action                         next
        1:  ( Start                                          , _         , _             ) => Abort                        , Aborting   ;
        2:  ( Aborting                                       , Executing , _             ) => Wait                         , Aborting   ;
        3:  ( Aborting                                       , Overdue   , _             ) => AskAgain                     , Aborting   ;
        4:  ( Aborting                                       , Done      , _             ) => Initiate                     , Initiating ;
        5:  ( Initiating                                     , Executing , _             ) => Wait                         , Initiating ;
        6:  ( Initiating                                     , Overdue   , _             ) => AskAgain                     , Initiating ;
        7:  ( Initiating                                     , Done      , _             ) => Startup                      , Connecting ;
        8:  ( Connecting                                     , Executing , _             ) => Wait                         , Connecting ;
        9:  ( Connecting                                     , Overdue   , _             ) => AskAgain                     , Connecting ;
        10: ( Connecting                                     , Done      , Closed | Open ) => Connect                      , Start      ;
        11: ( Connecting                                     , Done      , Owed          ) => ConnectAndTell               , Settling   ;
        12: ( Settling                                       , Executing , _             ) => Wait                         , Settling   ;
        13: ( Settling                                       , Overdue   , _             ) => AskAgain                     , Settling   ;
        14: ( Settling                                       , Done      , _             ) => Finish                       , Start      ;
        15: ( Aborting | Initiating | Connecting | Settling  , Refused   , _             ) => Fail(Reason::DataBase)       , Start      ;
        16: ( Aborting | Initiating | Connecting | Settling  , Silent    , _             ) => Fail(Reason::DataBaseSilent) , Start      ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = startup(step, s.data_base, s.books);
    Choice { table: &STARTUP, row, action, step: next.code() }
}
