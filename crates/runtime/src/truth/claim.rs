//! The statements about the cell of which the goals of commands are made, and their check.

use geometry::frame::{Frame, Vector, rotation_by};
use interfaces::{Unconfirmed, pose_range};
use plant::{Cell, PartState, RingState, description::PartType, t3::Stage};
use rcs_core::name::Name16;
use taskdata::files::{MovtabId, Place, PoseId, TaskData};

use super::{
    NotSensed, Scene,
    history::{History, apart},
    tolerance::{
        GRIP_INCHES, LAG_INCHES, OPENING_INCHES, SEEN_DEGREES, SEEN_INCHES, THERE_DEGREES, THERE_INCHES,
        TOUCH_INCHES, WIDTH_INCHES,
    },
};

/// A part belongs to a sector if it is no farther than this from its centre, in: half the distance of two sectors.
const SECTOR_INCHES: f64 = 5.25;

/// A claim that is untrue.
#[derive(Clone, Debug, PartialEq)]
pub struct Untruth {
    /// What is true instead: a sentence without its full stop.
    pub text: String,
    /// Why no sensor could show it; `None` if the confirmation is false.
    pub not_sensed: Option<NotSensed>,
}

impl Untruth {
    const fn is_false(text: String) -> Self {
        Self { text, not_sensed: None }
    }
}

/// A statement about the cell. Frames are world frames, in.
#[derive(Clone, Debug, PartialEq)]
pub enum Claim {
    /// The tool frame of the robot is at a frame.
    At {
        /// The frame.
        goal: Frame,
        /// Its name.
        name: String,
    },
    /// The tool frame of the robot is at a part that the camera has found, moved by a movetable.
    AtPart {
        /// Name of the part.
        object: String,
        /// Where the command has it.
        near: Frame,
        /// From the part to the goal.
        movetable: Movement,
    },
    /// The robot has passed a frame, or is at most this far from it, in.
    Near {
        /// The frame.
        goal: Frame,
        /// The distance at which the next motion may begin, in.
        inches: f64,
    },
    /// The fingers are at least this far open, in.
    Open(f64),
    /// The robot holds a part in the place of a grip.
    Holds {
        /// Name of the part.
        object: Name16,
        /// Frame of the part in the tool frame, if task data and cell give it.
        place: Vec<Frame>,
        /// True if no picture is taken of the part where it is fetched.
        unseen: bool,
    },
    /// The robot alone holds it: the pedestal has released it.
    HoldsAlone,
    /// The robot holds nothing.
    HoldsNothing,
    /// A part is where the robot has released it, with the tool at this frame.
    Placed {
        /// Name of the part.
        object: Name16,
        /// Tool frame in which the command releases it.
        goal: Frame,
    },
    /// A part lies at a location of the cell.
    LiesAt {
        /// Name of the part.
        object: Name16,
        /// Location and sector, 0 for none.
        place: (String, u16),
    },
    /// A part lies where the report of E-move has it.
    Located {
        /// Name of the part.
        object: Name16,
        /// Where the command has it.
        near: Frame,
    },
    /// A gripper is on the robot, and the ring is locked.
    Wears(u8),
    /// No gripper is on the robot, the ring is open, and the gripper is in the seat of a holster.
    WearsNone(Option<u8>),
    /// A tool is in its place in the drum.
    InDrum(Name16),
    /// A tool is out of the drum.
    OutOfDrum(Name16),
    /// The robot or what it holds touches something.
    Touches,
    /// The robot is at rest, or has no pressure.
    RobotStill,
    /// The fingers of the robot are at rest.
    FingersStill,
    /// Hand and table of the pedestal are at rest.
    PedestalStill,
    /// The robot controller executes the DEPC function.
    Linked,
}

/// A movetable, resolved: the motion from a reference frame to the goal, in the axes of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement(pub MovtabId);

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

/// The claim that the robot holds an object with a grip; `from` is where it is fetched.
pub fn holds(object: Option<Name16>, grip: i32, from: Option<&Place>, scene: &Scene<'_>) -> Option<Claim> {
    let object = object?;
    let seen = from.and_then(|place| scene.data.view(&object, place)).is_some_and(|(_, view)| view.enabled);
    Some(Claim::Holds { object, place: in_grip(&object, grip, scene), unseen: !seen })
}

