use interfaces::{
    ChangingPose, Reason, TaskOutputs, Unconfirmed,
    data_base::DataBaseVerb,
    hws::{HwsReport, HwsStatus},
    pose_range,
    process::Inputs,
    subtask::{SubtaskCommand, SubtaskVerb},
};
use taskdata::files::TaskData;

use super::{
    data_system::DataSystem,
    ledger::opened,
    plan::{Plan, PlanSite, TaskVerb},
    state::State,
    tables::{Action, StateVariables, Takeover, TaskRecipient, joystick::Control, load::LoadEvent},
};
use crate::{
    execution::{Outcome, Report},
    held::Held,
};

impl State {
    /// The poses of an accepted command get new record numbers: T-POSE-1 source, T-POSE-2 destination, T-POSE-3 end-at.
    pub(super) fn begin(
        &mut self,
        plan: &Plan,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut TaskOutputs,
    ) {
        self.plan = *plan;
        outputs.ledger = opened(outputs.ledger, &inputs.external.hws, plan);
        if plan.is_about_something() {
            self.data_system.accept(plan, &inputs.memory.subtask.status);
        }
        let sites = [&mut self.plan.source, &mut self.plan.destination, &mut self.plan.end_at];
        for (slot, site) in outputs.poses.iter_mut().zip(sites) {
            self.last_pose = pose_range::next(pose_range::TASK, self.last_pose);
            *slot = ChangingPose { number: Some(self.last_pose), ..ChangingPose::default() };
            if let Some(location) = &mut site.location {
                slot.pose = location.pose.pose;
                location.pose = *slot;
            }
        }
    }
    pub(super) fn take_over(
        &mut self,
        takeover: Takeover,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut TaskOutputs,
    ) {
        match takeover {
            Takeover::None | Takeover::Refuse | Takeover::Resume => return,
            Takeover::Clear => self.execution.outcome = Outcome::Idle,
            Takeover::Interrupt | Takeover::Pause => {}
        }
        self.send(SubtaskVerb::Pause, &PlanSite::default(), inputs, outputs);
    }

    pub(super) fn act(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut TaskOutputs,
    ) {
        let (plan, tick) = (self.plan, inputs.tick);
        match action {
            Action::Wait => {}
            Action::Pause => self.send(SubtaskVerb::Pause, &PlanSite::default(), inputs, outputs),
            Action::GetEndeff => self.send(SubtaskVerb::GetEndeff, &plan.source, inputs, outputs),
            Action::GetObject => self.send(SubtaskVerb::GetObject, &plan.source, inputs, outputs),
            Action::FixGrip => self.send(SubtaskVerb::FixGrip, &plan.source, inputs, outputs),
            Action::PlaceObj => self.send(SubtaskVerb::PlaceObj, &plan.destination, inputs, outputs),
            Action::MoveObjToDest => {
                self.send(SubtaskVerb::MoveObjToDest, &plan.destination, inputs, outputs);
            }
            Action::GotoDest => self.send(SubtaskVerb::GotoDest, &plan.destination, inputs, outputs),
            Action::GotoEndpt => self.send(SubtaskVerb::GotoEndpt, &plan.end_at, inputs, outputs),
            Action::Position => self.send(SubtaskVerb::Position, plan.position_site(), inputs, outputs),
            Action::Return => {
                self.send(SubtaskVerb::Position, &plan.destination, inputs, outputs);
                // >POSITION uses the grip of the source first (SPECNOTES.md, contradiction 24).
                outputs.subtask.source_grip = plan.destination.grip;
            }
            Action::Release => self.send(SubtaskVerb::Release, &plan.source, inputs, outputs),
            Action::InsertTool => self.send_tool(SubtaskVerb::InsertTool, inputs, outputs),
            Action::ReleaseTool => self.send_tool(SubtaskVerb::ReleaseTool, inputs, outputs),
            Action::AcquireTool => self.send_tool(SubtaskVerb::AcquireTool, inputs, outputs),
            Action::RemoveTool => self.send_tool(SubtaskVerb::RemoveTool, inputs, outputs),
            Action::Abort => self.order().reconfigure(DataBaseVerb::Abort, tick, outputs),
            Action::Initiate => self.order().reconfigure(DataBaseVerb::Initiate, tick, outputs),
            Action::Startup => self.order().reconfigure(DataBaseVerb::Startup, tick, outputs),
            Action::Disconnect => self.order().disconnect(tick, outputs),
            Action::Connect => {
                self.data_system.connect();
                self.finish(inputs, outputs);
            }
            Action::ConnectAndSend => {
                self.data_system.connect();
                self.order().send_pending(tick, outputs);
            }
            Action::SendPending => self.order().send_pending(tick, outputs),
            Action::SendAgain => self.order().send_again(tick, outputs),
            Action::Update => self.report_item(inputs, outputs),
            Action::UpdateAndGotoEndpt => {
                self.report_item(inputs, outputs);
                self.send(SubtaskVerb::GotoEndpt, &plan.end_at, inputs, outputs);
            }
            Action::SendPendingAndPosition => {
                self.data_system.send_pending(tick, outputs);
                self.send(SubtaskVerb::Position, plan.position_site(), inputs, outputs);
            }
            Action::AwaitUpdate => self.ordered = TaskRecipient::DataSystem,
            Action::Finish => self.finish(inputs, outputs),
            Action::Fail(reason) => self.execution.fail(reason),
            Action::PassUp => {
                self.execution.pass_up(seen.subordinates.subtask, inputs.memory.subtask.status.reason);
            }
        }
    }

