//! Postprocess of Task: commands to Subtask and to the Data System, and the status to the HWSC.

use rcs_core::{
    interface::{
        Reason, TaskOutputs,
        data_base::DataBaseVerb,
        hws::{HwsReport, HwsStatus},
        subtask::{SubtaskCommand, SubtaskVerb},
    },
    process::Inputs,
};
use taskdata::files::TaskData;

use super::{
    Task,
    plan::Site,
    state::Watch,
    tables::{Action, Situation},
};
use crate::old_execution::Outcome;

impl Task {
    /// Set the outputs that a row asks for.
    pub(super) fn act(
        &mut self,
        action: Action,
        situation: &Situation,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut TaskOutputs,
    ) {
        let plan = self.state.plan;
        let ledger = &mut self.state.ledger;
        let below = &inputs.memory.subtask.status;
        let in_hand = below.object_held && below.held_object == plan.object;
        match action {
            Action::Wait => {}
            Action::Pause => self.send(SubtaskVerb::Pause, &Site::default(), inputs, outputs),
            Action::GetEndeff => self.send(SubtaskVerb::GetEndeff, &plan.source, inputs, outputs),
            Action::GetObject => self.send(SubtaskVerb::GetObject, &plan.source, inputs, outputs),
            Action::FixGrip => self.send(SubtaskVerb::FixGrip, &plan.source, inputs, outputs),
            Action::PlaceObj => self.send(SubtaskVerb::PlaceObj, &plan.destination, inputs, outputs),
            Action::MoveObjToDest => {
                self.send(SubtaskVerb::MoveObjToDest, &plan.destination, inputs, outputs);
            }
            Action::GotoDest => self.send(SubtaskVerb::GotoDest, &plan.destination, inputs, outputs),
            Action::GotoEndpt => self.send(SubtaskVerb::GotoEndpt, &plan.end_at, inputs, outputs),
            Action::Position => self.send(SubtaskVerb::Position, &plan.position_site(), inputs, outputs),
            Action::Release => self.send(SubtaskVerb::Release, &plan.source, inputs, outputs),
            Action::InsertTool => self.send_tool(SubtaskVerb::InsertTool, inputs, outputs),
            Action::ReleaseTool => self.send_tool(SubtaskVerb::ReleaseTool, inputs, outputs),
            Action::AcquireTool => self.send_tool(SubtaskVerb::AcquireTool, inputs, outputs),
            Action::RemoveTool => self.send_tool(SubtaskVerb::RemoveTool, inputs, outputs),
            Action::Abort => ledger.reconfigure(DataBaseVerb::Abort, inputs.tick, outputs),
            Action::Initiate => ledger.reconfigure(DataBaseVerb::Initiate, inputs.tick, outputs),
            Action::Startup => ledger.reconfigure(DataBaseVerb::Startup, inputs.tick, outputs),
            Action::Disconnect => ledger.disconnect(inputs.tick, outputs),
            Action::Connect => {
                ledger.connected = true;
                self.state.execution.finish();
            }
            Action::ConnectAndTell => {
                ledger.connected = true;
                ledger.tell_owed(inputs.tick, outputs);
            }
            Action::TellOwed => ledger.tell_owed(inputs.tick, outputs),
            Action::AskAgain => ledger.ask_again(inputs.tick, outputs),
            Action::Update => ledger.tell(&plan, in_hand, inputs.tick, outputs),
            Action::UpdateAndGotoEndpt => {
                ledger.tell(&plan, in_hand, inputs.tick, outputs);
                self.send(SubtaskVerb::GotoEndpt, &plan.end_at, inputs, outputs);
            }
            Action::Finish => self.state.execution.finish(),
            Action::Fail(reason) => self.state.execution.fail(reason),
            Action::PassUp => {
                self.state.execution.pass_up(situation.subtask, below.reason);
            }
        }
    }

    /// A command to Subtask for the object of the plan at one of its locations.
    fn send(
        &mut self,
        verb: SubtaskVerb,
        site: &Site,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut TaskOutputs,
    ) {
        let plan = &self.state.plan;
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
    }

    /// A tool command to Subtask, which names the location itself. A tool that the command does not name is
    /// the one that is held.
    fn send_tool(&mut self, verb: SubtaskVerb, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let (grip, parameters) = self.state.plan.tool_grip();
        self.send(verb, &Site { parameters, ..Site::default() }, inputs, outputs);
        (outputs.subtask.source_grip, outputs.subtask.destination_grip) = (grip, grip);
        if outputs.subtask.object.is_empty() {
            outputs.subtask.object = inputs.memory.subtask.status.held_object;
        }
    }

    /// The operator has taken the robot: what was being done ends, and S-PAUSE passes the control on (V.4.1
    /// PAUSE).
    pub(super) fn yield_to_operator(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let execution = &mut self.state.execution;
        match execution.outcome {
            Outcome::Executing => {
                execution.outcome = Outcome::Joystick;
                execution.reason = Reason::JoystickOn;
            }
            Outcome::Done => execution.outcome = Outcome::Idle,
            Outcome::Idle | Outcome::Error | Outcome::Joystick => {}
        }
        self.send(SubtaskVerb::Pause, &Site::default(), inputs, outputs);
    }

    /// Write the status to the HWSC.
    pub(super) fn report(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let execution = &self.state.execution;
        let (report, reason) = match (self.state.watch, execution.outcome) {
            (Watch::Manual, _) => (HwsReport::JoystickOn, Reason::JoystickOn),
            (Watch::Free, Outcome::Idle) => (HwsReport::Idle, execution.reason),
            (Watch::Free, Outcome::Executing) => (HwsReport::Executing, execution.reason),
            (Watch::Free, Outcome::Done) => (HwsReport::Finished, execution.reason),
            (Watch::Free, Outcome::Error | Outcome::Joystick) => (HwsReport::Error, execution.reason),
        };
        outputs.header = execution.header(inputs.tick);
        outputs.status =
            HwsStatus { echo: execution.receiver.echo, command: inputs.external.hws.command, report, reason };
    }
}
