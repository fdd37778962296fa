//! Task (V.4): takes a command of the workstation controller apart into commands to Subtask.
//!
//! Task looks every name of a new command up before anything moves: a command that names an unknown object, location, sector
//! or grip is refused whole. What it found travels down as record numbers and as the poses T-POSE-1 to T-POSE-3 (VII.1).
//!
//! * [`state`]: what Task remembers;
//! * [`plan`]: a command with its names looked up;
//! * [`tables`]: one decision table a command;
//! * this module: the three phases.

pub mod plan;
pub mod state;
pub mod tables;

use rcs_core::{
    handshake::Lower,
    interface::{
        ChangingPose, HwsCommand, Reason, TaskOutputs,
        hws::{HwsReport, HwsStatus},
        pose_range,
        subtask::{SubtaskCommand, SubtaskVerb},
    },
    pose::Pose,
    process::{Inputs, Process},
    table::Table,
};
use taskdata::files::TaskData;

use self::{
    plan::{Plan, Site, TaskVerb},
    state::State,
    tables::{Action, DataBase, Ends, Grips, Handling, Holding, Situation},
};
use crate::execution::{Course, EXECUTE, Outcome};

/// The Task process.
#[derive(Clone, Debug, Default)]
pub struct Task {
    state: State,
}

impl<'d> Process<TaskData<'d>> for Task {
    type Outputs = TaskOutputs;
    type State = State;

    const NAME: &'static str = "Task";
    const TABLES: &'static [&'static Table] = &[
        &EXECUTE,
        &tables::pause::PAUSE,
        &tables::transfer::TRANSFER,
        &tables::mov::MOVE,
        &tables::position::POSITION,
        &tables::acquire::ACQUIRE,
    ];

    fn step(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut TaskOutputs) {
        let course = self.take_command(inputs, outputs);
        if matches!(course, Course::Begin | Course::Continue) {
            let situation = self.preprocess(inputs);
            let choice = tables::decide(self.state.plan.verb, self.state.execution.step, &situation);
            self.state.execution.note(
                <Self as Process<TaskData<'d>>>::TABLES,
                choice.table,
                choice.row,
                choice.step,
            );
            self.act(choice.action, &situation, inputs, outputs);
        }
        self.postprocess(inputs, outputs);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restore(&mut self, state: State) {
        self.state = state;
    }
}

impl Task {
    /// Read the command buffer; look the names of a new command up.
    fn take_command(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) -> Course {
        let command = &inputs.external.hws;
        self.state.subtask.start(inputs.memory.subtask.status.echo);
        let mut found = Ok(Plan::default());
        let course = self.state.execution.consult(command.number, || {
            found = Plan::new(command, inputs.data);
            found.err()
        });
        if course == Course::Begin {
            let (plan, frames) = found.map(|p| (p, p.poses)).unwrap_or_default();
            self.state.plan = plan;
            self.publish_poses(&frames, outputs);
        }
        course
    }

    /// Give the poses of a new command new record numbers: T-POSE-1 source, T-POSE-2 destination, T-POSE-3 end-at.
    fn publish_poses(&mut self, poses: &[Pose; 3], outputs: &mut TaskOutputs) {
        let plan = &mut self.state.plan;
        let sites = [&mut plan.source, &mut plan.destination, &mut plan.end_at];
        for ((slot, pose), site) in outputs.poses.iter_mut().zip(poses).zip(sites) {
            self.state.last_pose = pose_range::next(pose_range::TASK, self.state.last_pose);
            *slot = ChangingPose { number: self.state.last_pose, pose: *pose };
            site.pose = if site.location.is_empty() { 0 } else { self.state.last_pose };
        }
    }

    /// Set the state variables.
    fn preprocess(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let below = &inputs.memory.subtask;
        let plan = &self.state.plan;
        Situation {
            subtask: self.state.subtask.read(
                inputs.tick,
                &below.header,
                below.status.echo,
                below.status.report.lower(),
            ),
            handling: if plan.object.is_empty() { Handling::NoObject } else { Handling::Object },
            holding: if below.status.object_held { Holding::Held } else { Holding::NotHeld },
            grips: if plan.source.grip == plan.destination.grip { Grips::Same } else { Grips::Different },
            ends: if plan.end_at.location.is_empty() { Ends::Here } else { Ends::Elsewhere },
            data_base: DataBase::Done,
        }
    }

    /// Set the outputs that the action names.
    fn act(
        &mut self,
        action: Action,
        situation: &Situation,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut TaskOutputs,
    ) {
        let plan = self.state.plan;
        let mut send = |verb, site: &Site| {
            outputs.subtask = SubtaskCommand {
                number: self.state.subtask.send(inputs.tick),
                command: verb,
                object: plan.object,
                end_effector_id: plan.end_effector_id,
                source_grip: plan.source.grip,
                destination_grip: plan.destination.grip,
                object_parameters: site.parameters,
                location: site.location,
                location_kind: site.kind,
                location_record: site.record,
                location_array: site.array,
                pose: site.pose,
            };
        };
        match action {
            Action::Wait | Action::UpdateDataBase => {}
            Action::Pause => send(SubtaskVerb::Pause, &Site::default()),
            Action::GetEndeff => send(SubtaskVerb::GetEndeff, &plan.source),
            Action::GetObject => send(SubtaskVerb::GetObject, &plan.source),
            Action::PlaceObj => send(SubtaskVerb::PlaceObj, &plan.destination),
            Action::MoveObjToDest => send(SubtaskVerb::MoveObjToDest, &plan.destination),
            Action::GotoDest => send(SubtaskVerb::GotoDest, &plan.destination),
            Action::GotoEndpt => send(SubtaskVerb::GotoEndpt, &plan.end_at),
            Action::Position => send(SubtaskVerb::Position, &plan.position_site()),
            Action::Release => send(SubtaskVerb::Release, &plan.source),
            Action::Finish => self.state.execution.finish(),
            Action::Fail(reason) => self.state.execution.fail(reason),
            Action::PassUp => {
                self.state.execution.pass_up(situation.subtask, inputs.memory.subtask.status.reason);
                if situation.subtask == Lower::Joystick {
                    // V.4.1 PAUSE: a running command is cancelled so that control passes to the joystick box.
                    send(SubtaskVerb::Pause, &Site::default());
                }
            }
        }
    }

    /// Write the output buffers.
    fn postprocess(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let execution = &self.state.execution;
        outputs.header = execution.header(inputs.tick);
        outputs.status = HwsStatus {
            echo: execution.receiver.echo,
            command: inputs.external.hws.command,
            report: match execution.outcome {
                Outcome::Idle => HwsReport::Idle,
                Outcome::Executing => HwsReport::Executing,
                Outcome::Done => HwsReport::Finished,
                Outcome::Error => HwsReport::Error,
                Outcome::Joystick => HwsReport::JoystickOn,
            },
            reason: execution.reason,
        };
    }
}

/// The Task command that a word means.
fn verb_of(command: &HwsCommand) -> Result<TaskVerb, Reason> {
    TaskVerb::from_text(command.command.as_str())
        .filter(|verb| *verb != TaskVerb::None)
        .ok_or(Reason::UnknownCommand)
}
