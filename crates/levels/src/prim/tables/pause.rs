//! PAUSE (V.1.1), with the joystick box (III.3.3).

use rcs_core::{Plain, old_table, table::Decision};

use super::{Action, Choice, Posture, Situation, attend::Switches};

/// Reference action of PAUSE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet, or nothing to do.
    Start,
    /// The motion of the command before ramps down.
    Stopping,
    /// The box moves the robot.
    Driving,
}

old_table! {
    /// PAUSE (V.1.1): do nothing. A motion ramps down within its limits; then the last point is repeated.
    /// From there on the joystick box moves the robot while one of its frame switches is on.
    pub PAUSE: fn pause(step: Step, posture: Posture, switches: Switches) -> (Action, Step) {
        //    step               posture           switches            action   next
        1: ( _                , Unpositioned    , Off           ) => Finish , Start    ;
        2: ( _                , Unpositioned    , One | Several ) => Yield  , Start    ;
        3: ( _                , Standing        , Off           ) => Finish , Start    ;
        4: ( _                , Standing        , One           ) => Drive  , Driving  ;
        5: ( _                , Standing        , Several       ) => Yield  , Start    ;
        6: ( Start            , Moving | Ending , Off           ) => Halt   , Stopping ;
        7: ( Stopping         , Moving | Ending , Off           ) => Wait   , Stopping ;
        8: ( Start | Stopping , Moving | Ending , One | Several ) => Yield  , Stopping ;
        9: ( Driving          , Moving | Ending , One           ) => Drive  , Driving  ;
       10: ( Driving          , Moving | Ending , Several       ) => Yield  , Driving  ;
       11: ( Driving          , Moving | Ending , Off           ) => Wait   , Driving  ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = pause(step, s.posture, s.switches);
    Choice { table: &PAUSE, row, action, step: next.code() }
}
