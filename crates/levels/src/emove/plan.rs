//! The data of a command, looked up when it comes: a command that cannot be executed moves nothing.

use geometry::frame::Frame;
use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb},
    pose_range,
    process::Inputs,
    quick_change::RingPosition,
};
use rcs_core::name::Name10;
use taskdata::files::{PoseId, TaskData};

use super::{
    fingers::{gripper_on, sizes},
    gripper::Gripper,
    locate::view_of,
    relative::{self, Relative},
    robot_place::place_named,
    route::{Goal, Planning},
    state::State,
    tables::{
        Attached, Coupling, Exchange, HolsterData, Knowledge, Ordered, Record, Request, Target, ToolWork,
    },
    way::Flight,
};
use crate::{execution::Asked, halt::BoxState};

/// The gripper on the robot, seen from the command.
fn attached(command: &EmoveCommand, memory: &CommonMemory) -> Attached {
    match Gripper::attached(memory) {
        Gripper::None => Attached::None,
        _ if command.end_effector_id.is_none() => Attached::Right,
        attached if command.end_effector_id == attached.id() => Attached::Right,
        Gripper::Parts | Gripper::V | Gripper::Tool => Attached::Wrong,
    }
}

/// A gripper with a holster, and the opening with which it goes through it.
fn holster(command: &EmoveCommand, data: &TaskData<'_>) -> HolsterData {
    if Gripper::of(command.end_effector_id) == Gripper::None {
        HolsterData::NoGripper
    } else if gripper_on(command, data).is_none() {
        HolsterData::NoOpening
    } else {
        HolsterData::Found
    }
}

/// How the gripper hangs on the robot.
const fn coupling(memory: &CommonMemory) -> Coupling {
    let status = &memory.quick_change.status;
    match (status.end_effector_id, status.ring) {
        (None, _) => Coupling::Bare,
        (_, RingPosition::Locked) => Coupling::Locked,
        _ => Coupling::Loose,
    }
}

/// The location of a motion command that is no gripper change.
fn target(command: &EmoveCommand, data: &TaskData<'_>) -> Target {
    let relative = Name10::clipped(Relative::QcaBack.text());
    match data.relative_move(&relative, &place_named(command)) {
        Some(_) if command.command == EmoveVerb::MovToLoc => Target::Holster,
        _ => Target::Plain,
    }
}

const fn record(found: bool) -> Record {
    if found { Record::Found } else { Record::Missing }
}

impl State {
    /// A new command: look up all that it needs. What is found is kept.
    pub(super) fn look_up(
        &mut self,
        command: &EmoveCommand,
        joystick: BoxState,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Request {
        let (memory, data) = (inputs.memory, inputs.data);
        let planned = self.plan(command, inputs);
        Flight { route: self.route, back: self.back, rejoin: self.rejoin } = planned.unwrap_or_default();
        (self.ordered, self.uses_prim) = (Ordered::Nothing, false);
        (self.tries, self.undetected) = (0, 0);
        self.carrying = self.beliefs.held.is_some();
        Request {
            asked: Asked::Now,
            verb: command.command,
            gripper: attached(command, memory),
            start: match (self.place(), self.beliefs.drum) {
                (None, None) => Knowledge::Unknown,
                _ => Knowledge::Known,
            },
            coupling: if self.is_misread(memory) { Coupling::Misread } else { coupling(memory) },
            exchange: if self.beliefs.exchange.is_some() { Exchange::HalfDone } else { Exchange::None },
            drum: if self.beliefs.drum.is_some() { ToolWork::HalfDone } else { ToolWork::None },
            target: target(command, inputs.data),
            sizes: record(sizes(command, data).is_some()),
            view: record(view_of(command, data).is_some()),
            holster: holster(command, data),
            moves: relative::look_up(command, memory, data),
            route: planned.err().unwrap_or(Planning::Planned),
            joystick,
        }
    }

    /// The way of a motion command.
    fn plan(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<Flight, Planning> {
        match command.command {
            EmoveVerb::MovToLoc
            | EmoveVerb::MovToObj
            | EmoveVerb::MovObjTo
            | EmoveVerb::MovToVu
            | EmoveVerb::MovToHol => {
                let base = self.base_frame(command, inputs)?;
                let goal = Goal::new(command, &base, inputs.data)?;
                let mut flight = self.flight(command, &goal, inputs)?;
                if let (Some(route), Gripper::None) = (&mut flight.route, Gripper::attached(inputs.memory)) {
                    route.opening = None;
                }
                Ok(flight)
            }
            EmoveVerb::LocateObj | EmoveVerb::GraspObj | EmoveVerb::Release => self.stand_still(inputs),
            _ => Ok(Flight::default()),
        }
    }

    /// The pose of a command, or where vision has found the object.
    pub(super) fn base_frame(
        &self,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Result<Frame, Planning> {
        let located = self.beliefs.located.filter(|located| {
            command.command == EmoveVerb::MovToObj
                && Some(located.object) == command.object
                && located.record == command.location_record
                && located.array == command.location_array
                && located.sector == command.location_sector
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
}
