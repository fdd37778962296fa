//! The cell as a whole: one tick of it is one call.

mod changing;
mod clearing;
mod drumming;
mod event;
mod handling;
mod machining;
mod order;
mod outline;
mod picture;
mod placing;
mod sagging;
mod saving;
mod sensing;
mod workstation;

use depc::{
    Limits, Plate,
    controller::ControllerState,
    fault::{Direction, Injector as LineInjector},
};
use geometry::{frame::Frame, kinematics::Joints};
use interfaces::device::{DeviceInputs, DeviceOutputs, LinkBytes};
use rapier3d_f64::prelude::*;
use rcs_core::tick::{TICK_S, Tick};
use serde::{Deserialize, Serialize};

use changing::Changer;
pub use event::{CellError, CellEvent};
use handling::Hand;
pub use picture::{Link, part_link};
pub use sagging::Droop;
pub use saving::{RestoreError, SaveError};
pub use workstation::{Placement, WorkstationAction, WorkstationError};

use crate::{
    bodies,
    camera::{Analysis, Optics},
    clearance::{Body, Clearance},
    convert::{GRAVITY, to_frame, to_pose},
    description::{Actuators, CellDescription, Points},
    drum::Drum,
    fault::{Change, FaultPlan, Injector, Struck},
    gripper::Gripper,
    jaws::Supply,
    joystick::Joystick,
    noise::{Noise, Stream},
    part::{Part, PartState},
    pedestal::Pedestal,
    scene::{Block, FINGER, furniture},
    sensor::DeadTimes,
    t3::{DriveError, Key, Message, Refusal, StepInputs, StepOutputs, T3Controller},
    vise::Vise,
};

/// The simulated cell: everything outside the controller.
#[derive(Deserialize, Serialize)]
pub struct Cell {
    description: CellDescription,
    world: PhysicsWorld,
    t3: T3Controller,
    /// The host's DTR.
    host_ready: bool,
    /// Parts gripper, v-gripper, tool gripper.
    grippers: [Gripper; 3],
    changer: Changer,
    drum: Drum,
    pedestal: Pedestal,
    vise: Vise,
    optics: Optics,
    analysis: Analysis,
    /// Another process analyses the pictures.
    vision_elsewhere: bool,
    joystick: Joystick,
    parts: Vec<Part>,
    next_part: u32,
    /// What stands still: built anew from the description when a cell is restored, as are the obstacles.
    #[serde(skip)]
    furniture: Vec<Block>,
    #[serde(skip)]
    obstacles: Vec<Body>,
    clearance: Clearance,
    gripper_noise: Noise,
    pedestal_noise: Noise,
    force_noise: Noise,
    placement_noise: Noise,
    resolver_noise: Noise,
    dead_times: DeadTimes,
    faults: Injector,
    /// Ticks in which the jaw of the vise should have moved and has not.
    jaw_waits: u32,
    events: Vec<CellEvent>,
    /// The arm cannot follow the robot; said once.
    stays_behind: bool,
    droop: Option<Droop>,
    #[serde(with = "crate::image::record")]
    inputs: DeviceInputs,
}

impl Cell {
    /// Build the cell of a description; the seed sets the noise of the sensors and where parts are put down at random.
    ///
    /// # Errors
    /// [`CellError`] if the description cannot be used.
    pub fn new(description: &CellDescription, seed: u64) -> Result<Self, CellError> {
        Self::with_faults(description, seed, &FaultPlan::default())
    }

