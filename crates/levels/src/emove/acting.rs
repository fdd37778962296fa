//! Postprocess of E-move: commands to Prim, Grip, Quick Change and vision, and the status to Subtask.

use rcs_core::{
    frame::Frame,
    interface::{
        EmoveOutputs, Reason,
        device::Picture,
        emove::{EmoveCommand, EmoveStatus, EmoveVerb},
        grip::{GripCommand, GripVerb},
        prim::{PrimCommand, PrimVerb},
        quick_change::{QuickChangeCommand, QuickChangeVerb},
    },
    name::{Name10, Name16},
    pose::Pose,
    process::Inputs,
};
use taskdata::files::{EndEffId, EndEffPara, MovtabId, TaskData, TrajParaId};

use super::{
    Emove, Slot,
    locate::{centred, looked_at, part_frame, request, view_of},
    route::{Ahead, FULL_OPENING, LegGoal},
    sensing::present_frame,
    state::{Held, Located, Sort, Stance},
    tables::{Action, Situation},
};
use crate::places::place_of;

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
        let parameters = inputs.data.end_eff(EndEffId::new(command.object_parameters));
        match action {
            Action::Wait => {}
            Action::RobotInit => self.send_prim(PrimVerb::RobotInit, inputs, outputs),
            Action::Pause => self.pause_all(command, inputs, outputs),
            Action::GoThru | Action::GotoPt => self.send_leg(situation, inputs, outputs),
            Action::Open => {
                self.state.route.opening_sent = true;
                let opening = self.state.route.opening;
                self.send_grip(GripVerb::Position, opening, 0, inputs, outputs);
            }
            Action::Close => {
                let (size, force) = parameters.map_or((0, 0), |p| (p.grasp_size, p.grasp_force));
                self.send_grip(GripVerb::CloseGrip, size, force, inputs, outputs);
            }
            Action::OpenToDepart => {
                let held = inputs.data.end_eff(self.state.held.parameters);
                let opening = held.or(parameters).map_or(FULL_OPENING, |p: &EndEffPara| p.depart_size);
                self.send_grip(GripVerb::OpenGrip, opening, 0, inputs, outputs);
            }
            Action::Arrive => self.arrive(command, outputs),
            Action::Grasped => self.grasped(command, parameters),
            Action::Released => {
                self.state.held = Held::default();
                self.state.execution.finish();
            }
            Action::Flood | Action::FloodAgain => {
                self.take_picture(Picture::FastFlood, action, command, inputs, outputs)
            }
            Action::Precise | Action::PreciseAgain => {
                self.take_picture(Picture::Precise, action, command, inputs, outputs);
            }
            Action::Centre | Action::Align => self.move_camera(action, command, inputs, outputs),
            Action::Located => {
                self.settle(command, Sort::View, outputs);
                self.state.execution.finish();
            }
            Action::Finish => self.state.execution.finish(),
            Action::Fail(reason) => self.fail(reason, inputs, outputs),
            Action::FailGrip => {
                let below = inputs.memory.grip.status.reason;
                let reason = if below == Reason::None { Reason::NeighbourLost } else { below };
                self.fail(reason, inputs, outputs);
            }
            Action::PassUp => {
                self.state.execution.pass_up(situation.prim, inputs.memory.prim.status.reason);
            }
        }
    }

    /// Stop the robot and report an error.
    fn fail(&mut self, reason: Reason, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        self.stop_prim(inputs, outputs);
        self.state.execution.fail(reason);
    }

    /// PAUSE to Prim: ramp down and hold.
    pub(super) fn stop_prim(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        self.send_prim(PrimVerb::Pause, inputs, outputs);
    }

    fn pause_all(
        &mut self,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        self.state.searched = 0;
        self.send_prim(PrimVerb::Pause, inputs, outputs);
        self.send_grip(GripVerb::Pause, 0, 0, inputs, outputs);
        outputs.grip.end_effector_id = command.end_effector_id;
        outputs.quick_change = QuickChangeCommand {
            number: self.state.quick_change.send(inputs.tick),
            command: QuickChangeVerb::Pause,
        };
    }

    /// A command to Prim that names no goal.
    fn send_prim(&mut self, verb: PrimVerb, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
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

    fn send_grip(
        &mut self,
        verb: GripVerb,
        position: i32,
        force: i32,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        outputs.grip = GripCommand {
            number: self.state.grip.send(inputs.tick),
            command: verb,
            force,
            position,
            velocity: 0,
            end_effector_id: inputs.memory.quick_change.status.end_effector_id,
        };
    }

    /// The robot is at the goal of the current command.
    fn arrive(&mut self, command: &EmoveCommand, outputs: &EmoveOutputs) {
        let sort = match command.command {
            EmoveVerb::MovToObj | EmoveVerb::MovObjTo => Sort::Object,
            EmoveVerb::MovToVu | EmoveVerb::LocateObj => Sort::View,
            EmoveVerb::None
            | EmoveVerb::Pause
            | EmoveVerb::MovToLoc
            | EmoveVerb::GraspObj
            | EmoveVerb::Release
            | EmoveVerb::MovToHol
            | EmoveVerb::QcDetach
            | EmoveVerb::QcAttach
            | EmoveVerb::Withdraw
            | EmoveVerb::InsertTool
            | EmoveVerb::ReleaseTool
            | EmoveVerb::AcquireTool
            | EmoveVerb::RemoveTool => Sort::Location,
        };
        self.settle(command, sort, outputs);
        self.state.execution.finish();
    }

    /// The robot has come to rest at the goal record: remember where that is.
    fn settle(&mut self, command: &EmoveCommand, sort: Sort, outputs: &EmoveOutputs) {
        let [_, goal, ..] = outputs.poses;
        self.state.stance = Stance {
            known: true,
            sort,
            location: command.location,
            kind: command.location_kind,
            record: command.location_record,
            array: command.location_array,
            object: command.object,
            grip: command.grip,
            pose: goal.pose,
        };
    }

    fn grasped(&mut self, command: &EmoveCommand, parameters: Option<&EndEffPara>) {
        self.state.held = Held {
            object: command.object,
            parameters: EndEffId::new(command.object_parameters),
            grasp_size: parameters.map_or(0, |p| p.grasp_size),
        };
        self.state.located = Located::default();
        self.state.execution.finish();
    }

    fn take_picture(
        &mut self,
        picture: Picture,
        action: Action,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let again = matches!(action, Action::FloodAgain | Action::PreciseAgain);
        self.state.tries = if again { self.state.tries.saturating_add(1) } else { 0 };
        match action {
            Action::Flood => self.state.located = Located::default(),
            Action::Precise => self.settle(command, Sort::View, outputs),
            _ => {}
        }
        let Some(view) = view_of(command, inputs.data) else {
            return self.fail(Reason::BadRecord, inputs, outputs);
        };
        outputs.vision = request(self.state.vision.send(inputs.tick), picture, self.state.tries, view);
    }

    /// Move the camera over the centroid, and for [`Action::Align`] turn it with the part.
    fn move_camera(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        let found = view_of(command, inputs.data).zip(present_frame(inputs.memory));
        let approach = inputs.data.view_approach(&command.object, command.grip, &place);
        let parameters = approach.and_then(|path| Some(inputs.data.path(path).last()?.para));
        let (Some((view, tool)), Some(parameters)) = (found, parameters) else {
            return self.fail(Reason::BadRecord, inputs, outputs);
        };
        let seen = &inputs.external.devices.vision;
        let middle = looked_at(&tool, view.movetable, inputs.data);
        let target: Frame = if action == Action::Align {
            let part = part_frame(&middle, seen);
            let pose = Pose::from_frame(&part);
            self.publish(Slot::Located, pose, outputs);
            self.state.located = Located {
                object: command.object,
                record: command.location_record,
                array: command.location_array,
                pose,
            };
            part
        } else {
            centred(&middle, seen)
        };
        let goal = Pose::from_frame(&inputs.data.moved(&target, view.movetable));
        let record = self.publish(Slot::Goal, goal, outputs);
        self.send_prim(PrimVerb::GotoPt, inputs, outputs);
        outputs.prim.pose = record;
        outputs.prim.trajectory_parameters = parameters.number();
    }

    /// Write the status to Subtask.
    pub(super) fn report(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        let state = &self.state;
        outputs.header = state.execution.header(inputs.tick);
        outputs.status = EmoveStatus {
            echo: state.execution.receiver.echo,
            report: state.execution.report(),
            reason: state.execution.reason,
            reference_pose: inputs.memory.prim.status.sensor_pose,
            object_held: !state.held.object.is_empty(),
            end_effector_id: inputs.memory.quick_change.status.end_effector_id,
            held_object: if state.held.object.is_empty() { Name16::EMPTY } else { state.held.object },
            at: if state.stance.known { state.stance.location } else { Name10::EMPTY },
        };
    }
}
