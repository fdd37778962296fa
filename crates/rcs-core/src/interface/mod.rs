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
pub mod quick_change;
pub mod subtask;
pub mod t3i;

use crate::{coded_enum, handshake::Lower, pose::Pose, record, tick::Tick};

pub use self::{
    data_base::{DataBaseCommand, DataBaseStatus},
    device::{DeviceInputs, DeviceOutputs},
    emove::EmoveOutputs,
    grip::GripOutputs,
    hws::{HwsCommand, TaskOutputs},
    jaws::JawsOutputs,
    pedestal::{OutsidePedestal, PedestalOutputs, TableOutputs},
    prim::PrimOutputs,
    quick_change::QuickChangeOutputs,
    subtask::SubtaskOutputs,
    t3i::T3iOutputs,
};

record! {
    /// What every set of output buffers starts with.
    pub struct Header {
        /// Tick that wrote the buffers. A stamp other than the last tick means that the process is lost.
        pub stamp: Tick,
        /// The process was not stepped in that tick (dormant or held); its last outputs were republished for it.
        pub republished: bool,
        /// Decision table that was used, from 1 in the order of the process's tables; 0 for none.
        pub table: u8,
        /// Row of it that fired, from 1; 0 for none.
        pub row: u8,
    }
}

coded_enum! {
    /// `status-report` of Subtask and E-move (V.2.2, V.3.2).
    pub enum Report {
        /// Nothing was commanded yet (extension).
        Idle = "idle",
        /// The current command is executing.
        Executing = "executing",
        /// The current command is finished.
        Done = "done",
        /// An error has occurred in executing the command.
        Error = "error-state",
        /// The joystick box is active.
        JoystickOn = "joystick-on",
    }
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

coded_enum! {
    /// Why a command failed: `status-para-out`, passed up the ladder unchanged (extension, DESIGN 15).
    pub enum Reason {
        /// It did not fail.
        None = "",
        /// The process was restarted and did not execute the command that stood in its buffer.
        Restarted = "the process was restarted and does not know how far the command had come",
        /// A process below does not answer.
        NeighbourLost = "a process below does not answer",
        /// A command word that the process does not have.
        UnknownCommand = "the command is not known",
        /// The operator has the robot.
        JoystickOn = "the joystick box is on",
        /// No such object in the task data.
        UnknownObject = "the object is not in the task data",
        /// No such location in the task data.
        UnknownLocation = "the location is not in the task data",
        /// The sector is not one of the array's.
        SectorOutOfRange = "the sector is not in the array",
        /// The object has no array assigned at this location.
        NoArrayForObject = "the object has no array at the location",
        /// The object form has no entry for this grip.
        UnknownGrip = "the object has no such grip",
        /// No grip movetable for object, grip and location.
        NoGripMovetable = "no grip movetable for the object at the location",
        /// No intermediate trajectory from here to there.
        NoTrajectory = "no trajectory from the present location to the destination",
        /// It is not known where the robot is.
        UnknownStart = "the robot is at no known location",
        /// An approach is missing.
        NoApproach = "no approach trajectory for the object at the location",
        /// A record number that no file has.
        BadRecord = "a record number is in no file",
        /// A command needs a location and has none.
        NoDestination = "the command names no location",
        /// A command needs an object and has none.
        NoObjectNamed = "the command names no object",
        /// An object is held that must not be.
        AlreadyHolding = "another object is held already",
        /// Nothing is held though something must be.
        NothingHeld = "no object is held",
        /// The fingers closed without holding anything.
        GraspMissed = "the fingers closed on nothing",
        /// The object was lost on the way.
        ObjectLost = "the object was lost on the way",
        /// The wrong gripper, or none, is attached, and it cannot be changed.
        WrongGripper = "the attached gripper is not the one for the object",
        /// The object is held with another grip than the one with which it is to be placed: FIX-GRIP comes first.
        RegripNeeded = "the object is held with another grip than the destination needs",
        /// Vision saw nothing.
        NothingSeen = "vision sees no object",
        /// Vision saw something else.
        NotRecognised = "vision does not recognise the object",
        /// Vision does not answer.
        VisionSilent = "vision does not answer",
        /// The gripper cannot do what it is asked.
        GripUnattainable = "the gripper cannot reach the commanded opening or force",
        /// The gripper does not finish.
        GripTimeout = "the gripper does not finish",
        /// The gripper is not calibrated.
        GripNotCalibrated = "the gripper is not calibrated",
        /// The quick change sensors contradict each other.
        QuickChangeFault = "the quick change is not locked or its sensors fail",
        /// The DEPC link is off or does not respond.
        LinkOff = "the link to the robot controller is off",
        /// The DEPC link detected an error.
        LinkError = "the link to the robot controller reports an error",
        /// T3I does not answer.
        InterfaceSilent = "the T3 interface does not answer",
        /// T3I refused a command.
        InterfaceRefused = "the T3 interface refused a command",
        /// The robot did not come to rest at the goal.
        NotAtGoal = "the robot did not come to rest at the goal",
        /// The sensors of a guarded move failed.
        SensorError = "a sensor is overloaded or fails",
        /// The data base refused.
        DataBase = "the data base does not accept the update",
        /// A TRAJ-PARA record with a count that is not positive.
        BadParameters = "the trajectory parameters allow no motion",
        /// The locking ring is neither locked nor unlocked.
        QuickChangeStuck = "the locking ring of the quick change is stuck",
        /// The gripper did not come off.
        NotDetached = "the gripper did not come off in the holster",
        /// No gripper came on.
        NotAttached = "no gripper was attached in the holster",
        /// The gripper that came on is another one than was expected.
        WrongGripperId = "the gripper in the holster is not the one expected",
        /// There is a gripper in a holster that must be empty.
        HolsterOccupied = "the holster is not empty",
        /// There is none in a holster that must be full.
        HolsterEmpty = "no gripper is seated in the holster",
        /// No holster object for the gripper in the task data.
        NoHolster = "the task data have no holster for the gripper",
        /// The task data lack a move of the command at the location.
        NoRelativeMove = "the task data lack a relative move of the command",
        /// No such sensor in the task data.
        UnknownSensor = "the sensor of the guarded move is not in the task data",
        /// The condition of a GO-UNTIL did not come.
        NotDetected = "the sensor condition did not come on the way to the goal",
        /// The condition of a GO-WHILE came.
        Detected = "the sensor condition came before the goal was reached",
        /// The fingers stand where nothing wanted them.
        JawsStuck = "the fingers of the gripper are stuck",
        /// The pedestal cannot execute its command.
        PedestalCannot = "the Active Pedestal cannot do what it is asked",
        /// The pedestal reports an error.
        PedestalError = "the Active Pedestal reports an error",
        /// The pedestal does not answer.
        PedestalSilent = "the Active Pedestal does not answer",
        /// No PED-PARA record for the object.
        NoPedestalData = "the task data do not say how the pedestal takes the object",
        /// The robot does not hold, or is not where, what the command begins with.
        NotPrepared = "what must precede the command has not been done",
        /// The Data System does not answer.
        DataBaseSilent = "the Data System does not answer",
        /// The table of the pedestal does not turn as it should.
        TableStuck = "the rotary table of the pedestal does not reach its angle",
        /// The angle is beyond a limit of the table.
        TableLimit = "the angle is beyond a limit of the rotary table",
        /// The gripper that held the object is no longer seen on the robot.
        GripperGone = "the gripper with the object is off the robot, or its id pins or the sensors of the ring say so",
        /// Vision measured a place or an angle that its camera does not see.
        VisionImplausible = "vision answers what its camera cannot have seen",
    }
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

record! {
    /// A pose record that changes while running (T-POSE-1 …, VII.1): it has a new number whenever it changes.
    pub struct ChangingPose {
        /// Record number; 0 while empty.
        pub number: u32,
        /// The pose.
        pub pose: Pose,
    }
}

record! {
    /// Common memory (II.2.4): the output buffers of all processes, in the order of the digest.
    pub struct CommonMemory {
        /// Task.
        pub task: TaskOutputs,
        /// Subtask.
        pub subtask: SubtaskOutputs,
        /// E-move.
        pub emove: EmoveOutputs,
        /// Prim.
        pub prim: PrimOutputs,
        /// T3 Interface.
        pub t3i: T3iOutputs,
        /// Quick Change.
        pub quick_change: QuickChangeOutputs,
        /// Grip.
        pub grip: GripOutputs,
        /// V-Grip.
        pub v_grip: JawsOutputs,
        /// Tool-Grip.
        pub tool_grip: JawsOutputs,
        /// Active Pedestal.
        pub pedestal: PedestalOutputs,
        /// Hand of the pedestal.
        pub hand: GripOutputs,
        /// Rotary table of the pedestal.
        pub table: TableOutputs,
    }
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

record! {
    /// Everything that comes from outside in a tick: the only inputs that a replay needs.
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
}
