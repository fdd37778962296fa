//! TRANSFER (V.4.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, DataBase, Ends, Grips, Situation};

coded_enum! {
    /// Reference action of TRANSFER.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The gripper is being fetched.
        Gripper = "gripper",
        /// The object is being fetched.
        Object = "object",
        /// The object is being placed.
        Placing = "placing",
        /// The robot is on its way to the end-at location.
        Leaving = "leaving",
        /// The data base is being told.
        Update = "update",
    }
}

decision_table! {
    /// TRANSFER (V.4.1): move an object from one location to another, then go to the end-at location.
    pub TRANSFER: fn transfer(step: Step, grips: Grips, ends: Ends, subtask: Lower, data_base: DataBase) -> (Action, Step) {
        //     step                                  grips       ends        subtask                    data base    action         next
        1:  ( Start                               , Different , _         , _                       , _         ) => Fail(Reason::RegripNeeded), Start ;
        2:  ( Start                               , Same      , _         , _                       , _         ) => GetEndeff      , Gripper ;
        3:  ( Gripper                             , _         , _         , Pending | Executing     , _         ) => Wait           , Gripper ;
        4:  ( Gripper                             , _         , _         , Done                    , _         ) => GetObject      , Object  ;
        5:  ( Object                              , _         , _         , Pending | Executing     , _         ) => Wait           , Object  ;
        6:  ( Object                              , _         , _         , Done                    , _         ) => PlaceObj       , Placing ;
        7:  ( Placing                             , _         , _         , Pending | Executing     , _         ) => Wait           , Placing ;
        8:  ( Placing                             , _         , Elsewhere , Done                    , _         ) => GotoEndpt      , Leaving ;
        9:  ( Placing                             , _         , Here      , Done                    , _         ) => UpdateDataBase , Update  ;
        10: ( Leaving                             , _         , _         , Pending | Executing     , _         ) => Wait           , Leaving ;
        11: ( Leaving                             , _         , _         , Done                    , _         ) => UpdateDataBase , Update  ;
        12: ( Update                              , _         , _         , _                       , Executing ) => Wait           , Update  ;
        13: ( Update                              , _         , _         , _                       , Done      ) => Finish         , Start   ;
        14: ( Update                              , _         , _         , _                       , Error     ) => Fail(Reason::DataBase), Start ;
        15: ( Gripper | Object | Placing | Leaving, _         , _         , Error | Joystick | Lost , _         ) => PassUp         , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = transfer(step, s.grips, s.ends, s.subtask, s.data_base);
    Choice { table: &TRANSFER, row, action, step: next.code() }
}
