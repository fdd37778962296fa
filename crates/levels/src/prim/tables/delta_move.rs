//! DELTA-MOVE (V.1.1).

use rcs_core::{
    Plain,
    interface::Reason::{InterfaceRefused, InterfaceSilent, LinkError, LinkOff, NeighbourLost, NotAtGoal},
    old_table,
    table::Decision,
};

use super::{Action, Arrival, Choice, Health, Posture, Situation};

/// Reference action of DELTA-MOVE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// On the way.
    Going,
}

old_table! {
    /// DELTA-MOVE (V.1.1): move to a place given relative to a pose, by a movetable, and stop. It ends as
    /// GOTO-PT does.
    pub DELTA_MOVE: fn delta_move(step: Step, health: Health, posture: Posture, arrival: Arrival)
        -> (Action, Step)
    {
        //    step    health      posture        arrival                   action                   next
        1: ( _     , LinkOff   , _            , _                   ) => Fail(LinkOff)          , Start ;
        2: ( _     , LinkError , _            , _                   ) => Fail(LinkError)        , Start ;
        3: ( _     , Refused   , _            , _                   ) => Fail(InterfaceRefused) , Start ;
        4: ( _     , Silent    , _            , _                   ) => Fail(InterfaceSilent)  , Start ;
        5: ( _     , Orphaned  , _            , _                   ) => Fail(NeighbourLost)    , Start ;
        6: ( _     , Operator  , _            , _                   ) => Yield                  , Start ;
        7: ( _     , Good      , Unpositioned , _                   ) => Fail(LinkOff)          , Start ;
        8: ( Start , Good      , _            , _                   ) => Go                     , Going ;
        9: ( Going , Good      , _            , UnderWay | Settling ) => Wait                   , Going ;
       10: ( Going , Good      , _            , Arrived             ) => Finish                 , Start ;
       11: ( Going , Good      , _            , Late                ) => Fail(NotAtGoal)        , Start ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = delta_move(step, s.health, s.posture, s.arrival);
    Choice { table: &DELTA_MOVE, row, action, step: next.code() }
}
