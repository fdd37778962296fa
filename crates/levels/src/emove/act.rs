use interfaces::{
    EmoveOutputs, Reason,
    emove::{EmoveCommand, EmoveVerb, GoneTo},
    prim::PrimVerb,
    quick_change::QuickChangeVerb,
};
use rcs_core::handshake::Lower;

use super::{
    EmoveInputs, State,
    grasp::{grasp_of, gripper_on, sizes},
    gripper::EmoveGripper,
    gripper_exchange::seat_pose,
    grippers::{FingerOrder, FingerVerb},
    motion::{
        Slot,
        relative::{Reference, Relative},
        route::FULL_OPENING,
    },
    robot_place::{commanded_pose, gone_to, robot_at},
    tables::{Action, EmoveRecipient, StateVariables},
    tool_drum::start_of,
};
use crate::halt::Commanding as _;

const HAND_FORCE: i32 = 30; // lb: the smallest in the usual range (VIII.9.1; ASSUMED)

/// The process that receives the order. No row waits for fingers that open during a motion, but the previous motion
/// must have ended.
const fn ordered(action: Action) -> Option<EmoveRecipient> {
    match action {
        Action::RobotInit
        | Action::Open
        | Action::GoThru
        | Action::GotoPt
        | Action::DeltaMove(_)
        | Action::CalSensor(_)
        | Action::Centre
        | Action::Align => Some(EmoveRecipient::Prim),
        Action::GoUntil(_) => Some(EmoveRecipient::GoUntil),
        Action::GoWhile(Relative::InsNear) => Some(EmoveRecipient::Nearing),
        Action::GoWhile(_) => Some(EmoveRecipient::Prim),
        Action::OpenToApproach
        | Action::Close
        | Action::OpenToDepart
        | Action::OpenFully
        | Action::Calibrate => Some(EmoveRecipient::Gripper),
        Action::CloseForHolster => Some(EmoveRecipient::GripperInHolster),
        Action::Lock | Action::Unlock => Some(EmoveRecipient::QuickChange),
        Action::Flood | Action::FloodAgain | Action::Precise | Action::PreciseAgain => {
            Some(EmoveRecipient::Vision)
        }
        Action::Pause | Action::StopRobot => Some(EmoveRecipient::All),
        _ => None,
    }
}

