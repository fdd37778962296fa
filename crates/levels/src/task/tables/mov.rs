//! MOVE (V.4.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, DataBase, Grips, Handling, Situation};

coded_enum! {
    /// Reference action of MOVE.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The gripper is being fetched.
        Gripper = "gripper",
        /// The object is being fetched.
        Object = "object",
        /// The object, or the robot alone, is on its way.
        Moving = "moving",
        /// The data base is being told.
        Update = "update",
    }
}

decision_table! {
    /// MOVE (V.4.1): move an object to a location and hold it there, or move the robot; the end-at location is ignored.
    pub MOVE: fn mov(step: Step, handling: Handling, grips: Grips, subtask: Lower, data_base: DataBase) -> (Action, Step) {
        //     step                        handling   grips       subtask                    data base    action                  next
        1:  ( Start                     , NoObject , _         , _                       , _         ) => GotoDest             , Moving  ;
        2:  ( Start                     , Object   , Different , _                       , _         ) => Fail(Reason::RegripNeeded), Start ;
        3:  ( Start                     , Object   , Same      , _                       , _         ) => GetEndeff            , Gripper ;
        4:  ( Gripper                   , _        , _         , Pending | Executing     , _         ) => Wait                 , Gripper ;
        5:  ( Gripper                   , _        , _         , Done                    , _         ) => GetObject            , Object  ;
        6:  ( Object                    , _        , _         , Pending | Executing     , _         ) => Wait                 , Object  ;
        7:  ( Object                    , _        , _         , Done                    , _         ) => MoveObjToDest        , Moving  ;
        8:  ( Moving                    , _        , _         , Pending | Executing     , _         ) => Wait                 , Moving  ;
        9:  ( Moving                    , NoObject , _         , Done                    , _         ) => Finish               , Start   ;
        10: ( Moving                    , Object   , _         , Done                    , _         ) => UpdateDataBase       , Update  ;
        11: ( Update                    , _        , _         , _                       , Executing ) => Wait                 , Update  ;
        12: ( Update                    , _        , _         , _                       , Done      ) => Finish               , Start   ;
        13: ( Update                    , _        , _         , _                       , Error     ) => Fail(Reason::DataBase), Start  ;
        14: ( Gripper | Object | Moving , _        , _         , Error | Joystick | Lost , _         ) => PassUp               , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov(step, s.handling, s.grips, s.subtask, s.data_base);
    Choice { table: &MOVE, row, action, step: next.code() }
}
