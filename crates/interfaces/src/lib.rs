//! The buffers between processes, and between the controller and its devices: chapters V and VI.
//!
//! Each process owns one record of output buffers, which starts with a [`Header`]; together they are [`CommonMemory`].
//! Variables have the manual's names in Rust spelling: `command-#-in` is `number`, its echo is `echo`, `^-pose` is
//! `pose` and holds a record number. Variables that are not in the manual are marked *extension*.

#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(
    not(test),
    deny(
        clippy::as_conversions,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic
    )
)]

pub mod data_base;
pub mod detail;
pub mod device;
pub mod emove;
pub mod grip;
pub mod hws;
pub mod jaws;
pub mod location;
pub mod operator;
pub mod pedestal;
pub mod point;
pub mod prim;
pub mod process;
pub mod processes;
pub mod quick_change;
pub mod record_number;
mod remedy;
pub mod station;
pub mod subtask;
pub mod t3i;
pub mod track;
pub mod unconfirmed;
pub mod vision;
mod words;

use geometry::pose::Pose;
use rcs_core::{Plain, handshake::Lower};

pub use self::{
    data_base::{DataBaseCommand, DataBaseStatus},
    detail::Detail,
    device::{DeviceInputs, DeviceOutputs},
    emove::EmoveOutputs,
    grip::GripOutputs,
    hws::{HwsCommand, TaskOutputs},
    jaws::JawsOutputs,
    operator::OperatorInputs,
    pedestal::{OutsidePedestal, PedestalOutputs, TableOutputs},
    prim::PrimOutputs,
    processes::{CommonMemory, CommonStatus, Fault, PROCESS_COUNT, ProcessId},
    quick_change::QuickChangeOutputs,
    subtask::SubtaskOutputs,
    t3i::T3iOutputs,
    unconfirmed::Unconfirmed,
};
pub use rcs_core::header::{Basis, Consulted, Decided, Header};

/// `status-report` of Subtask and E-move (V.2.2, V.3.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum StatusReport {
    /// No command yet (extension).
    Idle,
    /// The current command is executing.
    Executing,
    /// The current command is finished.
    Done,
    /// An error has occurred in executing the command.
    #[text = "error-state"]
    Error,
    /// The joystick box is active.
    JoystickOn,
}

impl StatusReport {
    /// The report as a state variable of the process above.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Done => Lower::Done,
            Self::Executing => Lower::Executing,
            Self::Error => Lower::Error,
            Self::JoystickOn => Lower::Joystick,
        }
    }
}