impl State {
    pub(super) fn act(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) {
        let command = &inputs.memory.subtask.emove;
        if action.is_order() {
            self.ordered_at = self.motion.flight().progress();
        }
        if let Some(ordered) = ordered(action) {
            self.ordered = ordered;
            self.uses_prim |= matches!(
                ordered,
                EmoveRecipient::Prim
                    | EmoveRecipient::GoUntil
                    | EmoveRecipient::Nearing
                    | EmoveRecipient::All
            );
        }
        match action {
            Action::Wait => {}
            Action::RobotInit => self.motion.initialize(inputs, outputs),
            Action::Pause => {
                self.stop_robot(inputs, outputs);
                if self.is_releasing() {
                    self.held.pause_release();
                }
                let request = FingerOrder { order: FingerVerb::Pause, ..FingerOrder::default() };
                self.grippers.send(request, inputs.tick, inputs.memory, outputs);
            }
            Action::StopRobot => self.stop_robot(inputs, outputs),
            Action::Manual => {
                self.localization.search_again();
                self.execution.pass_up(Lower::Joystick, Reason::JoystickOn);
            }
            Action::GoThru => self.send_leg(PrimVerb::GoThru, inputs, outputs),
            Action::GotoPt => self.send_leg(PrimVerb::GotoPt, inputs, outputs),
            Action::DeltaMove(by) => self.send_relative(PrimVerb::DeltaMove, by, command, inputs, outputs),
            Action::GoUntil(by) => self.send_relative(PrimVerb::GoUntil, by, command, inputs, outputs),
            Action::GoWhile(by) => self.send_relative(PrimVerb::GoWhile, by, command, inputs, outputs),
            Action::CalSensor(at) => {
                self.drum.note_calibration(at);
                self.motion.send(PrimVerb::CalSensor, inputs, outputs);
            }
            Action::Lock => self.exchange.send(QuickChangeVerb::Lock, inputs.tick, outputs),
            Action::Unlock => self.exchange.send(QuickChangeVerb::Unlock, inputs.tick, outputs),
            Action::Open
            | Action::OpenToApproach
            | Action::CloseForHolster
            | Action::Close
            | Action::OpenToDepart
            | Action::OpenFully
            | Action::Calibrate
            | Action::OpenByHand
            | Action::CloseByHand => self.order_fingers(action, command, inputs, outputs),
            Action::Arrive | Action::Located => self.arrive(command, outputs),
            Action::Stand => self.stand(GoneTo::Location, command, inputs),
            Action::Leave(reason) => {
                self.stand(GoneTo::Location, command, inputs);
                self.fail(reason, inputs, outputs);
            }
            Action::StandInDrum => self.stand(GoneTo::Drum, command, inputs),
            Action::Grasped => {
                self.hold(grasp_of(command, inputs));
                self.finish();
            }
            Action::Acquired => {
                self.hold(grasp_of(command, inputs));
                self.stand(GoneTo::Drum, command, inputs);
            }
            Action::Flood | Action::FloodAgain | Action::PreciseAgain => {
                self.vision.take_picture(action, command, inputs, outputs);
            }
            Action::Precise => {
                self.settle(command, gone_to(command), outputs);
                self.vision.take_picture(action, command, inputs, outputs);
            }
            Action::Centre | Action::Align => self.move_camera(action, command, inputs, outputs),
            Action::Finish => self.finish(),
            Action::Refuse(reason) => self.execution.fail(reason),
            Action::Fail(reason) => self.fail(reason, inputs, outputs),
            Action::FailGrip => self.fail(self.grippers.fault(inputs.tick, inputs.memory), inputs, outputs),
            Action::FailRing => self.fail(self.exchange.fault(inputs.tick, inputs.memory), inputs, outputs),
            Action::PassUp => {
                self.execution.pass_up(seen.subordinates.prim, inputs.memory.prim.status.reason);
            }
        }
    }

    fn finish(&mut self) {
        self.execution.reason = Reason::None;
        self.execution.finish();
    }

    fn fail(&mut self, reason: Reason, inputs: &EmoveInputs<'_>, outputs: &mut EmoveOutputs) {
        self.motion.send(PrimVerb::Pause, inputs, outputs);
        self.execution.fail(reason);
    }

    /// Stops the robot; the ring keeps its state.
    fn stop_robot(&mut self, inputs: &EmoveInputs<'_>, outputs: &mut EmoveOutputs) {
        self.localization.search_again();
        self.motion.send(PrimVerb::Pause, inputs, outputs);
        self.exchange.send(QuickChangeVerb::Pause, inputs.tick, outputs);
    }

    fn arrive(&mut self, command: &EmoveCommand, outputs: &EmoveOutputs) {
        let at = match gone_to(command) {
            GoneTo::Object(object) if self.brings(command) => GoneTo::Brought(object),
            at => at,
        };
        self.settle(command, at, outputs);
        self.finish();
    }

    fn brings(&self, command: &EmoveCommand) -> bool {
        let held = self.held.held().map(|held| held.object.object);
        command.command == EmoveVerb::MovObjTo && held == command.object
    }

    fn settle(&mut self, command: &EmoveCommand, gone_to: GoneTo, outputs: &EmoveOutputs) {
        let [_, goal, ..] = outputs.poses;
        self.localization.arrive(robot_at(command, gone_to, goal.pose));
    }

    /// Records that relative moves have ended at the location of the command.
    fn stand(&mut self, gone_to: GoneTo, command: &EmoveCommand, inputs: &EmoveInputs<'_>) {
        self.localization.stand(gone_to, command, inputs.memory);
        self.exchange.end();
        self.drum.end();
        self.finish();
    }

