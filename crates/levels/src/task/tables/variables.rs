//! The values of the state variables of Task.

use rcs_core::{Actions, Plain};

/// Where the robot is to be at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ends {
    /// Where the command leaves it.
    Here,
    /// At the end-at location, where it is now.
    There,
    /// At the end-at location, where it is not.
    Elsewhere,
}

/// State of the data base (V.4.1): what the Data System makes of the last command to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum DataBase {
    /// It is done.
    Done,
    /// It is executing, or not answered yet.
    Executing,
    /// It was refused.
    Refused,
    /// It is not done in time, and can be written again.
    Overdue,
    /// It is not done in time, however often it was written.
    Silent,
}

/// The update that the next order to the Data System contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Update {
    /// None: the object is not moved from or to the MBD, its move was reported, or no Data System is connected
    /// (DB-DONE, IV.3.2).
    None,
    /// The move of this command, from or to the MBD, when it is completed.
    Due,
    /// An earlier update, which is not accepted yet.
    Pending,
}

/// The tool gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskTool {
    /// It is not on, or it holds another tool than the command names.
    None,
    /// It holds nothing.
    Free,
    /// It holds the tool.
    Held,
    /// It holds something unknown, or its sensors do not tell.
    Unsure,
}

/// Where the robot is, for the tool commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Station {
    /// At none of the following.
    Elsewhere,
    /// Near the drum: at TOOL-SAFE.
    Safe,
    /// In the transfer location of the drum.
    Transfer,
    /// At no known place: it may be on its way.
    Unplaced,
}

/// The fingers and the tool drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskDrum {
    /// They are not around a tool in it.
    Outside,
    /// They are.
    Inside,
}

/// Can the robot go to the position of a POSITION, as far as Task can tell?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskRoute {
    /// It is there.
    Here,
    /// It is elsewhere, and the task data have a trajectory.
    Leads,
    /// They have none.
    NoTrajectory,
    /// It is not known where the robot is.
    NoStart,
}

/// The way from the tool drum to the end-at location of RELEASE-TOOL and REMOVE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum WayOut {
    /// The task data have it, or the command needs none.
    Leads,
    /// They have no trajectory from the drum to that location.
    NoTrajectory,
}

/// The neighbour that has the last order of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskRecipient {
    /// Nothing was ordered yet.
    Nothing,
    /// Subtask.
    Subtask,
    /// The Data System.
    DataSystem,
}

/// Where the destination is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Destination {
    /// At neither of the following, or none is named.
    Elsewhere,
    /// Near the tool drum: it is TOOL-SAFE.
    NearDrum,
    /// At the Active Pedestal: it is PEDESTAL.
    Pedestal,
}

/// A location of the command, with the grip of the object there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SiteData {
    /// The command does not name the location.
    Null,
    /// It does, and the object has no such grip.
    NoGrip,
    /// It does, and the task data have the grip, or no object is named.
    Known,
}

/// The object as a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ToolData {
    /// It is for the tool gripper and has the source grip or the destination grip, or no object is named.
    Fit,
    /// It is for another gripper.
    Unfit,
    /// It has neither of the two grips.
    NoGrip,
}

/// Must the object be regripped on the pedestal?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskRegrip {
    /// No: the source and destination grips are the same.
    None,
    /// Yes, and the object has a PED-PARA record (VII.7.4), or no object is named.
    Possible,
    /// Yes, and it has none.
    NoData,
}
