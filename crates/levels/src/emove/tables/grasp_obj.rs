//! GRASP-OBJ (V.2.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Fingers, Held, Situation};

/// Reference action of GRASP-OBJ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The gripper is closing.
    Closing,
}

old_table! {
    /// GRASP-OBJ (V.2.1): close the gripper on the object; done at once if it is held.
    pub GRASP_OBJ: fn grasp_obj(step: Step, held: Held, fingers: Fingers, gripper: Lower) -> (Action, Step) {
        //    step      held      fingers    gripper                     action                        next
        1: ( Start   , Right   , _        , _                       ) => Finish                       , Start   ;
        2: ( Start   , Other   , _        , _                       ) => Fail(Reason::AlreadyHolding) , Start   ;
        3: ( Start   , Nothing , _        , _                       ) => Close                        , Closing ;
        4: ( Closing , _       , _        , Pending | Executing     ) => Wait                         , Closing ;
        5: ( Closing , _       , Gripping , Done                    ) => Grasped                      , Start   ;
        6: ( Closing , _       , Empty    , Done                    ) => Fail(Reason::GraspMissed)    , Start   ;
        7: ( Closing , _       , _        , Error | Joystick | Lost ) => FailGrip                     , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = grasp_obj(step, s.held, s.fingers, s.gripper);
    Choice { table: &GRASP_OBJ, row, action, step: next.code() }
}
