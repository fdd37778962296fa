//! Errors and events of a cell.

use std::fmt;

use depc::controller::{JointProblem, Warning};
use serde::{Deserialize, Serialize};

use super::SagReport;
use crate::{
    clearance::Contact,
    description::DescriptionError,
    t3::{Cut, DriveError, Lamps, RobotEvent, explained},
};

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CellError {
    #[error(transparent)]
    Description(#[from] DescriptionError),
    #[error("robot.start: {0}")]
    Start(#[from] DriveError),
    #[error("robot.start: {0}")]
    Blocked(CellEvent),
}

/// An event of the cell: an error, or information for the operator.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[non_exhaustive]
pub enum CellEvent {
    /// The robot or its load touches a body that it may never touch, or deeper than any command permits. See
    /// [`Cell::contacts`](super::Cell::contacts) for contacts that only some commands permit.
    Contact(Contact),
    /// A part slides in a hand: the load exceeds the hand's force and friction.
    Slipped {
        part: String,
        hand: String,
        distance: f64, // how far it has slid since it was gripped, in
    },
    Dropped {
        part: String,
        hand: String,
    },
    ForcedOut {
        part: String,
    },
    /// The quick change has released a gripper that was not over an empty holster.
    GripperFell {
        gripper: String,
    },
    /// The robot lifted a gripper in the seat of its holster, and the lips detached it from the quick change.
    GripperTorn {
        gripper: String,
    },
    Fell {
        part: String,
    },
    Warning(#[serde(with = "crate::image::record")] Warning),
    Sagged(SagReport),
    Lamps(Lamps),
    Robot(RobotEvent),
    /// The simulated arm cannot reach the position of the robot that it follows, and does not move.
    CannotFollow(JointProblem),
    Quarantined,
    ViseStuck,
    FaultBegins {
        number: usize, // its number in the file, from 1
        text: String,
    },
    FaultEnds {
        number: usize, // its number in the file, from 1
        text: String,
    },
}

impl CellEvent {
    /// True if something was dropped, lost or damaged.
    #[must_use]
    pub const fn is_harm(&self) -> bool {
        matches!(
            self,
            Self::Dropped { .. }
                | Self::ForcedOut { .. }
                | Self::GripperFell { .. }
                | Self::GripperTorn { .. }
                | Self::Fell { .. }
                | Self::Quarantined
        )
    }

    /// Stable short name of the kind of event.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Contact(_) => "cell.contact",
            Self::Slipped { .. } => "cell.slipped",
            Self::Dropped { .. } => "cell.dropped",
            Self::ForcedOut { .. } => "cell.forced-out",
            Self::GripperFell { .. } => "cell.gripper-fell",
            Self::GripperTorn { .. } => "cell.gripper-torn",
            Self::Fell { .. } => "cell.fell",
            Self::Warning(_) => "cell.warning",
            Self::Sagged(_) => "cell.sagged",
            Self::Robot(RobotEvent::Sinks(Cut::EStop(_))) => "cell.emergency",
            Self::Robot(RobotEvent::Sinks(Cut::PressureLost)) => "cell.pressure",
            Self::Robot(RobotEvent::Sinks(_)) => "cell.power",
            Self::Lamps(_) | Self::Robot(_) => "cell.t3",
            Self::CannotFollow(_) => "cell.cannot-follow",
            Self::Quarantined => "cell.quarantined",
            Self::ViseStuck => "cell.vise-stuck",
            Self::FaultBegins { .. } => "fault.begins",
            Self::FaultEnds { .. } => "fault.ends",
        }
    }
}

impl fmt::Display for CellEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Contact(contact) => {
                write!(f, "{} runs into {}, {:.3} in deep", contact.mover, contact.obstacle, contact.depth)
            }
            Self::Slipped { part, hand, distance } => {
                write!(f, "{part} slides in {hand}, {distance:.3} in so far")
            }
            Self::Dropped { part, hand } => write!(f, "{part} is lost from {hand}"),
            Self::ForcedOut { part } => write!(f, "{part} is forced out of the vise"),
            Self::GripperFell { gripper } => {
                write!(f, "{gripper} falls: it was released away from its holster")
            }
            Self::GripperTorn { gripper } => {
                write!(f, "{gripper} is torn off the quick change by its holster")
            }
            Self::Fell { part } => write!(f, "{part} lies on the floor"),
            Self::Sagged(droop) => write!(f, "the arm {}", droop.end()),
            Self::Lamps(change) => write!(f, "T3: {change}"),
            Self::Robot(event) => write!(f, "T3: {event}"),
            Self::Warning(warning) => write!(f, "the T3 controller shows {}", explained(*warning)),
            Self::CannotFollow(problem) => {
                write!(f, "the simulated arm cannot follow the robot: {problem:?}")
            }
            Self::Quarantined => f.write_str("a body has no finite position: the simulation has failed"),
            Self::ViseStuck => f.write_str("the jaw of the vise does not move"),
            Self::FaultBegins { number, text } => write!(f, "fault {number} begins: {text}"),
            Self::FaultEnds { number, text } => write!(f, "fault {number} is over: {text}"),
        }
    }
}
