//! Test doubles of E-move's neighbours, each with a few lines from the manual's chapter on the process, and their
//! cell.

use std::ops::{Deref, DerefMut};

use geometry::{
    frame::{Frame, Vector, rotation_by, rotation_vector},
    pose::Pose,
};
use interfaces::{
    CommonMemory, ExternalInputs, GripOutputs, Header, JawsOutputs, PrimOutputs, QuickChangeOutputs, Reason,
    device::{JawValves, Picture, VisionStatus},
    grip::{Felt, GripReport, GripVerb},
    jaws::{JawsCommand, JawsReport, JawsVerb},
    pose_range,
    prim::{FORCE_AXES, JoystickGrip, PrimReport, PrimVerb},
    quick_change::{QuickChangeReport, QuickChangeVerb, RingPosition},
};
use rcs_core::tick::Tick;

use super::{
    bench::{data, frame_of, given},
    together::Real,
};
use crate::{
    bench::World,
    emove::Emove,
    environment::worker::{Turn, Worker},
    places::pose_of,
};

const TICKS: u32 = 4; // duration of a command

const STEP: f64 = 0.5; // in per tick, for a stepwise motion of Prim
const ROUNDED: f64 = 1.0; // in before a through point, where Prim turns to the next point

const fn is_motion(verb: PrimVerb) -> bool {
    !matches!(verb, PrimVerb::None | PrimVerb::Pause | PrimVerb::RobotInit | PrimVerb::CalSensor)
}

fn toward(from: &Frame, to: &Frame, share: f64) -> Frame {
    let turn = rotation_vector(&(from.rotation.inverse() * to.rotation));
    Frame { position: from.position + (to.position - from.position) * share, ..*from }
        .turned(&rotation_by(&(turn * share)))
}

/// The failure of a command whose text contains a word.
#[derive(Clone, Copy, Debug)]
pub enum DeliveryFault {
    Prim(PrimReport, Reason), // Prim reports this at the end
    Grip(Reason),             // Grip reports `serror`
    Jaws(JawsReport),         // V-Grip or Tool-Grip reports this at any opening
    Ring(QuickChangeReport),  // Quick Change always reports this
    Joystick,
    Slip,  // the object slips out of the fingers
    Stays, // Prim reports done, but the robot has not moved
    /// The gripper stays on the robot, drops off it, or is another one.
    AttachedGripper(u8),
    /// The sensors of the holster read this.
    Holster(u8),
    Never, // Grip never completes
}

#[derive(Clone)]
pub struct Cell {
    scene: Scene,
    pub prim: Prim,
    pub ring: Ring,
    pub grip: Grip,
    pub v_grip: Jaws,
    pub tool_grip: Jaws,
    vision: EmoveVision,
    pub real: Option<Real>,
    pub dead: Vec<&'static str>,
}

#[derive(Clone)]
pub struct Scene {
    pub frame: Frame,
    /// The mated gripper, and the grippers in the holsters right, left, centre.
    pub mated: u8,
    pub resident: [u8; 3],
    pub holsters: [u8; 3],
    pub locked: bool,
    /// Size of the object at the fingers, 0.01 in.
    pub object: Option<i32>,
    pub joystick: bool,
    pub button: JoystickGrip,
    pub mishaps: Vec<(&'static str, DeliveryFault)>,
    pub log: Vec<String>,
    /// Answers of vision; `Done` after the last.
    pub answers: Vec<VisionStatus>,
    /// Wrong answers of vision: Y, Z, angle, and the recognised object.
    pub claims: Vec<(i32, i32, i32, u16)>,
}

impl Deref for Cell {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.scene
    }
}

impl DerefMut for Cell {
    fn deref_mut(&mut self) -> &mut Scene {
        &mut self.scene
    }
}

impl Cell {
    pub fn new(frame: Frame, gripper: u8, real: Option<Real>) -> Self {
        let mut resident = [1, 2, 3];
        let mut holsters = [0b1111; 3];
        if let Some(which) = usize::from(gripper).checked_sub(1) {
            (resident[which], holsters[which]) = (0, 0);
        }
        let scene = Scene {
            frame,
            mated: gripper,
            resident,
            holsters,
            locked: gripper != 0,
            object: None,
            joystick: false,
            button: JoystickGrip::None,
            mishaps: Vec::new(),
            log: Vec::new(),
            answers: Vec::new(),
            claims: Vec::new(),
        };
        Self {
            scene,
            prim: Prim::default(),
            ring: Ring::default(),
            grip: Grip::default(),
            v_grip: Jaws::new((50, 350)),
            tool_grip: Jaws::new((100, 400)),
            vision: EmoveVision::default(),
            real,
            dead: Vec::new(),
        }
    }
}

