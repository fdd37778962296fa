//! The state of the cell during a job, and how steps change it.

use geometry::frame::{Frame, Vector, rotation_by};
use interfaces::emove::EmoveVerb;
use plant::{
    part::sizes_along,
    pedestal::hand_frame,
    room::{Layout, Placed, Room},
    vise::Jaws,
};
use rcs_core::name::Name16;
use taskdata::{files::Location, load::job::ViseOpening};

use crate::{
    finding::{Finding, Walked},
    flight::Robot,
    job::{Random, placed},
    known::Known,
    plan::Phase,
    steps::{PedestalVerb, Step},
    walk::Walk,
};

const THERE: f64 = 8.0; // in: farther from its expected position a part is missing

#[derive(Clone, Debug)]
pub struct State<'a> {
    pub room: &'a Room,
    pub known: &'a Known,
    pub walk: Walk<'a>, // the robot's position in the task data, and its paths
    pub robot: Robot,
    pub layout: Layout,
    pub held: Option<(Name16, i32)>,    // with its grip
    pub random: Vec<Random>,            // parts at random in their sectors
    pub advises: bool,                  // a failed flight is repeated with more via points
    pub stranded: bool,                 // the robot's controller has stopped
    pub before: Vec<[&'static str; 2]>, // the commands that brought the robot here
    regrip: Option<Name16>,             // at the pedestal, or about to arrive
    last: Option<(Name16, Location)>,   // of the last motion
    pub(crate) drum_grips: bool,
    pub(crate) lacking: Vec<Name16>, // missing parts, each reported once, and parts machined from them
}

impl<'a> State<'a> {
    /// The state after start-up, with open fingers.
    #[must_use]
    pub fn new(room: &'a Room, known: &'a Known, walk: Walk<'a>, robot: Robot) -> Self {
        let mut layout = room.at_start();
        layout.opening = room.worn(&layout).map_or(0.0, |gripper| gripper.opening[1]);
        Self {
            room,
            known,
            walk,
            robot,
            layout,
            held: None,
            random: Vec::new(),
            advises: false,
            stranded: false,
            before: Vec::new(),
            regrip: None,
            last: None,
            drum_grips: false,
            lacking: Vec::new(),
        }
    }

    /// With `again`, moves the part within its sector. Returns false if the cell has no such location.
    pub fn deliver(&mut self, object: &Name16, at: &Location, aside: [f64; 3], again: bool) -> bool {
        let cell = self.room.cell();
        let Some(kind) = cell.part(object.as_str()) else { return false };
        let sector = at.sector.map_or(0, |sector| u16::try_from(sector).unwrap_or(u16::MAX));
        let Ok(frame) = cell.delivered(kind, at.name.as_str(), sector, aside) else { return false };
        if again && let Some(there) = self.nearest(object, &at.frame) {
            self.layout.parts.remove(there);
        }
        self.layout.parts.push(Placed { kind: kind.clone(), frame });
        true
    }

