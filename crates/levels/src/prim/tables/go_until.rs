//! GO-UNTIL (V.1.1).

use rcs_core::{
    Plain,
    interface::Reason::{
        InterfaceRefused, InterfaceSilent, LinkError, LinkOff, NeighbourLost, NotAtGoal, SensorError,
    },
    old_table,
    table::Decision,
};

use super::{Action, Arrival, Choice, Guard, Health, Posture, Situation};

/// Reference action of GO-UNTIL.
///
/// ```text
///             condition                          stands
///   Start ----------------------> Stopping ------------------> done
///     |                            ^    ^
///     v         condition          |    |  condition
///   Going -------------------------'    |
///     |    at the goal                  |
///     `-------------------------> Missed: not-detected
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// On the way.
    Going,
    /// The condition has come; the robot comes to rest.
    Stopping,
    /// At the goal without it.
    Missed,
}

old_table! {
    /// GO-UNTIL (V.1.1): a guarded move. Done when the condition has come and the robot stands; a goal
    /// without it is `not-detected` until it comes after all, or another command does.
    pub GO_UNTIL: fn go_until(
        step: Step, health: Health, posture: Posture, guard: Guard, arrival: Arrival, rest: Arrival,
    ) -> (Action, Step) {
        //    step                     health      posture        guard    arrival               rest                     action                   next
        1: ( _                      , LinkOff   , _            , _      , _                   , _                   ) => Fail(LinkOff)          , Start    ;
        2: ( _                      , LinkError , _            , _      , _                   , _                   ) => Fail(LinkError)        , Start    ;
        3: ( _                      , Refused   , _            , _      , _                   , _                   ) => Fail(InterfaceRefused) , Start    ;
        4: ( _                      , Silent    , _            , _      , _                   , _                   ) => Fail(InterfaceSilent)  , Start    ;
        5: ( _                      , Orphaned  , _            , _      , _                   , _                   ) => Fail(NeighbourLost)    , Start    ;
        6: ( _                      , Operator  , _            , _      , _                   , _                   ) => Yield                  , Start    ;
        7: ( _                      , Good      , Unpositioned , _      , _                   , _                   ) => Fail(LinkOff)          , Start    ;
        8: ( Start | Going | Missed , Good      , _            , Faulty , _                   , _                   ) => Fail(SensorError)      , Start    ;
        9: ( Start | Going | Missed , Good      , _            , Met    , _                   , _                   ) => Detect                 , Stopping ;
       10: ( Start                  , Good      , _            , Clear  , _                   , _                   ) => Go                     , Going    ;
       11: ( Going                  , Good      , _            , Clear  , UnderWay | Settling , _                   ) => Wait                   , Going    ;
       12: ( Going                  , Good      , _            , Clear  , Arrived             , _                   ) => Miss                   , Missed   ;
       13: ( Going                  , Good      , _            , Clear  , Late                , _                   ) => Fail(NotAtGoal)        , Start    ;
       14: ( Missed                 , Good      , _            , Clear  , _                   , _                   ) => Wait                   , Missed   ;
       15: ( Stopping               , Good      , _            , _      , _                   , UnderWay | Settling ) => Wait                   , Stopping ;
       16: ( Stopping               , Good      , _            , _      , _                   , Arrived             ) => Finish                 , Start    ;
       17: ( Stopping               , Good      , _            , _      , _                   , Late                ) => Fail(NotAtGoal)        , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = go_until(step, s.health, s.posture, s.guard, s.arrival, s.rest);
    Choice { table: &GO_UNTIL, row, action, step: next.code() }
}
