//! ACQUIRE-TOOL (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Held, Situation};

coded_enum! {
    /// Reference action of ACQUIRE-TOOL.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// E-move is going to the tool and grasping it.
        Acquiring = "acquiring",
    }
}

decision_table! {
    /// ACQUIRE-TOOL (V.3.1): move to a tool in the tool drum and grasp it; done at once if it is held.
    pub ACQUIRE_TOOL: fn acquire_tool(step: Step, held: Held, emove: Lower) -> (Action, Step) {
        //    step        held              E-move                     action                        next
        1: ( Start     , Right           , _                       ) => Finish                       , Start     ;
        2: ( Start     , Other           , _                       ) => Fail(Reason::AlreadyHolding) , Start     ;
        3: ( Start     , Nothing         , _                       ) => AcquireTool                  , Acquiring ;
        4: ( Acquiring , _               , Pending | Executing     ) => Wait                         , Acquiring ;
        5: ( Acquiring , Right           , Done                    ) => Finish                       , Start     ;
        6: ( Acquiring , Nothing | Other , Done                    ) => Fail(Reason::GraspMissed)    , Start     ;
        7: ( Acquiring , _               , Error | Joystick | Lost ) => PassUp                       , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = acquire_tool(step, s.held, s.emove);
    Choice { table: &ACQUIRE_TOOL, row, action, step: next.code() }
}