    fn send_leg(&mut self, verb: PrimVerb, inputs: &EmoveInputs<'_>, outputs: &mut EmoveOutputs) {
        let rest = commanded_pose(inputs.memory).unwrap_or_default();
        let at = &mut self.localization;
        let from = (at.track(), at.is_straight(), rest);
        at.depart(self.motion.send_leg(verb, from, inputs, outputs), rest);
    }

    /// The command fails if the position of the robot is unknown.
    fn send_relative(
        &mut self,
        verb: PrimVerb,
        relative: Relative,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) {
        let EmoveInputs { memory, data, .. } = *inputs;
        let from = match relative.reference() {
            Reference::Location => None,
            Reference::Seat => seat_pose(command, memory, data),
            Reference::Start => start_of(relative, command, memory, data),
            Reference::Stand => commanded_pose(memory),
        };
        let pose = match relative.reference() {
            Reference::Location => command.pose,
            Reference::Seat | Reference::Start | Reference::Stand => {
                from.map(|pose| self.motion.publish(Slot::Departure, pose, outputs))
            }
        };
        let sent = pose
            .is_some_and(|pose| self.motion.send_relative(verb, relative, pose, command, inputs, outputs));
        if !sent {
            return self.fail(Reason::BadRecord, inputs, outputs);
        }
        self.localization.leave();
        self.exchange.note_move(command, inputs);
        self.drum.note_move(command, inputs);
    }

    /// Move the camera over the centroid. [`Action::Align`] also turns it with the part.
    fn move_camera(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) {
        let Some(view) = self.vision.next_view(action, command, inputs) else { return };
        if let Some(part) = view.part {
            self.motion.publish(Slot::Located, part, outputs);
        }
        self.localization.leave_view(robot_at(command, gone_to(command), view.goal), inputs.memory);
        self.motion.send_goal(view.goal, view.parameters, inputs, outputs);
    }

    fn finger_order(&self, action: Action, command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> FingerOrder {
        let sizes = sizes(command, inputs.data).copied().unwrap_or_default();
        match action {
            Action::Open => {
                let opening = self.motion.opening().map_or(0, |(opening, _)| opening);
                FingerOrder::to(FingerVerb::Stand, opening)
            }
            Action::OpenToApproach => FingerOrder::to(FingerVerb::Stand, sizes.appr_size),
            Action::CloseForHolster => {
                let opening = gripper_on(command, inputs.data).map_or(0, |on| on.appr_size);
                FingerOrder::to(FingerVerb::Stand, opening)
            }
            Action::OpenToDepart => {
                let holding = self.holding(inputs.memory);
                FingerOrder::to(FingerVerb::Release, self.held.depart_opening(holding, command, inputs))
            }
            Action::OpenByHand | Action::OpenFully => FingerOrder::to(FingerVerb::Release, FULL_OPENING),
            Action::Close => {
                FingerOrder { order: FingerVerb::Grasp, opening: sizes.grasp_size, force: sizes.grasp_force }
            }
            Action::CloseByHand => {
                let opening = EmoveGripper::attached(inputs.memory).closed();
                FingerOrder { order: FingerVerb::Grasp, opening, force: HAND_FORCE }
            }
            Action::Calibrate => FingerOrder { order: FingerVerb::Calibrate, ..FingerOrder::default() },
            _ => FingerOrder { order: FingerVerb::Pause, ..FingerOrder::default() },
        }
    }

    fn order_fingers(
        &mut self,
        action: Action,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
        outputs: &mut EmoveOutputs,
    ) {
        let order = self.finger_order(action, command, inputs);
        self.held.note_order(order.order);
        if order.order == FingerVerb::Grasp {
            let seat = self.held.next_seat(command, self.vision.located().is_some());
            self.held.close((action == Action::Close).then(|| grasp_of(command, inputs)), seat);
        }
        if action == Action::Open {
            self.motion.note_opening();
        }
        self.grippers.send(order, inputs.tick, inputs.memory, outputs);
    }
}