    /// Like [`Cell::new`], with faults that will begin when their plan says.
    ///
    /// # Errors
    /// [`CellError`] if the description cannot be used.
    pub fn with_faults(
        description: &CellDescription,
        seed: u64,
        faults: &FaultPlan,
    ) -> Result<Self, CellError> {
        description.validate()?;
        let description = &faults.displaced(description);
        let mut world = physics(description);
        let furniture = furniture(description);
        let ground = world.insert_body(RigidBodyBuilder::fixed());
        for block in &furniture {
            world.insert_collider(block.collider(), Some(ground));
        }
        let actuators = Actuators::from(&description.robot);
        let t3 = T3Controller::started(Limits::NBS, &actuators, &description.robot.start_joints(), seed)?;
        let tool = to_pose(&t3.arm().tool());
        let stiffness = description.robot.stiffness;
        let changer = Changer::new(description);
        let [parts, v, tools] =
            [&description.gripper.parts, &description.gripper.v, &description.gripper.tool];
        let grippers =
            [parts, v, tools].map(|gripper| Gripper::new(&mut world, gripper, stiffness, &tool, FINGER));
        let pedestal = Pedestal::new(&mut world, &description.pedestal);
        let vise = Vise::new(&mut world, &description.vise);
        let mut cell = Self {
            t3,
            host_ready: true,
            optics: Optics::new(&description.camera),
            analysis: Analysis::new(&description.camera, seed),
            vision_elsewhere: false,
            obstacles: bodies::standing(description, &furniture),
            joystick: Joystick::default(),
            description: description.clone(),
            world,
            grippers,
            changer,
            drum: Drum::new(place(&description.drum.pose), &description.drum),
            pedestal,
            vise,
            parts: Vec::new(),
            next_part: 1,
            furniture,
            clearance: Clearance::default(),
            gripper_noise: Noise::new(seed, Stream::Gripper),
            pedestal_noise: Noise::new(seed, Stream::Pedestal),
            force_noise: Noise::new(seed, Stream::Force),
            placement_noise: Noise::new(seed, Stream::Placement),
            resolver_noise: Noise::new(seed, Stream::Resolvers),
            dead_times: DeadTimes::new(&description.sensors),
            faults: Injector::new(faults, seed),
            jaw_waits: 0,
            events: Vec::new(),
            stays_behind: false,
            droop: None,
            inputs: DeviceInputs::default(),
        };
        cell.hang_grippers();
        cell.check_clearance();
        if let Some(blocked) = cell.events.pop() {
            return Err(CellError::Blocked(blocked));
        }
        let begin = cell.faults.turn();
        cell.tell(begin);
        cell.inputs = cell.sense(LinkBytes::default(), false);
        Ok(cell)
    }

    /// What it was built from, as the faults of the plan have displaced it.
    #[must_use]
    pub const fn description(&self) -> &CellDescription {
        &self.description
    }

    /// What the devices show: before the first tick as the cell was built, then as the last tick left it.
    #[must_use]
    pub fn inputs(&self) -> DeviceInputs {
        self.inputs
    }

    /// Advance the cell by exactly one tick of 40 ms with what the controller wrote in the last one.
    pub fn step(&mut self, outputs: &DeviceOutputs) -> DeviceInputs {
        let outputs = &self.begin_tick(outputs);
        let StepOutputs { tx, dtr, .. } =
            self.t3.step(&StepInputs { rx: outputs.link_tx, cts: self.host_ready });
        self.hear_t3();
        self.advance(outputs);
        self.inputs = self.sense(tx, dtr);
        self.inputs
    }

    /// Like [`Cell::step`], with a line to the robot controller that may have faults in `tick`.
    pub fn step_behind(
        &mut self,
        line: &mut LineInjector,
        tick: Tick,
        outputs: &DeviceOutputs,
    ) -> DeviceInputs {
        let (rx, ready) = line.carry(Direction::ToController, tick, &outputs.link_tx, true);
        self.set_host_ready(ready);
        let mut inputs = self.step(&DeviceOutputs { link_tx: rx, ..*outputs });
        (inputs.link_rx, inputs.link_ready) =
            line.carry(Direction::ToHost, tick, &inputs.link_rx, inputs.link_ready);
        inputs
    }

    /// Like [`Cell::step`], while a robot elsewhere is commanded: the simulated arm, and with it all else in
    /// the cell, follows `position`, the one that the robot has acknowledged; `None` while none is known. The
    /// simulated T3 controller is not asked: `outputs.link_tx` goes to the robot, and what it answers is the
    /// caller's to fill in (`link_rx` and `link_ready` are returned empty).
    ///
    /// The arm comes from where it is as fast as its servos can, so a first position far away is a motion,
    /// not a jump. A position that it cannot take leaves it where it is and is a [`CellEvent::CannotFollow`].
    pub fn step_following(&mut self, position: Option<&Plate>, outputs: &DeviceOutputs) -> DeviceInputs {
        let outputs = &self.begin_tick(outputs);
        let followed = position.map_or(Ok(()), |plate| self.t3.follow(plate));
        if let Err(problem) = followed
            && !self.stays_behind
        {
            self.events.push(CellEvent::CannotFollow(problem));
        }
        self.stays_behind = followed.is_err();
        self.advance(outputs);
        self.inputs = self.sense(LinkBytes::default(), false);
        self.inputs
    }

