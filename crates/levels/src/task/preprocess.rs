use interfaces::{
    emove::{Holding, Offset, Standing},
    hws::{Checked, Confirmed},
    process::Inputs,
    subtask::{SubtaskStatus, SubtaskVerb},
};
use rcs_core::{handshake::Lower, name::Name10};
use taskdata::files::TaskData;

use super::{
    goals::proof,
    ledger::{TaskPart, is_from_elsewhere, is_taken, placed, resumed},
    plan::{Found, Plan, PlanSite, Resumed, TOOL_GRIPPER, TaskVerb},
    state::State,
    support::TaskSupport,
    tables::{
        Ends, Preconditions, Request, Situation, StateVariables, Station, Subordinates, Takeover, TaskDrum,
        TaskRecipient, TaskRoute, TaskTool,
        item::{
            Area, Carrying, Continuation, InLedger, Move, Notice, Place, Release, Taker, released, update_due,
        },
        joystick::Control,
    },
};
use crate::{
    execution::{Asked, Work},
    halt::{Above, Below, BoxState, Intake, Kind, Replaced},
    held::Held,
    places::{is_in_mbd, named},
};

impl State {
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>) -> StateVariables {
        let command = &inputs.external.hws;
        self.adopt(inputs);
        let data_base = &self.data_system.read(inputs.external);
        self.data_system.observe(data_base, inputs.tick);
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        let (below, ledger) = (&inputs.memory.subtask.status, inputs.memory.task.ledger.as_ref());
        self.data_system.observe_grasp(below.held, ledger);
        self.note_support(inputs);
        let (plan, request, preconditions) = if asked == Asked::Now {
            self.ordered = TaskRecipient::Nothing;
            let found = Plan::look_up(command, inputs.data);
            let plan = Plan { resumed: resumed(command, ledger), ..found.plan };
            let replaces = plan.is_about_something() && plan.resumed == Resumed::Not;
            self.follow_object(plan.verb, replaces, inputs);
            (self.plan(&plan, inputs), request(&found), preconditions(&found, command.checked))
        } else {
            self.follow_object(self.plan.verb, false, inputs);
            (self.plan, Request::default(), Preconditions::default())
        };
        let subtask = self.subtask(inputs);
        let data_base = self.data_system.status(data_base, inputs.tick);
        let pausing = inputs.memory.task.subtask.command == SubtaskVerb::Pause;
        StateVariables {
            arrival,
            asked,
            replaced: Replaced {
                intake: Intake::Taken,
                kind: if plan.verb == TaskVerb::Pause { Kind::Pause } else { Kind::Other },
                above: Above::Live,
                joystick: BoxState::Off,
                below: Below::of(subtask, pausing),
            },
            verb: plan.verb,
            plan,
            request,
            preconditions,
            subordinates: Subordinates {
                takeover: Takeover::None,
                ordered: self.ordered,
                subtask,
                data_base,
            },
            proof: proof(&plan, below, data_base),
            situation: self.situation(&plan, inputs),
        }
    }

    /// Before the first command after a start, adopt the output buffers from before it.
    fn adopt(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let (memory, written) = (inputs.memory, &inputs.memory.task);
        self.subtask.start_from(inputs.tick, written.subtask.number, memory.subtask.status.echo);
        if !self.execution.receiver.started {
            self.last_pose = written.poses.iter().filter_map(|pose| pose.number).max().unwrap_or_default();
            self.data_system.adopt(written, inputs.tick);
            self.confirmed = written.confirmed;
        }
    }

    /// A person's confirmation is dropped when the robot leaves its place or holds nothing.
    fn note_support(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let below = &inputs.memory.subtask.status;
        let told = inputs.external.operator.confirmed.map(|by| Confirmed { by, at: below.at });
        self.confirmed = told
            .or(self.confirmed)
            .filter(|confirmed| confirmed.at == below.at && below.held != Holding::Nothing);
    }

    fn plan(&self, plan: &Plan, inputs: &Inputs<'_, TaskData<'_>>) -> Plan {
        let (below, ledger) = (&inputs.memory.subtask.status, inputs.memory.task.ledger.as_ref());
        let held = Held::of(below.held, plan.object);
        let carried = self.data_system.updates.carried.as_ref();
        let from_elsewhere = plan.verb == TaskVerb::Acquire
            && held == Held::Right
            && is_from_elsewhere(&inputs.external.hws, plan, ledger, carried);
        let plan = Plan { from_elsewhere, ..*plan };
        let due = update_due(
            (),
            &Move {
                verb: plan.verb,
                origin: plan.origin(),
                ledger: match ledger {
                    Some(ledger) if plan.resumed != Resumed::Not && ledger.reported => InLedger::Reported,
                    Some(_) if plan.resumed != Resumed::Not => InLedger::Unreported,
                    Some(_) | None => InLedger::Other,
                },
                held,
                placed: placed(&plan, below, ledger),
                area: if plan.update_due { Area::Mbd } else { Area::Outside },
                carrying: plan.object.map_or(Carrying::Other, |object| self.data_system.carrying(object)),
            },
        );
        Plan { update_due: due.action == Notice::Send, ..plan }
    }

    /// Consult RELEASED about an object that Subtask reports as released.
    fn follow_object(&mut self, verb: TaskVerb, replaces: bool, inputs: &Inputs<'_, TaskData<'_>>) {
        let memory = inputs.memory;
        let Some(placed) = memory.subtask.status.placed else { return };
        let in_mbd = is_in_mbd(placed.site.record, inputs.data);
        let is_taken = is_taken(memory.task.ledger.as_ref(), &placed.object);
        let place = Place {
            carrying: self.data_system.carrying(placed.object),
            area: if in_mbd { Area::Mbd } else { Area::Outside },
            connection: self.data_system.connection(None),
            taker: if is_taken { Taker::Ledger } else { Taker::Other },
            command: match verb {
                TaskVerb::Position => Continuation::Position,
                _ if replaces => Continuation::Another,
                _ => Continuation::Same,
            },
        };
        match released((), &place).action {
            Release::Keep => {}
            Release::Append => self.data_system.append_released(&placed),
        }
    }

    fn subtask(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        self.subtask.status_of(inputs.tick, &inputs.memory.subtask)
    }

    fn situation(&self, plan: &Plan, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let below = &inputs.memory.subtask.status;
        Situation {
            work: Work::Busy,
            handling: plan.handling(),
            held: Held::of(below.held, plan.object),
            grips: plan.grips(),
            ends: ends(&plan.end_at, below),
            update: self.data_system.update(plan),
            tool: match below.held {
                _ if below.end_effector_id != Some(TOOL_GRIPPER) => TaskTool::None,
                Holding::Nothing => TaskTool::Free,
                Holding::Object(held) if plan.object.is_none_or(|object| object == held.object) => {
                    TaskTool::Held
                }
                Holding::Object(_) => TaskTool::None,
                Holding::Something | Holding::NotKnown => TaskTool::Unsure,
            },
            station: station(below.at.map(|at| at.site.location)),
            drum: if below.drum { TaskDrum::Inside } else { TaskDrum::Outside },
            way: way(below.at, plan, inputs.data),
            support: TaskSupport::sense(below, plan, self.confirmed.as_ref(), inputs.external, inputs.data),
            resumed: plan.resumed,
            placed: placed(plan, below, inputs.memory.task.ledger.as_ref()),
            part: if below.pedestal_part { TaskPart::InPedestal } else { TaskPart::Elsewhere },
        }
    }
}

