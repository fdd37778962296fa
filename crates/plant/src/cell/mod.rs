//! The whole cell; one call advances it by one tick.

mod changing;
mod clearing;
pub mod devices;
mod drumming;
mod event;
mod following;
mod handling;
mod links;
pub(crate) mod machining;
pub(crate) mod order;
mod placing;
mod sagging;
mod saving;
mod sensing;
mod stride;
mod truth;
mod workstation;

use depc::{
    Limits,
    controller::ControllerState,
    fault::{Direction, Injector as LineInjector},
};
use geometry::{frame::Frame, kinematics::Joints};
use interfaces::{
    device::{DeviceInputs, DeviceOutputs, LinkBytes},
    station::Key,
};
use rapier3d_f64::prelude::*;
use rcs_core::tick::{TICK_S, Tick};
use serde::{Deserialize, Serialize};

pub use event::{CellError, CellEvent};
pub use following::Half;
pub use links::{LinkPose, part_link};
pub use sagging::SagReport;
pub use saving::{RestoreError, SaveError};
pub use truth::{Holders, RingState};
pub use workstation::{Placement, WorkstationAction, WorkstationError};

use crate::{
    bodies,
    camera::{Analysis, Optics},
    changer::Changer,
    clearance::{Body, Clearance},
    convert::{GRAVITY, to_frame, to_pose},
    description::{Actuators, CellDescription, Points},
    drum::Drum,
    fault::{Change, FaultPlan, FaultResult, Injector},
    gripper::Gripper,
    joystick::Joystick,
    noise::{Noise, Stream},
    part::{Part, PartState},
    pedestal::{Pedestal, TablePanel},
    resolver_box::ResolverBox,
    scene::{Block, FINGER, furniture},
    sensor::DeadTimes,
    t3::{DriveError, Message, Refusal, StepInputs, StepOutputs, T3Controller},
    vise::Vise,
    world::World,
};

/// The simulated cell: everything outside the controller. A copy continues bit for bit like the original.
#[derive(Clone, Deserialize, Serialize)]
pub struct Cell {
    description: CellDescription,
    world: World,
    t3: T3Controller,
    host_ready: bool,
    grippers: [Gripper; 3], // the parts gripper, the v-gripper, the tool gripper
    changer: Changer,
    drum: Drum,
    pedestal: Pedestal,
    vise: Vise,
    optics: Optics,
    analysis: Analysis,
    vision_elsewhere: bool,
    joystick: Joystick,
    parts: Vec<Part>,
    next_part: u32,
    /// Fixed blocks. Like the obstacles, they are made from the description when a cell is restored.
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
    resolver_box: ResolverBox,
    jaw_waits: u32, // number of ticks in which the jaw of the vise should have moved and did not
    events: Vec<CellEvent>,
    stays_behind: bool, // true once it was reported that the arm cannot follow the robot
    droop: Option<SagReport>,
    #[serde(with = "crate::image::record")]
    inputs: DeviceInputs,
}

impl Cell {
    /// The seed determines sensor noise and random places of parts. Fails if the description cannot be used.
    pub fn new(description: &CellDescription, seed: u64) -> Result<Self, CellError> {
        Self::with_faults(description, seed, &FaultPlan::default())
    }

    /// Like [`Cell::new`], with the faults of a plan. Fails if the description cannot be used.
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
            world: world.into(),
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
            resolver_box: ResolverBox::default(),
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

    /// The description of the cell, with the displacements of the fault plan.
    #[must_use]
    pub const fn description(&self) -> &CellDescription {
        &self.description
    }

    /// The sensor words after the last tick. Before the first tick, the sensor words of the initial cell.
    #[must_use]
    pub fn inputs(&self) -> DeviceInputs {
        self.inputs
    }

    /// Advance the cell by exactly one tick of 40 ms with the controller's outputs of the last one.
    pub fn step(&mut self, outputs: &DeviceOutputs) -> DeviceInputs {
        let outputs = &self.begin_tick(outputs);
        let StepOutputs { tx, dtr, .. } =
            self.t3.step(&StepInputs { rx: outputs.link_tx, cts: self.host_ready });
        self.read_controller();
        self.advance(outputs);
        self.inputs = self.sense(tx, dtr);
        self.inputs
    }

    /// Like [`Cell::step`], with injected faults on the line to the robot controller in `tick`.
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

    /// Begin a tick and its faults. Returns the controller's commands with the faults applied.
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

    pub(super) fn tell(&mut self, changes: Vec<Change>) {
        self.events.extend(changes.into_iter().map(|Change { number, text, begins }| {
            if begins {
                CellEvent::FaultBegins { number, text }
            } else {
                CellEvent::FaultEnds { number, text }
            }
        }));
    }

