//! What a command must have before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if the gripper is not the right one, or if a record that it needs is
    /// missing; nothing has been ordered then, since HALT has stopped what was under way. A robot that changes a
    /// gripper, is half way at the tool drum, or whose gripper is not locked, goes nowhere. Quick change commands have rows of their own
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
        13: verb: MovToLoc | MovToObj | MovObjTo, drum: HalfDone       => Refuse(InDrum);
        14: verb: MovToVu | MovToHol | Withdraw, drum: HalfDone        => Refuse(InDrum);
        15: verb: QcDetach | QcAttach, drum: HalfDone                  => Refuse(InDrum);
        16: verb: MovToLoc | MovToObj | MovObjTo, coupling: Loose      => Refuse(RingNotLocked);
        17: verb: MovToVu | MovToHol | Withdraw, coupling: Loose       => Refuse(RingNotLocked);
        18: verb: InsertTool | ReleaseTool, coupling: Loose            => Refuse(RingNotLocked);
        19: verb: AcquireTool | RemoveTool, coupling: Loose            => Refuse(RingNotLocked);
        20: verb: LocateObj | GraspObj, coupling: Loose                => Refuse(RingNotLocked);
        21: target: Holster                                            => Refuse(HolsterOnly);
        22: verb: InsertTool | ReleaseTool, start: Unknown             => Refuse(UnknownStart);
        23: verb: AcquireTool | RemoveTool, start: Unknown             => Refuse(UnknownStart);
        24: verb: GraspObj | AcquireTool, sizes: Missing               => Refuse(UnknownGrip);
        25: verb: LocateObj, view: Missing                             => Refuse(BadRecord);
        26: verb: QcDetach | QcAttach, holster: NoGripper              => Refuse(NoHolster);
        27: verb: QcDetach | QcAttach, holster: NoOpening              => Refuse(UnknownGrip);
        28: moves: Missing                                             => Refuse(NoRelativeMove);
        29: moves: Unguarded                                           => Refuse(UnknownSensor);
        30: moves: NoPose                                              => Refuse(NoDestination);
        31: route: NoPose                                              => Refuse(NoDestination);
        32: route: BadPose | NoView                                    => Refuse(BadRecord);
        33: route: NoSizes                                             => Refuse(UnknownGrip);
        34: route: NoGrip                                              => Refuse(NoGripMovetable);
        35: route: NoApproach | NoSpeed                                => Refuse(NoApproach);
        36: route: NoStart                                             => Refuse(UnknownStart);
        37: route: ForwardOnly                                         => Refuse(ForwardOnly);
        38: route: InDrum                                              => Refuse(NotPrepared);
        39: route: NoTrajectory                                        => Refuse(NoTrajectory);
        40: route: Planned                                             => consult;
    }
}
