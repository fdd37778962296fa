//! Preconditions of a command before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if the gripper is not the right one, or if a record that it needs is
    /// missing; nothing has been ordered then, since HALT has stopped what was under way. A robot that
    /// changes a gripper, is half way at the tool drum, or whose gripper is not locked, goes nowhere; one
    /// whose id pins fail only to a plain location. Quick change commands have rows of their own for the
    /// gripper. While the operator has the robot only E-PAUSE is accepted: fingers and ring must not move
    /// where the commander does not know the robot to be.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1:  asked: Before                                              => consult;
        2:  verb: None                                                 => Refuse(UnknownCommand);
        3:  verb: MovToObj | MovObjTo | MovToVu, coupling: Misread     => Refuse(PinsFail);
        4:  verb: MovToHol | QcDetach | QcAttach, coupling: Misread    => Refuse(PinsFail);
        5:  verb: LocateObj | GraspObj, coupling: Misread              => Refuse(PinsFail);
        6:  verb: InsertTool | ReleaseTool, coupling: Misread          => Refuse(PinsFail);
        7:  verb: AcquireTool | RemoveTool, coupling: Misread          => Refuse(PinsFail);
        8:  verb: MovToHol, gripper: Wrong                             => Refuse(WrongGripper);
        9:  verb: MovToObj | MovObjTo | MovToVu, gripper: Wrong | None => Refuse(WrongGripper);
        10: verb: LocateObj | GraspObj, gripper: Wrong | None          => Refuse(WrongGripper);
        11: verb: InsertTool | ReleaseTool, gripper: Wrong | None      => Refuse(WrongGripper);
        12: verb: AcquireTool | RemoveTool, gripper: Wrong | None      => Refuse(WrongGripper);
        13: verb: MovToLoc | MovToObj | MovObjTo, exchange: HalfDone   => Refuse(InHolster);
        14: verb: MovToVu | MovToHol | Withdraw, exchange: HalfDone    => Refuse(InHolster);
        15: verb: InsertTool | ReleaseTool, exchange: HalfDone         => Refuse(InHolster);
        16: verb: AcquireTool | RemoveTool, exchange: HalfDone         => Refuse(InHolster);
        17: verb: LocateObj | GraspObj, exchange: HalfDone             => Refuse(InHolster);
        18: verb: MovToLoc | MovToObj | MovObjTo, drum: HalfDone       => Refuse(InDrum);
        19: verb: MovToVu | MovToHol | Withdraw, drum: HalfDone        => Refuse(InDrum);
        20: verb: QcDetach | QcAttach, drum: HalfDone                  => Refuse(InDrum);
        21: verb: MovToLoc | MovToObj | MovObjTo, coupling: Loose      => Refuse(RingNotLocked);
        22: verb: MovToVu | MovToHol | Withdraw, coupling: Loose       => Refuse(RingNotLocked);
        23: verb: InsertTool | ReleaseTool, coupling: Loose            => Refuse(RingNotLocked);
        24: verb: AcquireTool | RemoveTool, coupling: Loose            => Refuse(RingNotLocked);
        25: verb: LocateObj | GraspObj, coupling: Loose                => Refuse(RingNotLocked);
        26: target: Holster                                            => Refuse(HolsterOnly);
        27: verb: InsertTool | ReleaseTool, start: Unknown             => Refuse(UnknownStart);
        28: verb: AcquireTool | RemoveTool, start: Unknown             => Refuse(UnknownStart);
        29: verb: GraspObj | AcquireTool, sizes: Missing               => Refuse(UnknownGrip);
        30: verb: LocateObj, view: Missing                             => Refuse(BadRecord);
        31: verb: QcDetach | QcAttach, holster: NoGripper              => Refuse(NoHolster);
        32: verb: QcDetach | QcAttach, holster: NoOpening              => Refuse(UnknownGrip);
        33: moves: Missing                                             => Refuse(NoRelativeMove);
        34: moves: Unguarded                                           => Refuse(UnknownSensor);
        35: moves: NoPose                                              => Refuse(NoDestination);
        36: route: NoPose                                              => Refuse(NoDestination);
        37: route: BadPose | NoView                                    => Refuse(BadRecord);
        38: route: NoSizes                                             => Refuse(UnknownGrip);
        39: route: NoGrip                                              => Refuse(NoGripMovetable);
        40: route: NoApproach | NoSpeed                                => Refuse(NoApproach);
        41: route: NoStart                                             => Refuse(UnknownStart);
        42: route: ForwardOnly                                         => Refuse(ForwardOnly);
        43: route: InDrum                                              => Refuse(NotPrepared);
        44: route: NoTrajectory                                        => Refuse(NoTrajectory);
        45: route: OffPlace                                            => Refuse(OffPlace);
        46: route: Planned, joystick: Off                              => consult;
        47: route: Planned, joystick: On, verb: Pause                  => consult;
        48: route: Planned, joystick: On                               => Manual;
    }
}