impl World<Emove> for Cell {
    fn act(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        after: &mut CommonMemory,
        external: &mut ExternalInputs,
    ) {
        let (dead, scene) = (&self.dead, &mut self.scene);
        let alive = |name| !dead.contains(&name);
        if alive("Subtask") {
            after.subtask.header.stamp = tick;
        }
        if alive("Prim") {
            after.prim = self.prim.step(tick, before, scene);
            if self.prim.by_steps {
                scene.feel_holsters(["HOLSTER-R", "HOLSTER-L", "HOLSTER-C"].map(frame_of));
            }
        }
        if let Some(real) = &mut self.real {
            real.step(tick, before, external, scene, after);
        } else {
            if alive("Quick Change") {
                after.quick_change = self.ring.step(tick, before, scene);
            }
            if alive("gripper") {
                let (asleep, to) = (before.emove.dormant, &before.emove);
                after.grip = self.grip.step(tick, before, scene);
                after.v_grip = self.v_grip.step(tick, asleep.v_grip, &to.v_grip, &before.v_grip, scene);
                after.tool_grip =
                    self.tool_grip.step(tick, asleep.tool_grip, &to.tool_grip, &before.tool_grip, scene);
            }
        }
        if alive("vision") {
            self.vision.step(before, external, scene);
        }
    }
}

impl Scene {
    fn mishap(&self, text: &str) -> Option<DeliveryFault> {
        self.mishaps.iter().find(|(word, _)| text.contains(word)).map(|(_, mishap)| *mishap)
    }

    /// `seats` are the poses of the holsters right, left, centre.
    pub fn feel_holsters(&mut self, seats: [Frame; 3]) {
        for ((which, id), base) in (0..3).zip(1..).zip(seats) {
            let Frame { position: at, .. } = base.inverse().compose(&self.frame);
            let beside = at.y.abs() < 1.0 && at.z > -1.0 && at.z < 2.0;
            let seated = (at.z - 1.5).abs() < 0.06;
            if self.mated == id && !self.locked && seated && beside && at.x < -0.05 {
                (self.mated, self.resident[which]) = (0, id);
            } else if self.mated == 0 && self.resident[which] == id && seated && beside && at.x > -0.05 {
                (self.mated, self.resident[which]) = (id, 0);
            }
            self.holsters[which] = match (self.mated == id && beside, self.resident[which] == id) {
                (_, true) => 0b1111,
                (true, _) if seated && at.x > -0.05 => 0b1111,
                (true, _) if at.x > -0.05 => 0b0011,
                (true, _) if at.x > -1.0 => 0b0001,
                _ => 0,
            };
        }
    }

    fn moved(&mut self, text: &str, gripper: u8) {
        let which = usize::from(gripper.clamp(1, 3)) - 1;
        let seen = &mut self.holsters[which];
        if text.contains("QCD-DOWN") || text.contains("QCA-BACK") {
            *seen = 0b0011;
        } else if text.contains("QCD-SEAT") {
            *seen = 0b1111;
        } else if text.contains("QCD-UP") && !self.locked {
            self.resident[which] = self.mated;
            self.mated = 0;
        } else if text.contains("QCA-SLOW") && self.mated == 0 {
            self.mated = self.resident[which];
        } else if text.contains("QCA-LIFT") {
            *seen = 0;
            self.resident[which] = 0;
        }
        match self.mishap(text) {
            Some(DeliveryFault::AttachedGripper(id)) => self.mated = id,
            Some(DeliveryFault::Holster(bits)) => self.holsters[which] = bits,
            _ => {}
        }
    }
}

#[derive(Clone, Default)]
struct Receiving {
    worker: Worker,
    text: String,
}

impl Receiving {
    /// True in the tick in which the command is done.
    fn step(
        &mut self,
        number: u32,
        ticks: u32,
        text: impl FnOnce() -> String,
        log: &mut Vec<String>,
    ) -> bool {
        let turn = self.worker.turn(number, ticks);
        if turn == Turn::Takes {
            self.text = text();
            log.push(self.text.clone());
        }
        turn == Turn::Ends
    }
}

