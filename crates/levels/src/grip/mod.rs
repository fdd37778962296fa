//! Grip (VI.3): the parts gripper, end effector 1, by eight air valves, a potentiometer and two strain gages.
//!
//! Air flow is not proportional: six flow valves open or close the fingers at three speeds, and trapped air keeps
//! the opening. The servo chooses a flow by the remaining distance, stops in a dead band, lets the readings settle,
//! and then decides. To prevent oscillation, a stopped flow starts again only outside a wider band.
//!
//! UP-INIT starts by itself when the system starts, later only by command, because it closes with the whole supply
//! pressure and a part may be held. Commands wait for it. Without a calibration only OPEN-GRIP to the open end works,
//! with all open flows until the readings are steady.
//!
//! ```text
//!   a command                               the calibration (UP-INIT)
//!
//!      | calibrated          Missing    Deferred, Failed, Valid     Adopting   restarted, and calibrated
//!      v                        |                |                     |       before
//!   .-------.                   | at once        | UP-INIT             | the sensors agree
//!   | Start |                   v                v                     v
//!   '-------'                .----------------------.                Valid
//!      |                     |       Closing        |  readings at 0.10 in
//!      v                     '----------------------'
//!   .-------. <---------.               | steady
//!   |  Move |           |    .----------------------.
//!   '-------'           |    |       Opening        |  readings at 5.00 in
//!      | in the dead    |    '----------------------'
//!      | band           |               | steady
//!      v                |    .----------------------.
//!   .--------. outside  |    |       Venting        |  readings without force
//!   | Settle |----------'    '----------------------'
//!   '--------' wide band           | steady, plausible   | else
//!      | inside the wide band      v                     v
//!      v                         Valid                 Failed
//!    Done         (Error: too late, without the gripper)
//! ```
//!
//! The process of a gripper attached later was dormant, and moves nothing before a command (docs/design/handshake.md
//! "Wake"): E-move sends UP-INIT when the gripper is clear of its holster (V.2.1 QC-ATTACH). Removing the gripper
//! voids a calibration in progress, keeps a finished one, and turns all valves off. PAUSE leaves the valves as they
//! are (VI.3.1), and is done when the fingers rest.

pub mod calibration;
pub mod goal;
pub mod goals;
pub mod postprocess;
pub mod preprocess;
pub mod presence;
pub mod servoed;
pub mod state;
pub mod tables;
#[cfg(test)]
pub(crate) mod tests;

use core::marker::PhantomData;

use interfaces::{
    GripOutputs,
    operator::{Variable, Write},
    process::{Inputs, Process},
};
use rcs_core::table::{Choice, Table, Verdict};

use self::{
    servoed::{PartsGripper, Servoed},
    state::State,
    tables::{
        Action, GripDuty, GripPhase, Situation, StateVariables, Step, accept::accept, number, of_command,
        up_init,
    },
};
use crate::execution::Course;

#[derive(Clone, Debug, Default)]
pub struct Servo<S> {
    state: State,
    gripper: PhantomData<S>,
}

/// Consult UP-INIT and CALIBRATION. The error is the row that decides.
fn calibrating(phase: GripPhase, situation: &Situation) -> Result<GripDuty, Choice<Action, GripPhase>> {
    match up_init::up_init(phase, situation) {
        Verdict::Decided(decision) => Err(decision.of(number::UP_INIT)),
        Verdict::Passed(()) => match up_init::calibration(phase, situation) {
            Verdict::Decided(decision) => Err(decision.of(number::CALIBRATION)),
            Verdict::Passed(duty) => Ok(duty),
        },
    }
}

pub type Grip = Servo<PartsGripper>;

impl<S> crate::goal::Goals for Servo<S> {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<S: Servoed, Data: ?Sized> Process<Data> for Servo<S> {
    type State = State;
    type Outputs = GripOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = S::NAME;
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &GripOutputs) -> StateVariables {
        self.state.sense::<S, Data>(inputs, outputs)
    }

    /// A calibration continues in the tick of a refusal, and while a command waits for it.
    fn decide(&mut self, seen: &StateVariables) -> Action {
        let state = &mut self.state;
        let course = state.execution.execute(seen.arrival);
        if course == Course::Begin {
            state.step = Step::Start;
        }
        let accepted = state.execution.accepts(accept(state.step, &seen.request));
        let command = state.goal.command(course, accepted);
        let situation = Situation { command, ..seen.situation };
        match calibrating(state.phase, &situation) {
            Err(choice) => {
                state.phase = choice.next;
                if accepted {
                    state.execution.rows.decide(&choice);
                } else {
                    state.execution.rows.beside(&choice);
                }
                choice.action
            }
            Ok(GripDuty::Nothing) => Action::Keep,
            Ok(GripDuty::Refused) => Action::Refuse,
            Ok(GripDuty::Command) => {
                let choice = of_command(state.goal.verb, state.step, &situation);
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
        outputs: &mut GripOutputs,
    ) {
        self.state.act(action, seen, inputs.tick);
        self.state.execution.reason = S::reason(self.state.execution.reason);
        *outputs = self.state.report(action, seen, inputs.tick);
    }

    /// If the sensors contradict the written calibration, CALIBRATION row 5 discards it.
    fn write(&mut self, write: &Write, _: &Inputs<'_, Data>, outputs: &mut GripOutputs) {
        if write.variable == Variable::Calibration {
            (self.state.calibration, outputs.calibration) = (None, None);
            if self.state.phase == GripPhase::Valid {
                self.state.phase = GripPhase::Adopting;
            }
        }
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