    /// Adds faults that begin in later ticks; those that displace something are ignored, as the cell is already built.
    pub fn add_faults(&mut self, faults: &FaultPlan, seed: u64) {
        self.faults.add(faults, seed);
    }

    /// Discard the faults that are over: they have no more effect, and [`Cell::faults`] no longer lists them.
    /// Call it only if none is added later, because their random numbers depend on how many there are.
    pub fn forget_past_faults(&mut self) {
        self.faults.forget_past();
    }

    #[must_use]
    pub fn faults(&self) -> Vec<FaultResult> {
        self.faults.struck()
    }

    #[must_use]
    pub fn is_device_cut(&self, device: &str) -> bool {
        self.faults.is_device_cut(device)
    }

    fn advance(&mut self, outputs: &DeviceOutputs) {
        self.advance_bodies(outputs, self.description.physics.substeps);
        self.end_tick(outputs);
    }

    fn advance_bodies(&mut self, outputs: &DeviceOutputs, substeps: u32) {
        self.pedestal.table.order(&outputs.pedestal_table);
        self.step_bodies(outputs, substeps);
    }

    fn end_tick(&mut self, outputs: &DeviceOutputs) {
        self.after_tick();
        self.watch_droop();
        self.look(outputs);
    }

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

    /// The tool frame, in, including the deflection of arm and fingers. Its origin is between the fingertips, even
    /// without a gripper.
    #[must_use]
    pub fn tool(&self) -> Frame {
        match self.changer.carried() {
            Some(hand) => to_frame(&self.hand(hand).loaded_tool(&self.world)),
            None => self.t3.arm().tool(),
        }
    }

    /// Opening, in, and force, lb, of a finger of the mated gripper: true values; zeros without a gripper.
    #[must_use]
    pub fn fingers(&self) -> (f64, f64) {
        let gripper = self.changer.mated().map(|hand| self.hand(hand));
        gripper.map_or((0.0, 0.0), |gripper| (gripper.air.opening(), gripper.air.force()))
    }

    /// Frame of the fingertips of the pedestal's hand: X up, Y across the fingers; in.
    #[must_use]
    pub fn pedestal(&self) -> Frame {
        self.pedestal.frame()
    }

    /// Finger opening, in, and force of a finger, lb, of the pedestal's hand: true values, not sensor readings.
    #[must_use]
    pub fn pedestal_fingers(&self) -> (f64, f64) {
        (self.pedestal.hand.air.opening(), self.pedestal.hand.air.force())
    }

    /// Distance of the vise's clamping faces, in.
    #[must_use]
    pub fn vise_opening(&self) -> f64 {
        self.vise.opening()
    }

    #[must_use]
    pub fn parts(&self) -> Vec<PartState> {
        (0..self.parts.len()).map(|index| self.part_state(index)).collect()
    }

    #[must_use]
    pub fn part_frame(&self, id: u32) -> Option<Frame> {
        self.parts.iter().find(|part| part.id == id).map(|part| part.frame(&self.world))
    }

    pub fn events(&mut self) -> Vec<CellEvent> {
        std::mem::take(&mut self.events)
    }

    /// Presses a key or an emergency stop. Errors: [`Refusal`] with the missing step; the state is unchanged.
    pub fn press(&mut self, key: Key) -> Result<(), Refusal> {
        let done = self.t3.press(key);
        self.read_controller();
        done
    }

    #[must_use]
    pub const fn table_panel(&self) -> TablePanel {
        self.pedestal.table.panel()
    }

    #[must_use]
    pub fn t3(&self) -> &T3Controller {
        &self.t3
    }

    /// Turn messages of the controller and motions of the robot into events, except those of normal operation.
    fn read_controller(&mut self) {
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

    #[must_use]
    pub fn depc(&self) -> ControllerState {
        self.t3.depc().state()
    }

    /// Move the arm to an end-plate frame (inches) by the end of the next tick, as with the teach pendant: not through
    /// the line. Fails if the arm cannot reach the position; it does not move.
    pub fn drive(&mut self, plate: &Frame) -> Result<(), DriveError> {
        self.t3.drive(plate)
    }
}

/// The frame of three points; the description has been validated.
fn place(points: &Points) -> Frame {
    points.frame().unwrap_or_else(Frame::identity)
}

/// An empty world with the time steps and contact stiffness of the description.
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
    // The job has gaps of about a millimetre. Rapier's defaults allow 5 mm of penetration, and do not check
    // contacts until a body has moved by 50 mm. Faces that are more than 0.5 mm apart need not be solved for.
    parameters.normalized_allowed_linear_error = 1e-5;
    parameters.normalized_prediction_distance = 5e-4;
    parameters.contact_recycling = false;
    parameters.warmstart_joints = true;
    world
}
