//! Prim (V.1): divides a motion command into trajectory points, one every 40 ms.
//!
//! A command of E-move names records. Prim looks them up, gives the goal to the trajectory generator, and sends T3I
//! a point whenever T3I is ready for one. Three things are separate:
//!
//! * the *command* (its table decides when it is done or has failed);
//! * the *motion* ([`motion`], or [`manual`] while the operator has the robot), which continues when a GO-THRU is done,
//!   and ramps down when a command has failed;
//! * the *path clock* ([`tables::path_clock`]), which stops while T3I has enough points.
//!
//! So three tables are consulted in every tick, for every command: ATTEND decides whether the tables of the command
//! follow; PATH-CLOCK and RECORD-POSE use the motion after the row of the command.
//!
//! ```text
//!                        ROBOT-INIT: RESTART, link runs, frame-feedback taken over
//!   +--------------+ ------------------------------------------------------------> +------------+
//!   | unpositioned |                                                               | positioned |
//!   +--------------+ <------------------------------------------------------------ +------------+
//!     T3I: PAUSE         link off, link error, refused or silent T3I; a restart        T3I: POINT
//! ```
//!
//! A motion also makes Prim positioned if T3I reports that the robot is at its commanded position. The command
//! continues from rest there, so the robot is never commanded to jump to an assumed position. PAUSE ramps down and then
//! repeats the last point under its number: T3I holds it, its queue is not cut short, and the commanded position stays
//! exact. PAUSE goes to T3I only while Prim has no position.
//!
//! A stick or button that is moved while a frame switch is on stops every motion with `joystick-on`; only during
//! PAUSE does the box move the robot. The sensors of guarded moves are in [`sensors`].
//!
//! T3I queues up to four points. In tick k+2 Prim reads the answer to the point of tick k, so T3I reports
//! `Executing` while it has room for fewer than two. This prevents an overrun of the queue.

pub mod goals;
pub mod manual;
pub mod motion;
pub mod postprocess;
pub mod preprocess;
pub mod sensors;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use interfaces::{
    PrimOutputs, Reason,
    process::{Inputs, Process},
};
use rcs_core::table::Table;
use taskdata::files::TaskData;

use self::{
    state::State,
    tables::{
        Action, Attendance, CommandKind, StateVariables,
        attend::{Attention, attend},
        link::LinkStep,
        number,
    },
};
use crate::execution::Course;

#[derive(Clone, Debug, Default)]
pub struct Prim {
    state: State,
}

impl crate::goal::Goals for Prim {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<'d> Process<TaskData<'d>> for Prim {
    type State = State;
    type Outputs = PrimOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = "Prim";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &PrimOutputs) -> StateVariables {
        self.state.sense(inputs, outputs)
    }

    fn decide(&mut self, seen: &StateVariables) -> Action {
        tables::decide(&mut self.state, &mut { *seen })
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'d>>,
        outputs: &mut PrimOutputs,
    ) {
        let state = &mut self.state;
        if state.execution.accepted(seen.request.asked, &[number::ACCEPT]) {
            state.begin(outputs);
        }
        state.act(action, seen, inputs, outputs);
        let recording = state.follow_path(seen, inputs, outputs);
        state.report(recording, seen, inputs, outputs);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}

impl State {
    /// Consult ATTEND. Its action is the error if the tables of the command are not consulted.
    fn attend(&mut self, course: Course, seen: &mut StateVariables) -> Result<Course, Action> {
        let attendance =
            Attendance { course, kind: CommandKind::of(seen.verb), operator: seen.situation.operator };
        let attention = attend(self.execution.outcome, &attendance);
        self.execution.rows.beside(&attention.of(number::ATTEND));
        self.execution.outcome = attention.next;
        match attention.action {
            Attention::Leave => Err(Action::Wait),
            Attention::Halt => Err(Action::Halt),
            Attention::Begin => {
                self.link = LinkStep::Commanding;
                Ok(Course::Begin)
            }
            Attention::Continue => Ok(Course::Continue),
            Attention::Resume => {
                self.execution.reason = Reason::None;
                Ok(Course::Continue)
            }
        }
    }
}