    pub(crate) fn nearest(&self, object: &Name16, frame: &Frame) -> Option<usize> {
        let away = |part: &Placed| (part.frame.position - frame.position).norm();
        let named =
            self.layout.parts.iter().enumerate().filter(|(_, part)| part.kind.name == object.as_str());
        named
            .map(|(index, part)| (index, away(part)))
            .filter(|(_, away)| *away < THERE)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(index, _)| index)
    }

    pub fn move_vise(&mut self, opening: ViseOpening, program: Option<&Name16>) {
        let programs = &self.room.cell().vise.program;
        let named = program.and_then(|name| programs.iter().position(|one| one.name == name.as_str()));
        self.layout.program = named.unwrap_or(self.layout.program);
        let jaws = match opening {
            ViseOpening::Partial => Jaws::Partial,
            ViseOpening::Open => Jaws::Open,
            ViseOpening::Close => Jaws::Closed,
        };
        self.layout.jaws = self.room.jaws(self.layout.program, jaws);
        if jaws == Jaws::Closed {
            self.room.clamp(&mut self.layout, &self.robot.tool());
        }
    }

    pub fn machine(&mut self, blank: &Name16, part: &Name16) {
        let next = self.room.cell().part(part.as_str());
        let is = |one: &&mut Placed| one.kind.name == blank.as_str();
        if let (Some(next), Some(one)) = (next, self.layout.parts.iter_mut().find(is)) {
            one.kind.clone_from(next);
        }
        if self.lacking.contains(blank) {
            self.lacking.push(*part);
        }
        if self.room.in_vise(&self.layout).is_some() {
            self.room.clamp(&mut self.layout, &self.robot.tool());
        }
    }

    pub fn put_into_drum(&mut self, tool: &Name16) {
        let drum = &self.room.cell().drum;
        if let Some(pose) = drum.pose.frame() {
            let frame = pose.shifted(Vector::new(drum.middle, 0.0, 0.0));
            self.layout.parts.extend(placed(self.room, tool, frame));
            self.drum_grips = true;
        }
    }

    pub fn step(&mut self, step: &Step, task: &str) -> (Walked, Vec<Finding>) {
        let hindrance = self.hindrance(step);
        let (walked, mut findings) = self.make(step, task);
        // A missing or clamped part also causes contacts, so only the cause is reported.
        if let Some(hindrance) = hindrance {
            findings = vec![hindrance];
        }
        (walked, findings)
    }

    fn make(&mut self, step: &Step, task: &str) -> (Walked, Vec<Finding>) {
        match *step {
            Step::Go { verb, object, location, .. } => {
                self.layout.engaged = None;
                self.last = object.map(|object| (object, location));
                let phase = self.walk.step(step);
                let subtask = match task {
                    "POSITION" => ">POSITION",
                    _ if self.regrip.is_some() => "FIX-GRIP",
                    _ => "",
                };
                self.fly(phase, [verb.text(), subtask], true)
            }
            Step::Relative { name, .. } => {
                let phase = self.walk.step(step);
                let verb = match name.get(..3) {
                    Some("QCA") => "QC-ATTACH",
                    Some("QCD") => "QC-DETACH",
                    _ => match task {
                        "ACQUIRE-TOOL" => "ACQUIRE-TOOL",
                        "RELEASE-TOOL" => "RELEASE-TOOL",
                        "REMOVE-TOOL" => "REMOVE-TOOL",
                        _ => "INSERT-TOOL",
                    },
                };
                // After a guarded move the position is unknown. INS-NEAR, if it does not fail, ends at its goal.
                let known = match name {
                    "QCD-UP" | "REL-BACK" => false,
                    "INS-NEAR" => true,
                    _ => !phase.guarded,
                };
                self.fly(phase, [verb, verb], known)
            }
            Step::Locate => {
                let phase = self.locate();
                self.fly(phase, ["LOCATE-OBJ", ""], true)
            }
            _ => {
                let phase = self.walk.step(step);
                let findings = self.beside(step, &phase).into_iter().collect();
                self.stand(step);
                (Walked::of(phase), findings)
            }
        }
    }

    fn stand(&mut self, step: &Step) {
        match *step {
            Step::Fingers { verb: EmoveVerb::GraspObj, object, grip } => {
                if let Some(object) = object {
                    self.grasp(&object, grip, &self.robot.tool());
                }
                self.before = vec![["GRASP-OBJ", ""]];
            }
            Step::Fingers { object, grip, .. } => {
                let sizes = object.and_then(|object| self.walk.data().object(&object, grip));
                self.release(sizes.map(|(_, sizes)| f64::from(sizes.depart_size) / 100.0));
                self.before = vec![["RELEASE", ""]];
            }
            Step::GraspTool => {
                // The end of a guarded move is unknown, so the fingers are assumed at the drum's tool position.
                let drum = self.room.cell().drum.pose.frame();
                if let Some((object, drum)) = self.tool_in_drum().zip(drum) {
                    self.grasp(&object, 1, &drum);
                }
                self.before = vec![["ACQUIRE-TOOL"; 2]];
            }
            Step::LetGoTool => {
                self.release(None);
                self.before = vec![["RELEASE-TOOL"; 2]];
            }
            Step::Pedestal(verb) => self.pedestal(verb),
            Step::Engage(id) => self.layout.engaged = Some(id),
            Step::Leave(id) => (self.layout.gripper, self.layout.engaged) = (None, Some(id)),
            Step::Take(id) => {
                (self.layout.gripper, self.layout.engaged) = (Some(id), None);
                self.layout.opening = self.room.gripper(id).map_or(0.0, |gripper| gripper.opening[0]);
                self.before = vec![["QC-ATTACH", "QC-ATTACH"]];
            }
            Step::Go { .. } | Step::Relative { .. } | Step::Locate | Step::Other(_) => {}
        }
    }

    pub(crate) fn tool_in_drum(&self) -> Option<Name16> {
        let tool = self.robot.tool();
        let away = |part: &Placed| (part.frame.position - tool.position).norm();
        let part = self.layout.parts.iter().filter(|part| part.kind.tool && away(part) < THERE);
        let part = part.min_by(|a, b| away(a).total_cmp(&away(b)))?;
        Some(Name16::clipped(&part.kind.name))
    }

    /// Grasps the nearest part of this name; `tool` is the tool frame.
    fn grasp(&mut self, object: &Name16, grip: i32, tool: &Frame) {
        self.held = Some((*object, grip));
        let Some(index) = self.nearest(object, tool) else {
            self.lacking.push(*object);
            return;
        };
        let part = self.layout.parts.remove(index);
        let mut frame = tool.inverse().compose(&part.frame);
        frame.position.y = 0.0; // the fingers centre the part between them
        let groove = self.room.worn(&self.layout).and_then(|gripper| gripper.groove);
        if groove.is_none() {
            self.layout.opening = sizes_along(&frame, &part.kind).y;
        }
        self.layout.held = Some(Placed { frame, ..part });
    }

    /// Opens the fingers to `opening`, in; fully with `None`.
    fn release(&mut self, opening: Option<f64>) {
        self.held = None;
        if let Some(held) = self.layout.held.take() {
            let frame = self.robot.tool().compose(&held.frame);
            let there = Placed { frame, ..held };
            let frame = self.room.nest_seat(&there).unwrap_or(there.frame);
            self.layout.parts.push(Placed { frame, ..there });
        }
        self.open(opening.unwrap_or(f64::INFINITY));
    }

    /// Opening in inches, limited by the gripper.
    fn open(&mut self, opening: f64) {
        if let Some(gripper) = self.room.worn(&self.layout) {
            self.layout.opening = opening.clamp(gripper.opening[0], gripper.opening[1]);
        }
    }

    fn pedestal(&mut self, verb: PedestalVerb) {
        let held = self.held.map(|(object, _)| object);
        let Some(object) = self.regrip.or(held) else { return };
        let Some((_, sizes)) = self.walk.data().ped_para(&object) else { return };
        let pedestal = &self.room.cell().pedestal;
        let [low, high] = pedestal.hand.opening;
        let inches = |size: i32| (f64::from(size) / 100.0).clamp(low, high);
        let angle = |tenths: i32| pedestal.table.angle(f64::from(tenths) / 10.0);
        match verb {
            PedestalVerb::PreGrip => {
                self.regrip = Some(object);
                (self.layout.hand, self.layout.table) = (inches(sizes.appr), angle(sizes.table_pos));
            }
            PedestalVerb::Grip => {
                self.layout.hand = inches(sizes.grasp_size);
                self.before = vec![["MOV-OBJ-TO", "FIX-GRIP"]];
            }
            PedestalVerb::Flip => {
                let to = angle(sizes.table_pos.saturating_add(sizes.flip_angle));
                let part = self.nearest(&object, &hand_frame(pedestal, self.layout.table));
                let turned = part.and_then(|index| {
                    Some((index, self.room.turned(&self.layout, to, &self.layout.parts.get(index)?.frame)))
                });
                if let Some((index, frame)) = turned
                    && let Some(part) = self.layout.parts.get_mut(index)
                {
                    part.frame = frame;
                }
                self.layout.table = to;
            }
            PedestalVerb::Release => {
                self.layout.hand = inches(sizes.release_size);
                self.before = vec![["GRASP-OBJ", "FIX-GRIP"]];
                self.regrip = None;
            }
        }
    }

    fn locate(&mut self) -> Phase {
        let seen = self.last.and_then(|(object, location)| {
            let part = self.layout.parts.get(self.nearest(&object, &location.frame)?)?;
            let (_, view) = self.walk.data().view(&object, &location.place)?;
            Some((found(&location.frame, part, view.grip), location.frame))
        });
        match seen {
            Some((object, looked_at)) => self.walk.find(&object, &looked_at),
            None => self.walk.step(&Step::Locate),
        }
    }
}

/// The part frame from vision (V.2.1 LOCATE-OBJ) is in the plane of the location. It is turned by at most 90 degrees
/// until tool Y crosses the wider side for grip 1, the narrower for others (VII.7.6).
fn found(place: &Frame, part: &Placed, grip: i32) -> Frame {
    let aside = part.frame.position - place.position;
    let at = Vector::new(0.0, aside.dot(&place.y()), aside.dot(&place.z()));
    let [_, wide, long] = part.kind.size;
    let across = if (wide > long) == (grip.abs() == 1) { part.frame.y() } else { part.frame.z() };
    let angle = across.dot(&place.z()).atan2(across.dot(&place.y()));
    let quarter = core::f64::consts::FRAC_PI_2;
    let angle = (angle + quarter).rem_euclid(2.0 * quarter) - quarter;
    place.shifted(at).turned(&rotation_by(&Vector::new(angle, 0.0, 0.0)))
}