const fn request(found: &Found) -> Request {
    let Found { plan, missing, gripper, .. } = found;
    Request { asked: Asked::Now, verb: plan.verb, missing: *missing, gripper: *gripper }
}

fn preconditions(found: &Found, checked: Checked) -> Preconditions {
    let plan = &found.plan;
    Preconditions {
        asked: Asked::Now,
        verb: plan.verb,
        handling: plan.handling(),
        source: plan.site(&plan.source),
        goal: plan.goal(),
        destination: plan.destination.destination(),
        tool: plan.tool(),
        regrip: found.regrip,
        way_out: found.way_out,
        checked,
        control: Control::Automatic,
    }
}

/// The name of a location does not identify a sector. A robot that was moved off its place must return to it.
fn ends(end_at: &PlanSite, below: &SubtaskStatus) -> Ends {
    let is_there = matches!(below.offset, Offset::None | Offset::NotSensed);
    let at = below.at.filter(|_| is_there).map(|at| at.site.location);
    match end_at.site() {
        None => Ends::Here,
        Some(site) if Some(site.location) == at && site.array.is_null() => Ends::There,
        Some(_) => Ends::Elsewhere,
    }
}
fn station(at: Option<Name10>) -> Station {
    match at.as_ref().map(Name10::as_str) {
        None => Station::Unplaced,
        Some(named::TOOL_TRNS) => Station::Transfer,
        Some(named::TOOL_SAFE) => Station::Safe,
        Some(_) => Station::Elsewhere,
    }
}

/// Compares only the names of locations.
fn way(at: Option<Standing>, plan: &Plan, data: &TaskData<'_>) -> TaskRoute {
    let Some(at) = at else { return TaskRoute::NoStart };
    let Some(to) = plan.position_site().site() else { return TaskRoute::Here };
    let from = at.site;
    if from.has_location_of(&to) {
        // Between the sectors of a tray no trajectory is needed.
        if (from.array, from.sector) == (to.array, to.sector) { TaskRoute::Here } else { TaskRoute::Leads }
    } else if data.trajectory(&from.place(), &to.place()).is_some() {
        TaskRoute::Leads
    } else {
        TaskRoute::NoTrajectory
    }
}
