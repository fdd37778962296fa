//! What a new command needs before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// PRECONDITION: a new command whose names are known is refused if it names too little, if its grips, its gripper or
    /// its way do not fit, if it does not pass the check against the task data that precedes Task, and while the
    /// operator has the robot. PAUSE is what an operator needs; anything else would move the robot under manual
    /// control. An object that is put on the pedestal would fall: only FIX-GRIP closes its hand.
    pub PRECONDITION: fn precondition(super::Preconditions) -> super::Action or () {
        1:  asked: Before                                                            => consult;
        2:  verb: Transfer | Refixture | Acquire | AcquireTool, handling: NoObject   => Fail(NoObjectNamed);
        3:  verb: Transfer | Refixture | Acquire, source: Null                       => Fail(NoDestination);
        4:  verb: Move, handling: Object, source: Null                               => Fail(NoDestination);
        5:  verb: Transfer | Refixture | Acquire | Move, source: NoGrip              => Fail(UnknownGrip);
        6:  verb: Transfer | Refixture | Move | Position | AcquireTool, goal: Null   => Fail(NoDestination);
        7:  verb: Transfer | Refixture | Move | Position, goal: NoGrip               => Fail(UnknownGrip);
        8:  verb: Transfer, destination: Pedestal                                    => Fail(PedestalOnly);
        9:  verb: InsertTool | ReleaseTool | AcquireTool | RemoveTool, tool: Unfit   => Fail(WrongGripper);
        10: verb: InsertTool | ReleaseTool | AcquireTool | RemoveTool, tool: NoGrip  => Fail(UnknownGrip);
        11: verb: Transfer | Refixture | Move, regrip: NoData                        => Fail(NoPedestalData);
        12: verb: Refixture, regrip: None                                            => Fail(EqualGrips);
        13: verb: AcquireTool, destination: Elsewhere | Pedestal                     => Fail(NotNearDrum);
        14: verb: ReleaseTool | RemoveTool, way_out: NoTrajectory                    => Fail(NoTrajectory);
        15: verb: Pause                                                              => consult;
        16: checked: Fails                                                           => Fail(CheckFailed);
        17: control: Manual                                                          => Fail(JoystickOn);
        18: control: Automatic                                                       => consult;
    }
}
