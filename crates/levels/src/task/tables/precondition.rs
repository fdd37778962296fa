use rcs_core::decision_table;

decision_table! {
    /// PRECONDITION: a new command with known names is refused if data are missing; if its grips, gripper or route do
    /// not fit; or if it fails the check against the task data that precedes Task. Under manual control only PAUSE is
    /// accepted: any other command would move the robot. A TRANSFER to the pedestal is refused: the object
    /// would fall, since only FIX-GRIP closes the pedestal's hand.
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
