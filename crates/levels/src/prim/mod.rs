//! Prim (V.1): takes a motion command apart into trajectory points, one every 40 ms.
//!
//! A command of E-move names records; Prim looks them up, gives the goal to the trajectory generator, and
//! sends T3I a point whenever it wants one. Three things are kept apart:
//!
//! * the *command* (its table decides when it is done, and when it failed);
//! * the *motion* ([`motion`], or [`manual`] while the operator has the robot), which goes on when a GO-THRU
//!   is done, and ramps down when a command failed;
//! * the *path clock* ([`tables::path_clock`]), which stands while T3I has points enough.
//!
//! So three tables are consulted in every tick, whatever the command: ATTEND says whether the tables of the
//! command are consulted; PATH-CLOCK and RECORD-POSE look at the motion as the row of the command has left
//! it.
//!
//! ```text
//!                        ROBOT-INIT: RESTART, link runs, frame-feedback taken over
//!   +--------------+ ------------------------------------------------------------> +------------+
//!   | unpositioned |                                                               | positioned |
//!   +--------------+ <------------------------------------------------------------ +------------+
//!     T3I: PAUSE         link off, link error, refused or silent T3I; a restart        T3I: POINT
//! ```
//!
//! A motion leads from the left to the right too, if T3I says that the robot is where it was sent; the
//! command goes on executing meanwhile, and then goes on from rest where the robot is. So the robot is never
//! asked to jump to where Prim believes it to be. PAUSE ramps down and then repeats the last point under its
//! number: T3I holds it, its queue is not cut short, and the commanded position stays exact. PAUSE goes to
//! T3I only while Prim has no position.
//!
//! A stick or button of the joystick box that is moved while a frame switch is on stops every motion with
//! `joystick-on`; only PAUSE lets the box move the robot. The sensors of guarded moves are in [`sensors`].
//!
//! T3I queues up to four points. Prim reads in tick k+2 what T3I says to the point of tick k, so that T3I
//! must say `Executing` while it has room for fewer than two. With that the queue cannot overrun.

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
        Action, Attendance, Kind, Seen, Step,
        attend::{Attention, attend},
        link::LinkStep,
        number,
    },
};

/// The Prim process.
#[derive(Clone, Debug, Default)]
pub struct Prim {
    state: State,
}

impl<'d> Process<TaskData<'d>> for Prim {
    type State = State;
    type Outputs = PrimOutputs;
    type Seen = Seen;
    type Action = Action;

    const NAME: &'static str = "Prim";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &PrimOutputs) -> Seen {
        self.state.sense(inputs, outputs)
    }

    fn decide(&mut self, seen: &Seen) -> Action {
        let state = &mut self.state;
        let attendance = Attendance {
            course: state.execution.course(seen.arrival),
            kind: Kind::of(seen.verb),
            operator: seen.situation.operator,
        };
        let attention = attend(state.execution.outcome, &attendance);
        state.execution.rows.beside(&attention.of(number::ATTEND));
        state.execution.outcome = attention.next;
        match attention.action {
            Attention::Leave => return Action::Wait,
            Attention::Halt => return Action::Halt,
            Attention::Begin => {
                (state.step, state.link) = (Step::first(seen.verb), LinkStep::Commanding);
            }
            Attention::Continue => {}
            Attention::Resume => state.execution.reason = Reason::None,
        }
        let choice = tables::decide(state.step, &mut state.link, seen);
        state.execution.note(&choice);
        state.step = choice.next;
        choice.action
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &Seen,
        inputs: &Inputs<'_, TaskData<'d>>,
        outputs: &mut PrimOutputs,
    ) {
        let state = &mut self.state;
        if state.execution.begins(seen.arrival) {
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
