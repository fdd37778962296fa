use rcs_core::Plain;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Attachment {
    /// It is attached and the quick change is locked.
    Attached,
    /// It is not attached, or the quick change is not locked.
    Detached,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Addressee {
    /// That of this process, or the command names none.
    This,
    /// Another gripper.
    Other,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Clock {
    /// The time limit is not over.
    Running,
    /// The time limit is over.
    Expired,
}
