//! The buffers between processes, and between the controller and its devices: chapters V and VI.
//!
//! Each process owns one record of output buffers; together they are [`CommonMemory`]. Every buffer record starts with a
//! [`Header`] and is written only by its owner. Variables have the manual's names in Rust's spelling: `command-#-in` is
//! `number`, its echo is `echo`, `^-pose` is `pose` and holds a record number. What the manual does not have is marked
//! *extension*.

pub mod data_base;
pub mod device;
pub mod emove;
pub mod grip;
pub mod hws;
pub mod jaws;
pub mod pedestal;
pub mod prim;
pub mod processes;
pub mod quick_change;
pub mod subtask;
pub mod t3i;
mod words;

use crate::{Plain, handshake::Lower, name::Name16, pose::Pose, tick::Tick};

pub use self::{
    data_base::{DataBaseCommand, DataBaseStatus},
    device::{DeviceInputs, DeviceOutputs},
    emove::EmoveOutputs,
    grip::GripOutputs,
    hws::{HwsCommand, TaskOutputs},
    jaws::JawsOutputs,
    pedestal::{OutsidePedestal, PedestalOutputs, TableOutputs},
    prim::PrimOutputs,
    processes::{CommonMemory, Fault, PROCESS_COUNT, ProcessId, Said},
    quick_change::QuickChangeOutputs,
    subtask::SubtaskOutputs,
    t3i::T3iOutputs,
};

/// What every set of output buffers starts with.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Header {
    /// Tick that wrote the buffers. A stamp other than the last tick means that the process is lost.
    pub stamp: Tick,
    /// The process was not stepped in that tick (dormant or held); its last outputs were republished for it.
    pub republished: bool,
    /// Decision table that was used, from 1 in the order of the process's tables; 0 for none.
    pub table: u8,
    /// Row of it that fired, from 1; 0 for none.
    pub row: u8,
    /// Step of the current command after that row: its reference action (V.1.1); empty for none.
    pub step: Name16,
}

/// `status-report` of Subtask and E-move (V.2.2, V.3.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Report {
    /// Nothing was commanded yet (extension).
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

