//! E-move (V.2): takes elemental moves apart into straight segments for Prim, and coordinates gripper, quick change and vision
//! with them.
//!
//! * [`state`]: what E-move remembers: among it *where the robot is* and what it holds;
//! * [`route`]: depart, trajectory, approach and stop as one list of points;
//! * [`locate`]: from a picture to a part frame;
//! * [`sensing`]: preprocess, the state variables;
//! * [`tables`]: the decision tables, a file a command;
//! * [`acting`]: postprocess, the outputs that a row asks for;
//! * this module: the process.

pub mod acting;
pub mod locate;
pub mod route;
pub mod sensing;
pub mod state;
pub mod tables;

use rcs_core::{
    frame::Frame,
    interface::{ChangingPose, EmoveOutputs, Reason, emove::EmoveCommand, emove::EmoveVerb, pose_range},
    pose::Pose,
    process::{Inputs, Process},
    table::Table,
};
use taskdata::files::TaskData;

use self::{
    route::{Goal, Route},
    state::State,
};
use crate::execution::{Course, EXECUTE};

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

    const NAME: &'static str = "E-move";
    const TABLES: &'static [&'static Table] = &[
        &EXECUTE,
        &tables::pause::E_PAUSE,
        &tables::mov_to_loc::MOV_TO_LOC,
        &tables::mov_to_obj::MOV_TO_OBJ,
        &tables::mov_obj_to::MOV_OBJ_TO,
        &tables::locate_obj::LOCATE_OBJ,
        &tables::grasp_obj::GRASP_OBJ,
        &tables::release::RELEASE,
    ];

    fn step(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut EmoveOutputs) {
        let command = inputs.memory.subtask.emove;
        self.sense(inputs);
        let course = self.take_command(&command, inputs, outputs);
        if matches!(course, Course::Begin | Course::Continue) {
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
        self.report(inputs, outputs);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restore(&mut self, state: State) {
        self.state = state;
    }
}

impl Emove {
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

    /// The route of a motion command; `None` for commands without one.
    fn plan(
        &self,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Result<Option<(Route, Goal)>, Reason> {
        match command.command {
            EmoveVerb::None
            | EmoveVerb::MovToHol
            | EmoveVerb::QcDetach
            | EmoveVerb::QcAttach
            | EmoveVerb::Withdraw
            | EmoveVerb::InsertTool
            | EmoveVerb::ReleaseTool
            | EmoveVerb::AcquireTool
            | EmoveVerb::RemoveTool => Err(Reason::UnknownCommand),
            EmoveVerb::Pause | EmoveVerb::GraspObj | EmoveVerb::Release => Ok(None),
            EmoveVerb::LocateObj => match locate::view_of(command, inputs.data) {
                Some(_) => Ok(None),
                None => Err(Reason::BadRecord),
            },
            EmoveVerb::MovToLoc | EmoveVerb::MovToObj | EmoveVerb::MovObjTo | EmoveVerb::MovToVu => {
                let base = self.base_frame(command, inputs)?;
                let goal = Goal::new(command, &base, inputs.data)?;
                let route = Route::plan(command, &goal, &self.state.stance, inputs.data)?;
                Ok(Some((route, goal)))
            }
        }
    }

    /// The pose of a command, or where vision has found the object.
    fn base_frame(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<Frame, Reason> {
        let located = &self.state.located;
        let found = command.command == EmoveVerb::MovToObj
            && located.object == command.object
            && !located.object.is_empty()
            && located.record == command.location_record
            && located.array == command.location_array;
        let pose = if found {
            &located.pose
        } else {
            inputs.memory.changing_pose(command.pose).ok_or(Reason::NoDestination)?
        };
        pose.to_frame().map_err(|_| Reason::BadRecord)
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
