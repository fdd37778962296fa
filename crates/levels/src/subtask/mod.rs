//! Subtask (V.3): takes a command of Task apart into commands to E-move, and coordinates the robot with the
//! Active Pedestal.
//!
//! * [`state`]: what Subtask remembers;
//! * [`aims`]: objects and locations that commands to E-move are aimed at, among them those that Subtask
//!   names itself;
//! * [`sensing`]: preprocess, the state variables;
//! * [`tables`]: the decision tables, a file for each kind of command;
//! * [`acting`]: postprocess, the outputs that a row asks for;
//! * this module: the process.

pub mod acting;
pub mod aims;
pub mod sensing;
pub mod state;
pub mod tables;
#[cfg(test)]
pub(crate) mod tests;

use rcs_core::{
    interface::{
        ChangingPose, Reason, SubtaskOutputs, pose_range,
        subtask::{SubtaskCommand, SubtaskVerb},
    },
    process::{Inputs, Process},
    table::Table,
};
use taskdata::files::{PedPara, TaskData};

use self::{aims::Aims, state::State};
use crate::execution::{Course, EXECUTE};

/// The Subtask process.
#[derive(Clone, Debug, Default)]
pub struct Subtask {
    state: State,
}

/// Decision tables of Subtask.
pub const TABLES: &[&Table] = &[
    &EXECUTE,
    &tables::pause::S_PAUSE,
    &tables::get_endeff::GET_ENDEFF,
    &tables::get_object::GET_OBJECT,
    &tables::fix_grip::FIX_GRIP,
    &tables::place_obj::PLACE_OBJ,
    &tables::move_obj::MOVE_OBJ_TO_DEST,
    &tables::goto::GOTO,
    &tables::position::POSITION,
    &tables::release::RELEASE,
    &tables::insert_tool::INSERT_TOOL,
    &tables::release_tool::RELEASE_TOOL,
    &tables::acquire_tool::ACQUIRE_TOOL,
    &tables::remove_tool::REMOVE_TOOL,
];

impl<'d> Process<TaskData<'d>> for Subtask {
    type Outputs = SubtaskOutputs;
    type State = State;

    const NAME: &'static str = "Subtask";
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut SubtaskOutputs) {
        let command = inputs.memory.task.subtask;
        self.sense(inputs, outputs);
        let course = self.take_command(&command, inputs, outputs);
        if matches!(course, Course::Begin | Course::Continue) {
            let situation = self.situation(&command, inputs);
            let choice = tables::decide(command.command, self.state.execution.step, &situation);
            self.state.execution.note(TABLES, choice.table, choice.row, choice.step);
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

impl Subtask {
    /// Read the command buffer; look up what a new command needs beside the location that Task names.
    fn take_command(
        &mut self,
        command: &SubtaskCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut SubtaskOutputs,
    ) -> Course {
        let attached = inputs.memory.emove.status.end_effector_id;
        let mut found = (Aims::default(), PedPara::default());
        let course =
            self.state.execution.consult(command.number, || match look_up(command, attached, inputs.data) {
                Ok(records) => {
                    found = records;
                    None
                }
                Err(reason) => Some(reason),
            });
        if course == Course::Begin {
            (self.state.aims, self.state.ped_para) = found;
            self.publish_poses(outputs);
        }
        course
    }

    /// Give the poses of a new command new record numbers.
    fn publish_poses(&mut self, outputs: &mut SubtaskOutputs) {
        let aims = &mut self.state.aims;
        for ((slot, pose), aim) in
            outputs.poses.iter_mut().zip(&aims.poses).zip([&mut aims.first, &mut aims.second])
        {
            if !aim.location.is_empty() {
                self.state.last_pose = pose_range::next(pose_range::SUBTASK, self.state.last_pose);
                *slot = ChangingPose { number: self.state.last_pose, pose: *pose };
                aim.pose = self.state.last_pose;
            }
        }
        aims.third.pose = aims.first.pose;
    }
}

/// The locations of a command that Subtask names itself, and for FIX-GRIP how the pedestal takes the object.
fn look_up(command: &SubtaskCommand, attached: u8, data: &TaskData<'_>) -> Result<(Aims, PedPara), Reason> {
    if command.command == SubtaskVerb::None {
        return Err(Reason::UnknownCommand);
    }
    let ped_para = match command.command {
        SubtaskVerb::FixGrip if command.object.is_empty() => return Err(Reason::NoObjectNamed),
        SubtaskVerb::FixGrip => *data.ped_para(&command.object).ok_or(Reason::NoPedestalData)?.1,
        _ => PedPara::default(),
    };
    Ok((Aims::new(command, attached, data)?, ped_para))
}