impl Report {
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
pub enum Reason {
    /// It did not fail.
    #[text = ""]
    None,
    /// The process was restarted and did not execute the command that stood in its buffer.
    #[text = "the process was restarted and does not know how far the command had come"]
    Restarted,
    /// A process below does not answer.
    #[text = "a process below does not answer"]
    NeighbourLost,
    /// A command word that the process does not have.
    #[text = "the command is not known"]
    UnknownCommand,
    /// The operator has the robot.
    #[text = "the joystick box is on"]
    JoystickOn,
    /// No such object in the task data.
    #[text = "the object is not in the task data"]
    UnknownObject,
    /// No such location in the task data.
    #[text = "the location is not in the task data"]
    UnknownLocation,
    /// The sector is not one of the array's.
    #[text = "the sector is not in the array"]
    SectorOutOfRange,
    /// The object has no array assigned at this location.
    #[text = "the object has no array at the location"]
    NoArrayForObject,
    /// The object form has no entry for this grip.
    #[text = "the object has no such grip"]
    UnknownGrip,
    /// No grip movetable for object, grip and location.
    #[text = "no grip movetable for the object at the location"]
    NoGripMovetable,
    /// No intermediate trajectory from here to there.
    #[text = "no trajectory from the present location to the destination"]
    NoTrajectory,
    /// It is not known where the robot is.
    #[text = "the robot is at no known location"]
    UnknownStart,
    /// An approach is missing.
    #[text = "no approach trajectory for the object at the location"]
    NoApproach,
    /// A record number that no file has.
    #[text = "a record number is in no file"]
    BadRecord,
    /// A command needs a location and has none.
    #[text = "the command names no location"]
    NoDestination,
    /// A command needs an object and has none.
    #[text = "the command names no object"]
    NoObjectNamed,
    /// An object is held that must not be.
    #[text = "another object is held already"]
    AlreadyHolding,
    /// Nothing is held though something must be.
    #[text = "no object is held"]
    NothingHeld,
    /// The fingers closed without holding anything.
    #[text = "the fingers closed on nothing"]
    GraspMissed,
    /// The object was lost on the way.
    #[text = "the object was lost on the way"]
    ObjectLost,
    /// The wrong gripper, or none, is attached, and it cannot be changed.
    #[text = "the attached gripper is not the one for the object"]
    WrongGripper,
    /// The object is held with another grip than the one with which it is to be placed: FIX-GRIP comes first.
    #[text = "the object is held with another grip than the destination needs"]
    RegripNeeded,
    /// Vision saw nothing.
    #[text = "vision sees no object"]
    NothingSeen,
    /// Vision saw something else.
    #[text = "vision does not recognise the object"]
    NotRecognised,
    /// Vision does not answer.
    #[text = "vision does not answer"]
    VisionSilent,
    /// The gripper cannot do what it is asked.
    #[text = "the gripper cannot reach the commanded opening or force"]
    GripUnattainable,
    /// The gripper does not finish.
    #[text = "the gripper does not finish"]
    GripTimeout,
    /// The gripper is not calibrated.
    #[text = "the gripper is not calibrated"]
    GripNotCalibrated,
    /// The quick change sensors contradict each other.
    #[text = "the quick change is not locked or its sensors fail"]
    QuickChangeFault,
    /// The DEPC link is off or does not respond.
    #[text = "the link to the robot controller is off"]
    LinkOff,
    /// The DEPC link detected an error.
    #[text = "the link to the robot controller reports an error"]
    LinkError,
    /// T3I does not answer.
    #[text = "the T3 interface does not answer"]
    InterfaceSilent,
    /// T3I refused a command.
    #[text = "the T3 interface refused a command"]
    InterfaceRefused,
    /// The robot did not come to rest at the goal.
    #[text = "the robot did not come to rest at the goal"]
    NotAtGoal,
    /// The sensors of a guarded move failed.
    #[text = "a sensor is overloaded or fails"]
    SensorError,
    /// The data base refused.
    #[text = "the data base does not accept the update"]
    DataBase,
    /// A TRAJ-PARA record with a count that is not positive.
    #[text = "the trajectory parameters allow no motion"]
    BadParameters,
    /// The locking ring is neither locked nor unlocked.
    #[text = "the locking ring of the quick change is stuck"]
    QuickChangeStuck,
    /// The gripper did not come off.
    #[text = "the gripper did not come off in the holster"]
    NotDetached,
    /// No gripper came on.
    #[text = "no gripper was attached in the holster"]
    NotAttached,
    /// The gripper that came on is another one than was expected.
    #[text = "the gripper in the holster is not the one expected"]
    WrongGripperId,
    /// There is a gripper in a holster that must be empty.
    #[text = "the holster is not empty"]
    HolsterOccupied,
    /// There is none in a holster that must be full.
    #[text = "no gripper is seated in the holster"]
    HolsterEmpty,
    /// No holster object for the gripper in the task data.
    #[text = "the task data have no holster for the gripper"]
    NoHolster,
    /// The task data lack a move of the command at the location.
    #[text = "the task data lack a relative move of the command"]
    NoRelativeMove,
    /// No such sensor in the task data.
    #[text = "the sensor of the guarded move is not in the task data"]
    UnknownSensor,
    /// The condition of a GO-UNTIL did not come.
    #[text = "the sensor condition did not come on the way to the goal"]
    NotDetected,
    /// The condition of a GO-WHILE came.
    #[text = "the sensor condition came before the goal was reached"]
    Detected,
    /// The fingers stand where nothing wanted them.
    #[text = "the fingers of the gripper are stuck"]
    JawsStuck,
    /// The pedestal cannot execute its command.
    #[text = "the Active Pedestal cannot do what it is asked"]
    PedestalCannot,
    /// The pedestal reports an error.
    #[text = "the Active Pedestal reports an error"]
    PedestalError,
    /// The pedestal does not answer.
    #[text = "the Active Pedestal does not answer"]
    PedestalSilent,
    /// No PED-PARA record for the object.
    #[text = "the task data do not say how the pedestal takes the object"]
    NoPedestalData,
    /// The robot does not hold, or is not where, what the command begins with.
    #[text = "what must precede the command has not been done"]
    NotPrepared,
    /// The Data System does not answer.
    #[text = "the Data System does not answer"]
    DataBaseSilent,
    /// The table of the pedestal does not turn as it should.
    #[text = "the rotary table of the pedestal does not reach its angle"]
    TableStuck,
    /// The angle is beyond a limit of the table.
    #[text = "the angle is beyond a limit of the rotary table"]
    TableLimit,
    /// The gripper that held the object is no longer seen on the robot.
    #[text = "the gripper with the object is off the robot, or its id pins or the sensors of the ring say so"]
    GripperGone,
    /// Vision measured a place or an angle that its camera does not see.
    #[text = "vision answers what its camera cannot have seen"]
    VisionImplausible,
}

/// Which process a changing pose record belongs to: part of its record number.
pub mod pose_range {
    /// Record numbers from here on are changing records.
    pub const CHANGING: u32 = 0x8000_0000;
    /// T-POSE records of Task.
    pub const TASK: u32 = 0x8100_0000;
    /// Records of E-move: goals, located objects.
    pub const EMOVE: u32 = 0x8200_0000;
    /// Records of Prim: present, sensor and detected poses.
    pub const PRIM: u32 = 0x8300_0000;
    /// Records of Subtask: locations that it names itself.
    pub const SUBTASK: u32 = 0x8400_0000;
    /// Bits of a record number that name the writer.
    pub const WRITER: u32 = 0xFF00_0000;

