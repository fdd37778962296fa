//! The table of every tick that looks after finished commands.
//!
//! An outcome stays until a new command comes, with two exceptions that the joystick box asks for (III.3.3).
//! PAUSE never ends: while it stands, the operator may take the robot and give it back. And a motion that is
//! done may be one on which the robot still flies: the operator can stop it, and the commander must learn of
//! it.

use rcs_core::{Plain, interface::prim::PrimVerb, old_table};

use crate::old_execution::{Course, Outcome};

/// What a command is, for the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Kind {
    /// It ends, and moves nothing afterwards.
    Single,
    /// It moves the robot.
    Motion,
    /// PAUSE.
    Lasting,
}

impl Kind {
    /// What a command is.
    #[must_use]
    pub const fn of(verb: PrimVerb) -> Self {
        match verb {
            PrimVerb::Pause => Self::Lasting,
            PrimVerb::GoThru
            | PrimVerb::GotoPt
            | PrimVerb::GoUntil
            | PrimVerb::GoWhile
            | PrimVerb::DeltaMove => Self::Motion,
            PrimVerb::None | PrimVerb::RobotInit | PrimVerb::CalSensor => Self::Single,
        }
    }
}

/// The frame switches of the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Switches {
    /// None is on.
    Off,
    /// One: the box may move the robot.
    One,
    /// Two or more: nobody knows what is meant.
    Several,
}

/// What happens with the table of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attention {
    /// It is left alone.
    Leave,
    /// It is consulted.
    Consult,
}

old_table! {
    /// ATTEND (III.3.3): is the table of the current command consulted, and with which outcome?
    pub ATTEND: fn attend(course: Course, kind: Kind, outcome: Outcome, switches: Switches)
        -> (Attention, Outcome)
    {
        //   course             kind               outcome            switches         attention outcome
        1: ( Begin | Continue , _                , _                , _             ) => Consult , Executing ;
        2: ( Refuse           , _                , _                , _             ) => Leave   , Error     ;
        3: ( Rest             , Lasting          , Done | Joystick  , _             ) => Consult , Executing ;
        4: ( Rest             , Motion           , Done             , One | Several ) => Consult , Executing ;
        5: ( Rest             , Motion           , Done             , Off           ) => Leave   , Done      ;
        6: ( Rest             , Single           , Done             , _             ) => Leave   , Done      ;
        7: ( Rest             , Single | Motion  , Joystick         , _             ) => Leave   , Joystick  ;
        8: ( Rest             , _                , Error            , _             ) => Leave   , Error     ;
        9: ( Rest             , _                , Idle | Executing , _             ) => Leave   , Idle      ;
    }
}
