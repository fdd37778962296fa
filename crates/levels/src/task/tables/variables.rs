use rcs_core::{Actions, Plain};

/// The robot's place at the end of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ends {
    /// Where the command leaves the robot.
    Here,
    /// At the end-at location, and the robot is there.
    There,
    /// At the end-at location, and the robot is elsewhere.
    Elsewhere,
}

/// State of the database (V.4.1): the result of the last command to the Data System.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum DataBase {
    /// The command is done.
    Done,
    /// The command is executing, or not answered yet.
    Executing,
    /// The command was refused.
    Refused,
    /// The command is overdue, and can be written again.
    Overdue,
    /// The command is overdue after all retries.
    Silent,
}

/// The update that the next order to the Data System contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Update {
    /// None: the object is not moved from or to the MBD, its move was reported, or no Data System is connected
    /// (DB-DONE, IV.3.2).
    None,
    /// The move of this command, from or to the MBD, when it is complete.
    Due,
    /// An earlier update, which is still pending.
    Pending,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskTool {
    /// The tool gripper is not attached, or holds another tool than the command names.
    None,
    /// The tool gripper holds nothing.
    Free,
    /// The tool gripper holds the tool.
    Held,
    /// The tool gripper holds something unknown, or its sensors give no result.
    Unsure,
}

/// The robot's place, for the tool commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Station {
    /// At any other place.
    Elsewhere,
    /// Near the drum, at TOOL-SAFE.
    Safe,
    /// In the transfer location of the drum.
    Transfer,
    /// At no known place; it may be moving.
    Unplaced,
}

/// The fingers relative to the tool drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskDrum {
    /// The fingers are not around a tool in the drum.
    Outside,
    /// The fingers are around a tool in the drum.
    Inside,
}

/// The route to the position of a POSITION, by the names of the locations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskRoute {
    /// The robot is there.
    Here,
    /// The robot is elsewhere, and the task data have a trajectory.
    Leads,
    /// The task data have no trajectory.
    NoTrajectory,
    /// The robot's place is not known.
    NoStart,
}

/// The trajectory from the tool drum to the end-at location of RELEASE-TOOL and REMOVE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum DrumDeparture {
    /// The task data have it, or the command needs none.
    Leads,
    /// The task data have no trajectory from the drum to that location.
    NoTrajectory,
}

/// The recipient of the last order of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskRecipient {
    /// No order was sent yet.
    Nothing,
    /// Subtask.
    Subtask,
    /// The Data System.
    DataSystem,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Destination {
    /// Any other place, or none is named.
    Elsewhere,
    /// TOOL-SAFE, near the tool drum.
    NearDrum,
    /// PEDESTAL, at the Active Pedestal.
    Pedestal,
}

/// The data for a location of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SiteData {
    /// The command does not name the location.
    Null,
    /// The object does not have the grip there.
    NoGrip,
    /// The task data have the grip, or no object is named.
    Known,
}

/// The object as a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ToolData {
    /// The object fits the tool gripper and has the source or destination grip, or no object is named.
    Fit,
    /// The object needs another gripper.
    Unfit,
    /// The object has neither of the two grips.
    NoGrip,
}

/// The regrip on the pedestal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskRegrip {
    /// Not needed: the source and destination grips are the same.
    None,
    /// Needed, and the object has a PED-PARA record (VII.7.4), or no object is named.
    Possible,
    /// Needed, but the object has no PED-PARA record.
    NoData,
}
