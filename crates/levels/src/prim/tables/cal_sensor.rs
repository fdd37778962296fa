//! CAL-SENSOR (V.1.1).

use rcs_core::{
    Plain,
    interface::Reason::{
        InterfaceRefused, InterfaceSilent, LinkError, LinkOff, NeighbourLost, NotAtGoal, SensorError,
    },
    old_table,
    table::Decision,
};

use super::{Action, Arrival, Choice, Health, Posture, Samples, Situation};

/// Reference action of CAL-SENSOR.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Not at rest yet.
    Start,
    /// Readings are taken.
    Sampling,
}

old_table! {
    /// CAL-SENSOR (V.1.1): take what the force sensor reads at rest as no force. A robot that moves is stopped first.
    pub CAL_SENSOR: fn cal_sensor(step: Step, health: Health, posture: Posture, rest: Arrival, samples: Samples)
        -> (Action, Step)
    {
        //   step   health      posture           rest                  samples        action                   next
        1: ( _    , LinkOff   , _               , _                   , _        ) => Fail(LinkOff)          , Start    ;
        2: ( _    , LinkError , _               , _                   , _        ) => Fail(LinkError)        , Start    ;
        3: ( _    , Refused   , _               , _                   , _        ) => Fail(InterfaceRefused) , Start    ;
        4: ( _    , Silent    , _               , _                   , _        ) => Fail(InterfaceSilent)  , Start    ;
        5: ( _    , Orphaned  , _               , _                   , _        ) => Fail(NeighbourLost)    , Start    ;
        6: ( _    , Operator  , _               , _                   , _        ) => Yield                  , Start    ;
        7: ( _    , Good      , Unpositioned    , _                   , _        ) => Fail(LinkOff)          , Start    ;
        8: ( _    , Good      , Moving | Ending , _                   , _        ) => Halt                   , Start    ;
        9: ( _    , Good      , Standing        , UnderWay | Settling , _        ) => Wait                   , Start    ;
       10: ( _    , Good      , Standing        , Late                , _        ) => Fail(NotAtGoal)        , Start    ;
       11: ( _    , Good      , Standing        , Arrived             , Faulty   ) => Fail(SensorError)      , Start    ;
       12: ( _    , Good      , Standing        , Arrived             , Wanted   ) => Sample                 , Sampling ;
       13: ( _    , Good      , Standing        , Arrived             , Complete ) => Calibrate              , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = cal_sensor(step, s.health, s.posture, s.rest, s.samples);
    Choice { table: &CAL_SENSOR, row, action, step: next.code() }
}
