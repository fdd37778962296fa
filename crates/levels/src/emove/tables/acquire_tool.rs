//! ACQUIRE-TOOL (V.2.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Fingers, Held, Situation, Station, Travel};
use crate::emove::relative::Relative::{AcqNear, AcqSlide, AcqStrike};

/// Reference action of ACQUIRE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The gripper is opening.
    Opening,
    /// The robot is moving towards the machine tool.
    Approaching,
    /// The force sensor is being calibrated for the contact.
    #[text = "calibrating first"]
    CalibratingFirst,
    /// The robot is moving into contact with the strike plate.
    Striking,
    /// The force sensor is being calibrated for the slide.
    #[text = "calibrating second"]
    CalibratingSecond,
    /// The gripper is sliding to the left.
    Sliding,
    /// The gripper is closing.
    Grasping,
}

old_table! {
    /// ACQUIRE-TOOL (V.2.1): open the tool gripper, move towards the machine tool, calibrate, touch the
    /// strike plate, calibrate, slide to the left around the tool, grasp it. Done at once if it is held in
    /// the drum.
    pub ACQUIRE_TOOL: fn acquire_tool(step: Step, station: Station, held: Held, fingers: Fingers, gripper: Lower, travel: Travel) -> (Action, Step) {
        //     step                                        station             held      fingers    gripper                   travel                 action                         next
        1:  ( Start                                     , _                 , Other   , _        , _                       , _                 ) => Fail(Reason::AlreadyHolding) , Start             ;
        2:  ( Start                                     , InDrum            , Right   , _        , _                       , _                 ) => Finish                       , Start             ;
        3:  ( Start                                     , Elsewhere | There , Right   , _        , _                       , _                 ) => Fail(Reason::NotPrepared)    , Start             ;
        4:  ( Start                                     , InDrum            , Nothing , _        , _                       , _                 ) => Fail(Reason::NotPrepared)    , Start             ;
        5:  ( Start                                     , Elsewhere | There , Nothing , _        , _                       , _                 ) => OpenToApproach               , Opening           ;
        6:  ( Opening                                   , _                 , _       , _        , Pending | Executing     , _                 ) => Wait                         , Opening           ;
        7:  ( Opening                                   , _                 , _       , _        , Done                    , _                 ) => DeltaMove(AcqNear)           , Approaching       ;
        8:  ( Approaching                               , _                 , _       , _        , _                       , UnderWay | Missed ) => Wait                         , Approaching       ;
        9:  ( Approaching                               , _                 , _       , _        , _                       , Over              ) => CalSensor                    , CalibratingFirst  ;
        10: ( CalibratingFirst                          , _                 , _       , _        , _                       , UnderWay | Missed ) => Wait                         , CalibratingFirst  ;
        11: ( CalibratingFirst                          , _                 , _       , _        , _                       , Over              ) => GoUntil(AcqStrike)           , Striking          ;
        12: ( Striking                                  , _                 , _       , _        , _                       , UnderWay          ) => Wait                         , Striking          ;
        13: ( Striking | Sliding                        , _                 , _       , _        , _                       , Missed            ) => Fail(Reason::NotDetected)    , Start             ;
        14: ( Striking                                  , _                 , _       , _        , _                       , Over              ) => CalSensor                    , CalibratingSecond ;
        15: ( CalibratingSecond                         , _                 , _       , _        , _                       , UnderWay | Missed ) => Wait                         , CalibratingSecond ;
        16: ( CalibratingSecond                         , _                 , _       , _        , _                       , Over              ) => GoUntil(AcqSlide)            , Sliding           ;
        17: ( Sliding                                   , _                 , _       , _        , _                       , UnderWay          ) => Wait                         , Sliding           ;
        18: ( Sliding                                   , _                 , _       , _        , _                       , Over              ) => Close                        , Grasping          ;
        19: ( Approaching | CalibratingFirst | Striking , _                 , _       , _        , _                       , Failed            ) => PassUp                       , Start             ;
        20: ( CalibratingSecond | Sliding               , _                 , _       , _        , _                       , Failed            ) => PassUp                       , Start             ;
        21: ( Grasping                                  , _                 , _       , _        , Pending | Executing     , _                 ) => Wait                         , Grasping          ;
        22: ( Grasping                                  , _                 , _       , Gripping , Done                    , _                 ) => Acquired                     , Start             ;
        23: ( Grasping                                  , _                 , _       , Empty    , Done                    , _                 ) => Fail(Reason::GraspMissed)    , Start             ;
        24: ( Opening | Grasping                        , _                 , _       , _        , Error | Joystick | Lost , _                 ) => FailGrip                     , Start             ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } =
        acquire_tool(step, s.station, s.held, s.fingers, s.gripper, s.travel);
    Choice { table: &ACQUIRE_TOOL, row, action, step: next.code() }
}
