//! What a command must have before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if the gripper is not the right one, or if a record that it needs is
    /// missing; the motion of the command before it is stopped. Quick change commands have rows of their own
    /// for the gripper.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1:  asked: Before                                              => consult;
        2:  verb: None                                                 => Fail(UnknownCommand);
        3:  verb: MovToHol, gripper: Wrong                             => Fail(WrongGripper);
        4:  verb: MovToObj | MovObjTo | MovToVu, gripper: Wrong | None => Fail(WrongGripper);
        5:  verb: LocateObj | GraspObj, gripper: Wrong | None          => Fail(WrongGripper);
        6:  verb: InsertTool | ReleaseTool, gripper: Wrong | None      => Fail(WrongGripper);
        7:  verb: AcquireTool | RemoveTool, gripper: Wrong | None      => Fail(WrongGripper);
        8:  verb: InsertTool | ReleaseTool, start: Unknown             => Fail(UnknownStart);
        9:  verb: AcquireTool | RemoveTool, start: Unknown             => Fail(UnknownStart);
        10: verb: GraspObj | AcquireTool, sizes: Missing               => Fail(UnknownGrip);
        11: verb: LocateObj, view: Missing                             => Fail(BadRecord);
        12: verb: QcDetach | QcAttach, holster: NoGripper              => Fail(NoHolster);
        13: verb: QcDetach | QcAttach, holster: NoOpening              => Fail(UnknownGrip);
        14: moves: Missing                                             => Fail(NoRelativeMove);
        15: moves: Unguarded                                           => Fail(UnknownSensor);
        16: moves: NoPose                                              => Fail(NoDestination);
        17: route: NoPose                                              => Fail(NoDestination);
        18: route: BadPose | NoView                                    => Fail(BadRecord);
        19: route: NoSizes                                             => Fail(UnknownGrip);
        20: route: NoGrip                                              => Fail(NoGripMovetable);
        21: route: NoApproach | NoSpeed                                => Fail(NoApproach);
        22: route: NoStart                                             => Fail(UnknownStart);
        23: route: InDrum                                              => Fail(NotPrepared);
        24: route: NoTrajectory                                        => Fail(NoTrajectory);
        25: route: Planned                                             => consult;
    }
}
