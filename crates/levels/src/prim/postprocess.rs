use geometry::{
    pose::{Pose, WireFrame},
    units::hundredths,
};
use interfaces::{
    ChangingPose, PrimOutputs, Reason,
    device::JoystickBox,
    pose_range,
    prim::{JoystickGrip, PrimReport, PrimStatus, PrimVerb},
    process::Inputs,
    t3i::{T3iCommand, T3iVerb},
};
use rcs_core::{handshake::Lower, tick::Tick};
use taskdata::files::TaskData;

use super::{
    manual::PrimManual,
    motion::PrimMotion,
    state::{Standstill, State},
    tables::{
        Action, FirstPause, Path, PrimPath, StateVariables, number,
        path_clock::{PathProgress, path_clock},
        record_pose::{Recording, record_pose},
    },
};
use crate::execution::Outcome;

impl State {
    /// Only a new GO-UNTIL clears the detected pose.
    pub(super) fn begin(&self, outputs: &mut PrimOutputs) {
        if self.target.verb == PrimVerb::GoUntil {
            let [_, _, detected, _] = &mut outputs.poses;
            *detected = ChangingPose::default();
        }
    }

    pub(super) fn act(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut PrimOutputs,
    ) {
        let devices = &inputs.external.devices;
        self.manual.release();
        match action {
            Action::Wait => {}
            Action::Go => self.go(),
            Action::Halt => self.halt(),
            Action::Restart => {
                self.drop_position();
                self.command_t3i(T3iVerb::Restart, inputs.tick, &mut outputs.t3i);
            }
            Action::Recover => {
                self.drop_position();
                self.restarts.add(inputs.tick);
                self.command_t3i(T3iVerb::Restart, inputs.tick, &mut outputs.t3i);
            }
            Action::TakePosition => {
                self.motion = seen.feedback.as_ref().map(PrimMotion::at_rest);
                self.execution.finish();
            }
            Action::Resume => {
                self.motion = seen.feedback.as_ref().map(PrimMotion::at_rest);
                self.way = PrimPath::Lost;
                self.standstill = Standstill::default();
            }
            Action::Yield => {
                self.execution.pass_up(Lower::Joystick, Reason::JoystickOn);
                self.halt();
            }
            Action::Drive => {
                self.execution.pass_up(Lower::Joystick, Reason::JoystickOn);
                self.manual.ask(&devices.joystick);
            }
            Action::Detect => {
                self.execution.reason = Reason::None;
                self.detect(seen, outputs);
            }
            Action::Miss => self.execution.reason = Reason::NotDetected,
            Action::Sample => self.calibration.sample(&devices.force),
            Action::Calibrate => {
                self.calibration.finish();
                self.execution.finish();
            }
            Action::Finish => self.execution.finish(),
            Action::Fail(reason) => {
                self.execution.fail(reason);
                self.halt();
            }
        }
    }

    fn go(&mut self) {
        if let (Some(motion), Some(goal)) = (&mut self.motion, &self.target.goal) {
            motion.go(&goal.frame.frame(), &goal.limits, goal.through);
        }
        self.way = PrimPath::Kept;
        self.standstill = Standstill::default();
    }

    fn halt(&mut self) {
        if let Some(motion) = &mut self.motion {
            motion.halt();
        }
    }

    /// Publish the resolver frame, or without resolvers the commanded one, and stop the robot.
    fn detect(&mut self, seen: &StateVariables, outputs: &mut PrimOutputs) {
        let commanded = self.motion.as_ref().map(PrimMotion::frame);
        let [_, _, detected, _] = &mut outputs.poses;
        self.publish(detected, seen.resolvers.or(commanded).as_ref().map(Pose::from_frame));
        self.halt();
        self.standstill = Standstill::default();
    }

    fn drop_position(&mut self) {
        self.motion = None;
        self.manual = PrimManual::default();
    }