#[derive(Clone, Default)]
pub struct Prim {
    pub by_steps: bool,
    pub sag: Vector, // offset of the arm from its commanded position
    receiving: Receiving,
    pub restarts: bool, // Prim orders T3I to restart the link
    pub report: PrimReport,
    pub reason: Reason,
    /// The force sensor has been calibrated, and has had power ever since.
    pub calibrated: bool,
    link: bool,
    /// The robot controller is off, after the last command was done.
    pub controller_off: bool,
    poses: u32,
}

impl Prim {
    fn text(memory: &CommonMemory) -> String {
        let (command, data) = (&memory.emove.prim, data());
        let table = command.movetable.of(data.movetables).map(|record| record.name);
        let words = [
            command.command.text().to_owned(),
            table.map_or(String::new(), |n| n.to_string()),
            command.sensor.unwrap_or_default().to_string(),
        ];
        words.iter().filter(|word| !word.is_empty()).cloned().collect::<Vec<_>>().join(" ")
    }

    fn goal(memory: &CommonMemory) -> Option<Frame> {
        let command = &memory.emove.prim;
        let base = pose_of(command.pose, memory, &data())?;
        Some(data().moved(&base, command.movetable))
    }

    fn step(&mut self, tick: Tick, memory: &CommonMemory, world: &mut Scene) -> PrimOutputs {
        let command = &memory.emove.prim;
        let new = command.number != self.receiving.worker.echo();
        let steps = self.by_steps && is_motion(command.command);
        let ticks = if steps { u32::MAX } else { TICKS };
        let ends = self.receiving.step(command.number, ticks, || Self::text(memory), &mut world.log);
        if new {
            (self.report, self.reason) = (PrimReport::Executing, Reason::None);
        } else if steps && self.report == PrimReport::Executing && Self::go(memory, world) {
            self.report = PrimReport::Done;
        }
        let text = self.receiving.text.clone();
        if ends && self.report == PrimReport::Executing {
            self.end(&text, memory, world);
        }
        let pausing = command.command == PrimVerb::Pause;
        if world.joystick && (pausing || self.report != PrimReport::Done) {
            (self.report, self.reason) = (PrimReport::JoystickOn, Reason::JoystickOn);
        } else if pausing && self.report == PrimReport::JoystickOn {
            (self.report, self.reason) = (PrimReport::Done, Reason::None);
        }
        self.outputs(tick, world)
    }

    /// A step towards the goal. True if the motion has ended.
    fn go(memory: &CommonMemory, world: &mut Scene) -> bool {
        let command = &memory.emove.prim;
        let goal = Self::goal(memory).expect("a command to Prim names existing records");
        let sensor = command.sensor.unwrap_or_default();
        let condition = |world: &Scene| {
            let bits = match sensor.as_str() {
                "HOL-NEAR" => 0b0011,
                "HOL-SEAT" => 0b1111,
                _ => return false,
            };
            let which = usize::from(memory.subtask.emove.end_effector_id.unwrap_or(1).clamp(1, 3)) - 1;
            world.holsters[which] & bits == bits
        };
        if command.command == PrimVerb::GoUntil && condition(world) {
            return true;
        }
        let distance = world.frame.distance(&goal).path();
        let near = if command.command == PrimVerb::GoThru { ROUNDED } else { 0.0 };
        world.frame = toward(&world.frame, &goal, (STEP / distance.max(STEP)).min(1.0));
        distance <= STEP.max(near)
    }

    fn end(&mut self, text: &str, memory: &CommonMemory, world: &mut Scene) {
        let command = &memory.emove.prim;
        self.report = PrimReport::Done;
        match world.mishap(text) {
            Some(DeliveryFault::Prim(report, reason)) => (self.report, self.reason) = (report, reason),
            Some(DeliveryFault::Joystick) => (world.joystick, self.report) = (true, PrimReport::JoystickOn),
            Some(DeliveryFault::Slip) => world.object = None,
            _ => {}
        }
        if matches!(world.mishap(text), Some(DeliveryFault::Stays)) {
            return;
        }
        match command.command {
            PrimVerb::RobotInit => self.link = self.report == PrimReport::Done,
            PrimVerb::CalSensor => self.calibrated |= self.report == PrimReport::Done,
            PrimVerb::None | PrimVerb::Pause => {}
            _ if matches!(self.report, PrimReport::Done | PrimReport::NotDetected) => {
                world.frame = Self::goal(memory).expect("a command to Prim names existing records");
                world.moved(text, memory.subtask.emove.end_effector_id.unwrap_or(1));
            }
            _ => {}
        }
    }

