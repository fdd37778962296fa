//! What the rows of the tables ask for, and postprocess: state becomes output buffers.

use rcs_core::{
    handshake::Lower,
    interface::{
        ChangingPose, PrimOutputs, Reason,
        device::{JoystickBox, single_step},
        pose_range,
        prim::{JoystickGrip, PrimReport, PrimStatus, PrimVerb},
        t3i::{T3iCommand, T3iVerb},
    },
    pose::{Pose, WireFrame},
    process::Inputs,
    tick::Tick,
    units::hundredths,
};
use taskdata::files::TaskData;

use super::{
    Prim,
    manual::Manual,
    motion::Motion,
    preprocess,
    state::Target,
    tables::{
        Action, Posture, Situation,
        attend::{Attention, Kind, attend},
        record_pose::{Button, Note, Recording, record_pose},
    },
};
use crate::old_execution::{Course, Outcome};

impl Prim {
    /// Take notice of a time in which Prim was held or suspended: T3I has stopped the robot dead, so that
    /// the motion goes on from rest. A Prim that is stepped singly goes on from point to point.
    pub(super) fn wake(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let held = inputs.external.devices.joystick.hold & single_step::PRIM != 0;
        let stood = inputs.memory.prim.header.republished || self.state.single_step;
        if stood && !held {
            self.state.motion.stand();
            self.state.manual = Manual::default();
        }
        self.state.single_step = held;
    }

    /// Take a new command up, or refuse it.
    pub(super) fn take_command(
        &mut self,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut PrimOutputs,
    ) -> Course {
        let command = &inputs.memory.emove.prim;
        let mut found = Target::default();
        let course = self.state.execution.consult(command.number, || {
            preprocess::look_up(command, inputs).map(|target| found = target).err()
        });
        match course {
            Course::Begin => {
                self.state.target = found;
                self.state.forget_rest();
                if found.verb == PrimVerb::GoUntil {
                    let [_, _, detected, _] = &mut outputs.poses;
                    *detected = ChangingPose::default();
                }
            }
            Course::Refuse => self.state.motion.halt(),
            Course::Rest | Course::Continue => {}
        }
        course
    }

    /// Is the table of the current command consulted in this tick?
    pub(super) fn attends(&mut self, course: Course, situation: &Situation) -> bool {
        let execution = &mut self.state.execution;
        let kind = Kind::of(self.state.target.verb);
        let decision = attend(course, kind, execution.outcome, situation.switches);
        let [row, ..] = &mut self.state.rows;
        *row = decision.row;
        if course == Course::Rest && decision.action == Attention::Consult {
            execution.reason = Reason::None;
        }
        execution.outcome = decision.next;
        decision.action == Attention::Consult
    }

    /// Do what a row of a command's table asks for.
    pub(super) fn act(
        &mut self,
        action: Action,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut PrimOutputs,
    ) {
        let devices = &inputs.external.devices;
        let execution = &mut self.state.execution;
        match action {
            Action::Wait => {}
            Action::Go => self.go(),
            Action::Halt => self.state.motion.halt(),
            Action::Restart => {
                self.drop_position();
                self.command_t3i(T3iVerb::Restart, inputs.tick, &mut outputs.t3i);
            }
            Action::TakePosition => match inputs.memory.t3i.status.frame_feedback.to_frame() {
                Ok(frame) => {
                    self.state.motion = Motion::at_rest(&frame);
                    self.state.positioned = true;
                    execution.finish();
                }
                Err(_) => execution.fail(Reason::LinkError),
            },
            Action::Yield => {
                execution.pass_up(Lower::Joystick, Reason::JoystickOn);
                self.state.motion.halt();
            }
            Action::Drive => {
                execution.pass_up(Lower::Joystick, Reason::JoystickOn);
                self.state.manual.ask(&devices.joystick);
            }
            Action::Detect => {
                execution.reason = Reason::None;
                self.detect(inputs, outputs);
            }
            Action::Miss => execution.reason = Reason::NotDetected,
            Action::Sample => self.state.calibration.sample(&devices.force),
            Action::Calibrate => {
                self.state.calibration.finish();
                execution.finish();
            }
            Action::Finish => execution.finish(),
            Action::Fail(reason) => {
                execution.fail(reason);
                self.state.motion.halt();
            }
        }
    }

    /// The condition has come: publish where the resolvers see the robot, or without them where it was sent,
    /// and stop it.
    fn detect(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut PrimOutputs) {
        let t3i = &inputs.memory.t3i.status;
        let seen = t3i.resolver_frame.to_frame().ok().filter(|_| t3i.resolver_valid);
        let frame = seen.unwrap_or_else(|| self.state.motion.frame());
        let [_, _, detected, _] = &mut outputs.poses;
        self.publish(detected, Some(Pose::from_frame(&frame)));
        self.state.motion.halt();
        self.state.forget_rest();
    }

    /// The record button: is the commanded pose recorded in this tick?
    pub(super) fn records(&mut self, joystick: &JoystickBox, posture: Posture) -> bool {
        let pressed = joystick.record && !self.state.record_button;
        self.state.record_button = joystick.record;
        let decision = record_pose(if pressed { Button::Pressed } else { Button::Idle }, posture);
        let [_, _, row] = &mut self.state.rows;
        *row = decision.row;
        self.state.recording = decision.next;
        decision.action == Note::Record
    }

    /// Give the goal of the command to the motion.
    fn go(&mut self) {
        let Target { goal, limits, brake_distance, .. } = self.state.target;
        let through = self.state.target.is_through().then_some(brake_distance);
        self.state.motion.go(&goal.frame(), &limits, through);
        self.state.forget_rest();
    }