    fn command_t3i(&mut self, command: T3iVerb, tick: Tick, t3i: &mut T3iCommand) {
        let frame = match (command, &self.motion) {
            (T3iVerb::Point, Some(motion)) => WireFrame::from_frame(&motion.frame()),
            _ => WireFrame::default(),
        };
        *t3i = T3iCommand { cycle: tick, number: self.t3i.send(tick), command, frame };
    }

    /// Consult the tables after the command's row, and carry out their actions. True if the commanded pose is recorded.
    pub(super) fn follow_path(
        &mut self,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut PrimOutputs,
    ) -> Recording {
        let path = Path {
            first_pause: if self.t3i.started { FirstPause::Sent } else { FirstPause::Due },
            posture: self.posture(seen.situation.t3i),
            t3i: seen.situation.t3i,
            button: seen.button,
        };
        let (clock, record) = (path_clock((), &path), record_pose((), &path));
        self.execution.rows.beside(&clock.of(number::PATH_CLOCK));
        self.execution.rows.beside(&record.of(number::RECORD_POSE));
        match clock.action {
            PathProgress::Repeat => {}
            PathProgress::Advance => {
                self.advance(inputs.external.devices.joystick.velocity);
                self.command_t3i(T3iVerb::Point, inputs.tick, &mut outputs.t3i);
            }
            PathProgress::Abandon => {
                self.drop_position();
                self.command_t3i(T3iVerb::Pause, inputs.tick, &mut outputs.t3i);
            }
        }
        record.action
    }

    fn advance(&mut self, knob: u16) {
        let Some(motion) = &mut self.motion else { return };
        if self.manual.is_moving() {
            let frame = self.manual.step(&motion.frame(), knob);
            motion.put(&frame);
        } else {
            motion.step(knob);
        }
    }

    pub(super) fn report(
        &mut self,
        recording: Recording,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'_>>,
        outputs: &mut PrimOutputs,
    ) {
        let devices = &inputs.external.devices;
        let commanded = self.motion.as_ref().map(|motion| Pose::from_frame(&motion.frame()));
        let [present, sensor, detected, recorded] = &mut outputs.poses;
        self.publish(present, commanded);
        self.publish(sensor, seen.resolvers.as_ref().map(Pose::from_frame));
        if recording == Recording::Record {
            self.publish(recorded, commanded);
        }
        let execution = &self.execution;
        let engaged = self.manual.engaged;
        outputs.header = execution.rows.header(inputs.tick, self.step.text());
        outputs.status = PrimStatus {
            echo: execution.receiver.echo,
            report: report(execution.outcome, execution.reason),
            reason: execution.reason,
            restarting: execution.outcome == Outcome::Executing
                && self.motion.is_none()
                && outputs.t3i.command == T3iVerb::Restart,
            link_running: self.motion.is_some() && inputs.memory.t3i.status.link_running,
            controller_off: !inputs.memory.t3i.status.controller_ready,
            present_pose: present.number,
            sensor_pose: sensor.number,
            detected_pose: detected.number,
            holster_right: devices.holsters.right,
            holster_left: devices.holsters.left,
            holster_centre: devices.holsters.centre,
            joystick_grip: if engaged { gripper_buttons(&devices.joystick) } else { JoystickGrip::None },
            recorded_pose: recorded.number,
            recording: recording == Recording::Record,
            sensed: self.sensed,
            distance: self.motion.as_ref().map_or(0, |motion| hundredths(motion.distance())),
        };
        outputs.bias = self.calibration.bias;
        outputs.joystick_leds = if engaged { devices.joystick.frame } else { 0 };
    }

    /// A different pose gets a new number. `None` empties the record.
    fn publish(&mut self, record: &mut ChangingPose, pose: Option<Pose>) {
        match pose {
            None => *record = ChangingPose::default(),
            Some(pose) if record.number.is_some() && record.pose == pose => {}
            Some(pose) => {
                self.newest_pose = pose_range::next(pose_range::PRIM, self.newest_pose);
                *record = ChangingPose { number: Some(self.newest_pose), pose };
            }
        }
    }
}

/// Push-buttons F and H (III.3.3); both together have no meaning.
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