    fn outputs(&mut self, tick: Tick, world: &Scene) -> PrimOutputs {
        let mut outputs =
            PrimOutputs { header: Header { stamp: tick, ..Header::default() }, ..PrimOutputs::default() };
        for record in &mut outputs.poses[..2] {
            self.poses = pose_range::next(pose_range::PRIM, self.poses);
            (record.number, record.pose) = (Some(self.poses), Pose::from_frame(&world.frame));
        }
        outputs.poses[1].pose =
            Pose::from_frame(&Frame { position: world.frame.position - self.sag, ..world.frame });
        outputs.bias = self.calibrated.then_some([0.0; FORCE_AXES]);
        let status = &mut outputs.status;
        status.restarting = self.restarts;
        status.echo = self.receiving.worker.echo();
        (status.report, status.reason) = (self.report, self.reason);
        (status.link_running, status.controller_off) = (self.link, self.controller_off);
        (status.present_pose, status.sensor_pose) = (outputs.poses[0].number, outputs.poses[1].number);
        [status.holster_right, status.holster_left, status.holster_centre] = world.holsters;
        status.joystick_grip = world.button;
        outputs
    }
}

#[derive(Clone, Default)]
pub struct Ring {
    receiving: Receiving,
    failed: Option<QuickChangeReport>,
    /// The ring is between its ends until an order turns it.
    pub half: bool,
}

impl Ring {
    fn step(&mut self, tick: Tick, memory: &CommonMemory, world: &mut Scene) -> QuickChangeOutputs {
        let command = &memory.emove.quick_change;
        let text = || command.command.text().to_owned();
        let new = command.number != self.receiving.worker.echo();
        if self.receiving.step(command.number, TICKS, text, &mut world.log) {
            match world.mishap(command.command.text()) {
                Some(DeliveryFault::Ring(report)) => self.failed = Some(report),
                _ if command.command == QuickChangeVerb::Lock => (self.half, world.locked) = (false, true),
                _ if command.command == QuickChangeVerb::Unlock => (self.half, world.locked) = (false, false),
                _ => {}
            }
        } else if new {
            self.failed = None;
        }
        let mut outputs = QuickChangeOutputs {
            header: Header { stamp: tick, ..Header::default() },
            ..QuickChangeOutputs::default()
        };
        outputs.status.echo = self.receiving.worker.echo();
        outputs.status.end_effector_id = given(world.mated);
        outputs.status.ring = match self.failed {
            Some(QuickChangeReport::SensorMalfunction) => RingPosition::Implausible,
            Some(_) => RingPosition::Between,
            None if self.half => RingPosition::Between,
            None if world.locked => RingPosition::Locked,
            None => RingPosition::Unlocked,
        };
        outputs.status.report = match self.failed {
            Some(report) => report,
            None if self.receiving.worker.is_working() => QuickChangeReport::Executing,
            None if world.locked => QuickChangeReport::Locked,
            None => QuickChangeReport::Unlocked,
        };
        outputs
    }
}

/// Publish the last output of a dormant process again.
fn sleep(header: &mut Header, tick: Tick) {
    (header.stamp, header.republished) = (tick, true);
}

#[derive(Clone)]
pub struct Grip {
    receiving: Receiving,
    report: GripReport,
    reason: Reason,
    pub initialized: bool,
    pub opening: i32,
    pub force: i32, // lb on each finger
}

impl Default for Grip {
    fn default() -> Self {
        Self {
            receiving: Receiving::default(),
            report: GripReport::Idle,
            reason: Reason::None,
            initialized: true,
            opening: 200,
            force: 30,
        }
    }
}

impl Grip {
    fn step(&mut self, tick: Tick, memory: &CommonMemory, world: &mut Scene) -> GripOutputs {
        let mut outputs = memory.grip;
        if memory.emove.dormant.grip {
            sleep(&mut outputs.header, tick);
            return outputs;
        }
        let command = &memory.emove.grip;
        let new = command.number != self.receiving.worker.echo();
        if self.receiving.step(command.number, TICKS, || command.command.text().to_owned(), &mut world.log) {
            self.report = GripReport::Done;
            match (world.mishap(command.command.text()), command.command) {
                (Some(DeliveryFault::Grip(reason)), _) => {
                    (self.report, self.reason) = (GripReport::Serror, reason)
                }
                (Some(DeliveryFault::Never), _) => self.report = GripReport::Executing,
                (_, GripVerb::Position | GripVerb::OpenGrip) => {
                    self.opening = command.position;
                    world.object = world.object.filter(|size| *size > command.position);
                }
                (_, GripVerb::CloseGrip) => self.opening = world.object.unwrap_or(command.position),
                (_, GripVerb::UpInit) => (self.initialized, self.opening) = (true, 500),
                (_, GripVerb::None | GripVerb::Pause) => {}
            }
        } else if new {
            (self.report, self.reason) = (GripReport::Executing, Reason::None);
        }
        outputs.header = Header { stamp: tick, ..Header::default() };
        outputs.status.echo = self.receiving.worker.echo();
        (outputs.status.report, outputs.status.reason) = (self.report, self.reason);
        (outputs.status.initialized, outputs.status.position) = (self.initialized, self.opening);
        (outputs.status.left_force, outputs.status.right_force) = (self.force, self.force);
        outputs.status.felt = match world.object {
            _ if !self.initialized => Felt::NotKnown,
            Some(size) if size == self.opening && self.force > 0 => Felt::Something,
            _ => Felt::Nothing,
        };
        outputs
    }
}

