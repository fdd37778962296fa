//! The table of every tick that looks after finished commands.
//!
//! An outcome stays until a new command comes, with two exceptions that the joystick box asks for (III.3.3).
//! PAUSE never ends: while it stands, the operator may take the robot and give it back. And a motion that is
//! done may be one on which the robot still flies: the operator can stop it, and the commander must learn of
//! it.

use rcs_core::{coded_enum, decision_table, interface::prim::PrimVerb};

use crate::execution::{Course, Outcome};

coded_enum! {
    /// What a command is, for the joystick box.
    pub enum Kind {
        /// It ends, and moves nothing afterwards.
        Single = "single",
        /// It moves the robot.
        Motion = "motion",
        /// PAUSE.
        Lasting = "lasting",
    }
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

coded_enum! {
    /// The frame switches of the joystick box.
    pub enum Switches {
        /// None is on.
        Off = "off",
        /// One: the box may move the robot.
        One = "one",
        /// Two or more: nobody knows what is meant.
        Several = "several",
    }
}

/// What happens with the table of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attention {
    /// It is left alone.
    Leave,
    /// It is consulted.
    Consult,
}

decision_table! {
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
