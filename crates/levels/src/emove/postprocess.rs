//! Postprocess of E-move: commands to Prim, the gripper and Quick Change, and the status to Subtask.

use geometry::pose::Pose;
use interfaces::{
    ChangingPose, EmoveOutputs, Reason, StatusReport, Unconfirmed,
    device::Picture,
    emove::{EmoveCommand, EmoveStatus, EmoveVerb, GoneTo, Located, LocatedObject, Offset, Pins},
    pose_range,
    prim::{PrimCommand, PrimReport, PrimVerb},
    process::Inputs,
    quick_change::{QuickChangeCommand, QuickChangeReport, QuickChangeVerb},
};
use rcs_core::handshake::Lower;
use taskdata::files::{TaskData, TrajParaId};

use super::{
    gripper::Gripper,
    order::{FingerOrder, FingerVerb},
    relative::{Reference, Relative},
    robot_place::{commanded_pose, standing},
    route::LegGoal,
    state::State,
    tables::{Action, Ordered, Seen},
};
use crate::execution::Outcome;

/// Which changing pose stands where in the outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    Departure,
    Goal,
    Between,
    Located,
}

/// The process to which an action gives an order. Fingers that open on the way to a goal are not waited for,
/// but the motion before must have come to its end.
const fn ordered(action: Action) -> Option<Ordered> {
    match action {
        Action::RobotInit
        | Action::Open
        | Action::GoThru
        | Action::GotoPt
        | Action::DeltaMove(_)
        | Action::CalSensor(_)
        | Action::Centre
        | Action::Align => Some(Ordered::Prim),
        Action::GoUntil(_) => Some(Ordered::GoUntil),
        Action::GoWhile(Relative::InsNear) => Some(Ordered::Nearing),
        Action::GoWhile(_) => Some(Ordered::Prim),
        Action::OpenToApproach
        | Action::Close
        | Action::OpenToDepart
        | Action::OpenFully
        | Action::Calibrate => Some(Ordered::Gripper),
        Action::CloseForHolster => Some(Ordered::GripperInHolster),
        Action::Lock | Action::Unlock => Some(Ordered::QuickChange),
        Action::Flood | Action::FloodAgain | Action::Precise | Action::PreciseAgain => Some(Ordered::Vision),
        Action::Pause | Action::StopRobot => Some(Ordered::All),
        _ => None,
    }
}

impl State {
    /// Set the outputs that a row asks for.
    pub(super) fn act(
        &mut self,
        action: Action,
        seen: &Seen,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let command = &inputs.memory.subtask.emove;
        if let Some(ordered) = ordered(action) {
            self.ordered = ordered;
            self.uses_prim |=
                matches!(ordered, Ordered::Prim | Ordered::GoUntil | Ordered::Nearing | Ordered::All);
        }
        match action {
            Action::Wait => {}
            Action::RobotInit => {
                self.robot_init = inputs.external.operator.robot_init;
                self.send_prim(PrimVerb::RobotInit, inputs, outputs);
            }
            Action::Pause => {
                self.stop_robot(inputs, outputs);
                if self.is_letting_go() {
                    // The order no longer says that a release has not ended. If E-move is restarted, this does.
                    self.beliefs.grasping = None;
                }
                let request = FingerOrder { order: FingerVerb::Pause, ..FingerOrder::default() };
                self.grippers.send(request, inputs.tick, inputs.memory, outputs);
            }
            Action::StopRobot => self.stop_robot(inputs, outputs),
            Action::Manual => {
                self.searched = 0;
                self.execution.pass_up(Lower::Joystick, Reason::JoystickOn);
            }
            Action::GoThru => self.send_leg(PrimVerb::GoThru, inputs, outputs),
            Action::GotoPt => self.send_leg(PrimVerb::GotoPt, inputs, outputs),
            Action::DeltaMove(by) => self.send_relative(PrimVerb::DeltaMove, by, command, inputs, outputs),
            Action::GoUntil(by) => self.send_relative(PrimVerb::GoUntil, by, command, inputs, outputs),
            Action::GoWhile(by) => self.send_relative(PrimVerb::GoWhile, by, command, inputs, outputs),
            Action::CalSensor(at) => {
                self.beliefs.calibrated = at;
                self.send_prim(PrimVerb::CalSensor, inputs, outputs);
            }
            Action::Lock => self.send_quick_change(QuickChangeVerb::Lock, inputs, outputs),
            Action::Unlock => self.send_quick_change(QuickChangeVerb::Unlock, inputs, outputs),
            Action::Open
            | Action::OpenToApproach
            | Action::CloseForHolster
            | Action::Close
            | Action::OpenToDepart
            | Action::OpenFully
            | Action::Calibrate
            | Action::OpenByHand
            | Action::CloseByHand => self.order(action, command, inputs, outputs),
            Action::Arrive | Action::Located => self.arrive(command, outputs),
            Action::Stand => self.stand(GoneTo::Location, command, inputs),
            Action::Leave(reason) => {
                self.stand(GoneTo::Location, command, inputs);
                self.fail(reason, inputs, outputs);
            }
            Action::StandInDrum => self.stand(GoneTo::Drum, command, inputs),
            Action::Grasped => self.grasped(command, inputs),
            Action::Acquired => {
                self.grasped(command, inputs);
                self.stand(GoneTo::Drum, command, inputs);
            }
            Action::Flood | Action::FloodAgain => {
                self.take_picture(Picture::FastFlood, action, command, inputs, outputs);
            }
            Action::Precise | Action::PreciseAgain => {
                self.take_picture(Picture::Precise, action, command, inputs, outputs);
            }
            Action::Centre | Action::Align => self.move_camera(action, command, inputs, outputs),
            Action::Finish => self.finish(),
            Action::Refuse(reason) => self.execution.fail(reason),
            Action::Fail(reason) => self.fail(reason, inputs, outputs),
            Action::FailGrip => self.fail(self.grippers.fault(inputs.tick, inputs.memory), inputs, outputs),
            Action::FailRing => self.fail(self.ring_fault(inputs), inputs, outputs),
            Action::PassUp => {
                self.execution.pass_up(seen.subordinates.prim, inputs.memory.prim.status.reason);
            }
        }
    }

