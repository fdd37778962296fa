//! The data of a command, looked up before anything moves: a command that cannot be executed moves nothing.

use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb},
    quick_change::RingPosition,
};
use taskdata::files::TaskData;

use super::{
    EmoveInputs, State,
    grasp::{gripper_on, sizes},
    gripper::EmoveGripper,
    motion::{
        flight::{Flight, Progress},
        relative::{self, Relative},
        route::{EmoveGoal, Planning},
    },
    tables::{
        Attached, CommandClass, Coupling, EmoveRecipient, EmoveRecord, EmoveTarget, ExchangeWork,
        HolsterData, Knowledge, Pause, Records, Request, ToolWork,
    },
    vision::view_of,
};
use crate::{execution::Asked, halt::BoxState};

const fn class(verb: EmoveVerb) -> CommandClass {
    match verb {
        EmoveVerb::None => CommandClass::None,
        EmoveVerb::Pause => CommandClass::Pause,
        EmoveVerb::MovToLoc | EmoveVerb::Withdraw => CommandClass::Plain,
        EmoveVerb::MovToObj | EmoveVerb::MovObjTo | EmoveVerb::MovToVu => CommandClass::ObjectMove,
        EmoveVerb::MovToHol => CommandClass::HolsterMove,
        EmoveVerb::QcAttach | EmoveVerb::QcDetach => CommandClass::Exchange,
        EmoveVerb::LocateObj | EmoveVerb::GraspObj => CommandClass::AtObject,
        EmoveVerb::InsertTool | EmoveVerb::ReleaseTool | EmoveVerb::AcquireTool | EmoveVerb::RemoveTool => {
            CommandClass::Tool
        }
        EmoveVerb::Release => CommandClass::Release,
    }
}

fn attached(command: &EmoveCommand, memory: &CommonMemory) -> Attached {
    match EmoveGripper::attached(memory) {
        EmoveGripper::None => Attached::None,
        _ if command.end_effector_id.is_none() => Attached::Right,
        attached if command.end_effector_id == attached.id() => Attached::Right,
        EmoveGripper::Parts | EmoveGripper::V | EmoveGripper::Tool => Attached::Wrong,
    }
}

fn holster(command: &EmoveCommand, data: &TaskData<'_>) -> HolsterData {
    if class(command.command) != CommandClass::Exchange {
        HolsterData::Found
    } else if EmoveGripper::of(command.end_effector_id) == EmoveGripper::None {
        HolsterData::NoGripper
    } else if gripper_on(command, data).is_none() {
        HolsterData::NoOpening
    } else {
        HolsterData::Found
    }
}

const fn coupling(memory: &CommonMemory) -> Coupling {
    let status = &memory.quick_change.status;
    match (status.end_effector_id, status.ring) {
        (None, _) => Coupling::Bare,
        (_, RingPosition::Locked) => Coupling::Locked,
        _ => Coupling::Loose,
    }
}

/// The location of a command; `Holster` if MOV-TO-LOC names one.
fn target(command: &EmoveCommand, data: &TaskData<'_>) -> EmoveTarget {
    match Relative::QcaBack.record(&command.site, data) {
        Some(_) if command.command == EmoveVerb::MovToLoc => EmoveTarget::Holster,
        _ => EmoveTarget::Plain,
    }
}

const fn record(is_needed: bool, is_found: bool) -> EmoveRecord {
    if is_needed && !is_found { EmoveRecord::Missing } else { EmoveRecord::Found }
}

impl State {
    pub(super) fn look_up(
        &mut self,
        command: &EmoveCommand,
        (joystick, pause): (BoxState, Pause),
        inputs: &EmoveInputs<'_>,
    ) -> (Request, Records) {
        let (memory, data) = (inputs.memory, inputs.data);
        let verb = command.command;
        let planned = self.plan(command, inputs);
        (self.ordered, self.uses_prim, self.ordered_at) =
            (EmoveRecipient::Nothing, false, Progress::default());
        self.motion.begin(planned.unwrap_or_default());
        self.vision.begin();
        self.held.begin();
        let request = Request {
            asked: Asked::Now,
            class: class(verb),
            gripper: attached(command, memory),
            start: match (self.localization.place(), self.drum.half_way()) {
                (None, None) => Knowledge::Unknown,
                _ => Knowledge::Known,
            },
            coupling: if self.exchange.is_misread(memory) { Coupling::Misread } else { coupling(memory) },
            exchange: if self.exchange.is_half_done() { ExchangeWork::HalfDone } else { ExchangeWork::None },
            drum: if self.drum.half_way().is_some() { ToolWork::HalfDone } else { ToolWork::None },
            target: target(command, inputs.data),
        };
        let grasps = matches!(verb, EmoveVerb::GraspObj | EmoveVerb::AcquireTool);
        let records = Records {
            sizes: record(grasps, sizes(command, data).is_some()),
            view: record(verb == EmoveVerb::LocateObj, view_of(command, data).is_some()),
            holster: holster(command, data),
            moves: relative::look_up(command, memory, data),
            route: planned.err().unwrap_or(Planning::Planned),
            joystick,
            pause,
        };
        (request, records)
    }

    fn plan(&self, command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> Result<Flight, Planning> {
        let holding = self.holding(inputs.memory);
        match command.command {
            EmoveVerb::MovToLoc
            | EmoveVerb::MovToObj
            | EmoveVerb::MovObjTo
            | EmoveVerb::MovToVu
            | EmoveVerb::MovToHol => {
                let base = self.vision.base_frame(command, inputs)?;
                let goal = EmoveGoal::new(command, &base, inputs.data)?;
                let begin = self.localization.origination(holding, inputs)?;
                let mut flight = Flight::plan(&goal, &goal.place(command), &begin, inputs.data)?;
                if let (Some(route), EmoveGripper::None) =
                    (&mut flight.route, EmoveGripper::attached(inputs.memory))
                {
                    route.opening = None;
                }
                Ok(flight)
            }
            EmoveVerb::LocateObj | EmoveVerb::GraspObj | EmoveVerb::Release => {
                self.localization.stand_still(holding, inputs)
            }
            _ => Ok(Flight::default()),
        }
    }
}
