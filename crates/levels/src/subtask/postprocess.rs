use interfaces::{
    ChangingPose, Reason, StatusReport, SubtaskOutputs, Unconfirmed,
    emove::{EmoveCommand, EmoveVerb},
    pedestal::{PedestalCommand, PedestalReport, PedestalVerb},
    pose_range,
    process::Inputs,
    subtask::{Regrip, SubtaskStatus, SubtaskVerb},
};
use taskdata::files::TaskData;

use super::{
    aims::SubtaskAim,
    manual,
    pedestal_hand::{pedestal_hand, turned},
    preprocess::location_pose,
    state::State,
    tables::{Action, Flip, PedestalLoad, StateVariables, SubtaskHolster, SubtaskPedestal, SubtaskRecipient},
};
use crate::execution::Outcome;

impl State {
    pub(super) fn act(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut SubtaskOutputs,
    ) {
        let command = &inputs.memory.task.subtask;
        let (own, aims) = (SubtaskAim::of_command(command), self.aims);
        let ped = self.ped_para;
        let both = action == Action::Pause && self.pause_pedestal(seen, inputs, outputs);
        if action == Action::PedGrip {
            self.give(command);
        }
        let mut send = |verb, aim: &SubtaskAim| {
            let number = self.emove.send(inputs.tick);
            self.ordered = if both { SubtaskRecipient::Both } else { SubtaskRecipient::Emove };
            outputs.emove = EmoveCommand { number, ..aim.command(verb, inputs.data) };
        };
        match action {
            Action::Wait => {}
            Action::Pause => send(EmoveVerb::Pause, &own),
            Action::MovToVu => send(EmoveVerb::MovToVu, &own),
            Action::LocateObj => {
                self.located_at = location_pose(command, inputs);
                send(EmoveVerb::LocateObj, &own);
            }
            Action::MovToObj => {
                self.gone_to = location_pose(command, inputs);
                send(EmoveVerb::MovToObj, &own);
            }
            Action::GraspObj => send(EmoveVerb::GraspObj, &own),
            Action::GraspAgain => {
                let held = own.as_held(&inputs.memory.emove.status.held, inputs.data);
                send(EmoveVerb::GraspObj, &held);
            }
            Action::MovObjTo => {
                self.gone_to = location_pose(command, inputs);
                send(EmoveVerb::MovObjTo, &own);
            }
            Action::MovToLoc => send(EmoveVerb::MovToLoc, &own),
            Action::Release => send(EmoveVerb::Release, &own),
            Action::MovToHol(SubtaskHolster::Own) => send(EmoveVerb::MovToHol, &aims.first),
            Action::MovToHol(SubtaskHolster::Wanted) => send(EmoveVerb::MovToHol, &aims.second),
            Action::QcDetach => send(EmoveVerb::QcDetach, &aims.first),
            Action::QcAttach => send(EmoveVerb::QcAttach, &aims.second),
            Action::MovObjToPed => send(EmoveVerb::MovObjTo, &aims.first),
            Action::ReleaseAtPed => send(EmoveVerb::Release, &aims.first),
            Action::MovToPedSafe => send(EmoveVerb::MovToLoc, &aims.second),
            Action::MovToObjAtPed => send(EmoveVerb::MovToObj, &aims.third),
            Action::GraspObjAtPed => send(EmoveVerb::GraspObj, &aims.third),
            Action::InsertTool => send(EmoveVerb::InsertTool, &aims.first),
            Action::ReleaseTool => send(EmoveVerb::ReleaseTool, &aims.first),
            Action::AcquireTool => send(EmoveVerb::AcquireTool, &aims.first),
            Action::RemoveTool => send(EmoveVerb::RemoveTool, &aims.first),
            Action::PedPreGrip => {
                self.command_pedestal(PedestalVerb::PreGrip, ped.appr, 0, ped.table_pos, inputs, outputs);
            }
            Action::PedGrip => {
                self.command_pedestal(PedestalVerb::Grip, ped.grasp_size, ped.force, 0, inputs, outputs);
            }
            Action::PedFlip(flip) => {
                let position = inputs.memory.pedestal.status.table_position.unwrap_or(ped.table_pos);
                let angle = match flip {
                    Flip::Whole => ped.flip_angle,
                    Flip::Rest => turned(&ped).saturating_sub(position),
                };
                self.command_pedestal(PedestalVerb::Flip, 0, 0, angle, inputs, outputs);
            }
            Action::PedRelease => {
                self.command_pedestal(PedestalVerb::Release, ped.release_size, 0, 0, inputs, outputs);
            }
            Action::Finish => self.execution.finish(),
            Action::Fail(reason) => self.execution.fail(reason),
            Action::PassUp => {
                self.execution.pass_up(seen.subordinates.emove, inputs.memory.emove.status.reason);
            }
            Action::PassUpPedestal(reason) => {
                // The reason of hand or table is more specific than a general error.
                let below = &inputs.memory.pedestal.status;
                let failed = matches!(below.report, PedestalReport::CannotDo | PedestalReport::Error);
                let known = failed && below.reason != Reason::None && reason != Reason::PedestalSilent;
                self.execution.fail(if known { below.reason } else { reason });
            }
        }
    }

