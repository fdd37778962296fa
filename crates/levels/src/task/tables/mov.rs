//! MOVE (V.4.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Books, Choice, DataBase, Grips, Handling, Situation};

/// Reference action of MOVE.
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
    /// The object, or the robot alone, is on its way.
    Moving,
    /// The data base is being told.
    Telling,
}

old_table! {
    /// MOVE (V.4.1): move an object to a location and hold it there, or move the robot; the end-at location
    /// is ignored.
    pub MOVE: fn mov(step: Step, handling: Handling, grips: Grips, subtask: Lower, data_base: DataBase, books: Books) -> (Action, Step) {
        //     step                                      handling   grips       subtask                    data base   books            action                         next
        1:  ( Start                                    , NoObject , _         , _                       , _         , _             ) => GotoDest                     , Moving     ;
        2:  ( Start                                    , Object   , _         , _                       , _         , Owed          ) => TellOwed                     , Settling   ;
        3:  ( Start                                    , Object   , _         , _                       , _         , Closed | Open ) => GetEndeff                    , Gripper    ;
        4:  ( Settling                                 , _        , _         , _                       , Executing , _             ) => Wait                         , Settling   ;
        5:  ( Settling                                 , _        , _         , _                       , Overdue   , _             ) => AskAgain                     , Settling   ;
        6:  ( Settling                                 , _        , _         , _                       , Done      , _             ) => GetEndeff                    , Gripper    ;
        7:  ( Gripper                                  , _        , _         , Pending | Executing     , _         , _             ) => Wait                         , Gripper    ;
        8:  ( Gripper                                  , _        , _         , Done                    , _         , _             ) => GetObject                    , Object     ;
        9:  ( Object                                   , _        , _         , Pending | Executing     , _         , _             ) => Wait                         , Object     ;
        10: ( Object                                   , _        , Same      , Done                    , _         , _             ) => MoveObjToDest                , Moving     ;
        11: ( Object                                   , _        , Different , Done                    , _         , _             ) => FixGrip                      , Regripping ;
        12: ( Regripping                               , _        , _         , Pending | Executing     , _         , _             ) => Wait                         , Regripping ;
        13: ( Regripping                               , _        , _         , Done                    , _         , _             ) => MoveObjToDest                , Moving     ;
        14: ( Moving                                   , _        , _         , Pending | Executing     , _         , _             ) => Wait                         , Moving     ;
        15: ( Moving                                   , _        , _         , Done                    , _         , Closed | Owed ) => Finish                       , Start      ;
        16: ( Moving                                   , _        , _         , Done                    , _         , Open          ) => Update                       , Telling    ;
        17: ( Telling                                  , _        , _         , _                       , Executing , _             ) => Wait                         , Telling    ;
        18: ( Telling                                  , _        , _         , _                       , Overdue   , _             ) => AskAgain                     , Telling    ;
        19: ( Telling                                  , _        , _         , _                       , Done      , _             ) => Finish                       , Start      ;
        20: ( Settling | Telling                       , _        , _         , _                       , Refused   , _             ) => Fail(Reason::DataBase)       , Start      ;
        21: ( Settling | Telling                       , _        , _         , _                       , Silent    , _             ) => Fail(Reason::DataBaseSilent) , Start      ;
        22: ( Gripper | Object | Regripping | Moving   , _        , _         , Error | Joystick | Lost , _         , _             ) => PassUp                       , Start      ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov(step, s.handling, s.grips, s.subtask, s.data_base, s.books);
    Choice { table: &MOVE, row, action, step: next.code() }
}
