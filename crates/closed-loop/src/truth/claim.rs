use geometry::frame::Frame;
use interfaces::{Unconfirmed, pose_range};
use rcs_core::name::Name16;
use taskdata::files::{Place, PoseId, TaskData};

use super::{
    Scene,
    contradiction::{Contradiction, expect},
    history::History,
    parts::{holds_nothing, is_held, is_held_alone, is_in_drum, is_out_of_drum, is_placed, lies_at},
    robot::{check_gripper_on, check_no_gripper, is_at, is_linked, is_near, is_open, stops, touches},
    seen::{Movement, at_part, is_located},
    tolerance::{THERE_DEGREES, THERE_INCHES},
};

/// A claim about the cell. Frames are world frames, in.
#[derive(Clone, Debug, PartialEq)]
pub enum Claim {
    /// The tool frame of the robot is at a frame.
    At {
        goal: Frame,
        name: String,
    },
    /// The tool frame of the robot is at a part found by the camera, moved by a movetable.
    AtPart {
        object: String,
        near: Frame,
        movetable: Movement, // from the part to the goal
    },
    /// The robot has passed a frame, or is at most this far from it, in.
    Near {
        goal: Frame,
        inches: f64, // distance at which the next motion may begin, in
    },
    /// The fingers are at least this far open, in.
    Open(f64),
    /// The robot holds a part as a grip requires.
    Holds {
        object: Name16,
        place: Vec<Frame>, // frame of the part in the tool frame, if task data and cell give it
        unseen: bool,      // true if no picture of the part is taken at its source
    },
    /// The robot alone holds it: the pedestal has released it.
    HoldsAlone,
    HoldsNothing,
    /// A part is where the robot released it, with the tool at this frame.
    Placed {
        object: Name16,
        goal: Frame,
    },
    LiesAt {
        object: Name16,
        place: (String, u16), // location and sector, 0 for none
    },
    /// A part is at the place that E-move reports.
    Located {
        object: Name16,
        near: Frame,
    },
    /// A gripper is attached, and the ring is locked.
    Wears(u8),
    /// No gripper is attached, the ring is open, and the gripper is in the seat of a holster.
    WearsNone(Option<u8>),
    InDrum(Name16),
    OutOfDrum(Name16),
    Touches,
    /// The commanded point is at rest, and the arm lags at most by the lag of its servos.
    RobotStops,
    FingersStill,
    PedestalStill,
    Linked,
}

/// The frame of a record of POSE, or of a changing record.
pub fn pose(number: Option<u32>, scene: &Scene<'_>) -> Option<Frame> {
    match number? {
        number @ 0..pose_range::CHANGING => scene.data.pose(PoseId::new(number)).map(|record| record.frame),
        number => scene.memory.changing_pose(number)?.to_frame().ok(),
    }
}

/// The claim that the robot is at a goal, if the goal is known.
pub fn at(goal: Option<Frame>, name: impl ToString) -> Option<Claim> {
    goal.map(|goal| Claim::At { goal, name: name.to_string() })
}

/// The claim that the robot holds an object with a grip; `from` is its source.
pub fn holds(object: Option<Name16>, grip: i32, from: Option<&Place>, scene: &Scene<'_>) -> Option<Claim> {
    let object = object?;
    let seen = from.and_then(|place| scene.data.view(&object, place)).is_some_and(|(_, view)| view.enabled);
    Some(Claim::Holds { object, place: in_grip(&object, grip, scene), unseen: !seen })
}

/// Frames of a part in the tool frame for a grip: one for each nest and tray that both cell and task data have.
fn in_grip(object: &Name16, grip: i32, scene: &Scene<'_>) -> Vec<Frame> {
    let (cell, data) = (scene.cell.description(), scene.data);
    let Some(kind) = cell.part(object.as_str()) else { return Vec::new() };
    let of = |(location, sector, part): (String, u16, Frame)| {
        let name = Name16::new(&location).ok()?;
        let sector = (sector != 0).then(|| i32::from(sector));
        let location = data.resolve_location(&name, sector, Some(object)).ok()?;
        let tool = data.grip_frame(object, grip, &location).ok()?;
        Some(tool.inverse().compose(&part))
    };
    cell.places_of(kind).into_iter().find_map(of).into_iter().collect()
}

impl Claim {
    /// True if the claim is left open, because the status names this part of the goal as unconfirmed. Jaws without a
    /// force sensor do not show whether they press, but the place of the part that they hold is still claimed.
    pub const fn is_covered(&self, by: Unconfirmed, holds: bool) -> bool {
        match by {
            Unconfirmed::None => false,
            Unconfirmed::GraspForce => matches!(self, Self::Holds { .. }) && !holds,
            Unconfirmed::ToolInDrum => matches!(self, Self::InDrum(_)),
            Unconfirmed::Position => {
                matches!(self, Self::At { .. } | Self::AtPart { .. } | Self::Near { .. })
            }
            Unconfirmed::PartInFingers => matches!(
                self,
                Self::Holds { .. }
                    | Self::Placed { .. }
                    | Self::LiesAt { .. }
                    | Self::InDrum(_)
                    | Self::OutOfDrum(_)
            ),
        }
    }

    pub fn is_of_grasp(&self) -> bool {
        matches!(self, Self::Holds { place, .. } if !place.is_empty())
    }

    pub const fn is_of_part(&self) -> bool {
        matches!(self, Self::Holds { .. } | Self::Placed { .. } | Self::LiesAt { .. } | Self::InDrum(_))
    }

    /// Compare the claim with the cell. Errors: the actual state.
    pub fn check(&self, scene: &Scene<'_>, history: &History) -> Result<(), Contradiction> {
        let cell = scene.cell;
        match self {
            Self::At { goal, name } => is_at(cell, &[*goal], name, THERE_INCHES, THERE_DEGREES),
            Self::AtPart { object, near, movetable } => at_part(scene, history, object, near, *movetable),
            Self::Near { goal, inches } => is_near(cell, goal, *inches),
            Self::Open(inches) => is_open(cell, *inches),
            Self::Holds { object, place, unseen } => is_held(scene, history, object, place, *unseen),
            Self::HoldsAlone => is_held_alone(cell),
            Self::HoldsNothing => holds_nothing(cell),
            Self::Placed { object, goal } => is_placed(cell, history, object, goal),
            Self::LiesAt { object, place } => lies_at(cell, history, object, place),
            Self::Located { object, near } => is_located(scene, history, object, near),
            Self::Wears(id) => check_gripper_on(cell, *id),
            Self::WearsNone(id) => check_no_gripper(cell, *id),
            Self::InDrum(object) => is_in_drum(cell, history, object),
            Self::OutOfDrum(object) => is_out_of_drum(cell, object),
            Self::Touches => touches(cell),
            Self::RobotStops => stops(cell),
            Self::FingersStill => expect(!cell.fingers_move(), || "the fingers still move".to_owned()),
            Self::PedestalStill => {
                // A pedestal in another process that does not answer cannot be stopped.
                let answers = scene.memory.pedestal.header.stamp == scene.tick;
                expect(!answers || !cell.pedestal_moves(), || "the pedestal still moves".to_owned())
            }
            Self::Linked => is_linked(cell),
        }
    }
}

/// The tool frame at a location for an object and grip.
pub fn grip_goal(
    data: &TaskData<'_>,
    base: Option<Frame>,
    object: Option<&Name16>,
    grip: i32,
    place: &Place,
) -> Option<Frame> {
    let movetable = data.grip_movetable(object?, grip, place)?;
    Some(data.moved(&base?, movetable))
}
