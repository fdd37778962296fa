//! Rotary table of the pedestal (III.9.1, III.10): a step motor behind a controller that counts its steps.
//!
//! The controller takes orders by number over a serial link: turn by so many steps, give the counter a value, stop. Its
//! counter means an angle only after it has been set where the angle is known: at the + limit. So the table calibrates
//! first, by itself when it is booted, and before the first turn it is asked for.
//!
//! ```text
//!   Missing, Deferred, Failed                    a command TURN
//!            |                                         |
//!            v                                         v
//!      .-----------.  stops elsewhere, late        .-------.   still turns: stop, and
//!      |  Seeking  |--------------> Failed         | Start |   wait until it stands
//!      '-----------'                               '-------'
//!            | stands at the + limit                   | stands
//!            v                                         v
//!      .-----------.  stops elsewhere, late        .---------.  stands elsewhere, late
//!      |  Setting  |--------------> Failed         | Turning |----------------> Error,
//!      '-----------'                               '---------'              uncalibrated
//!            | counter reads -20.00                    | stands at the angle
//!            v                                         v
//!          Valid                                     Done
//! ```
//!
//! An angle is believed if counter and potentiometer agree. If they do not, steps were lost, and the table has to find
//! its + limit again.

mod postprocess;
mod preprocess;
mod state;
pub mod tables;
#[cfg(test)]
pub(super) mod tests;

pub(super) use self::{postprocess::report, preprocess::within_limits};
pub use self::{
    preprocess::{LIMIT_MINUS, LIMIT_PLUS},
    state::{Phase, State},
};

use rcs_core::{
    interface::{TableOutputs, pedestal::TableVerb},
    process::{Inputs, Process},
    table::Table as DecisionTable,
};

use self::{
    preprocess::Seen,
    tables::{Action, CALIBRATE, PAUSE, Step, TURN, calibrate, pause, turn},
};
use crate::old_execution::{Course, EXECUTE};

/// Decision tables, the upper one first.
const TABLES: &[&DecisionTable] = &[&EXECUTE, &CALIBRATE, &TURN, &PAUSE];

/// The table process.
#[derive(Clone, Debug, Default)]
pub struct Table {
    state: State,
}

impl Table {
    /// Look up the state variables in the table that has the duty.
    fn decide(&mut self, seen: &Seen) -> Action {
        let state = &mut self.state;
        if seen.calibrate {
            let decision = calibrate(state.phase, seen.motor, seen.place, seen.clock);
            state.phase = decision.next;
            let step = state.execution.step;
            state.execution.note(TABLES, &CALIBRATE, decision.row, step);
            return decision.action;
        }
        if !matches!(seen.course, Course::Begin | Course::Continue) {
            return Action::Wait;
        }
        let step = Step::from_code(state.execution.step).unwrap_or_default();
        let (table, decision) = match state.command.command {
            TableVerb::Turn => (&TURN, turn(step, seen.motor, seen.place, seen.clock)),
            TableVerb::Pause | TableVerb::Calibrate | TableVerb::None => {
                (&PAUSE, pause(seen.motor, seen.clock))
            }
        };
        state.execution.note(TABLES, table, decision.row, decision.next.code());
        decision.action
    }
}

impl<Data: ?Sized> Process<Data> for Table {
    type State = State;
    type Seen = ();
    type Action = ();
    type Outputs = TableOutputs;

    const NAME: &'static str = "Rotary Table";
    const TABLES: &'static [&'static DecisionTable] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut TableOutputs) {
        let command = &inputs.memory.pedestal.table;
        let sensors = &inputs.external.devices.pedestal;
        let seen = Seen::preprocess(&mut self.state, command, sensors, inputs.tick);
        let action = self.decide(&seen);
        *outputs = postprocess::perform(&mut self.state, &seen, action, sensors, inputs.tick);
    }

    fn preprocess(&mut self, _: &Inputs<'_, Data>, _: &TableOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, Data>, _: &mut TableOutputs) {}

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restore(&mut self, state: State) {
        self.state = state;
    }
}