    /// The record number after `number` in the same range; generations start again after 2^24.
    #[must_use]
    pub const fn next(writer: u32, number: u32) -> u32 {
        let generation = (number & !WRITER).wrapping_add(1) & !WRITER;
        if generation == 0 { writer | 1 } else { writer | generation }
    }
}

/// A pose record that changes while running (T-POSE-1 …, VII.1): it has a new number whenever it changes.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ChangingPose {
    /// Record number; 0 while empty.
    pub number: u32,
    /// The pose.
    pub pose: Pose,
}

impl CommonMemory {
    /// A changing pose by its record number, from whichever process owns it.
    #[must_use]
    pub fn changing_pose(&self, number: u32) -> Option<&Pose> {
        let records: &[ChangingPose] = match number & pose_range::WRITER {
            pose_range::TASK => &self.task.poses,
            pose_range::SUBTASK => &self.subtask.poses,
            pose_range::EMOVE => &self.emove.poses,
            pose_range::PRIM => &self.prim.poses,
            _ => return None,
        };
        records.iter().find(|record| record.number == number).map(|record| &record.pose)
    }

    /// What the controller writes to its devices, gathered from the processes that own them.
    #[must_use]
    pub fn device_outputs(&self) -> DeviceOutputs {
        DeviceOutputs {
            link_tx: self.t3i.link_tx,
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

/// Everything that comes from outside in a tick: the only inputs that a replay needs.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ExternalInputs {
    /// From the workstation controller.
    pub hws: HwsCommand,
    /// From the devices.
    pub devices: DeviceInputs,
    /// From the Data System.
    pub data_base: DataBaseStatus,
    /// Generation of the task data that the tick uses: 0 as loaded before the first tick, one more after each reload.
    pub generation: u32,
    /// From an Active Pedestal that is a system of its own.
    pub pedestal: OutsidePedestal,
}