/// Frames of a part in the tool frame, for a grip: of each nest and tray that both cell and task data have for it.
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
    /// True if a status that names this part of its goal as unconfirmed leaves the claim open.
    pub const fn is_covered(&self, by: Unconfirmed) -> bool {
        match by {
            Unconfirmed::None => false,
            Unconfirmed::GraspForce => matches!(self, Self::Holds { .. }),
            Unconfirmed::ToolInDrum => matches!(self, Self::InDrum(_)),
            Unconfirmed::Position => {
                matches!(self, Self::At { .. } | Self::AtPart { .. } | Self::Near { .. })
            }
        }
    }

    /// Compare the claim with the cell.
    ///
    /// # Errors
    /// What is true instead.
    pub fn check(&self, scene: &Scene<'_>, history: &History) -> Result<(), Untruth> {
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
            Self::Wears(id) => wears(cell, *id),
            Self::WearsNone(id) => wears_none(cell, *id),
            Self::InDrum(object) => is_in_drum(cell, history, object),
            Self::OutOfDrum(object) => is_out_of_drum(cell, object),
            Self::Touches => touches(cell),
            Self::RobotStill => {
                let moves = cell.t3().arm().has_pressure() && !cell.t3().at_rest();
                expect(!moves, || "the robot still moves".to_owned())
            }
            Self::FingersStill => expect(!cell.fingers_move(), || "the fingers still move".to_owned()),
            Self::PedestalStill => expect(!cell.pedestal_moves(), || "the pedestal still moves".to_owned()),
            Self::Linked => is_linked(cell),
        }
    }
}

/// `Ok` if a condition holds.
fn expect(condition: bool, text: impl FnOnce() -> String) -> Result<(), Untruth> {
    if condition { Ok(()) } else { Err(Untruth::is_false(text())) }
}

fn is_at(cell: &Cell, goals: &[Frame], name: &str, inches: f64, degrees: f64) -> Result<(), Untruth> {
    let tool = cell.t3().arm().tool();
    let away = |goal: &Frame| {
        let distance = tool.distance(goal);
        (distance.inches, distance.radians.to_degrees())
    };
    let share = |(far, turned): &(f64, f64)| (far / inches).max(turned / degrees);
    let nearest = goals.iter().map(away).min_by(|a, b| share(a).total_cmp(&share(b)));
    let Some((far, turned)) = nearest else { return Ok(()) };
    expect(far <= inches && turned <= degrees, || {
        format!(
            "the robot is {far:.3} in and {turned:.2} degrees from {name}, {inches} in and {degrees} degrees allowed"
        )
    })
}

fn is_near(cell: &Cell, goal: &Frame, inches: f64) -> Result<(), Untruth> {
    let far = apart(&cell.t3().arm().tool().position, &goal.position);
    let most = inches + LAG_INCHES;
    expect(far <= most, || {
        format!("the robot is {far:.2} in from the point that it passes, {most:.2} in allowed")
    })
}

fn is_open(cell: &Cell, inches: f64) -> Result<(), Untruth> {
    let (opening, _) = cell.fingers();
    expect(cell.gripper().is_none() || opening >= inches - OPENING_INCHES, || {
        format!("the fingers are {opening:.2} in open, {inches:.2} in expected")
    })
}

/// All free parts of a name.
fn named<'p>(parts: &'p [PartState], object: &'p str) -> impl Iterator<Item = &'p PartState> {
    parts.iter().filter(move |part| part.name == object)
}

/// The part of a name that is nearest to a point, within half a sector.
fn nearest(cell: &Cell, object: &str, near: &Vector) -> Option<PartState> {
    let beside = |part: &PartState| {
        let [x, y, _] = part.position;
        (x - near.x).hypot(y - near.y)
    };
    let parts = cell.parts().into_iter().filter(|part| part.name == object && !part.held);
    let nearest = parts.min_by(|a, b| beside(a).total_cmp(&beside(b)))?;
    (beside(&nearest) <= SECTOR_INCHES).then_some(nearest)
}

