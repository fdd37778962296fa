//! State variables that several processes have in common.

use rcs_core::Plain;

/// Is the gripper of the process on the robot?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Attachment {
    /// It is mated and the quick change is locked.
    Attached,
    /// It is not.
    Detached,
}

/// The gripper for which a command is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Addressee {
    /// That of this process, or the commander did not say.
    This,
    /// Another one.
    Other,
}

/// The time of a command, or of a motion that it waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Clock {
    /// Within its limit.
    Running,
    /// Over its limit.
    Expired,
}
