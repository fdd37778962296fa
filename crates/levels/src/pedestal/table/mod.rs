//! Rotary table of the pedestal (III.9.1, III.10): a step motor behind a controller that counts its steps.
//!
//! The controller takes numbered orders over a serial link: turn by some steps, set the counter, stop. The counter
//! gives an angle only after it was set at a known angle: to zero at the + limit (IV.1 step 3). So the table is
//! calibrated at the start and before the first commanded turn if necessary. Then it is parked at -20.00, clear of
//! the switch.
//!
//! ```text
//!   Missing, Deferred, Failed                    a command TURN
//!            |                                         |
//!            v                                         v
//!      .-----------.  stops elsewhere, late        .-------.   still turns: stop, and
//!      |  Seeking  |--------------> Failed         | Start |   wait for rest
//!      '-----------'                               '-------'
//!            | at the + limit, at rest                 | at rest
//!            v                                         v
//!      .-----------.  stops elsewhere, late        .---------.  stops elsewhere, late
//!      |  Setting  |--------------> Failed         | Turning |----------------> Error,
//!      '-----------'                               '---------'              uncalibrated
//!            | counter reads zero                      | at the angle, at rest
//!            v                                         v
//!      .-----------.  stops elsewhere, late          Done
//!      |  Parking  |--------------> Failed
//!      '-----------'
//!            | at -20.00, at rest
//!            v
//!          Valid
//!            ^
//!            | at rest; counter and potentiometer agree
//!      .------------.  they do not, or it never rests
//!      |  Adopting  |--------------> Deferred
//!      '------------'
//!            ^ restarted in the middle of a job: a table that turns is stopped
//! ```
//!
//! An angle is valid if counter and potentiometer agree. If they do not, steps were lost, and the table must find
//! its + limit again.

pub mod goals;
pub mod postprocess;
pub mod preprocess;
pub mod state;
pub mod tables;
#[cfg(test)]
pub(super) mod tests;

pub(super) use self::{postprocess::report_of, preprocess::is_within_limits};
pub use self::{
    preprocess::{LIMIT_MINUS, LIMIT_PLUS},
    state::State,
};

use interfaces::{
    TableOutputs,
    process::{Inputs, Process},
};
use rcs_core::table::{Table as DecisionTable, Verdict};

use self::tables::{
    Action, Situation, StateVariables, Step, TableActivity, TableDuty, accept::accept, calibrate::calibrate,
    number, of_command,
};
use crate::execution::Course;

#[derive(Clone, Debug, Default)]
pub struct Table {
    state: State,
}

impl crate::goal::Goals for Table {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<Data: ?Sized> Process<Data> for Table {
    type State = State;
    type Outputs = TableOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = "Rotary Table";
    const TABLES: &'static [&'static DecisionTable] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &TableOutputs) -> StateVariables {
        self.state.sense(inputs, outputs)
    }

    /// A calibration continues in the tick of a refusal, and while a command waits for it.
    fn decide(&mut self, seen: &StateVariables) -> Action {
        let state = &mut self.state;
        let course = state.execution.execute(seen.arrival);
        if course == Course::Begin {
            state.step = Step::Start;
        }
        let accepted = state.execution.accepts(accept(state.step, &seen.request));
        let command = TableActivity::of(course, accepted, state.command.command);
        let situation = Situation { command, ..seen.situation };
        match calibrate(state.phase, &situation) {
            Verdict::Decided(decision) => {
                state.phase = decision.next;
                if accepted {
                    state.execution.rows.decide(&decision.of(number::CALIBRATE));
                } else {
                    state.execution.rows.beside(&decision.of(number::CALIBRATE));
                }
                decision.action
            }
            Verdict::Passed(TableDuty::Nothing) => Action::Wait,
            Verdict::Passed(TableDuty::Command) => {
                let choice = of_command(state.command.command, state.step, &situation);
                state.execution.rows.decide(&choice);
                state.step = choice.next;
                choice.action
            }
        }
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut TableOutputs,
    ) {
        let (state, sensors) = (&mut self.state, &inputs.external.devices.pedestal);
        if state.execution.accepted(seen.request.asked, &[number::ACCEPT]) {
            state.since = inputs.tick;
        }
        state.act(action, sensors, inputs.tick);
        *outputs = state.report(seen, inputs.tick);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
