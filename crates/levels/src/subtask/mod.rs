//! Subtask (V.3): takes a command of Task apart into commands to E-move.
//!
//! * [`state`]: what Subtask remembers;
//! * [`tables`]: the decision tables, a file for each kind of command;
//! * this module: the three phases.
//!
//! Commands to the Active Pedestal (FIX-GRIP) and the exchange of grippers are not there yet: GET-ENDEFF reports the wrong gripper.

pub mod state;
pub mod tables;

use rcs_core::{
    interface::{
        Reason, SubtaskOutputs,
        emove::{EmoveCommand, EmoveVerb},
        subtask::{SubtaskCommand, SubtaskStatus, SubtaskVerb},
    },
    process::{Inputs, Process},
    table::Table,
};
use taskdata::files::TaskData;

use self::{
    state::State,
    tables::{Action, Gripper, Held, Named, Situation, Vision},
};
use crate::{
    execution::{Course, EXECUTE},
    places::place_of,
};

/// The Subtask process.
#[derive(Clone, Debug, Default)]
pub struct Subtask {
    state: State,
}

impl<'d> Process<TaskData<'d>> for Subtask {
    type Outputs = SubtaskOutputs;
    type State = State;

    const NAME: &'static str = "Subtask";
    const TABLES: &'static [&'static Table] = &[
        &EXECUTE,
        &tables::pause::S_PAUSE,
        &tables::get_endeff::GET_ENDEFF,
        &tables::get_object::GET_OBJECT,
        &tables::place_obj::PLACE_OBJ,
        &tables::move_obj::MOVE_OBJ_TO_DEST,
        &tables::goto::GOTO,
        &tables::position::POSITION,
        &tables::release::RELEASE,
    ];

    fn step(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut SubtaskOutputs) {
        let command = inputs.memory.task.subtask;
        self.state.emove.start(inputs.memory.emove.status.echo);
        let course = self.state.execution.consult(command.number, || {
            matches!(
                command.command,
                SubtaskVerb::None
                    | SubtaskVerb::FixGrip
                    | SubtaskVerb::InsertTool
                    | SubtaskVerb::ReleaseTool
                    | SubtaskVerb::AcquireTool
                    | SubtaskVerb::RemoveTool
            )
            .then_some(Reason::UnknownCommand)
        });
        if matches!(course, Course::Begin | Course::Continue) {
            let situation = self.preprocess(&command, inputs);
            let choice = tables::decide(command.command, self.state.execution.step, &situation);
            self.state.execution.note(
                <Self as Process<TaskData<'d>>>::TABLES,
                choice.table,
                choice.row,
                choice.step,
            );
            self.act(choice.action, &situation, &command, inputs, outputs);
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

impl Subtask {
    /// Set the state variables.
    fn preprocess(&self, command: &SubtaskCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let below = &inputs.memory.emove;
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        let view = inputs.data.view(&command.object, &place).is_some_and(|(_, view)| view.enabled);
        let present = below.status.end_effector_id;
        Situation {
            emove: self.state.emove.read(
                inputs.tick,
                &below.header,
                below.status.echo,
                below.status.report.lower(),
            ),
            held: if !below.status.object_held {
                Held::Nothing
            } else if below.status.held_object == command.object {
                Held::Right
            } else {
                Held::Other
            },
            vision: if view { Vision::Needed } else { Vision::NotNeeded },
            gripper: if present == 0 {
                Gripper::None
            } else if command.end_effector_id == present || command.end_effector_id == 0 {
                Gripper::Right
            } else {
                Gripper::Wrong
            },
            named: if command.object.is_empty() { Named::Location } else { Named::Object },
        }
    }

    /// Set the outputs that the action names.
    fn act(
        &mut self,
        action: Action,
        situation: &Situation,
        command: &SubtaskCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut SubtaskOutputs,
    ) {
        let mut send = |verb| {
            outputs.emove = EmoveCommand {
                number: self.state.emove.send(inputs.tick),
                ..emove_command(verb, command, inputs.data)
            };
        };
        match action {
            Action::Wait => {}
            Action::Pause => send(EmoveVerb::Pause),
            Action::MovToVu => send(EmoveVerb::MovToVu),
            Action::LocateObj => send(EmoveVerb::LocateObj),
            Action::MovToObj => send(EmoveVerb::MovToObj),
            Action::GraspObj => send(EmoveVerb::GraspObj),
            Action::MovObjTo => send(EmoveVerb::MovObjTo),
            Action::MovToLoc => send(EmoveVerb::MovToLoc),
            Action::Release => send(EmoveVerb::Release),
            Action::Finish => self.state.execution.finish(),
            Action::Fail(reason) => self.state.execution.fail(reason),
            Action::PassUp => {
                self.state.execution.pass_up(situation.emove, inputs.memory.emove.status.reason);
            }
        }
    }

    /// Write the output buffers.
    fn postprocess(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut SubtaskOutputs) {
        let execution = &self.state.execution;
        let below = &inputs.memory.emove.status;
        outputs.header = execution.header(inputs.tick);
        outputs.status = SubtaskStatus {
            echo: execution.receiver.echo,
            report: execution.report(),
            reason: execution.reason,
            reference_pose: below.reference_pose,
            object_held: below.object_held,
            held_object: below.held_object,
            end_effector_id: below.end_effector_id,
            at: below.at,
        };
    }
}

/// A command to E-move with the parameters of the command from Task.
fn emove_command(verb: EmoveVerb, command: &SubtaskCommand, data: &TaskData<'_>) -> EmoveCommand {
    let place = place_of(command.location_kind, command.location_record, command.location_array);
    // The object is taken with the source grip and placed with the destination grip; both name the same record file.
    let grip = match command.command {
        SubtaskVerb::PlaceObj | SubtaskVerb::MoveObjToDest => command.destination_grip,
        SubtaskVerb::Position if command.source_grip == 0 => command.destination_grip,
        _ => command.source_grip,
    };
    EmoveCommand {
        number: 0,
        command: verb,
        object: command.object,
        grip,
        object_parameters: command.object_parameters,
        object_grips: data.obj_grips_id(&command.object).map_or(0, |id| id.number()),
        object_vision: data.view(&command.object, &place).map_or(0, |(id, _)| id.number()),
        location: command.location,
        location_kind: command.location_kind,
        location_record: command.location_record,
        location_array: command.location_array,
        pose: command.pose,
        end_effector_id: command.end_effector_id,
    }
}
