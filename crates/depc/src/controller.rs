//! The controller's end of the link: the DEPC function of the T3 controller (A 2.3, A 2.4).
//!
//! The function starts in auto mode, reports the robot's position, and then acknowledges, checks and executes one
//! command per period, on any implementation of [`Robot`]. A command that it cannot execute causes a warning on its
//! screen, which the operator answers with ENTER (restart) or CANCEL (end the function). The host gets no answer then.

use rcs_core::Plain;

pub use crate::warning::{JointProblem, Refusal, Warning, joints_for};

use crate::link::LinkBytes;
use crate::{
    Limits, Plate,
    receive::{Command, CommandReceiver},
    wire::{Control, DataCommand, FRAME_BYTES, NO_FUNCTION, Report, Response},
};

/// A robot; positions are words of the line, and [`crate::exact::ExactFrames`] has the unrounded frames.
pub trait Robot {
    /// Present position, or the end of the present motion. A command to this position moves nothing.
    fn present(&mut self) -> Plate;

    /// Sets the position to reach within the coming period. A refusal changes nothing and becomes a warning.
    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal>;

    /// A warning of the robot itself, during which no command is accepted and the function does not start.
    fn warning(&self) -> Option<Warning> {
        None
    }

    /// Stops: no further point follows, because the function has ended, shows a warning, or the host found the robot
    /// off its path. From now on [`Self::present`] returns the place where the robot comes to rest.
    fn stop(&mut self) {}
}

/// State of the DEPC function.
///
/// ```text
///              start               D0..D6, P05, P0B, P9P
///   Off ───────────────► Running ───────────────────────► Warning
///    ▲                   │    ▲        ENTER; 05 after D6    │
///    │ CANCEL      18    │    └──────────────────────────────┤ CANCEL
///    │          Ended ◄──┘                                   ▼
///    └─────────────────────────────────────────────────── PreManual
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ControllerState {
    /// The program has not reached the DEPC function.
    Off,
    /// Commands are accepted.
    Running,
    /// A warning waits for ENTER or CANCEL; nothing moves.
    Warning,
    /// Error P-IG: the function has ended (A 2.4).
    PreManual,
    /// Cancelled by the host; the program continues with its next point.
    Ended,
}

/// Panel and wiring in a tick. Pushbuttons are true in the tick in which they are pressed.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ControllerInputs {
    /// Bytes from the host.
    pub rx: LinkBytes,
    /// The host's DTR (A.2).
    pub cts: bool,
    /// The RS232 boards are present.
    pub board: bool,
    /// The transmitter has a hardware problem.
    pub transmitter_fault: bool,
    /// The program reaches the DEPC function.
    pub start: bool,
    /// Hold: the output in progress is completed; then no command is accepted.
    pub hold: bool,
    /// Interrupt pushbutton.
    pub interrupt: bool,
    /// ENTER on the console.
    pub enter: bool,
    /// CANCEL on the console.
    pub cancel: bool,
}

/// Outputs of the controller in a tick, except the motion of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ControllerOutputs {
    /// Bytes to the host.
    pub tx: LinkBytes,
    /// DTR, the host's CTS (A.2).
    pub dtr: bool,
    /// A command was executed in this tick, and the robot moves to [`Controller::commanded`].
    pub moving: bool,
    /// Function to run now. It belongs to the command whose position was reached in the previous tick.
    pub function: [u8; 2],
}

/// The DEPC function of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Controller {
    limits: Limits,
    state: ControllerState,
    warning: Warning,
    receiver: CommandReceiver,
    commanded: Plate,
    function: [u8; 2],
}

