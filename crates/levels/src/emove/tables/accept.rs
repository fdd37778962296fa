//! What a command must have before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if the gripper is not the right one, or if a record that it needs is
    /// missing; nothing has been ordered then, since HALT has stopped what was under way. A robot that changes a
    /// gripper, or whose gripper is not locked, goes nowhere. Quick change commands have rows of their own
    /// for the gripper.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1:  asked: Before                                              => consult;
        2:  verb: None                                                 => Refuse(UnknownCommand);
        3:  verb: MovToHol, gripper: Wrong                             => Refuse(WrongGripper);
        4:  verb: MovToObj | MovObjTo | MovToVu, gripper: Wrong | None => Refuse(WrongGripper);
        5:  verb: LocateObj | GraspObj, gripper: Wrong | None          => Refuse(WrongGripper);
        6:  verb: InsertTool | ReleaseTool, gripper: Wrong | None      => Refuse(WrongGripper);
        7:  verb: AcquireTool | RemoveTool, gripper: Wrong | None      => Refuse(WrongGripper);
        8:  verb: MovToLoc | MovToObj | MovObjTo, exchange: HalfDone   => Refuse(InHolster);
        9:  verb: MovToVu | MovToHol | Withdraw, exchange: HalfDone    => Refuse(InHolster);
        10: verb: InsertTool | ReleaseTool, exchange: HalfDone         => Refuse(InHolster);
        11: verb: AcquireTool | RemoveTool, exchange: HalfDone         => Refuse(InHolster);
        12: verb: LocateObj | GraspObj, exchange: HalfDone             => Refuse(InHolster);
        13: verb: MovToLoc | MovToObj | MovObjTo, coupling: Loose      => Refuse(RingNotLocked);
        14: verb: MovToVu | MovToHol | Withdraw, coupling: Loose       => Refuse(RingNotLocked);
        15: verb: InsertTool | ReleaseTool, coupling: Loose            => Refuse(RingNotLocked);
        16: verb: AcquireTool | RemoveTool, coupling: Loose            => Refuse(RingNotLocked);
        17: verb: LocateObj | GraspObj, coupling: Loose                => Refuse(RingNotLocked);
        18: target: Holster                                            => Refuse(HolsterOnly);
        19: verb: InsertTool | ReleaseTool, start: Unknown             => Refuse(UnknownStart);
        20: verb: AcquireTool | RemoveTool, start: Unknown             => Refuse(UnknownStart);
        21: verb: GraspObj | AcquireTool, sizes: Missing               => Refuse(UnknownGrip);
        22: verb: LocateObj, view: Missing                             => Refuse(BadRecord);
        23: verb: QcDetach | QcAttach, holster: NoGripper              => Refuse(NoHolster);
        24: verb: QcDetach | QcAttach, holster: NoOpening              => Refuse(UnknownGrip);
        25: moves: Missing                                             => Refuse(NoRelativeMove);
        26: moves: Unguarded                                           => Refuse(UnknownSensor);
        27: moves: NoPose                                              => Refuse(NoDestination);
        28: route: NoPose                                              => Refuse(NoDestination);
        29: route: BadPose | NoView                                    => Refuse(BadRecord);
        30: route: NoSizes                                             => Refuse(UnknownGrip);
        31: route: NoGrip                                              => Refuse(NoGripMovetable);
        32: route: NoApproach | NoSpeed                                => Refuse(NoApproach);
        33: route: NoStart                                             => Refuse(UnknownStart);
        34: route: ForwardOnly                                         => Refuse(ForwardOnly);
        35: route: InDrum                                              => Refuse(NotPrepared);
        36: route: NoTrajectory                                        => Refuse(NoTrajectory);
        37: route: Planned                                             => consult;
    }
}