    /// A tick begins, and with it the faults that do: what the controller's commands have become by the time
    /// they arrive.
    fn begin_tick(&mut self, outputs: &DeviceOutputs) -> DeviceOutputs {
        let before = self.faults.hydraulics_lost();
        let changes = self.faults.next();
        self.tell(changes);
        match (before, self.faults.hydraulics_lost()) {
            (false, true) => self.fail_hydraulics(),
            (true, false) => self.repair_hydraulics(),
            _ => {}
        }
        self.faults.outputs(outputs)
    }

    /// Say which faults begin and end.
    pub(super) fn tell(&mut self, changes: Vec<Change>) {
        self.events.extend(changes.into_iter().map(|Change { number, text, begins }| {
            if begins {
                CellEvent::FaultBegins { number, text }
            } else {
                CellEvent::FaultEnds { number, text }
            }
        }));
    }

    /// Faults that begin in ticks to come, beside those of the plan that the cell was built with.
    ///
    /// A fault that displaces something is not admitted: the cell stands as it was built.
    pub fn add_faults(&mut self, faults: &FaultPlan, seed: u64) {
        self.faults.add(faults, seed);
    }

    /// Faults of the plan that have happened so far.
    #[must_use]
    pub fn faults(&self) -> Vec<Struck> {
        self.faults.struck()
    }

    /// One tick of all that moves.
    fn advance(&mut self, outputs: &DeviceOutputs) {
        self.pedestal.table.order(&outputs.pedestal_table);
        let near = self.near_arm();
        for _ in 0..self.description.physics.substeps {
            self.substep(outputs, &near);
        }
        self.after_tick();
        self.watch_droop();
        self.look(outputs);
    }

    /// One step of the simulation; `near` is what an arm without pressure may come to lie on.
    fn substep(&mut self, outputs: &DeviceOutputs, near: &[Body]) {
        let dt = self.world.integration_parameters.dt;
        self.t3.advance(dt, &self.loads(near));
        self.change_grippers(dt, &outputs.quick_change);
        self.pedestal.turn(&mut self.world, dt);
        if let Some(hand) = self.changer.mated() {
            self.drive_fingers(dt, hand, self.supply(hand, outputs));
        }
        self.drive_fingers(dt, Hand::Pedestal, Supply::of_bits(outputs.pedestal_hand.bits));
        self.drive_jaw(dt);
        self.rub_holds(dt);
        self.work_drum(dt);
        self.world.step();
        self.let_holds_give_way();
    }

    /// What the valves let flow to a gripper of the robot.
    fn supply(&self, hand: Hand, outputs: &DeviceOutputs) -> Supply {
        let speed = self.description.gripper.jaw_speed;
        match hand {
            Hand::V => Supply::of_jaws(&outputs.v_grip, speed),
            Hand::Tool => Supply::of_jaws(&outputs.tool_grip, speed),
            Hand::Parts | Hand::Pedestal => Supply::of_bits(outputs.grip.bits),
        }
    }

    /// Once a tick: what has been run into, what has fallen.
    fn after_tick(&mut self) {
        self.check_clearance();
        if !self.world.quarantine().is_empty() {
            self.events.push(CellEvent::Quarantined);
        }
        self.note_falls();
        self.note_jaw();
    }

    /// True joint angles, radians: base, shoulder, elbow, pitch, yaw, roll.
    #[must_use]
    pub fn joints(&self) -> Joints {
        *self.t3.arm().joints()
    }

    /// The tool frame as the loaded arm and the fingers have it, inches: the middle between the fingertips;
    /// of a bare robot where they would be.
    #[must_use]
    pub fn tool(&self) -> Frame {
        match self.changer.carried() {
            Some(hand) => to_frame(&self.hand(hand).loaded_tool(&self.world)),
            None => self.t3.arm().tool(),
        }
    }

