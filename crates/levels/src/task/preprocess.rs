//! Preprocess of Task: its state variables, from the statuses of Subtask and of the Data System.

use rcs_core::{
    handshake::{Arrival, Lower},
    name::Name10,
    process::Inputs,
};
use taskdata::files::TaskData;

use super::{
    plan::{Found, Plan, Site, TOOL_GRIPPER},
    state::State,
    tables::{
        Ends, Holding, Ordered, Orders, Request, Seen, Situation, Station, Takeover, Tool, joystick::Control,
    },
};
use crate::{
    execution::{Asked, Work},
    places::named,
};

impl State {
    /// Read the inputs of a tick.
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>) -> Seen {
        let (command, data_base) = (&inputs.external.hws, &inputs.external.data_base);
        self.subtask.start(inputs.memory.subtask.status.echo);
        self.data_system.observe(data_base, inputs.tick);
        let arrival = self.execution.receiver.observe(command.number);
        let (plan, request) = if arrival == Arrival::New {
            self.ordered = Ordered::Nothing;
            let found = Plan::look_up(command, inputs.data);
            (found.plan, request(&found))
        } else {
            (self.plan, Request::default())
        };
        Seen {
            arrival,
            plan,
            request,
            orders: Orders {
                takeover: Takeover::None,
                ordered: self.ordered,
                subtask: self.subtask(inputs),
                data_base: self.data_system.status(data_base, inputs.tick),
            },
            situation: self.situation(&plan, inputs),
        }
    }

    /// Status of Subtask.
    fn subtask(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        let below = &inputs.memory.subtask;
        self.subtask.read(inputs.tick, &below.header, below.status.echo, below.status.report.lower())
    }

    /// Set the state variables for a command.
    fn situation(&self, plan: &Plan, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let below = &inputs.memory.subtask.status;
        let right = below.held.is_some() && plan.object == below.held;
        Situation {
            work: Work::Busy,
            handling: plan.handling(),
            holding: match (below.held, right) {
                (None, _) => Holding::NotHeld,
                (Some(_), true) => Holding::Held,
                (Some(_), false) => Holding::Other,
            },
            grips: plan.grips(),
            source: plan.source.named(),
            ends: ends(&plan.end_at, below.at),
            update: self.data_system.update(plan),
            tool: if below.end_effector_id != TOOL_GRIPPER {
                Tool::None
            } else if below.held.is_none() {
                Tool::Free
            } else if right || plan.object.is_none() {
                Tool::Held
            } else {
                Tool::None
            },
            station: station(&plan.source, below.at),
        }
    }
}

/// What a new command needs.
fn request(found: &Found) -> Request {
    let plan = &found.plan;
    Request {
        asked: Asked::Now,
        verb: plan.verb,
        missing: found.missing,
        gripper: found.gripper,
        handling: plan.handling(),
        source: plan.source.named(),
        source_grip: plan.grip(&plan.source),
        destination: plan.destination.named(),
        destination_grip: plan.grip(&plan.destination),
        tool: plan.tool(),
        grips: plan.grips(),
        pedestal: found.pedestal,
        control: Control::Automatic,
    }
}

/// Where the robot is to be at the end. A sector is not known by its location's name alone.
fn ends(end_at: &Site, at: Option<Name10>) -> Ends {
    match &end_at.location {
        None => Ends::Here,
        Some(location) if Some(location.name) == at && location.array.is_none() => Ends::There,
        Some(_) => Ends::Elsewhere,
    }
}

/// Where the robot is, for the tool commands.
fn station(source: &Site, at: Option<Name10>) -> Station {
    let Some(at) = at else { return Station::Elsewhere };
    if at.as_str() == named::TOOL_TRNS {
        Station::Transfer
    } else if at.as_str() == named::TOOL_SAFE || source.location.is_some_and(|location| location.name == at) {
        Station::Safe
    } else {
        Station::Elsewhere
    }
}