/// The frames that the camera may find for a part that lies in a tray: the part may be turned by half a turn.
fn seen(cell: &Cell, part: &PartState) -> Vec<Frame> {
    let (Some(frame), Some(kind)) = (cell.part_frame(part.id), cell.part_kind(part.id)) else {
        return Vec::new();
    };
    let down = Vector::new(0.0, 0.0, -kind.size[0] / 2.0);
    let lying = Frame { position: frame.position + down, ..frame };
    let half_turn = rotation_by(&Vector::new(core::f64::consts::PI, 0.0, 0.0));
    vec![lying, lying.turned(&half_turn)]
}

fn at_part(
    scene: &Scene<'_>,
    history: &History,
    object: &str,
    near: &Frame,
    Movement(movetable): Movement,
) -> Result<(), Untruth> {
    let missing = || format!("no {object} lies there");
    let found = nearest(scene.cell, object, &near.position);
    let checked = match &found {
        None => Err(Untruth::is_false(missing())),
        Some(part) => {
            let goals: Vec<_> =
                seen(scene.cell, part).iter().map(|base| scene.data.moved(base, movetable)).collect();
            is_at(scene.cell, &goals, object, SEEN_INCHES, SEEN_DEGREES)
        }
    };
    let changed = history.is_any_changed_since_look(object);
    checked
        .map_err(|untruth| Untruth { not_sensed: changed.then_some(NotSensed::ChangedAfterLook), ..untruth })
}

fn is_located(scene: &Scene<'_>, history: &History, object: &Name16, near: &Frame) -> Result<(), Untruth> {
    let reported = scene.memory.emove.beliefs.located.and_then(|located| located.pose.to_frame().ok());
    let Some(reported) = reported else {
        return Err(Untruth::is_false(format!("E-move reports no place of {object}")));
    };
    let Some(part) = nearest(scene.cell, object.as_str(), &near.position) else {
        let looks_like = looks_like(scene, object, &reported);
        let text = match &looks_like {
            Some(other) => format!("{other} lies there, no {object}"),
            None => format!("no {object} lies there"),
        };
        let equal = looks_like.is_some().then_some(NotSensed::EqualPart);
        let changed = history.is_any_changed_since_look(object.as_str());
        let not_sensed = equal.or_else(|| changed.then_some(NotSensed::ChangedAfterLook));
        return Err(Untruth { text, not_sensed });
    };
    let far = seen(scene.cell, &part)
        .iter()
        .map(|frame| frame.distance(&reported))
        .map(|distance| (distance.inches, distance.radians.to_degrees()))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let best = seen(scene.cell, &part).iter().any(|frame| {
        let distance = frame.distance(&reported);
        distance.inches <= SEEN_INCHES && distance.radians.to_degrees() <= SEEN_DEGREES
    });
    expect(best, || {
        let (inches, degrees) = far.unwrap_or_default();
        format!("{object} is {inches:.3} in and {degrees:.2} degrees from where E-move reports it")
    })
}

/// A part at a place that looks like another one to the camera: the same outline within its tolerance.
fn looks_like(scene: &Scene<'_>, object: &Name16, at: &Frame) -> Option<String> {
    let description = scene.cell.description();
    let asked = description.part(object.as_str())?;
    let tolerance = description.camera.shape_tolerance;
    let parts = scene.cell.parts();
    let other = parts.iter().filter(|part| !part.held).find(|part| {
        let [x, y, _] = part.position;
        (x - at.position.x).hypot(y - at.position.y) <= SEEN_INCHES
    })?;
    let kind = scene.cell.part_kind(other.id)?;
    is_alike(asked, kind, tolerance).then(|| other.name.clone())
}

/// True if two kinds have the same outline within a tolerance, in.
fn is_alike(one: &PartType, other: &PartType, tolerance: f64) -> bool {
    one.shape == other.shape && one.size.iter().zip(other.size).all(|(a, b)| (a - b).abs() <= tolerance)
}

