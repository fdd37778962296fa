//! GO-WHILE (V.1.1).

use rcs_core::{
    Plain,
    interface::Reason::{
        Detected, InterfaceRefused, InterfaceSilent, LinkError, LinkOff, NeighbourLost, NotAtGoal,
        SensorError,
    },
    old_table,
    table::Decision,
};

use super::{Action, Arrival, Choice, Guard, Health, Posture, Situation};

/// Reference action of GO-WHILE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// On the way.
    Going,
}

old_table! {
    /// GO-WHILE (V.1.1): move to a point and stop, while the condition does not come. If it comes, or the
    /// sensor cannot tell, the robot ramps down and the move has failed.
    pub GO_WHILE: fn go_while(step: Step, health: Health, posture: Posture, guard: Guard, arrival: Arrival)
        -> (Action, Step)
    {
        //    step    health      posture        guard    arrival                   action                   next
        1: ( _     , LinkOff   , _            , _      , _                   ) => Fail(LinkOff)          , Start ;
        2: ( _     , LinkError , _            , _      , _                   ) => Fail(LinkError)        , Start ;
        3: ( _     , Refused   , _            , _      , _                   ) => Fail(InterfaceRefused) , Start ;
        4: ( _     , Silent    , _            , _      , _                   ) => Fail(InterfaceSilent)  , Start ;
        5: ( _     , Orphaned  , _            , _      , _                   ) => Fail(NeighbourLost)    , Start ;
        6: ( _     , Operator  , _            , _      , _                   ) => Yield                  , Start ;
        7: ( _     , Good      , Unpositioned , _      , _                   ) => Fail(LinkOff)          , Start ;
        8: ( _     , Good      , _            , Faulty , _                   ) => Fail(SensorError)      , Start ;
        9: ( _     , Good      , _            , Met    , _                   ) => Fail(Detected)         , Start ;
       10: ( Start , Good      , _            , Clear  , _                   ) => Go                     , Going ;
       11: ( Going , Good      , _            , Clear  , UnderWay | Settling ) => Wait                   , Going ;
       12: ( Going , Good      , _            , Clear  , Arrived             ) => Finish                 , Start ;
       13: ( Going , Good      , _            , Clear  , Late                ) => Fail(NotAtGoal)        , Start ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = go_while(step, s.health, s.posture, s.guard, s.arrival);
    Choice { table: &GO_WHILE, row, action, step: next.code() }
}
