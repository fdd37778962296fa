//! ACQUIRE-TOOL (V.2.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Detection, Fingers, Held, Situation, Station};
use crate::emove::relative::Relative::{AcqNear, AcqSlide, AcqStrike};

coded_enum! {
    /// Reference action of ACQUIRE-TOOL.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The gripper is opening.
        Opening = "opening",
        /// The robot is moving towards the machine tool.
        Approaching = "approaching",
        /// The force sensor is being calibrated for the contact.
        CalibratingFirst = "calibrating first",
        /// The robot is moving into contact with the strike plate.
        Striking = "striking",
        /// The force sensor is being calibrated for the slide.
        CalibratingSecond = "calibrating second",
        /// The gripper is sliding to the left.
        Sliding = "sliding",
        /// The gripper is closing.
        Grasping = "grasping",
    }
}

decision_table! {
    /// ACQUIRE-TOOL (V.2.1): open the tool gripper, move towards the machine tool, calibrate, touch the strike plate, calibrate, slide to
    /// the left around the tool, grasp it. Done at once if it is held in the drum.
    pub ACQUIRE_TOOL: fn acquire_tool(step: Step, station: Station, held: Held, fingers: Fingers, gripper: Lower, detection: Detection, prim: Lower) -> (Action, Step) {
        //     step                                                         station             held      fingers    gripper                    detection Prim                       action                         next
        1:  ( Start                                                      , _                 , Other   , _        , _                       , _       , _                       ) => Fail(Reason::AlreadyHolding) , Start             ;
        2:  ( Start                                                      , InDrum            , Right   , _        , _                       , _       , _                       ) => Finish                       , Start             ;
        3:  ( Start                                                      , Elsewhere | There , Right   , _        , _                       , _       , _                       ) => Fail(Reason::NotPrepared)    , Start             ;
        4:  ( Start                                                      , InDrum            , Nothing , _        , _                       , _       , _                       ) => Fail(Reason::NotPrepared)    , Start             ;
        5:  ( Start                                                      , Elsewhere | There , Nothing , _        , _                       , _       , _                       ) => OpenToApproach               , Opening           ;
        6:  ( Opening | Grasping                                         , _                 , _       , _        , Error | Joystick | Lost , _       , _                       ) => FailGrip                     , Start             ;
        7:  ( Opening                                                    , _                 , _       , _        , Pending | Executing     , _       , _                       ) => Wait                         , Opening           ;
        8:  ( Opening                                                    , _                 , _       , _        , Done                    , _       , _                       ) => DeltaMove(AcqNear)           , Approaching       ;
        9:  ( Approaching | CalibratingFirst | Striking                  , _                 , _       , _        , _                       , _       , Error | Joystick | Lost ) => PassUp                       , Start             ;
        10: ( CalibratingSecond | Sliding                                , _                 , _       , _        , _                       , _       , Error | Joystick | Lost ) => PassUp                       , Start             ;
        11: ( Approaching                                                , _                 , _       , _        , _                       , _       , Pending | Executing     ) => Wait                         , Approaching       ;
        12: ( Approaching                                                , _                 , _       , _        , _                       , _       , Done                    ) => CalSensor                    , CalibratingFirst  ;
        13: ( CalibratingFirst                                           , _                 , _       , _        , _                       , _       , Pending | Executing     ) => Wait                         , CalibratingFirst  ;
        14: ( CalibratingFirst                                           , _                 , _       , _        , _                       , _       , Done                    ) => GoUntil(AcqStrike)           , Striking          ;
        15: ( Striking                                                   , _                 , _       , _        , _                       , Awaited , Pending | Executing     ) => Wait                         , Striking          ;
        16: ( Striking | Sliding                                         , _                 , _       , _        , _                       , Overdue , Pending | Executing     ) => Fail(Reason::NotDetected)    , Start             ;
        17: ( Striking                                                   , _                 , _       , _        , _                       , _       , Done                    ) => CalSensor                    , CalibratingSecond ;
        18: ( CalibratingSecond                                          , _                 , _       , _        , _                       , _       , Pending | Executing     ) => Wait                         , CalibratingSecond ;
        19: ( CalibratingSecond                                          , _                 , _       , _        , _                       , _       , Done                    ) => GoUntil(AcqSlide)            , Sliding           ;
        20: ( Sliding                                                    , _                 , _       , _        , _                       , Awaited , Pending | Executing     ) => Wait                         , Sliding           ;
        21: ( Sliding                                                    , _                 , _       , _        , _                       , _       , Done                    ) => Close                        , Grasping          ;
        22: ( Grasping                                                   , _                 , _       , _        , Pending | Executing     , _       , _                       ) => Wait                         , Grasping          ;
        23: ( Grasping                                                   , _                 , _       , Gripping , Done                    , _       , _                       ) => Acquired                     , Start             ;
        24: ( Grasping                                                   , _                 , _       , Empty    , Done                    , _       , _                       ) => Fail(Reason::GraspMissed)    , Start             ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } =
        acquire_tool(step, s.station, s.held, s.fingers, s.gripper, s.detection, s.prim);
    Choice { table: &ACQUIRE_TOOL, row, action, step: next.code() }
}
