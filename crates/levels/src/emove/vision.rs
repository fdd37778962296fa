//! Vision (V.2.1 LOCATE-OBJ): pictures, and from a picture to a part frame.
//!
//! A view movetable leads from a place to the tool frame for a picture of it. Its inverse leads from the tool frame
//! of a picture to the place in the middle of the picture; other mounting data of the camera are not needed. Vision
//! answers in the axes of that place.

use geometry::{
    frame::{Frame, Rotation, Vector},
    pose::Pose,
    units::{inches, radians},
};
use interfaces::{
    CommonMemory, EmoveOutputs,
    device::{Picture, VisionRequest, VisionResponse, VisionStatus},
    emove::{EmoveCommand, EmoveVerb, Estimates, Located, LocatedObject, RobotPlace},
    pose_range,
    prim::PrimReport,
};
use rcs_core::{Plain, handshake::Commander};
use taskdata::files::{MovtabId, PoseId, TaskData, TrajParaId, VisionPara};

use super::{
    EmoveInputs,
    motion::route::{EmoveGoal, Planning},
    robot_place::{is_moved_by_hand, may_push, near, present_frame},
    tables::{Action, EmoveReach, Sight, Tries, VisionAnswer},
};

const VISION_LIMIT: u64 = 100; // 4 s, after which vision is reported silent
const MAX_TRIES: u8 = 3; // pictures of one kind without a result
/// A picture is valid if the robot is this near to its commanded place.
const STANDS_INCHES: f64 = 0.1;
const STANDS_RADIANS: f64 = 0.5 * core::f64::consts::PI / 180.0; // half a degree
/// Vision's range is in millimetres (VII.7.6).
const MM_PER_INCH: f64 = 25.4;

/// VII.7.6.
#[must_use]
pub(super) fn view_of<'a>(command: &EmoveCommand, data: &TaskData<'a>) -> Option<&'a VisionPara> {
    data.vision_para(command.object_vision)
}

/// The place in the middle of a picture taken with the tool at `tool`.
fn looked_at(tool: &Frame, view: MovtabId, data: &TaskData<'_>) -> Frame {
    data.movetable(view).map_or(*tool, |movetable| movetable.unapply(tool))
}

fn centred(place: &Frame, seen: &VisionResponse) -> Frame {
    place.shifted(Vector::new(0.0, inches(seen.y), inches(seen.z)))
}

/// The frame at the centroid, turned so that tool Y lies across the dimension to grip.
fn part_frame(place: &Frame, seen: &VisionResponse) -> Frame {
    centred(place, seen).turned(&Rotation::from_axis_angle(&Vector::x_axis(), radians(seen.angle)))
}

/// Largest plausible turn, 0.01 degree: a half turn about tool X is equivalent for two fingers.
const QUARTER_TURN: u32 = 9_000;

/// The centroid of a plausible answer lies at most half the expected range from the optical axis (ASSUMED: a lens of
/// 53 degrees), and the roll is within a quarter turn. Else the arm must not move there.
fn is_plausible(request: &VisionRequest, answer: &VisionResponse) -> bool {
    let widest = f64::from(request.range_mm) / (2.0 * MM_PER_INCH);
    let inside = |hundredths: i32| inches(hundredths).abs() <= widest;
    inside(answer.y) && inside(answer.z) && answer.angle.unsigned_abs() <= QUARTER_TURN
}

/// A finger of any gripper: 0.50 in thick along the tool's Y (ASSUMED), and 1.50 in wide along its Z (VIII.9.5).
const FINGER: [f64; 2] = [0.50, 1.50];

/// True if the fingers, open by `opening` in at the tool frame `grip`, stay within the array of their `sector`, whose
/// wall is half a step from its outer sectors (VIII.6). `out` are the steps out of the array, in, in sector axes.
fn stays_in_array(sector: &Frame, grip: &Frame, opening: f64, out: &[Option<Vector>]) -> bool {
    let axes = sector.rotation.inverse();
    let aside = axes * (grip.position - sector.position);
    let [across, along] = [axes * grip.y(), axes * grip.z()];
    let [thick, wide] = FINGER;
    let [reach, half_wide] = [opening / 2.0 + thick, wide / 2.0];
    out.iter().flatten().all(|step| {
        let farthest = aside.dot(step) + reach * across.dot(step).abs() + half_wide * along.dot(step).abs();
        farthest <= step.dot(step) / 2.0
    })
}

