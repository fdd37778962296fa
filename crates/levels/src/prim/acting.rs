//! What the rows of the tables ask for, and postprocess: state becomes output buffers.

use rcs_core::{
    interface::{
        ChangingPose, PrimOutputs, Reason, pose_range,
        prim::{JoystickGrip, PrimReport, PrimStatus},
        t3i::{T3iCommand, T3iVerb},
    },
    pose::{Pose, WireFrame},
    process::Inputs,
    tick::Tick,
    units::hundredths,
};
use taskdata::files::TaskData;

use super::{Prim, motion::Motion, preprocess, state::Target, tables::Action};
use crate::execution::{Course, Outcome};

impl Prim {
    /// Take a new command up, or refuse it.
    pub(super) fn take_command(&mut self, inputs: &Inputs<'_, TaskData<'_>>) -> Course {
        let command = &inputs.memory.emove.prim;
        let mut found = Target::default();
        let course = self.state.execution.consult(command.number, || {
            preprocess::look_up(command, inputs).map(|target| found = target).err()
        });
        match course {
            Course::Begin => self.state.target = found,
            Course::Refuse => self.state.motion.halt(),
            Course::Rest | Course::Continue => {}
        }
        course
    }

    /// Do what a row of a command's table asks for.
    pub(super) fn act(&mut self, action: Action, inputs: &Inputs<'_, TaskData<'_>>, t3i: &mut T3iCommand) {
        match action {
            Action::Wait => {}
            Action::Go => self.go(),
            Action::Halt => self.state.motion.halt(),
            Action::Restart => {
                self.drop_position();
                self.command_t3i(T3iVerb::Restart, inputs.tick, t3i);
            }
            Action::TakePosition => match inputs.memory.t3i.status.frame_feedback.to_frame() {
                Ok(frame) => {
                    self.state.motion = Motion::at_rest(&frame);
                    self.state.positioned = true;
                    self.state.execution.finish();
                }
                Err(_) => self.state.execution.fail(Reason::LinkError),
            },
            Action::Finish => self.state.execution.finish(),
            Action::Fail(reason) => {
                self.state.execution.fail(reason);
                self.state.motion.halt();
            }
        }
    }

    /// Give the goal of the command to the motion.
    fn go(&mut self) {
        let Target { goal, limits, brake_distance, .. } = self.state.target;
        let through = self.state.target.is_through().then_some(brake_distance);
        self.state.motion.go(&goal.frame(), &limits, through);
        (self.state.finished, self.state.settled) = (0, 0);
    }

    /// Let a tick pass on the path and send the point.
    pub(super) fn advance(&mut self, inputs: &Inputs<'_, TaskData<'_>>, t3i: &mut T3iCommand) {
        self.state.motion.step(inputs.external.devices.joystick.velocity);
        self.command_t3i(T3iVerb::Point, inputs.tick, t3i);
    }

    /// Forget where the robot was told to be, and let T3I hold.
    pub(super) fn abandon(&mut self, inputs: &Inputs<'_, TaskData<'_>>, t3i: &mut T3iCommand) {
        self.drop_position();
        self.command_t3i(T3iVerb::Pause, inputs.tick, t3i);
    }

    fn drop_position(&mut self) {
        self.state.motion = Motion::default();
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

    /// Fill the output buffers.
    pub(super) fn postprocess(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut PrimOutputs) {
        let t3i = &inputs.memory.t3i.status;
        let commanded = self.state.positioned.then(|| Pose::from_frame(&self.state.motion.frame()));
        let seen = t3i.resolver_frame.to_frame().ok().filter(|_| t3i.resolver_valid);
        let [present, sensor, detected, _] = &mut outputs.poses;
        self.publish(present, commanded);
        self.publish(sensor, seen.map(|frame| Pose::from_frame(&frame)));
        self.publish(detected, None);
        let execution = &self.state.execution;
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
            joystick_grip: JoystickGrip::None,
            recorded_pose: 0,
            recording: false,
            sensed: 0,
            distance: if self.state.positioned { hundredths(self.state.motion.distance()) } else { 0 },
        };
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

/// The outcome as `status-report` (V.1.2).
const fn report(outcome: Outcome, reason: Reason) -> PrimReport {
    match (outcome, reason) {
        (Outcome::Idle, _) => PrimReport::Idle,
        (Outcome::Executing, _) => PrimReport::Executing,
        (Outcome::Done, _) => PrimReport::Done,
        (Outcome::Joystick, _) => PrimReport::JoystickOn,
        (Outcome::Error, Reason::LinkOff) => PrimReport::T3LinkOff,
        (Outcome::Error, Reason::LinkError) => PrimReport::T3LinkErr,
        (Outcome::Error, Reason::InterfaceSilent) => PrimReport::NoRespT3i,
        (Outcome::Error, Reason::InterfaceRefused) => PrimReport::T3BadCommand,
        (Outcome::Error, _) => PrimReport::Error,
    }
}
