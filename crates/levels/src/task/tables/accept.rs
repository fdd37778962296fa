//! Preconditions of a command before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if a name or a record that it needs is missing, if it does not pass the
    /// check against the task data that precedes Task, and while the operator has the robot. PAUSE is what an
    /// operator needs; anything else would move the robot under manual control. An object that is put on the
    /// pedestal would fall: only FIX-GRIP closes its hand.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1:  asked: Before                                                           => consult;
        2:  verb: None                                                              => Fail(UnknownCommand);
        3:  missing: Object                                                         => Fail(UnknownObject);
        4:  gripper: Invalid                                                        => Fail(WrongGripper);
        5:  missing: Location                                                       => Fail(UnknownLocation);
        6:  missing: ObjectName                                                     => Fail(NoObjectNamed);
        7:  missing: Array                                                          => Fail(NoArrayForObject);
        8:  missing: Sector                                                         => Fail(SectorOutOfRange);
        9:  missing: Grip | GripMovetable | Holster                                 => Fail(NoGripMovetable);
        10: verb: Transfer | Refixture | Acquire | AcquireTool, handling: NoObject  => Fail(NoObjectNamed);
        11: verb: Transfer | Refixture | Acquire, source: Null                      => Fail(NoDestination);
        12: verb: Move, handling: Object, source: Null                              => Fail(NoDestination);
        13: verb: Transfer | Refixture | Acquire | Move, source_grip: None          => Fail(UnknownGrip);
        14: verb: Transfer | Refixture | Move | AcquireTool, destination: Null      => Fail(NoDestination);
        15: verb: Transfer | Refixture | Move, destination_grip: None               => Fail(UnknownGrip);
        16: verb: Transfer, pedestal_goal: Yes                                      => Fail(PedestalOnly);
        17: verb: Position, source: Null, destination: Null                         => Fail(NoDestination);
        18: verb: Position, source: Null, destination_grip: None                    => Fail(UnknownGrip);
        19: verb: Position, source: Named, source_grip: None                        => Fail(UnknownGrip);
        20: verb: InsertTool | ReleaseTool | AcquireTool | RemoveTool, tool: Unfit  => Fail(WrongGripper);
        21: verb: InsertTool | ReleaseTool | AcquireTool | RemoveTool, tool: NoGrip => Fail(UnknownGrip);
        22: verb: Transfer | Refixture | Move, grips: Different, pedestal: Missing  => Fail(NoPedestalData);
        23: verb: Refixture, grips: Same                                            => Fail(EqualGrips);
        24: verb: AcquireTool, near: No                                             => Fail(NotNearDrum);
        25: verb: ReleaseTool | RemoveTool, way_out: NoTrajectory                   => Fail(NoTrajectory);
        26: verb: Pause                                                             => consult;
        27: checked: Fails                                                          => Fail(CheckFailed);
        28: control: Manual                                                         => Fail(JoystickOn);
        29: control: Automatic                                                      => consult;
    }
}
