//! Postprocess of E-move: commands to Prim, the gripper and Quick Change, and the status to Subtask.

use rcs_core::{
    handshake::Lower,
    interface::{
        EmoveOutputs, Reason, Report,
        device::Picture,
        emove::{EmoveCommand, EmoveStatus},
        prim::{PrimCommand, PrimReport, PrimVerb},
        quick_change::{QuickChangeCommand, QuickChangeReport, QuickChangeVerb},
    },
    name::{Name10, Name16},
    pose::Pose,
    process::Inputs,
};
use taskdata::files::{MovtabId, TaskData, TrajParaId};

use super::{
    Emove, Slot,
    gripper::{Gripper, Order, Request},
    route::{Ahead, LegGoal},
    state::Sort,
    tables::{Action, Situation},
};
use crate::old_execution::Outcome;

impl Emove {
    /// Set the outputs that a row asks for.
    pub(super) fn act(
        &mut self,
        action: Action,
        situation: &Situation,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        match action {
            Action::Wait => {}
            Action::RobotInit => self.send_prim(PrimVerb::RobotInit, inputs, outputs),
            Action::Pause => self.pause_all(inputs, outputs),
            Action::Manual => {
                self.state.searched = 0;
                self.state.execution.pass_up(Lower::Joystick, Reason::JoystickOn);
            }
            Action::GoThru | Action::GotoPt => self.send_leg(situation, inputs, outputs),
            Action::DeltaMove(by) => self.send_relative(PrimVerb::DeltaMove, by, command, inputs, outputs),
            Action::GoUntil(by) => self.send_relative(PrimVerb::GoUntil, by, command, inputs, outputs),
            Action::GoWhile(by) => self.send_relative(PrimVerb::GoWhile, by, command, inputs, outputs),
            Action::CalSensor => self.send_prim(PrimVerb::CalSensor, inputs, outputs),
            Action::Lock => self.send_quick_change(QuickChangeVerb::Lock, inputs, outputs),
            Action::Unlock => self.send_quick_change(QuickChangeVerb::Unlock, inputs, outputs),
            Action::Open
            | Action::OpenToApproach
            | Action::CloseForHolster
            | Action::Close
            | Action::OpenToDepart
            | Action::Calibrate
            | Action::OpenByHand
            | Action::CloseByHand => self.order(action, command, inputs, outputs),
            Action::Arrive => self.arrive(command, outputs),
            Action::Stand => self.stand(Sort::Location, command, inputs),
            Action::StandInDrum => self.stand(Sort::Drum, command, inputs),
            Action::Grasped => self.grasped(command, inputs),
            Action::Acquired => {
                self.grasped(command, inputs);
                self.stand(Sort::Drum, command, inputs);
            }
            Action::Flood | Action::FloodAgain => {
                self.take_picture(Picture::FastFlood, action, command, inputs, outputs);
            }
            Action::Precise | Action::PreciseAgain => {
                self.take_picture(Picture::Precise, action, command, inputs, outputs);
            }
            Action::Centre | Action::Align => self.move_camera(action, command, inputs, outputs),
            Action::Located => self.arrive(command, outputs),
            Action::Finish => self.finish(),
            Action::Fail(reason) => self.fail(reason, inputs, outputs),
            Action::FailLost => {
                let reason = if self.state.gripper_gone { Reason::GripperGone } else { Reason::ObjectLost };
                self.fail(reason, inputs, outputs);
            }
            Action::FailGrip => {
                let reason = self.state.grippers.fault(inputs.tick, inputs.memory);
                self.fail(reason, inputs, outputs);
            }
            Action::FailRing => self.fail(self.ring_fault(inputs), inputs, outputs),
            Action::PassUp => {
                self.state.execution.pass_up(situation.prim, inputs.memory.prim.status.reason);
            }
        }
    }

    /// Report done.
    pub(super) fn finish(&mut self) {
        self.state.execution.reason = Reason::None;
        self.state.execution.finish();
    }

    /// Stop the robot and report an error.
    pub(super) fn fail(
        &mut self,
        reason: Reason,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        self.stop_prim(inputs, outputs);
        self.state.execution.fail(reason);
    }