/// Why a command failed: `status-para-out`, passed up the ladder unchanged
/// (extension, docs/design/failures.md "Reason").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(doc)]
pub enum Reason {
    /// It did not fail.
    #[text = ""]
    None,
    /// The process was restarted and does not know how far the command had come.
    Restarted,
    /// A neighbouring process does not answer.
    NeighbourLost,
    /// The command is not known.
    UnknownCommand,
    /// The joystick box is on.
    JoystickOn,
    /// The object is not in the task data.
    UnknownObject,
    /// The location is not in the task data.
    UnknownLocation,
    /// The sector is not in the array.
    SectorOutOfRange,
    /// The object has no array at the location.
    NoArrayForObject,
    /// The object has no such grip.
    UnknownGrip,
    /// No grip movetable for the object at the location.
    NoGripMovetable,
    /// No trajectory from the present location to the destination.
    NoTrajectory,
    /// The robot is at no known location.
    UnknownStart,
    /// No approach trajectory for the object at the location.
    NoApproach,
    /// A record number is in no file.
    BadRecord,
    /// The command names no location.
    NoDestination,
    /// The command names no object.
    NoObjectNamed,
    /// Another object is held already.
    AlreadyHolding,
    /// No object is held.
    NothingHeld,
    /// The fingers closed on nothing.
    GraspMissed,
    /// The object was lost on the way.
    ObjectLost,
    /// The attached gripper is not the one for the object.
    WrongGripper,
    /// The object is held with another grip than the destination needs.
    RegripNeeded,
    /// Vision sees no object.
    NothingSeen,
    /// Vision does not recognise the object.
    NotRecognised,
    /// Vision does not answer.
    VisionSilent,
    /// The gripper cannot reach the commanded opening or force.
    GripUnattainable,
    /// The gripper does not finish.
    GripTimeout,
    /// The gripper is not calibrated.
    GripNotCalibrated,
    /// The quick change is not locked or its sensors fail.
    QuickChangeFault,
    /// The link to the robot controller is off.
    LinkOff,
    /// The link to the robot controller reports an error.
    LinkError,
    /// The T3 interface does not answer.
    InterfaceSilent,
    /// The T3 interface refused a command.
    InterfaceRefused,
    /// The robot did not come to rest at the goal.
    NotAtGoal,
    /// A sensor is overloaded or fails.
    SensorError,
    /// The database does not accept the update.
    DataBase,
    /// The trajectory parameters allow no motion.
    BadParameters,
    /// The locking ring of the quick change is stuck.
    QuickChangeStuck,
    /// The gripper did not come off in the holster.
    NotDetached,
    /// No gripper was attached in the holster.
    NotAttached,
    /// The gripper in the holster is not the one expected.
    WrongGripperId,
    /// The holster is not empty.
    HolsterOccupied,
    /// No gripper is seated in the holster.
    HolsterEmpty,
    /// The task data have no holster for the gripper.
    NoHolster,
    /// The task data lack a relative move of the command.
    NoRelativeMove,
    /// The sensor of the guarded move is not in the task data.
    UnknownSensor,
    /// The sensor condition did not come on the way to the goal.
    NotDetected,
    /// The sensor condition came before the goal was reached.
    Detected,
    /// The fingers of the gripper are stuck.
    JawsStuck,
    /// The Active Pedestal cannot do what it is asked.
    PedestalCannot,
    /// The Active Pedestal reports an error.
    PedestalError,
    /// The Active Pedestal does not answer.
    PedestalSilent,
    /// The task data do not say how the pedestal takes the object.
    NoPedestalData,
    /// What must precede the command has not been done.
    NotPrepared,
    /// The Data System does not answer.
    DataBaseSilent,
    /// The rotary table of the pedestal does not reach its angle.
    TableStuck,
    /// The angle is beyond a limit of the rotary table.
    TableLimit,
    /// The gripper with the object is off the robot, or its id pins or the sensors of the ring say so.
    GripperGone,
    /// Vision answers what its camera cannot have seen.
    VisionImplausible,
    /// It is not known whether the gripper holds something.
    HeldNotKnown,
    /// A gripper change was interrupted while the robot was in a holster.
    InHolster,
    /// A gripper is mated and the locking ring is not locked.
    RingNotLocked,
    /// The robot moves to a holster only in order to change the gripper.
    HolsterOnly,
    /// The robot was stopped on a path that it can only continue forward.
    ForwardOnly,
    /// An order was carried out and has changed nothing.
    NoEffect,
    /// The gripper holds something unknown.
    UnknownHeld,
    /// The part is in the pedestal's hand.
    PartInPedestal,
    /// The part in the pedestal's hand is not known to be the object of the command.
    PedestalHoldsOther,
    /// The source and destination grips are equal, so there is nothing to regrip.
    EqualGrips,
    /// The destination of ACQUIRE-TOOL is not TOOL-SAFE.
    NotNearDrum,
    /// The pedestal's hand closed on nothing.
    HandMissed,
    /// The pedestal's hand has lost the object.
    HandLost,
    /// The pedestal's hand is not calibrated.
    HandNotCalibrated,
    /// The pedestal's hand does not finish.
    HandTimeout,
    /// The pedestal's hand cannot reach the commanded opening or force.
    HandUnattainable,
    /// The sensors of the pedestal's hand do not show whether it holds the object.
    HandUncertain,
    /// The angle of the pedestal's rotary table is not known.
    TableAngleUnknown,
    /// The robot is not where it was sent.
    RobotElsewhere,
    /// The robot was stopped half-way into the tool drum or out of it.
    InDrum,
    /// The id pins of the quick change name another gripper, or none, at a locked ring.
    PinsFail,
    /// The command is complete, and the robot has since left the place where the command ends.
    SentAway,
    /// An object is held where nothing would support it.
    HeldElsewhere,
    /// The release of an object was interrupted, and the fingers still hold it.
    ReleaseNotEnded,
    /// The object lies too near to the edge of its tray for the open fingers.
    AtTrayEdge,
    /// The robot has been moved off its place, and what it holds may be clamped there.
    OffPlace,
    /// The robot is off its commanded path.
    OffPath,
    /// The tool meets something in front of the drum: its place is not free.
    DrumOccupied,
    /// The tool is not in the drum: the fingers closed on nothing of its size there.
    NoToolInDrum,
    /// The force sensor has not been calibrated at TOOL-SAFE, and the robot is no longer there.
    ForceUncalibrated,
    /// The command does not pass the check against the task data.
    CheckFailed,
    /// An object is brought to the pedestal only in order to regrip it.
    PedestalOnly,
    /// The vise is not known to clamp the object.
    NotClamped,
    /// A device of the field I/O does not answer.
    DeviceSilent,
    /// The outputs of a device were made safe, and nobody has released them.
    DeviceTripped,
}