    /// Finger opening, in, and force of a finger, lb, of the gripper that is mated: the truth behind the
    /// sensors. Zeros of a bare robot.
    #[must_use]
    pub fn fingers(&self) -> (f64, f64) {
        let gripper = self.changer.mated().map(|hand| self.hand(hand));
        gripper.map_or((0.0, 0.0), |gripper| (gripper.air.opening(), gripper.air.force()))
    }

    /// The fingertips of the pedestal's hand, X up, Y across the fingers, in.
    #[must_use]
    pub fn pedestal(&self) -> Frame {
        self.pedestal.frame()
    }

    /// Finger opening, in, and force of a finger, lb, of the pedestal's hand: the truth behind the sensors.
    #[must_use]
    pub fn pedestal_fingers(&self) -> (f64, f64) {
        (self.pedestal.hand.air.opening(), self.pedestal.hand.air.force())
    }

    /// Distance of the vise's clamping faces, in.
    #[must_use]
    pub fn vise_opening(&self) -> f64 {
        self.vise.opening()
    }

    /// All parts.
    #[must_use]
    pub fn parts(&self) -> Vec<PartState> {
        (0..self.parts.len()).map(|index| self.part_state(index)).collect()
    }

    /// The frame of a part, in, by its number.
    #[must_use]
    pub fn part_frame(&self, id: u32) -> Option<Frame> {
        self.parts.iter().find(|part| part.id == id).map(|part| part.frame(&self.world))
    }

    /// What has happened since this was last asked.
    pub fn events(&mut self) -> Vec<CellEvent> {
        std::mem::take(&mut self.events)
    }

    /// Do something at the T3 controller's console, its teach pendant, or an emergency stop.
    ///
    /// # Errors
    /// [`Refusal`]: what must be done first; then nothing has changed.
    pub fn press(&mut self, key: Key) -> Result<(), Refusal> {
        let done = self.t3.press(key);
        self.hear_t3();
        done
    }

    /// The T3 controller.
    #[must_use]
    pub fn t3(&self) -> &T3Controller {
        &self.t3
    }

    /// What the controller shows and the robot does becomes an event, unless it belongs to the day's work.
    fn hear_t3(&mut self) {
        for message in self.t3.messages() {
            match message {
                Message::Warning(warning) => self.events.push(CellEvent::Warning(warning)),
                Message::Lamps(change) => self.events.push(CellEvent::Lamps(change)),
                Message::Robot(event) => self.events.push(CellEvent::Robot(event)),
                _ => {}
            }
        }
        self.watch_pressure();
    }

    /// The controller's DTR line as the T3 controller sees it (A.2); on at the start.
    pub fn set_host_ready(&mut self, ready: bool) {
        self.host_ready = ready;
    }

    /// State of the DEPC function of the T3 controller.
    #[must_use]
    pub fn depc(&self) -> ControllerState {
        self.t3.depc().state()
    }

    /// Lead the arm to an end-plate frame (inches) by the end of the next tick, as the teach pendant does:
    /// past the line.
    ///
    /// # Errors
    /// [`DriveError`] if the arm cannot take the position; then it stays.
    pub fn drive(&mut self, plate: &Frame) -> Result<(), DriveError> {
        self.t3.drive(plate)
    }
}

/// The frame of three points; the description has been validated.
fn place(points: &Points) -> Frame {
    points.frame().unwrap_or_else(Frame::identity)
}

/// An empty world with the steps and stiffness of the description.
pub(crate) fn physics(description: &CellDescription) -> PhysicsWorld {
    let physics = &description.physics;
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, 0.0, -GRAVITY);
    let stiffness = SpringCoefficients::new(physics.contact_frequency, physics.contact_damping);
    let parameters = &mut world.integration_parameters;
    parameters.dt = TICK_S / f64::from(physics.substeps);
    parameters.num_solver_iterations = physics.solver_iterations;
    parameters.contact_softness = stiffness;
    parameters.static_contact_softness = stiffness;
    // The job lives on gaps of a millimetre: rapier's defaults leave 5 mm of penetration, and keep contacts unexamined
    // until something has moved by 50 mm. Faces that are more than 0.5 mm apart need not be solved for.
    parameters.normalized_allowed_linear_error = 1e-5;
    parameters.normalized_prediction_distance = 5e-4;
    parameters.contact_recycling = false;
    parameters.warmstart_joints = true;
    world
}
