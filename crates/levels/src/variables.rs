use rcs_core::Plain;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Attachment {
    /// The gripper is attached and the quick change is locked.
    Attached,
    /// The gripper is not attached, or the quick change is not locked.
    Detached,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Addressee {
    /// The command names the gripper of this process, or none.
    This,
    /// The command names another gripper.
    Other,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Clock {
    /// The time limit is not over.
    Running,
    /// The time limit is over.
    Expired,
}
