//! ROBOT-INIT (V.1.1).

use rcs_core::{
    Plain,
    interface::Reason::{InterfaceRefused, InterfaceSilent, LinkError, LinkOff, NeighbourLost},
    old_table,
    table::Decision,
};

use super::{Action, Choice, Health, Link, Posture, Situation};

/// Reference action of ROBOT-INIT.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing sent yet.
    Start,
    /// RESTART is sent.
    Restarting,
}

old_table! {
    /// ROBOT-INIT (V.1.1): RESTART to T3I. It is there to clear errors of the link, so that only those count
    /// which come after the RESTART. The only way from an error, or from a start, to a commanded position.
    /// The joystick box does not hinder it: nothing moves.
    pub ROBOT_INIT: fn robot_init(step: Step, health: Health, posture: Posture, link: Link)
        -> (Action, Step)
    {
        //    step         health            posture           link        action                   next
        1: ( _          , Silent          , _               , _       ) => Fail(InterfaceSilent)  , Start      ;
        2: ( _          , Orphaned        , _               , _       ) => Fail(NeighbourLost)    , Start      ;
        3: ( Start      , Good | Operator , Moving | Ending , _       ) => Halt                   , Start      ;
        4: ( Start      , _               , _               , _       ) => Restart                , Restarting ;
        5: ( Restarting , LinkOff         , _               , _       ) => Fail(LinkOff)          , Start      ;
        6: ( Restarting , LinkError       , _               , _       ) => Fail(LinkError)        , Start      ;
        7: ( Restarting , Refused         , _               , _       ) => Fail(InterfaceRefused) , Start      ;
        8: ( Restarting , Good | Operator , _               , Down    ) => Wait                   , Restarting ;
        9: ( Restarting , Good | Operator , _               , Running ) => TakePosition           , Start      ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = robot_init(step, s.health, s.posture, s.link);
    Choice { table: &ROBOT_INIT, row, action, step: next.code() }
}
