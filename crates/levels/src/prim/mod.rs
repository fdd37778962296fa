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
//! ```text
//!                        ROBOT-INIT: RESTART, link runs, frame-feedback taken over
//!   +--------------+ ------------------------------------------------------------> +------------+
//!   | unpositioned |                                                               | positioned |
//!   +--------------+ <------------------------------------------------------------ +------------+
//!     T3I: PAUSE         link off, link error, refused or silent T3I; a restart        T3I: POINT
//! ```
//!
//! Only ROBOT-INIT leads from the left to the right, so that the robot is never asked to jump to where Prim
//! believes it to be. PAUSE ramps down and then repeats the last point under its number: T3I holds it, its
//! queue is not cut short, and the commanded position stays exact. PAUSE goes to T3I only while Prim has no
//! position.
//!
//! A frame switch of the joystick box stops every motion with `joystick-on`; only PAUSE lets the box move
//! the robot. The sensors of guarded moves are in [`sensors`].
//!
//! T3I queues up to four points. Prim reads in tick k+2 what T3I says to the point of tick k, so that T3I
//! must say `Executing` while it has room for fewer than two. With that the queue cannot overrun.

mod acting;
pub mod manual;
pub mod motion;
mod preprocess;
pub mod sensors;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use rcs_core::{
    interface::{PrimOutputs, t3i::T3iVerb},
    process::{Inputs, Process},
    table::Table,
};
use taskdata::files::TaskData;

use self::{
    state::State,
    tables::path_clock::{Flow, path_clock},
};
use crate::old_execution::EXECUTE;

/// The Prim process.
#[derive(Clone, Debug, Default)]
pub struct Prim {
    state: State,
}

impl<'d> Process<TaskData<'d>> for Prim {
    type Outputs = PrimOutputs;
    type State = State;
    type Seen = ();
    type Action = ();

    const NAME: &'static str = "Prim";
    const TABLES: &'static [&'static Table] = &[
        &EXECUTE,
        &tables::pause::PAUSE,
        &tables::robot_init::ROBOT_INIT,
        &tables::go_thru::GO_THRU,
        &tables::goto_pt::GOTO_PT,
        &tables::go_until::GO_UNTIL,
        &tables::go_while::GO_WHILE,
        &tables::delta_move::DELTA_MOVE,
        &tables::cal_sensor::CAL_SENSOR,
        &tables::attend::ATTEND,
        &tables::path_clock::PATH_CLOCK,
        &tables::record_pose::RECORD_POSE,
    ];

    fn step(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut PrimOutputs) {
        if !self.state.t3i.started {
            self.state.t3i.start(inputs.memory.t3i.status.echo);
            self.command_t3i(T3iVerb::Pause, inputs.tick, &mut outputs.t3i);
        }
        self.wake(inputs);
        let course = self.take_command(inputs, outputs);
        let situation = preprocess::situation(&mut self.state, inputs, &outputs.t3i);
        self.state.manual.release();
        if self.attends(course, &situation) {
            let choice = tables::decide(self.state.target.verb, self.state.execution.step, &situation);
            let tables = <Self as Process<TaskData<'d>>>::TABLES;
            self.state.execution.note(tables, choice.table, choice.row, choice.step);
            self.act(choice.action, inputs, outputs);
        }
        let posture = preprocess::posture(&self.state, situation.pace);
        let flow = path_clock(posture, situation.health, situation.pace);
        let [_, row, _] = &mut self.state.rows;
        *row = flow.row;
        self.state.clock = flow.next;
        match flow.action {
            Flow::Repeat => {}
            Flow::Advance => self.advance(inputs, &mut outputs.t3i),
            Flow::Abandon => self.abandon(inputs, &mut outputs.t3i),
        }
        let record = self.records(&inputs.external.devices.joystick, posture);
        self.postprocess(inputs, record, outputs);
    }

    fn preprocess(&mut self, _: &Inputs<'_, TaskData<'d>>, _: &PrimOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, TaskData<'d>>, _: &mut PrimOutputs) {}

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