    /// What is wrong with the quick change.
    fn ring_fault(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Reason {
        let ring = &inputs.memory.quick_change;
        let lower = ring.status.report.lower();
        if self.state.quick_change.read(inputs.tick, &ring.header, ring.status.echo, lower) == Lower::Lost {
            return Reason::NeighbourLost;
        }
        match ring.status.report {
            QuickChangeReport::Stuck => Reason::QuickChangeStuck,
            QuickChangeReport::Idle
            | QuickChangeReport::Executing
            | QuickChangeReport::Locked
            | QuickChangeReport::Unlocked
            | QuickChangeReport::SensorMalfunction => Reason::QuickChangeFault,
        }
    }

    /// PAUSE to Prim: ramp down and hold.
    pub(super) fn stop_prim(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        self.send_prim(PrimVerb::Pause, inputs, outputs);
    }

    fn pause_all(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        self.state.searched = 0;
        self.stop_prim(inputs, outputs);
        let request = Request { order: Order::Pause, ..Request::default() };
        self.state.grippers.send(request, inputs.tick, inputs.memory, outputs);
        self.send_quick_change(QuickChangeVerb::Pause, inputs, outputs);
    }

    fn send_quick_change(
        &mut self,
        verb: QuickChangeVerb,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        outputs.quick_change =
            QuickChangeCommand { number: self.state.quick_change.send(inputs.tick), command: verb };
    }

    /// A command to Prim that names no goal.
    pub(super) fn send_prim(
        &mut self,
        verb: PrimVerb,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        outputs.prim = PrimCommand {
            number: self.state.prim.send(inputs.tick),
            command: verb,
            sensor: Name10::EMPTY,
            pose: 0,
            movetable: MovtabId::NULL.number(),
            trajectory_parameters: TrajParaId::NULL.number(),
            end_effector_id: inputs.memory.quick_change.status.end_effector_id,
        };
    }

    /// GO-THRU or GOTO-PT with the next point of the route.
    fn send_leg(
        &mut self,
        situation: &Situation,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let [departure, ..] = outputs.poses;
        let leg = departure.pose.to_frame().ok().and_then(|from| self.state.route.leg(&from, inputs.data));
        let Some(leg) = leg else {
            return self.fail(Reason::BadRecord, inputs, outputs);
        };
        let (pose, movetable) = match leg.at {
            LegGoal::Record { pose, movetable } => (pose, movetable),
            LegGoal::Computed(frame) => (self.publish(Slot::Between, Pose::from_frame(&frame), outputs), 0),
        };
        let verb = if situation.ahead == Ahead::Through { PrimVerb::GoThru } else { PrimVerb::GotoPt };
        self.send_prim(verb, inputs, outputs);
        outputs.prim.pose = pose;
        outputs.prim.movetable = movetable;
        outputs.prim.trajectory_parameters = leg.parameters.number();
        self.state.route.advance(inputs.data);
        self.state.stance.known = false;
    }

    /// Give the attached gripper the order that an action stands for.
    fn order(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let request = self.request(action, command, inputs);
        self.state.route.opening_sent |= action == Action::Open;
        self.state.grippers.send(request, inputs.tick, inputs.memory, outputs);
    }

    /// `status-report` and its reason. `joystick-on` lasts as long as the box is active (V.2.2), whatever was
    /// done before; a command that was given up for it ends in an error and is not resumed
    /// (docs/design/ownership.md "Joystick box").
    fn outcome(&self, inputs: &Inputs<'_, TaskData<'_>>) -> (Report, Reason) {
        let execution = &self.state.execution;
        let prim = &inputs.memory.prim;
        let taken =
            prim.status.report == PrimReport::JoystickOn && prim.header.stamp == inputs.tick.previous();
        match (taken, execution.outcome) {
            (true, Outcome::Done | Outcome::Joystick) => (Report::JoystickOn, Reason::JoystickOn),
            (false, Outcome::Joystick) => (Report::Error, Reason::JoystickOn),
            _ => (execution.report(), execution.reason),
        }
    }

    /// Write the status to Subtask and the flags of the gripper processes.
    pub(super) fn report(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        let state = &self.state;
        let (report, reason) = self.outcome(inputs);
        outputs.header = state.execution.header(inputs.tick);
        outputs.dormant = Gripper::attached(inputs.memory).dormancy();
        outputs.status = EmoveStatus {
            echo: state.execution.receiver.echo,
            report,
            reason,
            reference_pose: inputs.memory.prim.status.sensor_pose,
            object_held: !state.held.object.is_empty(),
            end_effector_id: inputs.memory.quick_change.status.end_effector_id,
            held_object: if state.held.object.is_empty() { Name16::EMPTY } else { state.held.object },
            at: if state.stance.known { state.stance.location } else { Name10::EMPTY },
        };
    }
}