fn is_held(
    scene: &Scene<'_>,
    history: &History,
    object: &Name16,
    place: &[Frame],
    unseen: bool,
) -> Result<(), Untruth> {
    let cell = scene.cell;
    let Some(id) = cell.held() else {
        return Err(Untruth::is_false(format!("the robot does not hold {object}: it holds nothing")));
    };
    let (Some(kind), Some(frame)) = (cell.part_kind(id), cell.part_frame(id)) else { return Ok(()) };
    if kind.name != object.as_str() {
        let text = format!("the robot holds {}, not {object}", kind.name);
        let asked = cell.description().part(object.as_str());
        let same_width = asked.is_some_and(|asked| same_width(asked, kind));
        let same_picture =
            asked.is_some_and(|asked| is_alike(asked, kind, cell.description().camera.shape_tolerance));
        let not_sensed = if same_width && (unseen || same_picture) {
            Some(NotSensed::EqualPart)
        } else if same_width && history.is_any_changed_since_look(object.as_str()) {
            Some(NotSensed::ChangedAfterLook)
        } else {
            None
        };
        return Err(Untruth { text, not_sensed });
    }
    let Some(meant) = place.first() else { return Ok(()) };
    let is = cell.t3().arm().tool().inverse().compose(&frame).position;
    // Across the fingers (tool Y) they centre the part. Along the axis of a long part its grips differ by the grip.
    let off = (is.x - meant.position.x).hypot(is.z - meant.position.z);
    if off <= GRIP_INCHES {
        return Ok(());
    }
    let text = format!("{object} is {off:.2} in from its place in the fingers, {GRIP_INCHES} in allowed");
    let not_sensed = if unseen && history.is_changed(id) {
        Some(NotSensed::NoPicture)
    } else if history.is_any_changed_since_look(object.as_str()) {
        Some(NotSensed::ChangedAfterLook)
    } else {
        None
    };
    Err(Untruth { text, not_sensed })
}

/// True if the fingers cannot tell two kinds by their width: some width of one is one of the other.
fn same_width(one: &PartType, other: &PartType) -> bool {
    one.size.iter().any(|a| other.size.iter().any(|b| (a - b).abs() <= WIDTH_INCHES))
}

fn is_held_alone(cell: &Cell) -> Result<(), Untruth> {
    let both = cell.held().and_then(|id| cell.holders(id)).is_some_and(|holders| holders.pedestal);
    expect(!both, || "the pedestal still holds the part, too".to_owned())
}

fn holds_nothing(cell: &Cell) -> Result<(), Untruth> {
    let held = cell.held().and_then(|id| cell.part_kind(id));
    expect(held.is_none(), || {
        format!("the robot still holds {}", held.map_or("something", |kind| kind.name.as_str()))
    })
}

fn is_placed(cell: &Cell, history: &History, object: &Name16, goal: &Frame) -> Result<(), Untruth> {
    // Without a release since the start of the judge the location of the part decides, in Task's claim.
    let Some(released) = history.released() else { return Ok(()) };
    let parts = cell.parts();
    let changed = history.is_changed_since(released.id, released.tick);
    let not_sensed = changed.then_some(NotSensed::ChangedAfterLook);
    let Some(part) = parts.iter().find(|part| part.id == released.id) else {
        return Err(Untruth { text: format!("{object} is not in the cell"), not_sensed });
    };
    if part.name != object.as_str() {
        // Whether the robot held the right part is a claim of the grasp.
        return Ok(());
    }
    let tolerance = cell.description().placing_tolerance;
    let off = apart(&released.tool.position, &goal.position);
    if off > tolerance {
        let text = format!("{object} was released {off:.2} in from its goal, {tolerance} in allowed");
        return Err(Untruth::is_false(text));
    }
    let moved = apart(&Vector::from(part.position), &released.part.position);
    if moved > tolerance {
        let text = format!(
            "{object} is {moved:.2} in from where the fingers have released it, {tolerance} in allowed"
        );
        return Err(Untruth { text, not_sensed });
    }
    Ok(())
}

