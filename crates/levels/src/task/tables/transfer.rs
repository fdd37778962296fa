//! TRANSFER (V.4.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Books, Choice, DataBase, Ends, Grips, Situation};

/// Reference action of TRANSFER.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// An earlier update is told again.
    Settling,
    /// The gripper is being fetched.
    Gripper,
    /// The object is being fetched.
    Object,
    /// It is being regripped on the pedestal.
    Regripping,
    /// It is being placed.
    Placing,
    /// The robot is on its way to the end-at location.
    Leaving,
    /// The data base is being told.
    Telling,
}

old_table! {
    /// TRANSFER (V.4.1): move an object from one location to another, then go to the end-at location. The
    /// data base is told as soon as the object is there, so that a robot that cannot leave does not leave it
    /// wrong.
    pub TRANSFER: fn transfer(step: Step, grips: Grips, ends: Ends, subtask: Lower, data_base: DataBase, books: Books) -> (Action, Step) {
        //     step                                                grips       ends                subtask                    data base   books            action                         next
        1:  ( Start                                              , _         , _                 , _                       , _         , Owed          ) => TellOwed                     , Settling   ;
        2:  ( Start                                              , _         , _                 , _                       , _         , Closed | Open ) => GetEndeff                    , Gripper    ;
        3:  ( Settling                                           , _         , _                 , _                       , Executing , _             ) => Wait                         , Settling   ;
        4:  ( Settling                                           , _         , _                 , _                       , Overdue   , _             ) => AskAgain                     , Settling   ;
        5:  ( Settling                                           , _         , _                 , _                       , Done      , _             ) => GetEndeff                    , Gripper    ;
        6:  ( Gripper                                            , _         , _                 , Pending | Executing     , _         , _             ) => Wait                         , Gripper    ;
        7:  ( Gripper                                            , _         , _                 , Done                    , _         , _             ) => GetObject                    , Object     ;
        8:  ( Object                                             , _         , _                 , Pending | Executing     , _         , _             ) => Wait                         , Object     ;
        9:  ( Object                                             , Same      , _                 , Done                    , _         , _             ) => PlaceObj                     , Placing    ;
        10: ( Object                                             , Different , _                 , Done                    , _         , _             ) => FixGrip                      , Regripping ;
        11: ( Regripping                                         , _         , _                 , Pending | Executing     , _         , _             ) => Wait                         , Regripping ;
        12: ( Regripping                                         , _         , _                 , Done                    , _         , _             ) => PlaceObj                     , Placing    ;
        13: ( Placing                                            , _         , _                 , Pending | Executing     , _         , _             ) => Wait                         , Placing    ;
        14: ( Placing                                            , _         , There | Elsewhere , Done                    , _         , Closed | Owed ) => GotoEndpt                    , Leaving    ;
        15: ( Placing                                            , _         , There | Elsewhere , Done                    , _         , Open          ) => UpdateAndGotoEndpt           , Leaving    ;
        16: ( Placing                                            , _         , Here              , Done                    , _         , Closed | Owed ) => Finish                       , Start      ;
        17: ( Placing                                            , _         , Here              , Done                    , _         , Open          ) => Update                       , Telling    ;
        18: ( Leaving                                            , _         , _                 , Pending | Executing     , _         , _             ) => Wait                         , Leaving    ;
        19: ( Leaving                                            , _         , _                 , Done                    , _         , Owed          ) => Wait                         , Telling    ;
        20: ( Leaving                                            , _         , _                 , Done                    , _         , Closed | Open ) => Finish                       , Start      ;
        21: ( Telling                                            , _         , _                 , _                       , Executing , _             ) => Wait                         , Telling    ;
        22: ( Telling                                            , _         , _                 , _                       , Overdue   , _             ) => AskAgain                     , Telling    ;
        23: ( Telling                                            , _         , _                 , _                       , Done      , _             ) => Finish                       , Start      ;
        24: ( Settling | Telling                                 , _         , _                 , _                       , Refused   , _             ) => Fail(Reason::DataBase)       , Start      ;
        25: ( Settling | Telling                                 , _         , _                 , _                       , Silent    , _             ) => Fail(Reason::DataBaseSilent) , Start      ;
        26: ( Gripper | Object | Regripping | Placing | Leaving  , _         , _                 , Error | Joystick | Lost , _         , _             ) => PassUp                       , Start      ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = transfer(step, s.grips, s.ends, s.subtask, s.data_base, s.books);
    Choice { table: &TRANSFER, row, action, step: next.code() }
}
