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
        8:  verb: InsertTool | ReleaseTool, start: Unknown             => Refuse(UnknownStart);
        9:  verb: AcquireTool | RemoveTool, start: Unknown             => Refuse(UnknownStart);
        10: verb: GraspObj | AcquireTool, sizes: Missing               => Refuse(UnknownGrip);
        11: verb: LocateObj, view: Missing                             => Refuse(BadRecord);
        12: verb: QcDetach | QcAttach, holster: NoGripper              => Refuse(NoHolster);
        13: verb: QcDetach | QcAttach, holster: NoOpening              => Refuse(UnknownGrip);
        14: verb: MovToLoc | MovToObj | MovObjTo, exchange: HalfDone   => Refuse(InHolster);
        15: verb: MovToVu | MovToHol | Withdraw, exchange: HalfDone    => Refuse(InHolster);
        16: verb: InsertTool | ReleaseTool, exchange: HalfDone         => Refuse(InHolster);
        17: verb: AcquireTool | RemoveTool, exchange: HalfDone         => Refuse(InHolster);
        18: verb: MovToLoc | MovToObj | MovObjTo, drum: HalfDone       => Refuse(InDrum);
        19: verb: MovToVu | MovToHol | Withdraw, drum: HalfDone        => Refuse(InDrum);
        20: verb: QcDetach | QcAttach, drum: HalfDone                  => Refuse(InDrum);
        21: verb: MovToLoc | MovToObj | MovObjTo, coupling: Loose      => Refuse(RingNotLocked);
        22: verb: MovToVu | MovToHol | Withdraw, coupling: Loose       => Refuse(RingNotLocked);
        23: target: Holster                                            => Refuse(HolsterOnly);
        24: moves: Missing                                             => Refuse(NoRelativeMove);
        25: moves: Unguarded                                           => Refuse(UnknownSensor);
        26: moves: NoPose                                              => Refuse(NoDestination);
        27: route: NoPose                                              => Refuse(NoDestination);
        28: route: BadPose | NoView                                    => Refuse(BadRecord);
        29: route: NoSizes                                             => Refuse(UnknownGrip);
        30: route: NoGrip                                              => Refuse(NoGripMovetable);
        31: route: NoApproach | NoSpeed                                => Refuse(NoApproach);
        32: route: NoStart                                             => Refuse(UnknownStart);
        33: route: ForwardOnly                                         => Refuse(ForwardOnly);
        34: route: InDrum                                              => Refuse(NotPrepared);
        35: route: NoTrajectory                                        => Refuse(NoTrajectory);
        36: route: Planned                                             => consult;
    }
}