    /// Opening in 0.01 in, force in lb, angle in 0.1 degree.
    fn command_pedestal(
        &mut self,
        verb: PedestalVerb,
        grasp_size: i32,
        grasp_force: i32,
        table_angle: i32,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut SubtaskOutputs,
    ) {
        self.ordered = SubtaskRecipient::Pedestal;
        outputs.pedestal = PedestalCommand {
            cycle: inputs.tick,
            number: self.pedestal.send(inputs.tick),
            command: verb,
            grasp_size,
            grasp_force,
            table_angle,
        };
    }

    /// A manual order does not affect the current command.
    pub(super) fn command_manually(
        &mut self,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut SubtaskOutputs,
    ) {
        let Some(order) = &inputs.external.operator.pedestal else { return };
        let regrip = self.regrip.map(|regrip| regrip.object);
        let command = manual::command(order, regrip.as_ref(), inputs.data);
        if order.command == PedestalVerb::Grip {
            self.regrip = order.object.map(|object| Regrip { object });
        }
        let number = self.pedestal.send(inputs.tick);
        outputs.pedestal = PedestalCommand { cycle: inputs.tick, number, ..command };
    }

    /// A PAUSE is not sent after a PAUSE, or before the first command. True if Subtask has to wait for the pedestal.
    fn pause_pedestal(
        &mut self,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut SubtaskOutputs,
    ) -> bool {
        match outputs.pedestal.command {
            PedestalVerb::None => false,
            PedestalVerb::Pause => seen.subordinates.pedestal == SubtaskPedestal::Moving,
            PedestalVerb::PreGrip | PedestalVerb::Grip | PedestalVerb::Flip | PedestalVerb::Release => {
                self.command_pedestal(PedestalVerb::Pause, 0, 0, 0, inputs, outputs);
                true
            }
        }
    }

    pub(super) fn publish_poses(&mut self, outputs: &mut SubtaskOutputs) {
        let aims = &mut self.aims;
        for ((slot, pose), aim) in
            outputs.poses.iter_mut().zip(&aims.poses).zip([&mut aims.first, &mut aims.second])
        {
            if aim.site.name().is_some() {
                self.last_pose = pose_range::next(pose_range::SUBTASK, self.last_pose);
                aim.pose = Some(self.last_pose);
                *slot = ChangingPose { number: aim.pose, pose: *pose };
            }
        }
        aims.third.pose = aims.first.pose;
    }

    pub(super) fn report(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut SubtaskOutputs) {
        let execution = &self.execution;
        let below = &inputs.memory.emove.status;
        let pauses = inputs.memory.task.subtask.command == SubtaskVerb::Pause;
        let ended = execution.report(pauses.then_some(below.reason));
        // The operator can take the robot at any time, also between two commands (V.4.1 PAUSE).
        let (report, reason) = if below.report == StatusReport::JoystickOn {
            (StatusReport::JoystickOn, Reason::JoystickOn)
        } else if execution.outcome == Outcome::Joystick {
            (StatusReport::Error, Reason::JoystickOn)
        } else {
            (ended.outcome.report(), ended.reason)
        };
        outputs.header = execution.rows.header(inputs.tick, self.step.text());
        outputs.status = SubtaskStatus {
            echo: execution.receiver.echo,
            report,
            reason,
            unconfirmed: if report == StatusReport::Done { ended.unconfirmed } else { Unconfirmed::None },
            reference_pose: below.reference_pose,
            held: below.held,
            seat: below.seat,
            placed: below.placed,
            end_effector_id: below.end_effector_id,
            pins: below.pins,
            at: below.at,
            offset: below.offset,
            drum: below.drum,
            pedestal_part: pedestal_hand(&inputs.memory.pedestal.status) != PedestalLoad::Free,
        };
        outputs.regrip = self.regrip;
    }
}
