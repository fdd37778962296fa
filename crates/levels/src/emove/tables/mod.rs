//! Decision tables of E-move: a file a command, MOV-TO-VU with MOV-TO-OBJ.

pub mod grasp_obj;
pub mod locate_obj;
pub mod mov_obj_to;
pub mod mov_to_loc;
pub mod mov_to_obj;
pub mod pause;
pub mod release;

use rcs_core::{
    coded_enum,
    handshake::Lower,
    interface::{Reason, emove::EmoveVerb},
};

use super::route::Ahead;

coded_enum! {
    /// Steps of a motion command: the reference action of all MOV-… commands.
    pub enum Motion {
        /// Nothing commanded yet.
        Start = "start",
        /// On the way through points.
        Moving = "moving",
        /// On the final motion.
        Stopping = "stopping",
    }
}

coded_enum! {
    /// The opening of the fingers for the goal.
    pub enum Opening {
        /// As it should be, or it does not matter.
        Set = "set",
        /// Not yet: the next point is a depart point.
        Departing = "departing",
        /// To be commanded now.
        Due = "due",
        /// The fingers are moving.
        Moving = "moving",
        /// The gripper reports an error.
        Failed = "failed",
    }
}

coded_enum! {
    /// Is the object of the command held?
    pub enum Held {
        /// The gripper holds nothing.
        Nothing = "nothing",
        /// It holds the object of the command.
        Right = "right",
        /// It holds another object.
        Other = "other",
    }
}

coded_enum! {
    /// What closed fingers have between them.
    pub enum Fingers {
        /// Nothing: they are closed to the grasp size or less.
        Empty = "empty",
        /// Something.
        Gripping = "gripping",
    }
}

coded_enum! {
    /// The DEPC link.
    pub enum Link {
        /// Prim does not command the robot.
        Down = "down",
        /// It does.
        Up = "up",
    }
}

coded_enum! {
    /// Quick change and gripper after the start.
    pub enum Tooling {
        /// Not read or not calibrated yet.
        Busy = "busy",
        /// Read and calibrated.
        Ready = "ready",
        /// The quick change reports an error.
        RingFaulty = "ring faulty",
        /// The gripper reports an error.
        GripFaulty = "grip faulty",
    }
}

coded_enum! {
    /// Is it known where the robot is?
    pub enum Whereabouts {
        /// It is at a known location.
        Known = "known",
        /// The location points are being looked through.
        Searching = "searching",
        /// It is at none of them.
        Unknown = "unknown",
    }
}

coded_enum! {
    /// What vision says to the last request.
    pub enum Sight {
        /// Nothing yet.
        Waiting = "waiting",
        /// It sees the object.
        Seen = "seen",
        /// It sees nothing.
        Missing = "missing",
        /// It sees something else.
        Unrecognised = "unrecognised",
        /// It does not answer.
        Silent = "silent",
    }
}

coded_enum! {
    /// May a picture be taken again?
    pub enum Tries {
        /// Yes, with other parameters.
        Left = "left",
        /// No.
        Spent = "spent",
    }
}

/// The state variables of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// What lies ahead on the route.
    pub ahead: Ahead,
    /// Status of Prim; `Done` as long as the current command has sent it nothing.
    pub prim: Lower,
    /// Status of Grip.
    pub grip: Lower,
    /// The opening of the fingers.
    pub opening: Opening,
    /// Is the object held?
    pub held: Held,
    /// What the fingers have between them.
    pub fingers: Fingers,
    /// The link.
    pub link: Link,
    /// Quick change and gripper.
    pub tooling: Tooling,
    /// Is it known where the robot is?
    pub whereabouts: Whereabouts,
    /// What vision says.
    pub sight: Sight,
    /// May a picture be taken again?
    pub tries: Tries,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// ROBOT-INIT to Prim.
    RobotInit,
    /// PAUSE to Prim and Grip, QC-PAUSE to Quick Change.
    Pause,
    /// GO-THRU to Prim with the next point.
    GoThru,
    /// GOTO-PT to Prim with the goal.
    GotoPt,
    /// POSITION to Grip with the opening for the goal.
    Open,
    /// CLOSE-GRIP to Grip.
    Close,
    /// OPEN-GRIP to Grip with the depart size.
    OpenToDepart,
    /// Report done: the robot is at the goal.
    Arrive,
    /// Report done: the object is held.
    Grasped,
    /// Report done: nothing is held.
    Released,
    /// Ask vision for the first picture.
    Flood,
    /// Ask for it again with other parameters.
    FloodAgain,
    /// GOTO-PT to Prim: camera over the centroid.
    Centre,
    /// Ask vision for the second picture.
    Precise,
    /// Ask for it again with other parameters.
    PreciseAgain,
    /// GOTO-PT to Prim: camera over the part, turned with it.
    Align,
    /// Report done: the object is located.
    Located,
    /// Report done.
    Finish,
    /// Stop the robot and report an error.
    Fail(Reason),
    /// Stop the robot and report what Grip reports.
    FailGrip,
    /// Report what Prim reports.
    PassUp,
}

/// What the table of the current command decided.
pub type Choice = crate::execution::Choice<Action>;

/// Consult the table of a command. A step that the command does not have counts as its first.
#[must_use]
pub fn decide(verb: EmoveVerb, step: u8, s: &Situation) -> Choice {
    match verb {
        EmoveVerb::None
        | EmoveVerb::Pause
        | EmoveVerb::MovToHol
        | EmoveVerb::QcDetach
        | EmoveVerb::QcAttach
        | EmoveVerb::Withdraw
        | EmoveVerb::InsertTool
        | EmoveVerb::ReleaseTool
        | EmoveVerb::AcquireTool
        | EmoveVerb::RemoveTool => pause::consult(step, s),
        EmoveVerb::MovToLoc => mov_to_loc::consult(step, s),
        EmoveVerb::MovToObj | EmoveVerb::MovToVu => mov_to_obj::consult(step, s),
        EmoveVerb::MovObjTo => mov_obj_to::consult(step, s),
        EmoveVerb::LocateObj => locate_obj::consult(step, s),
        EmoveVerb::GraspObj => grasp_obj::consult(step, s),
        EmoveVerb::Release => release::consult(step, s),
    }
}

#[cfg(test)]
mod tests {
    use rcs_core::process::Process;
    use taskdata::files::TaskData;

    use crate::emove::Emove;

    #[test]
    fn no_row_is_dead() {
        for table in <Emove as Process<TaskData<'_>>>::TABLES {
            table.dead_rows(|row| panic!("{}: row {row} can never fire", table.name));
        }
    }
}
