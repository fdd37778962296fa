//! GO-THRU (V.1.1).

use rcs_core::{
    Plain,
    interface::Reason::{InterfaceRefused, InterfaceSilent, LinkError, LinkOff, NeighbourLost},
    old_table,
    table::Decision,
};

use super::{Action, Choice, Health, Passage, Posture, Situation};

/// Reference action of GO-THRU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// On the way.
    Going,
}

old_table! {
    /// GO-THRU (V.1.1): move near a point on the way to the next. Done within the brake distance; the robot
    /// flies on while the next command comes, and stops at the point if none does.
    pub GO_THRU: fn go_thru(step: Step, health: Health, posture: Posture, passage: Passage)
        -> (Action, Step)
    {
        //    step    health      posture        passage        action                   next
        1: ( _     , LinkOff   , _            , _        ) => Fail(LinkOff)          , Start ;
        2: ( _     , LinkError , _            , _        ) => Fail(LinkError)        , Start ;
        3: ( _     , Refused   , _            , _        ) => Fail(InterfaceRefused) , Start ;
        4: ( _     , Silent    , _            , _        ) => Fail(InterfaceSilent)  , Start ;
        5: ( _     , Orphaned  , _            , _        ) => Fail(NeighbourLost)    , Start ;
        6: ( _     , Operator  , _            , _        ) => Yield                  , Start ;
        7: ( _     , Good      , Unpositioned , _        ) => Fail(LinkOff)          , Start ;
        8: ( Start , Good      , _            , _        ) => Go                     , Going ;
        9: ( Going , Good      , _            , UnderWay ) => Wait                   , Going ;
       10: ( Going , Good      , _            , Passing  ) => Finish                 , Start ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = go_thru(step, s.health, s.posture, s.passage);
    Choice { table: &GO_THRU, row, action, step: next.code() }
}
