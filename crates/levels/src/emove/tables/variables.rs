//! The state variables that the tables look up, and the steps that the motion commands share.

use rcs_core::{coded_enum, handshake::Lower, interface::prim::JoystickGrip};

use crate::emove::route::Ahead;

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
    /// What was held when the command came.
    pub enum Load {
        /// It is held still, or nothing was.
        Kept = "kept",
        /// It is held no more.
        Lost = "lost",
    }
}

coded_enum! {
    /// What closed fingers have between them.
    pub enum Fingers {
        /// Nothing, or nothing of the object's size.
        Empty = "empty",
        /// Something.
        Gripping = "gripping",
    }
}

coded_enum! {
    /// Are the fingers as wide open as letting go of the object would leave them?
    pub enum Spread {
        /// They are not.
        Narrow = "narrow",
        /// They are, or there are none.
        Open = "open",
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
        /// Read, and calibrated if it must be.
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
    /// Where the robot is, seen from the location of the command.
    pub enum Station {
        /// Elsewhere, or nobody knows.
        Elsewhere = "elsewhere",
        /// There.
        There = "there",
        /// There, with the fingers around a tool in the drum.
        InDrum = "in drum",
    }
}

coded_enum! {
    /// What is mated with the quick change, seen from the gripper of the command.
    pub enum Mate {
        /// Nothing.
        None = "none",
        /// That gripper.
        Right = "right",
        /// Another one.
        Wrong = "wrong",
    }
}

coded_enum! {
    /// What Quick Change says of its locking ring.
    pub enum Ring {
        /// It turns, or has not answered yet.
        Busy = "busy",
        /// It is locked.
        Locked = "locked",
        /// It is unlocked.
        Unlocked = "unlocked",
        /// It is stuck, its sensors fail, or nobody answers.
        Faulty = "faulty",
    }
}

coded_enum! {
    /// What the four sensors of the command's holster see (V.1.2 hol-R-status …).
    pub enum Holster {
        /// Nothing.
        Empty = "empty",
        /// Something, but no gripper at its seat.
        Partial = "partial",
        /// A gripper at its seat: all four see its ears.
        Full = "full",
    }
}

coded_enum! {
    /// How the last motion stands.
    pub enum Travel {
        /// The robot is on its way, or Prim has not answered yet.
        UnderWay = "under way",
        /// It stands at the goal of a GO-UNTIL, and the condition has not come for a second.
        Missed = "missed",
        /// It has come to its end.
        Over = "over",
        /// It was given up.
        Failed = "failed",
    }
}

coded_enum! {
    /// The attached gripper after an order.
    pub enum Readiness {
        /// It has not done what was ordered yet.
        Busy = "busy",
        /// It has.
        Ready = "ready",
        /// It has, and must be calibrated: the parts gripper, attached for the first time (VI.3.1 UP-INIT).
        Raw = "raw",
        /// It cannot.
        Faulty = "faulty",
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
        /// It says what cannot be.
        Implausible = "implausible",
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
    /// The same, with a GO-UNTIL that is in vain.
    pub travel: Travel,
    /// Status of the attached gripper.
    pub gripper: Lower,
    /// The same, with its calibration.
    pub readiness: Readiness,
    /// The opening of the fingers.
    pub opening: Opening,
    /// Is the object held?
    pub held: Held,
    /// Is still held what was held?
    pub load: Load,
    /// What the fingers have between them.
    pub fingers: Fingers,
    /// Are they wide open?
    pub spread: Spread,
    /// A gripper button of the joystick box that has just been pressed.
    pub button: JoystickGrip,
    /// The link.
    pub link: Link,
    /// Quick change and gripper.
    pub tooling: Tooling,
    /// What is mated.
    pub mate: Mate,
    /// The locking ring.
    pub ring: Ring,
    /// The holster.
    pub holster: Holster,
    /// Is it known where the robot is?
    pub whereabouts: Whereabouts,
    /// Is it at the command's location?
    pub station: Station,
    /// What vision says.
    pub sight: Sight,
    /// May a picture be taken again?
    pub tries: Tries,
}