    /// Let a tick pass on the path and send the point.
    pub(super) fn advance(&mut self, inputs: &Inputs<'_, TaskData<'_>>, t3i: &mut T3iCommand) {
        let knob = inputs.external.devices.joystick.velocity;
        if self.state.manual.is_moving() {
            let frame = self.state.manual.step(&self.state.motion.frame(), knob);
            self.state.motion.put(&frame);
        } else {
            self.state.motion.step(knob);
        }
        self.command_t3i(T3iVerb::Point, inputs.tick, t3i);
    }

    /// Forget where the robot was told to be, and let T3I hold.
    pub(super) fn abandon(&mut self, inputs: &Inputs<'_, TaskData<'_>>, t3i: &mut T3iCommand) {
        self.drop_position();
        self.command_t3i(T3iVerb::Pause, inputs.tick, t3i);
    }

    fn drop_position(&mut self) {
        self.state.motion = Motion::default();
        self.state.manual = Manual::default();
        self.state.positioned = false;
    }

    /// Write a command with a new number to T3I.
    pub(super) fn command_t3i(&mut self, command: T3iVerb, tick: Tick, t3i: &mut T3iCommand) {
        let frame = match command {
            T3iVerb::Point => WireFrame::from_frame(&self.state.motion.frame()),
            T3iVerb::None | T3iVerb::Restart | T3iVerb::Pause => WireFrame::default(),
        };
        *t3i = T3iCommand { cycle: tick, number: self.state.t3i.send(tick), command, frame };
    }

    /// Fill the output buffers; `record` puts the commanded pose into the record of the recorded one.
    pub(super) fn postprocess(
        &mut self,
        inputs: &Inputs<'_, TaskData<'_>>,
        record: bool,
        outputs: &mut PrimOutputs,
    ) {
        let t3i = &inputs.memory.t3i.status;
        let commanded = self.state.positioned.then(|| Pose::from_frame(&self.state.motion.frame()));
        let seen = t3i.resolver_frame.to_frame().ok().filter(|_| t3i.resolver_valid);
        let [present, sensor, detected, recorded] = &mut outputs.poses;
        self.publish(present, commanded);
        self.publish(sensor, seen.map(|frame| Pose::from_frame(&frame)));
        if record {
            self.publish(recorded, commanded);
        }
        let execution = &self.state.execution;
        let joystick = &inputs.external.devices.joystick;
        let engaged = self.state.manual.engaged;
        let restarting = execution.outcome == Outcome::Executing && outputs.t3i.command == T3iVerb::Restart;
        let holsters = &inputs.external.devices.holsters;
        outputs.header = execution.header(inputs.tick);
        outputs.status = PrimStatus {
            echo: execution.receiver.echo,
            report: report(execution.outcome, execution.reason),
            reason: execution.reason,
            restarting,
            link_running: self.state.positioned && t3i.link_running,
            present_pose: present.number,
            sensor_pose: sensor.number,
            detected_pose: detected.number,
            holster_right: holsters.right,
            holster_left: holsters.left,
            holster_centre: holsters.centre,
            joystick_grip: if engaged { gripper_buttons(joystick) } else { JoystickGrip::None },
            recorded_pose: recorded.number,
            recording: self.state.recording == Recording::On,
            sensed: self.state.sensed,
            distance: if self.state.positioned { hundredths(self.state.motion.distance()) } else { 0 },
        };
        outputs.joystick_leds = if engaged { joystick.frame } else { 0 };
    }

    /// Write a pose record, under a new number if the pose is another; no pose empties the record.
    fn publish(&mut self, record: &mut ChangingPose, pose: Option<Pose>) {
        match pose {
            None => *record = ChangingPose::default(),
            Some(pose) if record.number != 0 && record.pose == pose => {}
            Some(pose) => {
                self.state.newest_pose = pose_range::next(pose_range::PRIM, self.state.newest_pose);
                *record = ChangingPose { number: self.state.newest_pose, pose };
            }
        }
    }
}

/// Push-buttons F and H (III.3.3); both together mean nothing.
const fn gripper_buttons(joystick: &JoystickBox) -> JoystickGrip {
    match (joystick.open, joystick.close) {
        (true, false) => JoystickGrip::Open,
        (false, true) => JoystickGrip::Close,
        (true, true) | (false, false) => JoystickGrip::None,
    }
}

/// The outcome as `status-report` (V.1.2).
const fn report(outcome: Outcome, reason: Reason) -> PrimReport {
    match (outcome, reason) {
        (Outcome::Idle, _) => PrimReport::Idle,
        (Outcome::Executing, Reason::NotDetected) => PrimReport::NotDetected,
        (Outcome::Executing, _) => PrimReport::Executing,
        (Outcome::Done, _) => PrimReport::Done,
        (Outcome::Joystick, _) => PrimReport::JoystickOn,
        (Outcome::Error, Reason::LinkOff) => PrimReport::T3LinkOff,
        (Outcome::Error, Reason::LinkError) => PrimReport::T3LinkErr,
        (Outcome::Error, Reason::InterfaceSilent) => PrimReport::NoRespT3i,
        (Outcome::Error, Reason::InterfaceRefused) => PrimReport::T3BadCommand,
        (Outcome::Error, Reason::SensorError) => PrimReport::SensorError,
        (Outcome::Error, Reason::Detected) => PrimReport::DetectedErr,
        (Outcome::Error, _) => PrimReport::Error,
    }
}
