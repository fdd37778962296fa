//! A new command replaces what is under way.

use rcs_core::decision_table;

decision_table! {
    /// HALT: a new command, whatever it is, waits until robot, ring and fingers are at rest: only then is it
    /// accepted or refused. E-PAUSE brings them to rest itself. What a restarted E-move had ordered is stopped,
    /// unless the operator has the robot.
    pub HALT: fn halt(super::Below) -> super::Action or () {
        1: demand: Before                                                                    => consult;
        2: demand: Restarted, prim: Joystick                                                 => Wait;
        3: demand: Restarted, prim: Pending | Executing | Done | Error | Lost                => Pause;
        4: demand: Now, pause: UnderWay | Standing                                           => consult;
        5: demand: Now, pause: Other, rest: AtRest                                           => consult;
        6: demand: Now, pause: Other, rest: Moving, halt: NotOrdered                         => Pause;
        7: demand: Now, pause: Other, rest: Moving, halt: Ordered                            => Wait;
    }
}
