//! ACQUIRE-TOOL (V.4.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Holding, Situation, Station};

/// Reference action of ACQUIRE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The tool gripper is being fetched.
    Gripper,
    /// The robot is on its way to the destination, near the drum.
    Approaching,
    /// The tool is being grasped.
    Acquiring,
}

old_table! {
    /// ACQUIRE-TOOL (V.4.1): get the tool gripper, go to the destination, which is TOOL-SAFE, and grasp a
    /// tool in the tool drum; done at once if it is held there.
    pub ACQUIRE_TOOL: fn acquire_tool(step: Step, holding: Holding, station: Station, subtask: Lower) -> (Action, Step) {
        //     step                                holding   station            subtask                    action                        next
        1:  ( Start                             , Held    , Transfer         , _                       ) => Finish                       , Start       ;
        2:  ( Start                             , Held    , Safe | Elsewhere , _                       ) => Fail(Reason::AlreadyHolding) , Start       ;
        3:  ( Start                             , Other   , _                , _                       ) => Fail(Reason::AlreadyHolding) , Start       ;
        4:  ( Start                             , NotHeld , _                , _                       ) => GetEndeff                    , Gripper     ;
        5:  ( Gripper                           , _       , _                , Pending | Executing     ) => Wait                         , Gripper     ;
        6:  ( Gripper                           , _       , _                , Done                    ) => GotoDest                     , Approaching ;
        7:  ( Approaching                       , _       , _                , Pending | Executing     ) => Wait                         , Approaching ;
        8:  ( Approaching                       , _       , _                , Done                    ) => AcquireTool                  , Acquiring   ;
        9:  ( Acquiring                         , _       , _                , Pending | Executing     ) => Wait                         , Acquiring   ;
        10: ( Acquiring                         , _       , _                , Done                    ) => Finish                       , Start       ;
        11: ( Gripper | Approaching | Acquiring , _       , _                , Error | Joystick | Lost ) => PassUp                       , Start       ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = acquire_tool(step, s.holding, s.station, s.subtask);
    Choice { table: &ACQUIRE_TOOL, row, action, step: next.code() }
}
