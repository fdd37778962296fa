//! Preprocess of Task: its state variables, from the status of Subtask and of the Data System.

use rcs_core::{handshake::Lower, name::Name10, process::Inputs};
use taskdata::files::TaskData;

use super::{
    Task,
    plan::{Site, TOOL_GRIPPER},
    tables::{Ends, Grips, Handling, Holding, Situation, Station, Tool},
};
use crate::places::named;

impl Task {
    /// What is true whatever the command.
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        self.state.subtask.start(inputs.memory.subtask.status.echo);
        self.state.ledger.observe(&inputs.external.data_base, inputs.tick);
    }

    /// Status of Subtask.
    pub(super) fn subtask(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        let below = &inputs.memory.subtask;
        self.state.subtask.read(inputs.tick, &below.header, below.status.echo, below.status.report.lower())
    }

    /// Set the state variables.
    pub(super) fn situation(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let below = &inputs.memory.subtask.status;
        let plan = &self.state.plan;
        let right = below.held_object == plan.object;
        Situation {
            subtask: self.subtask(inputs),
            handling: if plan.object.is_empty() { Handling::NoObject } else { Handling::Object },
            holding: match (below.object_held, right) {
                (false, _) => Holding::NotHeld,
                (true, true) => Holding::Held,
                (true, false) => Holding::Other,
            },
            grips: if plan.source.grip == plan.destination.grip { Grips::Same } else { Grips::Different },
            ends: ends(&plan.end_at, &below.at),
            data_base: self.state.ledger.status(&inputs.external.data_base, inputs.tick),
            books: self.state.ledger.books(plan),
            tool: if below.end_effector_id != TOOL_GRIPPER {
                Tool::None
            } else if !below.object_held {
                Tool::Free
            } else if right || plan.object.is_empty() {
                Tool::Held
            } else {
                Tool::None
            },
            station: station(&plan.source, &below.at),
        }
    }
}

/// Where the robot is to be at the end. A sector is not known by its location's name alone.
fn ends(end_at: &Site, at: &Name10) -> Ends {
    if end_at.location.is_empty() {
        Ends::Here
    } else if end_at.location == *at && end_at.array == 0 {
        Ends::There
    } else {
        Ends::Elsewhere
    }
}

/// Where the robot is, for the tool commands.
fn station(source: &Site, at: &Name10) -> Station {
    if at.as_str() == named::TOOL_TRNS {
        Station::Transfer
    } else if at.as_str() == named::TOOL_SAFE || (!at.is_empty() && *at == source.location) {
        Station::Safe
    } else {
        Station::Elsewhere
    }
}