/// Writers of changing pose records, as part of the record numbers.
pub mod pose_range {
    /// Record numbers from here on are changing records.
    pub const CHANGING: u32 = 0x8000_0000;
    /// T-POSE records of Task.
    pub const TASK: u32 = 0x8100_0000;
    /// Records of E-move: goals, located objects.
    pub const EMOVE: u32 = 0x8200_0000;
    /// Records of Prim: present, sensor and detected poses.
    pub const PRIM: u32 = 0x8300_0000;
    /// Records of Subtask: locations that no Task command names.
    pub const SUBTASK: u32 = 0x8400_0000;
    /// Bits of a record number that identify the writer.
    pub const WRITER: u32 = 0xFF00_0000;

    /// The record number after `number` in the same range. The numbers wrap around after 2^24.
    #[must_use]
    pub const fn next(writer: u32, number: u32) -> u32 {
        let generation = (number & !WRITER).wrapping_add(1) & !WRITER;
        if generation == 0 { writer | 1 } else { writer | generation }
    }
}

/// A pose record that changes at run time (T-POSE-1 …, VII.1). Each change gives it a new number.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ChangingPose {
    /// Record number; `None` while empty.
    pub number: Option<u32>,
    /// The pose.
    pub pose: Pose,
}

impl CommonMemory {
    /// A changing pose by its record number, of any process.
    #[must_use]
    pub fn changing_pose(&self, number: u32) -> Option<&Pose> {
        let records: &[ChangingPose] = match number & pose_range::WRITER {
            pose_range::TASK => &self.task.poses,
            pose_range::SUBTASK => &self.subtask.poses,
            pose_range::EMOVE => &self.emove.poses,
            pose_range::PRIM => &self.prim.poses,
            _ => return None,
        };
        records.iter().find(|record| record.number == Some(number)).map(|record| &record.pose)
    }

    /// The outputs of the controller to its devices, collected from their owners.
    #[must_use]
    pub fn device_outputs(&self) -> DeviceOutputs {
        DeviceOutputs {
            link_tx: self.t3i.link_tx,
            robot_stop: self.t3i.status.following == t3i::Following::OffPath,
            grip: self.grip.valves,
            quick_change: self.quick_change.valves,
            vision: self.emove.vision,
            v_grip: self.v_grip.valves,
            tool_grip: self.tool_grip.valves,
            joystick_leds: self.prim.joystick_leds,
            pedestal_hand: self.hand.valves,
            pedestal_table: self.table.motor,
        }
    }
}

/// All external inputs of a tick: a replay needs no others.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ExternalInputs {
    /// From the workstation controller.
    pub hws: HwsCommand,
    /// From the devices.
    pub devices: DeviceInputs,
    /// From the Data System.
    pub data_base: DataBaseStatus,
    /// Generation of the task data in this tick: 0 before the first reload, then one more per reload.
    pub generation: u32,
    /// From an Active Pedestal on a separate system.
    pub pedestal: OutsidePedestal,
    /// From the operators' terminals.
    pub operator: OperatorInputs,
}