    fn finish(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let plan = self.plan;
        let held = Held::of(inputs.memory.subtask.status.held, plan.object);
        self.data_system.carry(LoadEvent::Finish, &plan, held);
        if self.is_in_ledger(outputs) {
            outputs.ledger = None;
            self.data_system.updates.taking = None;
        }
        self.execution.finish();
    }
    const fn is_in_ledger(&self, outputs: &TaskOutputs) -> bool {
        self.plan.is_about_something() && outputs.ledger.is_some()
    }

    const fn order(&mut self) -> &mut DataSystem {
        self.ordered = TaskRecipient::DataSystem;
        &mut self.data_system
    }

    fn report_item(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let held = Held::of(inputs.memory.subtask.status.held, self.plan.object);
        self.plan.update_due = false;
        if let Some(ledger) = &mut outputs.ledger {
            ledger.reported = true;
        }
        let plan = self.plan;
        self.order().report_item(&plan, held, inputs.tick, outputs);
    }

    fn send(
        &mut self,
        verb: SubtaskVerb,
        site: &PlanSite,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut TaskOutputs,
    ) {
        self.ordered = TaskRecipient::Subtask;
        let about = self.plan.is_about_something() && verb != SubtaskVerb::Pause;
        if let Some(ledger) = outputs.ledger.as_mut().filter(|_| about) {
            ledger.last = verb;
        }
        let (plan, location) = (&self.plan, site.location.unwrap_or_default());
        outputs.subtask = SubtaskCommand {
            number: self.subtask.send(inputs.tick),
            command: verb,
            object: plan.object,
            end_effector_id: plan.end_effector_id,
            source_grip: plan.source.grip,
            destination_grip: plan.destination.grip,
            object_parameters: site.parameters,
            site: location.site,
            pose: location.pose.number,
        };
    }

    /// Subtask names the location of a tool command itself. A command without a tool means the held one.
    fn send_tool(&mut self, verb: SubtaskVerb, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let PlanSite { grip, parameters, .. } = *self.plan.tool_site();
        self.send(verb, &PlanSite { location: None, grip, parameters }, inputs, outputs);
        (outputs.subtask.source_grip, outputs.subtask.destination_grip) = (grip, grip);
        if self.plan.object.is_none() {
            outputs.subtask.object = inputs.memory.subtask.status.held.object();
        }
    }

    pub(super) fn report(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) {
        let execution = &self.execution;
        let pauses = self.plan.verb == TaskVerb::Pause;
        let Report { outcome, reason, unconfirmed } =
            execution.report(pauses.then_some(inputs.memory.subtask.status.reason));
        let (report, reason) = match (self.control, outcome) {
            (Control::Manual, _) => (HwsReport::JoystickOn, Reason::JoystickOn),
            (Control::Automatic, Outcome::Idle) => (HwsReport::Idle, reason),
            (Control::Automatic, Outcome::Executing) => (HwsReport::Executing, reason),
            (Control::Automatic, Outcome::Done) => (HwsReport::Finished, reason),
            (Control::Automatic, Outcome::Error | Outcome::Joystick) => (HwsReport::Error, reason),
        };
        let executing = Some(self.plan.verb).filter(|_| execution.outcome == Outcome::Executing);
        outputs.connection = self.data_system.connection(executing);
        outputs.updates = self.data_system.updates;
        outputs.header = execution.rows.header(inputs.tick, self.step.text());
        let finished = report == HwsReport::Finished;
        outputs.status = HwsStatus {
            echo: execution.receiver.echo,
            command: inputs.external.hws.command,
            report,
            reason,
            unconfirmed: if finished { unconfirmed } else { Unconfirmed::None },
        };
    }
}