/// Vision may recognise another object than the requested one (V.2.1: the second picture includes recognition).
fn is_another(request: &VisionRequest, answer: &VisionResponse) -> bool {
    request.picture == Picture::Precise && answer.recognised != Some(request.object_id)
}

fn request(number: u32, picture: Picture, variation: u8, view: &VisionPara) -> VisionRequest {
    VisionRequest {
        number,
        picture,
        object_id: u16::try_from(view.id).unwrap_or(0),
        grip: i16::try_from(view.grip).unwrap_or(0),
        range_mm: u16::try_from(view.range).unwrap_or(0),
        variation,
    }
}

struct CameraAim {
    tool: Frame,
    view: MovtabId,
    /// The parameters of the last approach to the view.
    parameters: TrajParaId,
}

/// `None` if the resolvers or the task data are not sufficient.
fn aim(command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> Option<CameraAim> {
    if command.command != EmoveVerb::LocateObj {
        return None;
    }
    let data = inputs.data;
    let approach = data.view_approach(&command.object?, command.grip, &command.site.place())?;
    Some(CameraAim {
        tool: present_frame(inputs.memory)?,
        view: view_of(command, data)?.movetable,
        parameters: data.path(approach).last()?.para,
    })
}

pub(super) fn can_aim(command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> bool {
    aim(command, inputs).is_some()
}

/// True if the robot is where it was sent. A sinking arm has moved since the picture was taken.
fn is_where_sent(place: Option<&RobotPlace>, memory: &CommonMemory) -> bool {
    let sent = place.and_then(|place| place.pose.to_frame().ok());
    match (sent, present_frame(memory)) {
        (Some(sent), Some(present)) => near(&sent, &present, STANDS_INCHES, STANDS_RADIANS),
        _ => true,
    }
}

pub(super) fn sight(place: Option<&RobotPlace>, inputs: &EmoveInputs<'_>) -> Sight {
    let (request, answer) = (&inputs.memory.emove.vision, &inputs.external.devices.vision);
    match answer.status {
        VisionStatus::NotRecognised => Sight::Unrecognised,
        VisionStatus::Done if !is_plausible(request, answer) || !is_where_sent(place, inputs.memory) => {
            Sight::Implausible
        }
        VisionStatus::Done if is_another(request, answer) => Sight::Unrecognised,
        VisionStatus::Done => Sight::Seen,
        _ => Sight::Missing,
    }
}

pub(super) struct View {
    pub goal: Pose,
    pub parameters: TrajParaId,
    pub part: Option<Pose>, // if the last picture determines it
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveVision {
    commander: Commander, // requests to vision
    tries: u8,            // pictures without a result in this step
    located: Option<Located>,
}

impl EmoveVision {
    pub(super) const fn adopt(&mut self, estimates: &Estimates) {
        self.located = estimates.located;
    }

    pub(super) const fn write_to(&self, estimates: &mut Estimates) {
        estimates.located = self.located;
    }

    pub(super) fn start(&mut self, answer: &VisionResponse) {
        self.commander.start(answer.echo);
    }

    pub const fn begin(&mut self) {
        self.tries = 0;
    }

    pub(super) const fn forget(&mut self) {
        self.located = None;
    }

    pub(super) fn located(&self) -> Option<LocatedObject> {
        self.located.map(|Located { object, site, .. }| LocatedObject { object, site })
    }

    /// Discard the pictures after the robot controller was off, because the arm has sunk, perhaps onto the object. Also
    /// discard them after manual motion near the object, because the fingers may have pushed it.
    pub(super) fn sense(&mut self, memory: &CommonMemory) {
        let may_touch = |located: &Located| may_push(&located.pose, memory);
        let is_pushed = is_moved_by_hand(memory) && self.located.as_ref().is_some_and(may_touch);
        if is_pushed || memory.prim.status.report == PrimReport::T3LinkOff {
            self.located = None;
        }
    }

    pub(super) fn answer(&self, inputs: &EmoveInputs<'_>) -> VisionAnswer {
        let answer = &inputs.external.devices.vision;
        let over = matches!(
            answer.status,
            VisionStatus::Done | VisionStatus::NothingSeen | VisionStatus::NotRecognised
        );
        if over && answer.echo == self.commander.number {
            VisionAnswer::Answered
        } else if inputs.tick.since(self.commander.sent) > VISION_LIMIT {
            VisionAnswer::Silent
        } else {
            VisionAnswer::Waiting
        }
    }

    pub(super) const fn tries(&self) -> Tries {
        if self.tries.saturating_add(1) < MAX_TRIES { Tries::Left } else { Tries::Spent }
    }

    /// The pose of the command, or of the object found by vision.
    pub(super) fn base_frame(
        &self,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
    ) -> Result<Frame, Planning> {
        let located = self.located.filter(|located| {
            command.command == EmoveVerb::MovToObj
                && Some(located.object) == command.object
                && located.site == command.site
        });
        let pose = match (located, command.pose) {
            (Some(located), _) => located.pose,
            (None, None) => return Err(Planning::NoPose),
            (None, Some(pose @ 0..pose_range::CHANGING)) => {
                let record = inputs.data.pose(PoseId::new(pose)).ok_or(Planning::NoPose)?;
                return Ok(record.frame);
            }
            (None, Some(pose)) => *inputs.memory.changing_pose(pose).ok_or(Planning::NoPose)?,
        };
        pose.to_frame().map_err(|_| Planning::BadPose)
    }

    /// The open fingers, relative to the object's array, in the second picture. A place outside any array has no edge;
    /// the motion to the object reports missing task data.
    pub(super) fn reach(&self, command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> EmoveReach {
        let data = inputs.data;
        let inside = || {
            let CameraAim { tool, view, .. } = aim(command, inputs)?;
            let place = command.site.place();
            let array = data.array(place.array)?;
            let corner = data.locpt(place.locpt).map(|corner| corner.frame);
            let base = corner.or_else(|| Some(data.pose(array.pose)?.frame))?;
            let sector = self.base_frame(command, inputs).ok()?;
            let out = data.steps_out(array, &base, &sector);
            let part = part_frame(&looked_at(&tool, view, data), &inputs.external.devices.vision);
            let command = EmoveCommand { command: EmoveVerb::MovToObj, ..*command };
            let goal = EmoveGoal::new(&command, &part, data).ok()?;
            Some(stays_in_array(&sector, &goal.frame, inches(goal.opening?), &out))
        };
        if inside() == Some(false) { EmoveReach::Outside } else { EmoveReach::Inside }
    }

    pub(super) fn take_picture(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) {
        let again = matches!(action, Action::FloodAgain | Action::PreciseAgain);
        self.tries = if again { self.tries.saturating_add(1) } else { 0 };
        let picture = match action {
            Action::Flood | Action::FloodAgain => Picture::FastFlood,
            _ => Picture::Precise,
        };
        if action == Action::Flood {
            self.located = None;
        }
        if let Some(view) = view_of(command, inputs.data) {
            outputs.vision = request(self.commander.send(inputs.tick), picture, self.tries, view);
        }
    }

    /// The next view, over the centroid. For [`Action::Align`] it also turns with the part, whose place is then known.
    pub(super) fn next_view(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
    ) -> Option<View> {
        let (object, CameraAim { tool, view, parameters }) = (command.object?, aim(command, inputs)?);
        let seen = &inputs.external.devices.vision;
        let middle = looked_at(&tool, view, inputs.data);
        let (target, part) = if action == Action::Align {
            let part = part_frame(&middle, seen);
            let pose = Pose::from_frame(&part);
            self.located = Some(Located { object, site: command.site, pose });
            (part, Some(pose))
        } else {
            (centred(&middle, seen), None)
        };
        Some(View { goal: Pose::from_frame(&inputs.data.moved(&target, view)), parameters, part })
    }

    /// Searches renumber the requests (docs/evidence.md).
    pub const fn commander(&mut self) -> &mut Commander {
        &mut self.commander
    }
}
