//! E-move (V.2): takes elemental moves apart into straight segments for Prim, and coordinates gripper, quick
//! change and vision with them.
//!
//! * [`state`]: what E-move remembers: among it *where the robot is* and what it holds;
//! * [`plan`]: what a command needs, looked up before anything moves;
//! * [`route`]: depart, trajectory, approach and stop as one list of points;
//! * [`locate`]: from a picture to a part frame;
//! * [`relative`]: the short moves at holsters and tool drum;
//! * [`gripper`]: the three grippers as one;
//! * [`sensing`] and [`fingers`]: preprocess, the state variables;
//! * [`tables`]: the decision tables, a file a command;
//! * [`acting`], [`camera`] and [`stance`]: postprocess, the outputs that a row asks for;
//! * this module: the process.

pub mod acting;
pub mod camera;
pub mod fingers;
pub mod gripper;
pub mod locate;
pub mod plan;
pub mod relative;
pub mod route;
pub mod sensing;
pub mod stance;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use rcs_core::{
    interface::{
        ChangingPose, EmoveOutputs,
        emove::{EmoveCommand, EmoveVerb},
        pose_range,
    },
    pose::Pose,
    process::{Inputs, Process},
    table::Table,
};
use taskdata::files::TaskData;

use self::{route::Route, state::State};
use crate::old_execution::{Course, EXECUTE, Outcome};

/// The E-move process.
#[derive(Clone, Debug, Default)]
pub struct Emove {
    state: State,
}

/// Which changing pose stands where in the outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    Departure,
    Goal,
    Between,
    Located,
}

impl<'d> Process<TaskData<'d>> for Emove {
    type Outputs = EmoveOutputs;
    type State = State;
    type Seen = ();
    type Action = ();

    const NAME: &'static str = "E-move";
    const TABLES: &'static [&'static Table] = &[
        &EXECUTE,
        &tables::pause::E_PAUSE,
        &tables::mov_to_loc::MOV_TO_LOC,
        &tables::mov_to_obj::MOV_TO_OBJ,
        &tables::mov_obj_to::MOV_OBJ_TO,
        &tables::mov_to_hol::MOV_TO_HOL,
        &tables::locate_obj::LOCATE_OBJ,
        &tables::grasp_obj::GRASP_OBJ,
        &tables::release::RELEASE,
        &tables::qc_detach::QC_DETACH,
        &tables::qc_attach::QC_ATTACH,
        &tables::withdraw::WITHDRAW,
        &tables::insert_tool::INSERT_TOOL,
        &tables::release_tool::RELEASE_TOOL,
        &tables::acquire_tool::ACQUIRE_TOOL,
        &tables::remove_tool::REMOVE_TOOL,
    ];

    fn step(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut EmoveOutputs) {
        let command = inputs.memory.subtask.emove;
        self.sense(inputs);
        let course = self.take_command(&command, inputs, outputs);
        if matches!(course, Course::Begin | Course::Continue) || self.is_standing(&command) {
            let situation = self.situation(&command, inputs);
            let choice = tables::decide(command.command, self.state.execution.step, &situation);
            self.state.execution.note(
                <Self as Process<TaskData<'d>>>::TABLES,
                choice.table,
                choice.row,
                choice.step,
            );
            self.act(choice.action, &situation, &command, inputs, outputs);
        }
        self.state.button = inputs.memory.prim.status.joystick_grip;
        self.report(inputs, outputs);
    }

    fn preprocess(&mut self, _: &Inputs<'_, TaskData<'d>>, _: &EmoveOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, TaskData<'d>>, _: &mut EmoveOutputs) {}

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

impl Emove {
    /// E-PAUSE goes on after it is done, for as long as it is the command: the joystick box may take the
    /// robot (V.1.1 PAUSE).
    fn is_standing(&self, command: &EmoveCommand) -> bool {
        command.command == EmoveVerb::Pause
            && self.state.execution.step == tables::pause::Step::Standing.code()
            && matches!(self.state.execution.outcome, Outcome::Done | Outcome::Joystick)
    }

    /// Read the command buffer; plan the way of a new motion command.
    fn take_command(
        &mut self,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) -> Course {
        let mut plan = Ok(None);
        let mut execution = self.state.execution;
        let course = execution.consult(command.number, || {
            plan = self.plan(command, inputs);
            plan.err()
        });
        self.state.execution = execution;
        match course {
            Course::Begin => {
                self.state.tries = 0;
                self.state.undetected = 0;
                self.state.carrying = !self.state.held.object.is_empty();
                self.state.route = Route { complete: true, opening: -1, ..Route::default() };
                if let Ok(Some((route, goal))) = plan {
                    let departure = self.state.stance.pose;
                    self.state.route = Route {
                        departure: self.publish(Slot::Departure, departure, outputs),
                        goal: self.publish(Slot::Goal, Pose::from_frame(&goal.frame), outputs),
                        ..route
                    };
                }
            }
            // A refused command must not leave the motion of the one before it running.
            Course::Refuse if plan.is_err() => self.stop_prim(inputs, outputs),
            Course::Refuse | Course::Rest | Course::Continue => {}
        }
        course
    }

    /// Give a changing pose a new record number and value.
    fn publish(&mut self, slot: Slot, pose: Pose, outputs: &mut EmoveOutputs) -> u32 {
        self.state.last_pose = pose_range::next(pose_range::EMOVE, self.state.last_pose);
        let [departure, goal, between, located] = &mut outputs.poses;
        let record = match slot {
            Slot::Departure => departure,
            Slot::Goal => goal,
            Slot::Between => between,
            Slot::Located => located,
        };
        *record = ChangingPose { number: self.state.last_pose, pose };
        self.state.last_pose
    }
}