#[derive(Clone)]
pub struct Jaws {
    receiving: Receiving,
    report: JawsReport,
    stops: (i32, i32),
    pub opening: i32,
}

impl Jaws {
    pub fn new(stops: (i32, i32)) -> Self {
        Self { receiving: Receiving::default(), report: JawsReport::Idle, stops, opening: stops.1 }
    }

    fn step(
        &mut self,
        tick: Tick,
        dormant: bool,
        command: &JawsCommand,
        before: &JawsOutputs,
        world: &mut Scene,
    ) -> JawsOutputs {
        let mut outputs = *before;
        if dormant {
            sleep(&mut outputs.header, tick);
            return outputs;
        }
        let text = || format!("{} {}", command.command.text(), command.size);
        let new = command.number != self.receiving.worker.echo();
        if self.receiving.step(command.number, TICKS, text, &mut world.log) {
            let close = command.command == JawsVerb::Grasp;
            if !matches!(command.command, JawsVerb::None | JawsVerb::Pause) {
                outputs.valves = JawValves { open: !close, close };
            }
            match (world.mishap(command.command.text()), command.command) {
                (Some(DeliveryFault::Jaws(report)), _) => self.report = report,
                (_, JawsVerb::Pose | JawsVerb::Release) => {
                    (self.opening, self.report) = (self.stops.1, JawsReport::Opened);
                    world.object = None;
                }
                (_, JawsVerb::Grasp) => {
                    self.opening = world.object.unwrap_or(self.stops.0);
                    let expected = self.opening == self.stops.0 || (self.opening - command.size).abs() <= 10;
                    self.report = if expected { JawsReport::Closed } else { JawsReport::Stuck };
                }
                (_, JawsVerb::None | JawsVerb::Pause) => {
                    self.report = match self.opening {
                        at if at == self.stops.0 => JawsReport::Closed,
                        at if at == self.stops.1 => JawsReport::Opened,
                        at if at == command.size => JawsReport::AtPosition,
                        _ => JawsReport::Stuck,
                    };
                }
            }
        } else if new {
            self.report = JawsReport::Executing;
        }
        outputs.header = Header { stamp: tick, ..Header::default() };
        outputs.status.echo = self.receiving.worker.echo();
        (outputs.status.report, outputs.status.size) = (self.report, self.opening);
        let at_stop = self.opening == self.stops.0 || self.opening == self.stops.1;
        outputs.status.felt = if at_stop { Felt::Nothing } else { Felt::Something };
        if self.report == JawsReport::Stuck {
            outputs.status.reason = Reason::JawsStuck;
        }
        outputs
    }
}

#[derive(Clone, Default)]
pub struct EmoveVision {
    left: u32,
}

impl EmoveVision {
    fn step(&mut self, memory: &CommonMemory, external: &mut ExternalInputs, world: &mut Scene) {
        let (request, answer) = (&memory.emove.vision, &mut external.devices.vision);
        if request.number != answer.echo {
            (answer.echo, answer.status, self.left) = (request.number, VisionStatus::Busy, TICKS);
            let picture = if request.picture == Picture::Precise { "precise" } else { "flood" };
            world.log.push(format!("{picture} {}", request.variation));
        } else if self.left > 0 {
            self.left -= 1;
            if self.left == 0 {
                let next =
                    if world.answers.is_empty() { VisionStatus::Done } else { world.answers.remove(0) };
                let truth = (20, -10, 1000, request.object_id);
                let claim = if world.claims.is_empty() { truth } else { world.claims.remove(0) };
                answer.status = next;
                (answer.y, answer.z, answer.angle) = (claim.0, claim.1, claim.2);
                answer.recognised = Some(claim.3);
            }
        }
    }
}