    /// Report done.
    pub(super) fn finish(&mut self) {
        self.execution.reason = Reason::None;
        self.execution.finish();
    }

    /// Stop the robot and report an error.
    fn fail(&mut self, reason: Reason, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        self.send_prim(PrimVerb::Pause, inputs, outputs);
        self.execution.fail(reason);
    }

    /// What is wrong with the quick change.
    fn ring_fault(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Reason {
        let ring = &inputs.memory.quick_change;
        let report = ring.status.report;
        match self.quick_change.status_of(inputs.tick, ring) {
            Lower::Lost => Reason::NeighbourLost,
            _ if report == QuickChangeReport::Stuck => Reason::QuickChangeStuck,
            _ => Reason::QuickChangeFault,
        }
    }

    /// PAUSE to Prim and Quick Change: ramp down and hold, and leave the ring as it is.
    fn stop_robot(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        self.searched = 0;
        self.send_prim(PrimVerb::Pause, inputs, outputs);
        self.send_quick_change(QuickChangeVerb::Pause, inputs, outputs);
    }

    fn send_quick_change(
        &mut self,
        verb: QuickChangeVerb,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        outputs.quick_change =
            QuickChangeCommand { number: self.quick_change.send(inputs.tick), command: verb };
    }

    /// A command to Prim that names no goal.
    pub(super) fn send_prim(
        &mut self,
        verb: PrimVerb,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        outputs.prim = PrimCommand {
            number: self.prim.send(inputs.tick),
            command: verb,
            sensor: None,
            pose: 0,
            movetable: None,
            trajectory_parameters: TrajParaId::NULL.number(),
            end_effector_id: inputs.memory.quick_change.status.end_effector_id,
        };
    }

    /// GO-THRU or GOTO-PT with the next point of the route.
    fn send_leg(&mut self, verb: PrimVerb, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        let Some(leg) = self.next_leg(inputs.memory, inputs.data) else { return };
        let (pose, movetable) = match leg.at {
            LegGoal::Record { pose, movetable } => (pose, movetable),
            LegGoal::Computed(frame) => {
                (self.publish(Slot::Between, Pose::from_frame(&frame), outputs), None)
            }
        };
        self.send_prim(verb, inputs, outputs);
        outputs.prim.pose = pose;
        outputs.prim.movetable = movetable;
        outputs.prim.trajectory_parameters = leg.parameters.number();
    }

    /// DELTA-MOVE, GO-UNTIL or GO-WHILE to Prim. If nothing says where the robot stands, the command fails.
    fn send_relative(
        &mut self,
        verb: PrimVerb,
        relative: Relative,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut EmoveOutputs,
    ) {
        let pose = match relative.reference() {
            Reference::Location => command.pose,
            Reference::Seat => self
                .seat_pose(command, inputs.memory, inputs.data)
                .map(|pose| self.publish(Slot::Departure, pose, outputs)),
            Reference::Start => self
                .start_of(relative, command, inputs.memory, inputs.data)
                .map(|pose| self.publish(Slot::Departure, pose, outputs)),
            Reference::Stand => {
                commanded_pose(inputs.memory).map(|pose| self.publish(Slot::Departure, pose, outputs))
            }
        };
        let (Some(pose), Some(found)) = (pose, relative.record(command, inputs.data)) else {
            return self.fail(Reason::BadRecord, inputs, outputs);
        };
        self.send_prim(verb, inputs, outputs);
        outputs.prim.pose = pose;
        outputs.prim.movetable = found.movetable.to_option();
        outputs.prim.trajectory_parameters = found.para.number();
        if relative.is_guarded() {
            outputs.prim.sensor = Some(found.sensor);
        }
        self.undetected = 0;
        (self.beliefs.place, self.beliefs.way) = (None, None);
        self.note_exchange(command, inputs.memory, inputs.data);
        self.note_drum(command, inputs.memory, inputs.data);
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
        self.releasing = request.order == FingerVerb::Release;
        match request.order {
            FingerVerb::Grasp => {
                if action == Action::Close {
                    // What is closed on anew is held when the fingers have closed on it.
                    (self.beliefs.held, self.carrying) = (None, false);
                    self.beliefs.grasping = Some(self.grasp_of(command, inputs));
                } else {
                    // By hand: only what counts as held has a name, and it is not let go any more.
                    self.beliefs.grasping = self.beliefs.held;
                }
                self.beliefs.seat = self.next_seat(command);
                // What was placed may be taken, and lost elsewhere.
                (self.beliefs.placed, self.beliefs.empty) = (None, false);
            }
            FingerVerb::Stand
            | FingerVerb::Release
            | FingerVerb::Calibrate
            | FingerVerb::None
            | FingerVerb::Pause => {}
        }
        if let Some(route) = &mut self.route {
            route.opening_sent |= action == Action::Open;
        }
        self.grippers.send(request, inputs.tick, inputs.memory, outputs);
    }

    /// Give a changing pose a new record number and value.
    pub(super) fn publish(&mut self, slot: Slot, pose: Pose, outputs: &mut EmoveOutputs) -> u32 {
        self.last_pose = pose_range::next(pose_range::EMOVE, self.last_pose);
        let [departure, goal, between, located] = &mut outputs.poses;
        let record = match slot {
            Slot::Departure => departure,
            Slot::Goal => goal,
            Slot::Between => between,
            Slot::Located => located,
        };
        *record = ChangingPose { number: Some(self.last_pose), pose };
        self.last_pose
    }

    /// Give the ends of the route of a new command record numbers.
    pub(super) fn publish_route(&mut self, outputs: &mut EmoveOutputs) {
        if let Some(mut route) = self.route {
            route.departure = self.publish(Slot::Departure, route.from.pose, outputs);
            route.goal = self.publish(Slot::Goal, route.to.pose, outputs);
            self.route = Some(route);
        }
    }

    /// `status-report` and its reason. `joystick-on` lasts as long as the box is active (V.2.2), whatever was done
    /// before, and E-PAUSE keeps it until the processes below pause again. Another command that was given up for it
    /// ends in an error and is not resumed (docs/design/ownership.md "Joystick box").
    fn outcome(&self, inputs: &Inputs<'_, TaskData<'_>>) -> (StatusReport, Reason, Unconfirmed) {
        let prim = &inputs.memory.prim;
        let taken =
            prim.status.report == PrimReport::JoystickOn && prim.header.stamp == inputs.tick.previous();
        let pauses = inputs.memory.subtask.emove.command == EmoveVerb::Pause;
        let has_failed = || self.prim.status_of(inputs.tick, prim) == Lower::Error;
        let below = || if has_failed() { prim.status.reason } else { Reason::None };
        let ended = self.execution.report(pauses.then(below));
        match (taken, ended.outcome) {
            (true, Outcome::Done | Outcome::Joystick) => {
                (StatusReport::JoystickOn, Reason::JoystickOn, Unconfirmed::None)
            }
            (false, Outcome::Joystick) if pauses => {
                (StatusReport::JoystickOn, Reason::JoystickOn, Unconfirmed::None)
            }
            (false, Outcome::Joystick) => (StatusReport::Error, Reason::JoystickOn, Unconfirmed::None),
            _ => (ended.outcome.report(), ended.reason, ended.unconfirmed),
        }
    }

    /// Write the status to Subtask and the flags of the gripper processes.
    pub(super) fn report(&self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut EmoveOutputs) {
        let (report, reason, unconfirmed) = self.outcome(inputs);
        outputs.header = self.execution.rows.header(inputs.tick, self.step.text());
        outputs.dormant = Gripper::attached(inputs.memory).dormancy();
        outputs.beliefs = self.beliefs;
        outputs.nearest = self.surroundings.nearest;
        outputs.status = EmoveStatus {
            echo: self.execution.receiver.echo,
            report,
            reason,
            unconfirmed,
            reference_pose: inputs.memory.prim.status.sensor_pose,
            held: self.holding(inputs.memory),
            seat: self.beliefs.seat,
            placed: self.beliefs.placed,
            located: self.beliefs.located.map(|Located { object, record, array, sector, .. }| {
                LocatedObject { object, record, array, sector }
            }),
            // Pins with a bad contact do not make the robot bare: Subtask would fetch the gripper that is on.
            end_effector_id: if self.is_misread(inputs.memory) {
                self.attached.id()
            } else {
                inputs.memory.quick_change.status.end_effector_id
            },
            pins: if self.is_misread(inputs.memory) { Pins::Differ } else { Pins::Agree },
            at: self.place().as_ref().map(standing),
            offset: self.place().map_or(Offset::None, |place| self.offset_of_place(&place, inputs)),
            exchange: self.changing(inputs.memory),
            drum: self.is_around_tool(inputs.memory, inputs.data),
        };
    }
}
