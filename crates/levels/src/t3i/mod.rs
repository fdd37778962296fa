//! T3 Interface (VI.1): converts the frames of Prim into positions on the DEPC line and resolver angles into a
//! frame, and watches the link.
//!
//! Prim may send a point in every tick. T3I queues them by number, sends one frame per tick, and reports whether it
//! is ready for another:
//!
//! | tick | Prim | T3I | line | controller |
//! |---|---|---|---|---|
//! | k   | writes point n | | | |
//! | k+1 | writes n+1 | reads n, sends it, reports 3 | frame n | acknowledges n and moves |
//! | k+2 | reads 3, writes n+2 | reads the ACK of n, sends n+1 | frame n+1 | acknowledges n+1 and moves |
//!
//! While nothing moves the last position is repeated in every tick, so that a dead link is detected within three
//! ticks. A point beyond the velocity limits stays in the queue and is approached as fast as they allow. RESTART,
//! PAUSE and the loss of the link empty the queue. While Prim is held or lost the queue waits and the position is
//! repeated.
//!
//! When the link starts again the controller reports the position of the robot. T3I compares the words of the
//! report with those that it sent, and publishes the result (`check`): Prim continues, or the operator decides.
//!
//! While the link runs, T3I compares the resolvers with the path that it has sent in the time of the expected lag. A
//! robot that is off this path is stopped (`following`, `left`), because the rest of the motion would be a short cut.
//!
//! Four tables decide in a tick: REPORT, RECEIVE for the command in the buffer, FOLLOW for the robot, then the table
//! of the current command for the output.
//!
//! ```text
//!                 a point that is missing or cannot be sent
//!   +-----------+ -----------------------------------------> +----------+
//!   | accepting |                                            | refusing |
//!   +-----------+ <----------------------------------------- +----------+
//!                              RESTART, PAUSE
//! ```

pub mod goals;
pub mod postprocess;
pub mod preprocess;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use depc::Limits;
use interfaces::{
    T3iOutputs,
    process::{Inputs, Process},
};
use rcs_core::table::Table;

pub use self::state::State;
use self::tables::{
    Action, StateVariables,
    follow::follow,
    number, of_command,
    receive::{T3iIntake, receive},
    report::report,
};

#[derive(Clone, Debug)]
pub struct T3i {
    state: State,
}

impl Default for T3i {
    /// Has the limits of 40 ms, and a time limit of three ticks for an answer.
    fn default() -> Self {
        Self { state: State::nbs() }
    }
}

impl T3i {
    /// `limits` belong to the tick length; `answer_ticks`, at least 1, is the time limit for answers.
    #[must_use]
    pub fn new(limits: Limits, answer_ticks: u16) -> Self {
        Self { state: State::new(limits, answer_ticks) }
    }
}

impl crate::goal::Goals for T3i {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<Data: ?Sized> Process<Data> for T3i {
    type State = State;
    type Outputs = T3iOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = "T3 Interface";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &T3iOutputs) -> StateVariables {
        self.state.sense(inputs, outputs)
    }

    fn decide(&mut self, seen: &StateVariables) -> Action {
        let state = &mut self.state;
        let checked = report(state.check, &seen.answer);
        state.rows.beside(&checked.of(number::REPORT));
        state.check = checked.next;
        state.compare(checked.action);
        let taken = receive(state.receive, &seen.request);
        state.receive = taken.next;
        state.take(taken.action, seen);
        let followed = follow(state.following, &seen.feedback);
        state.rows.beside(&followed.of(number::FOLLOW));
        state.following = followed.next;
        state.supervise(followed.action, seen);
        let choice = of_command(state.command, state.step, &state.situation(seen));
        state.step = choice.next;
        // The last row decides, which is that of RECEIVE if it refuses the command.
        if matches!(taken.action, T3iIntake::Ignore | T3iIntake::Refuse) {
            state.rows.decide(&choice);
            state.rows.decide(&taken.of(number::RECEIVE));
        } else {
            state.rows.beside(&taken.of(number::RECEIVE));
            state.rows.decide(&choice);
        }
        choice.action
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut T3iOutputs,
    ) {
        let link_tx = self.state.send(action, seen);
        *outputs = self.state.outputs(action, link_tx, seen, inputs);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