fn lies_at(
    cell: &Cell,
    history: &History,
    object: &Name16,
    (location, sector): &(String, u16),
) -> Result<(), Untruth> {
    let parts = cell.parts();
    let there = |part: &&PartState| !part.held && part.location == *location && part.sector == *sector;
    if named(&parts, object.as_str()).any(|part| there(&part)) {
        return Ok(());
    }
    let place = if *sector == 0 { location.clone() } else { format!("{location} {sector}") };
    let where_it_is = |part: &PartState| match part.sector {
        0 => part.location.clone(),
        sector => format!("{} {sector}", part.location),
    };
    let found: Vec<String> = named(&parts, object.as_str()).map(where_it_is).collect();
    let text = match &found[..] {
        [] => format!("no {object} is at {place}, nor anywhere else"),
        found => format!("no {object} is at {place}, but at {}", found.join(" and ")),
    };
    let released = history.released();
    let other = released.and_then(|released| cell.part_kind(released.id)).is_some_and(|kind| {
        kind.name != object.as_str()
            && cell.description().part(object.as_str()).is_some_and(|asked| same_width(asked, kind))
    });
    let changed = released.is_some_and(|released| history.is_changed_since(released.id, released.tick));
    let not_sensed =
        if changed { Some(NotSensed::ChangedAfterLook) } else { other.then_some(NotSensed::EqualPart) };
    Err(Untruth { text, not_sensed })
}

fn wears(cell: &Cell, id: u8) -> Result<(), Untruth> {
    match (cell.gripper(), cell.ring()) {
        (Some(on), RingState::Locked) if on == id => Ok(()),
        (Some(on), RingState::Locked) => {
            Err(Untruth::is_false(format!("gripper {on} is on the robot, not {id}")))
        }
        (Some(on), _) => Err(Untruth::is_false(format!("gripper {on} hangs on a ring that is not locked"))),
        (None, _) => Err(Untruth::is_false("no gripper is on the robot".to_owned())),
    }
}

fn wears_none(cell: &Cell, id: Option<u8>) -> Result<(), Untruth> {
    if let Some(on) = cell.gripper() {
        return Err(Untruth::is_false(format!("gripper {on} is still on the robot")));
    }
    expect(cell.ring() == RingState::Open, || "the ring of the quick change is not open".to_owned())?;
    let Some(id) = id else { return Ok(()) };
    expect(cell.is_holstered(id), || format!("gripper {id} is not in the seat of its holster"))
}

/// Distance of a part of a name from its place in the drum, in: along the axis and beside it; the nearest one.
fn from_drum(cell: &Cell, object: &Name16) -> Option<(u32, f64, f64)> {
    let parts = cell.parts();
    let of = |part: &PartState| {
        let entering = cell.at_drum(part.id)?;
        Some((part.id, entering.left, entering.aside))
    };
    named(&parts, object.as_str()).filter_map(of).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

fn is_in_drum(cell: &Cell, history: &History, object: &Name16) -> Result<(), Untruth> {
    let seated = cell.description().drum.seated;
    let (text, id) = match from_drum(cell, object) {
        Some((_, left, aside)) if left.abs() <= seated && aside <= seated => return Ok(()),
        Some((id, left, aside)) => {
            let text =
                format!("{object} is {left:.2} in before and {aside:.2} in beside its place in the drum");
            (text, Some(id))
        }
        None => (format!("{object} is not in the drum"), history.released().map(|released| released.id)),
    };
    let since = history.released().map(|released| released.tick);
    let changed = id.zip(since).is_some_and(|(id, since)| history.is_changed_since(id, since));
    Err(Untruth { text, not_sensed: changed.then_some(NotSensed::ChangedAfterLook) })
}

fn is_out_of_drum(cell: &Cell, object: &Name16) -> Result<(), Untruth> {
    let length = cell.description().drum.detent_length;
    let inside = from_drum(cell, object).filter(|(_, left, _)| *left <= length);
    expect(inside.is_none(), || format!("{object} is still in the drum"))
}

fn touches(cell: &Cell) -> Result<(), Untruth> {
    let touching = cell.contacts().iter().any(|contact| contact.depth > -TOUCH_INCHES);
    expect(touching, || "neither the robot nor what it holds touches anything".to_owned())
}

fn is_linked(cell: &Cell) -> Result<(), Untruth> {
    let stage = cell.t3().stage();
    expect(stage == Stage::Depc, || format!("the robot controller does not execute DEPC: {}", stage.text()))
}

/// The frame of a location for an object and grip: where the tool is with the object there.
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