impl Controller {
    /// A controller whose program has not reached the DEPC function.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self { limits, ..Self::default() }
    }

    /// The limits of a step between two positions.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// State of the function.
    #[must_use]
    pub const fn state(&self) -> ControllerState {
        self.state
    }

    /// The warning on the screen.
    #[must_use]
    pub const fn warning(&self) -> Warning {
        self.warning
    }

    /// The last commanded or reported position, from which the next command is checked.
    #[must_use]
    pub const fn commanded(&self) -> Plate {
        self.commanded
    }

    /// Executes one period, in which the robot moves at most once.
    pub fn step(
        &mut self,
        inputs: &ControllerInputs,
        robot: &mut (impl Robot + ?Sized),
    ) -> ControllerOutputs {
        let mut out = ControllerOutputs {
            function: core::mem::replace(&mut self.function, NO_FUNCTION),
            ..Default::default()
        };
        self.receiver.accept(&inputs.rx);
        let before = self.state;
        match before {
            ControllerState::Off | ControllerState::Ended => {
                self.receiver.clear();
                if inputs.start {
                    self.begin(inputs, robot, &mut out);
                }
            }
            ControllerState::Running => self.run(inputs, robot, &mut out),
            ControllerState::Warning => self.wait_for_answer(inputs, robot, &mut out),
            ControllerState::PreManual => {
                self.receiver.clear();
                if inputs.cancel {
                    self.state = ControllerState::Off;
                    self.warning = Warning::None;
                }
            }
        }
        if before == ControllerState::Running && self.state != before {
            robot.stop();
        }
        // A missing board drives no line; DEPC checks it before it turns DTR on (A 2.3).
        out.dtr = inputs.board && matches!(self.state, ControllerState::Running | ControllerState::Warning);
        out
    }

    /// Starts or restarts the function: the checks in order, then the report.
    fn begin(
        &mut self,
        inputs: &ControllerInputs,
        robot: &mut (impl Robot + ?Sized),
        out: &mut ControllerOutputs,
    ) {
        self.receiver.clear();
        if !inputs.board {
            self.warn(Warning::BoardMissing);
        } else if !inputs.cts {
            self.warn(Warning::CtsLow);
        } else if let Some(warning) = robot.warning() {
            self.warn(warning);
        } else {
            self.state = ControllerState::Running;
            self.warning = Warning::None;
            self.report(inputs, robot, out);
        }
    }

    fn run(
        &mut self,
        inputs: &ControllerInputs,
        robot: &mut (impl Robot + ?Sized),
        out: &mut ControllerOutputs,
    ) {
        if inputs.interrupt {
            return self.warn(Warning::Interrupt);
        }
        if !inputs.cts {
            return self.warn(Warning::CtsLow);
        }
        if let Some(warning) = robot.warning() {
            return self.warn(warning);
        }
        if inputs.hold {
            return;
        }
        match self.receiver.take() {
            None => {}
            Some(Command::Undecipherable) => self.send(inputs, &[Response::Nak.byte()], out),
            Some(Command::Control(Control::Restart)) => self.report(inputs, robot, out),
            Some(Command::Control(Control::Cancel)) => {
                self.send(inputs, &[Response::Ack.byte()], out);
                self.receiver.clear();
                self.state = ControllerState::Ended;
            }
            Some(Command::Data(command)) => self.execute(inputs, &command, robot, out),
        }
    }

    /// ACK: the command is understood. The check whether it can be executed follows (A 2.3).
    fn execute(
        &mut self,
        inputs: &ControllerInputs,
        command: &DataCommand,
        robot: &mut (impl Robot + ?Sized),
        out: &mut ControllerOutputs,
    ) {
        self.send(inputs, &[Response::Ack.byte()], out);
        if self.state != ControllerState::Running {
            return;
        }
        let accepted = self
            .limits
            .check(&self.commanded, &command.plate)
            .map_err(Warning::from)
            .and_then(|()| robot.accept(&command.plate).map_err(Warning::from));
        match accepted {
            Ok(()) => {
                self.commanded = command.plate;
                self.function = command.function;
                out.moving = true;
            }
            Err(warning) => self.warn(warning),
        }
    }

    fn wait_for_answer(
        &mut self,
        inputs: &ControllerInputs,
        robot: &mut (impl Robot + ?Sized),
        out: &mut ControllerOutputs,
    ) {
        let command = self.receiver.take();
        let restart = command == Some(Command::Control(Control::Restart)) && self.warning.host_can_restart();
        self.receiver.clear();
        if inputs.cancel {
            self.state = ControllerState::PreManual;
            self.warning = Warning::Terminated;
        } else if inputs.enter || restart {
            self.begin(inputs, robot, out);
        }
    }

    fn report(
        &mut self,
        inputs: &ControllerInputs,
        robot: &mut (impl Robot + ?Sized),
        out: &mut ControllerOutputs,
    ) {
        self.commanded = robot.present();
        let mut frame = [0; FRAME_BYTES];
        Report { plate: self.commanded }.emit(&mut frame);
        self.send(inputs, &frame, out);
    }

    fn send(&mut self, inputs: &ControllerInputs, bytes: &[u8], out: &mut ControllerOutputs) {
        if inputs.transmitter_fault || out.tx.extend(bytes) < bytes.len() {
            self.warn(Warning::Transmitter);
        }
    }

    fn warn(&mut self, warning: Warning) {
        self.receiver.clear();
        self.state = ControllerState::Warning;
        self.warning = warning;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{limit::Exceeded, link::LINK_BYTES};
    use geometry::kinematics::{HOME_JOINTS, Joints, T3};

    const HOME: Plate = Plate { words: [0, -6293, -636, -9000, 13500, 0] };

    struct Exact {
        joints: Joints,
        at: Plate,
    }

    impl Robot for Exact {
        fn present(&mut self) -> Plate {
            self.at
        }

        fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
            self.joints = joints_for(&T3, goal, &self.joints)?;
            self.at = *goal;
            Ok(())
        }
    }

    fn well() -> ControllerInputs {
        ControllerInputs { cts: true, board: true, ..Default::default() }
    }

    fn line(bytes: &[u8]) -> ControllerInputs {
        let mut inputs = well();
        assert_eq!(inputs.rx.extend(bytes), bytes.len());
        inputs
    }

    fn to(words: [i16; 6], function: [u8; 2]) -> ControllerInputs {
        let mut frame = [0; 16];
        DataCommand { function, plate: Plate { words } }.emit(&mut frame);
        line(&frame)
    }

    fn running() -> (Controller, Exact) {
        let (mut controller, mut robot) =
            (Controller::new(Limits::NBS), Exact { joints: HOME_JOINTS, at: HOME });
        let out = controller.step(&ControllerInputs { start: true, ..well() }, &mut robot);
        assert_eq!(Report::parse(out.tx.as_slice()), Ok(Report { plate: HOME }));
        assert!(out.dtr);
        (controller, robot)
    }

    #[test]
    fn a_command_is_acknowledged_then_executed_then_its_function_runs() {
        let (mut controller, mut robot) = running();
        let out = controller.step(&to([10, -6293, -636, -9000, 13500, 0], [1, 2]), &mut robot);
        assert_eq!((out.tx.as_slice(), out.moving, out.function), (&[0x06][..], true, NO_FUNCTION));
        assert_eq!(robot.at.words[0], 10);
        let out = controller.step(&well(), &mut robot);
        assert_eq!((out.tx.as_slice(), out.moving, out.function), (&[][..], false, [1, 2]));
        assert_eq!(controller.step(&well(), &mut robot).function, NO_FUNCTION);
    }

    #[test]
    fn unknown_messages_are_answered_with_nak_and_discarded() {
        let (mut controller, mut robot) = running();
        let mut garbled = to([10, -6293, -636, -9000, 13500, 0], NO_FUNCTION);
        garbled.rx.bytes[15] ^= 1;
        let out = controller.step(&garbled, &mut robot);
        assert_eq!((out.tx.as_slice(), out.moving, robot.at), (&[0x15][..], false, HOME));
    }

    #[test]
    fn every_limit_has_its_warning_and_prevents_motion() {
        for (words, warning) in [
            ([57, -6293, -636, -9000, 13500, 0], Warning::Translation),
            ([0, -6293, -636, -9000, 13500, 230], Warning::Orientation),
        ] {
            let (mut controller, mut robot) = running();
            let out = controller.step(&to(words, NO_FUNCTION), &mut robot);
            assert_eq!((out.tx.as_slice(), out.moving), (&[0x06][..], false));
            assert_eq!(
                (controller.state(), controller.warning(), robot.at),
                (ControllerState::Warning, warning, HOME)
            );
            // The controller sends nothing until the operator answers, and then a report.
            let out = controller.step(&line(&[0x05]), &mut robot);
            assert!(out.tx.as_slice().is_empty() && out.dtr);
            let out = controller.step(&ControllerInputs { enter: true, ..well() }, &mut robot);
            assert_eq!(Report::parse(out.tx.as_slice()), Ok(Report { plate: HOME }));
            assert_eq!((controller.state(), controller.warning()), (ControllerState::Running, Warning::None));
        }
    }

    #[test]
    fn the_host_can_restart_after_a_joint_limit() {
        let (mut controller, mut robot) = running();
        let mut words = HOME.words;
        let mut warned = None;
        for _ in 0..100 {
            words[5] += 200;
            controller.step(&to(words, NO_FUNCTION), &mut robot);
            if controller.state() == ControllerState::Warning {
                warned = Some(controller.warning());
                break;
            }
        }
        assert_eq!(warned, Some(Warning::JointLimit));
        assert_eq!(robot.at.words[5], 13_400);
        let out = controller.step(&line(&[0x05]), &mut robot);
        assert_eq!(Report::parse(out.tx.as_slice()), Ok(Report { plate: robot.at }));
    }

    #[test]
    fn cancel_is_acknowledged_and_ends_the_function() {
        let (mut controller, mut robot) = running();
        let out = controller.step(&line(&[0x18]), &mut robot);
        assert_eq!((out.tx.as_slice(), out.dtr), (&[0x06][..], false));
        assert_eq!(controller.state(), ControllerState::Ended);
    }

    #[test]
    fn hold_only_delays() {
        let (mut controller, mut robot) = running();
        let mut inputs = to([10, -6293, -636, -9000, 13500, 0], NO_FUNCTION);
        inputs.hold = true;
        assert_eq!(controller.step(&inputs, &mut robot).tx.length, 0);
        assert_eq!(controller.step(&ControllerInputs { hold: true, ..well() }, &mut robot).tx.length, 0);
        assert!(controller.step(&well(), &mut robot).moving);
    }

    #[test]
    fn wiring_and_operator_have_their_warnings() {
        let faults = [
            (ControllerInputs { cts: false, ..well() }, Warning::CtsLow),
            (ControllerInputs { interrupt: true, ..well() }, Warning::Interrupt),
            (ControllerInputs { transmitter_fault: true, ..line(&[0x05]) }, Warning::Transmitter),
        ];
        for (inputs, warning) in faults {
            let (mut controller, mut robot) = running();
            controller.step(&inputs, &mut robot);
            assert_eq!((controller.state(), controller.warning()), (ControllerState::Warning, warning));
            let out = controller.step(&ControllerInputs { cancel: true, ..well() }, &mut robot);
            assert_eq!(
                (controller.state(), controller.warning()),
                (ControllerState::PreManual, Warning::Terminated)
            );
            assert!(!out.dtr);
            controller.step(&ControllerInputs { cancel: true, ..well() }, &mut robot);
            assert_eq!(controller.state(), ControllerState::Off);
        }
        let (mut controller, mut robot) =
            (Controller::new(Limits::NBS), Exact { joints: HOME_JOINTS, at: HOME });
        let out = controller.step(&ControllerInputs { start: true, board: false, ..well() }, &mut robot);
        assert_eq!((controller.warning(), out.dtr), (Warning::BoardMissing, false));
    }

    #[test]
    fn excess_bytes_of_a_tick_are_a_fault_of_the_transmitter() {
        let (mut controller, _) = running();
        let mut out = ControllerOutputs::default();
        let full = [0x06; LINK_BYTES];
        controller.send(&well(), &full, &mut out);
        assert_eq!((controller.state(), out.tx.as_slice()), (ControllerState::Running, &full[..]));
        controller.send(&well(), &[0x06], &mut out);
        assert_eq!(
            (controller.state(), controller.warning()),
            (ControllerState::Warning, Warning::Transmitter)
        );
    }

    #[test]
    fn the_next_command_is_taken_while_the_robot_moves() {
        let (mut controller, mut robot) = running();
        for n in 1..=20_i16 {
            let words = [n, -6293, -636, -9000, 13500, 0];
            let out = controller.step(&to(words, n.to_be_bytes()), &mut robot);
            assert_eq!((out.tx.as_slice(), out.moving), (&[0x06][..], true));
            // This is the function of the previous command, whose position is reached.
            assert_eq!(out.function, (n - 1).to_be_bytes());
        }
    }

    #[test]
    fn the_limits_are_those_of_the_configured_period() {
        for (limits, last) in [(Limits::APPENDIX, 27), (Limits::NBS, 56), (Limits::new(100).unwrap(), 140)] {
            let mut controller = Controller::new(limits);
            let mut robot = Exact { joints: HOME_JOINTS, at: HOME };
            controller.step(&ControllerInputs { start: true, ..well() }, &mut robot);
            controller.step(&to([last, -6293, -636, -9000, 13500, 0], NO_FUNCTION), &mut robot);
            assert_eq!((controller.warning(), robot.at.words[0]), (Warning::None, last));
            controller.step(&to([2 * last + 1, -6293, -636, -9000, 13500, 0], NO_FUNCTION), &mut robot);
            assert_eq!((controller.warning(), robot.at.words[0]), (Warning::Translation, last));
        }
    }

    #[test]
    fn a_hold_completes_the_current_step_and_keeps_the_next() {
        let (mut controller, mut robot) = running();
        controller.step(&to([10, -6293, -636, -9000, 13500, 0], [1, 2]), &mut robot);
        let mut held = to([20, -6293, -636, -9000, 13500, 0], NO_FUNCTION);
        held.hold = true;
        let out = controller.step(&held, &mut robot);
        assert_eq!((out.function, out.moving, out.tx.length, robot.at.words[0]), ([1, 2], false, 0, 10));
        let out = controller.step(&well(), &mut robot);
        assert_eq!((out.moving, out.tx.as_slice(), robot.at.words[0]), (true, &[0x06][..], 20));
    }

    #[test]
    fn interrupt_during_a_command_causes_no_motion() {
        let (mut controller, mut robot) = running();
        let mut inputs = to([10, -6293, -636, -9000, 13500, 0], NO_FUNCTION);
        inputs.interrupt = true;
        let out = controller.step(&inputs, &mut robot);
        assert_eq!((out.tx.length, out.moving, robot.at), (0, false, HOME));
        assert_eq!(controller.warning(), Warning::Interrupt);
        // An interrupted command is not executed after ENTER.
        let out = controller.step(&ControllerInputs { enter: true, ..well() }, &mut robot);
        assert_eq!((out.tx.length, out.moving), (16, false));
        let out = controller.step(&well(), &mut robot);
        assert_eq!((out.tx.length, out.moving, robot.at), (0, false, HOME));
    }

    #[test]
    fn program_restarts_the_function_after_a_cancel_of_the_host() {
        let (mut controller, mut robot) = running();
        controller.step(&line(&[0x18]), &mut robot);
        assert_eq!(controller.step(&line(&[0x05]), &mut robot).tx.length, 0);
        let out = controller.step(&ControllerInputs { start: true, ..well() }, &mut robot);
        assert_eq!((out.tx.length, out.dtr, controller.state()), (16, true, ControllerState::Running));
    }

    struct RefusingArm {
        complaint: Option<Warning>,
        stopped: u32,
    }

    impl Robot for RefusingArm {
        fn present(&mut self) -> Plate {
            HOME
        }

        fn accept(&mut self, _goal: &Plate) -> Result<(), Refusal> {
            Err(Refusal::TooFast(Exceeded::Translation))
        }

        fn warning(&self) -> Option<Warning> {
            self.complaint
        }

        fn stop(&mut self) {
            self.stopped += 1;
        }
    }

    #[test]
    fn own_warning_of_the_robot_is_shown_until_the_host_restarts() {
        let (mut controller, mut robot) =
            (Controller::new(Limits::NBS), RefusingArm { complaint: None, stopped: 0 });
        controller.step(&ControllerInputs { start: true, ..well() }, &mut robot);
        assert_eq!((controller.state(), robot.stopped), (ControllerState::Running, 0));
        robot.complaint = Some(Warning::OffPath);
        for _ in 0..3 {
            let out = controller.step(&line(&[0x05]), &mut robot);
            assert!(out.dtr && out.tx.length == 0);
            assert_eq!((controller.warning(), robot.stopped), (Warning::OffPath, 1));
        }
        robot.complaint = None;
        assert_eq!(controller.step(&line(&[0x05]), &mut robot).tx.length, 16);
        // A refusal by the robot is also a warning.
        let out = controller.step(&to([10, -6293, -636, -9000, 13500, 0], NO_FUNCTION), &mut robot);
        assert_eq!((out.tx.as_slice(), out.moving), (&[0x06][..], false));
        assert_eq!((controller.warning(), robot.stopped), (Warning::Translation, 2));
    }
}
