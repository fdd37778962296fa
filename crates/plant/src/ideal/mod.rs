//! The ideal cell: the devices of the cell without physics, noise, delay and fault.
//!
//! It has the devices of [`crate::Cell`] and the geometry of [`Room`] instead of bodies, and shows the actions of the
//! control processes if everything goes as planned:
//!
//! | device | differs from the cell |
//! |---|---|
//! | arm | stiff: the joints alone determine the tool frame |
//! | fingers | stop at the part between them; a part in them does not slide |
//! | released part | goes at once to its nest or onto the body below it; without one, it stays where it is |
//! | camera | nothing hides a part |
//! | force sensor | measures only the drum and its strike plate |
//! | vise and machines | work at once |
//! | robot | does not push parts: a part in the vise goes to its seat when the jaws close |

mod drumming;
mod grasping;
mod sensing;
mod workstation;

use std::sync::Arc;

use depc::{Limits, controller::Warning};
use geometry::frame::Frame;
use interfaces::device::{DeviceInputs, DeviceOutputs};
use rcs_core::tick::TICK_S;

use self::{
    drumming::Press,
    grasping::{Fingers, Hold},
};
use crate::{
    camera::{Analysis, Optics},
    cell::CellError,
    changer::Changer,
    description::{Actuators, CellDescription},
    drum::Drum,
    hand::{HANDS, Hand, ROBOT_HANDS},
    joystick::Joystick,
    noise::{Noise, Stream},
    pedestal::{Table, hand_frame},
    resolver_box::ResolverBox,
    room::{Layout, Placed, Room},
    t3::{Message, StepInputs, T3Controller},
    vise::Jaws,
};

/// The ideal cell. A copy shares the fixed bodies, and continues from the same state.
#[derive(Clone, Debug)]
pub struct Ideal {
    room: Arc<Room>,
    t3: T3Controller,
    changer: Changer,
    fingers: [Fingers; 4], // in the order of [`HANDS`]
    table: Table,
    drum: Drum,
    presses: Vec<Press>,
    optics: Optics,
    analysis: Analysis,
    joystick: Joystick,
    resolver_box: ResolverBox,
    parts: Vec<Placed>,
    program: usize,         // index of the selected program of the vise
    jaws: f64,              // distance of the inner faces of the vise's jaws, in
    clamped: Option<usize>, // index of the part in the closed jaws
    placement_noise: Noise,
    noise: Noise, // for sensors, whose noise is zero
    inputs: DeviceInputs,
}

impl Ideal {
    /// The ideal cell of a room. The seed determines the random places of parts, as in [`crate::Cell::new`]. Fails with
    /// [`CellError`] if the arm cannot take its start position.
    pub fn new(room: &Room, seed: u64) -> Result<Self, CellError> {
        let cell = room.cell().without_noise();
        let actuators = Actuators::from(&cell.robot);
        let t3 = T3Controller::started(Limits::NBS, &actuators, &cell.robot.start_joints(), seed)?;
        let room = Room::new(&cell);
        let mut ideal = Self {
            t3,
            changer: Changer::new(&cell),
            fingers: HANDS.map(|hand| Fingers::new(hand.description(&cell))),
            table: Table::new(&cell.pedestal.table),
            drum: Drum::new(cell.drum.pose.frame().unwrap_or_else(Frame::identity), &cell.drum),
            presses: Vec::new(),
            optics: Optics::new(&cell.camera),
            analysis: Analysis::new(&cell.camera, seed),
            joystick: Joystick::default(),
            resolver_box: ResolverBox::default(),
            parts: Vec::new(),
            program: 0,
            jaws: room.jaws(0, Jaws::Open),
            clamped: None,
            placement_noise: Noise::new(seed, Stream::Placement),
            noise: Noise::new(seed, Stream::Gripper),
            inputs: DeviceInputs::default(),
            room: Arc::new(room),
        };
        ideal.inputs = ideal.sense(Default::default(), false);
        Ok(ideal)
    }

    #[must_use]
    pub fn description(&self) -> &CellDescription {
        self.room.cell()
    }

    #[must_use]
    pub const fn inputs(&self) -> DeviceInputs {
        self.inputs
    }

    #[must_use]
    pub const fn t3(&self) -> &T3Controller {
        &self.t3
    }

    /// The warnings with which the robot controller has stopped since the last call.
    pub fn warnings(&mut self) -> Vec<Warning> {
        let warning = |message| if let Message::Warning(warning) = message { Some(warning) } else { None };
        self.t3.messages().into_iter().filter_map(warning).collect()
    }

    /// Advance by one tick of 40 ms with the controller's outputs of the last one.
    pub fn step(&mut self, outputs: &DeviceOutputs) -> DeviceInputs {
        let sent = self.t3.step(&StepInputs { rx: outputs.link_tx, cts: true });
        self.t3.advance(TICK_S, &[]);
        self.table.order(&outputs.pedestal_table);
        self.table.advance(TICK_S);
        let tool = self.tool();
        if let Some(hand) = self.changer.advance(TICK_S, &tool, &outputs.quick_change).parted {
            self.release(hand);
            self.fingers_mut(hand).air.cut();
        }
        self.carry();
        for hand in self.changer.mated().into_iter().chain([Hand::Pedestal]) {
            self.drive(hand, hand.supply(self.room.cell(), outputs));
        }
        self.work_drum();
        self.look(&outputs.vision);
        self.inputs = self.sense(sent.tx, sent.dtr);
        self.inputs
    }

    fn tool(&self) -> Frame {
        self.t3.arm().tool()
    }

    /// The frame of the fingertips of a hand, world, in; `None` for one that is neither on a holster nor on the robot.
    fn frame(&self, hand: Hand) -> Option<Frame> {
        match hand {
            Hand::Pedestal => Some(hand_frame(&self.room.cell().pedestal, self.table.angle())),
            _ => self.changer.frame(hand, &self.tool()),
        }
    }

    fn held(&self) -> Option<Hold> {
        ROBOT_HANDS.into_iter().find_map(|hand| self.fingers(hand).hold)
    }

    #[must_use]
    pub fn layout(&self) -> Layout {
        let worn = self.changer.carried();
        let engaged = self.changer.mated().filter(|mated| Some(*mated) != worn);
        let held = self.held();
        let is_held = |index: usize| held.is_some_and(|hold| hold.part == index);
        let others = self.parts.iter().enumerate().filter(|(index, _)| !is_held(*index));
        Layout {
            gripper: worn.and_then(Hand::end_effector_id),
            engaged: engaged.and_then(Hand::end_effector_id),
            opening: worn.map_or(0.0, |hand| self.fingers(hand).air.opening()),
            held: held.and_then(|hold| Some(Placed { frame: hold.at, ..self.parts.get(hold.part)?.clone() })),
            parts: others.map(|(_, part)| part.clone()).collect(),
            program: self.program,
            jaws: self.jaws,
            table: self.table.angle(),
            hand: self.fingers(Hand::Pedestal).air.opening(),
        }
    }
}
