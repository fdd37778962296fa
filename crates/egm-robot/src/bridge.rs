//! The robot's border: the DEPC function of the controller, with an EGM robot behind it.
//!
//! A tick brings the host's bytes and the newest sample, and gives at most one order. While the function runs
//! there is a point in every tick: the one that was accepted, or the one before again, since a robot without
//! a new set point keeps the old one. So the path ends exactly, and a tick without a command costs nothing
//! but time.
//!
//! | the robot | the function |
//! |---|---|
//! | motors off; RAPID or EGM stopped | has ended: no answers, DTR off |
//! | follows, and stands where it was sent | can begin, with a report of that place |
//! | no message for 3 ticks | warns: no answers; DTR stays on, since nothing says that the robot's program has ended |
//! | its path was interrupted, or it is not where it was sent | warns; the host's restart is answered when it stands |

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, Refusal, Robot},
    exact::ExactFrames,
    link::LinkBytes,
    warning::Warning,
};
use egm::{LinkState, Pose, Sample};
use geometry::{frame::Frame, kinematics::T3, pose::WireFrame};

use crate::{Line, Order, Placement};

/// What goes back to the host.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BridgeOutputs {
    /// Bytes.
    pub tx: LinkBytes,
    /// The controller's DTR.
    pub dtr: bool,
    /// A data command was acknowledged or refused, or a report was sent.
    pub busy: bool,
}

/// The border.
pub struct Bridge {
    controller: Controller,
    robot: Border,
}

/// What the function moves.
struct Border {
    placement: Placement,
    exact: ExactFrames,
    sample: Sample,
    /// The last position of the path: words, and the target behind them. `None` if no path was begun.
    path: Option<(Plate, Pose)>,
    /// D and R of the next report are near these.
    near: Plate,
    /// Why no path goes on or begins.
    warning: Option<Warning>,
    order: Option<Order>,
    now: u64,
}

impl Robot for Border {
    fn present(&mut self) -> Plate {
        if let Some((words, _)) = self.path {
            return words;
        }
        let start = self.sample.start.unwrap_or(self.sample.feedback);
        let words = self.placement.words(&start, &self.near).unwrap_or(self.near);
        self.path = Some((words, start));
        self.order = Some(Order::Begin { at: self.now, from: start });
        words
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        let target = match self.path {
            Some((words, target)) if words == *goal => target,
            _ => self.placement.pose(&self.exact.plate_frame(goal, &T3)),
        };
        (self.path, self.near) = (Some((*goal, target)), *goal);
        self.order = Some(Order::Point { at: self.now, to: target });
        Ok(())
    }

    fn warning(&self) -> Option<Warning> {
        self.warning
    }

    fn stop(&mut self) {
        self.path = None;
        self.order = Some(Order::Stop { at: self.now });
    }
}

impl Border {
    /// What the newest sample means for the path.
    fn look(&mut self, sample: Sample, now: u64) {
        // A path that was begun in the tick before is under way, unless the robot has refused it.
        let interrupted = self.path.is_some() && !sample.is_moving;
        (self.sample, self.now, self.order) = (sample, now, None);
        let expressible = || {
            let start = sample.start?;
            self.placement.words(&start, &self.near)
        };
        self.warning = (interrupted || expressible().is_none()).then_some(Warning::OffPath);
        if interrupted {
            self.path = None;
        }
    }
}

impl Bridge {
    /// The function has not begun.
    #[must_use]
    pub fn new(limits: Limits, placement: Placement) -> Self {
        Self {
            controller: Controller::new(limits),
            robot: Border {
                placement,
                exact: ExactFrames::default(),
                sample: Sample::default(),
                path: None,
                near: Plate::default(),
                warning: None,
                order: None,
                now: 0,
            },
        }
    }

    /// The DEPC function.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The robot's frames.
    #[must_use]
    pub const fn placement(&self) -> &Placement {
        &self.robot.placement
    }

    /// Prim has commanded the tool frame `exact` (inches, world), which T3I got as `wire`.
    pub fn offer(&mut self, wire: &WireFrame, exact: &Frame) {
        self.robot.exact.offer(wire, exact);
    }

    /// The words of where the robot is, if it has them.
    #[must_use]
    pub fn feedback(&self) -> Option<Plate> {
        let sample = &self.robot.sample;
        let known = sample.link != LinkState::Waiting;
        known.then(|| self.robot.placement.words(&sample.feedback, &self.robot.near)).flatten()
    }

    /// What keeps the robot from following, in words.
    #[must_use]
    pub fn trouble(&self) -> Option<&'static str> {
        match self.robot.sample.link {
            LinkState::Waiting => Some("no robot has sent an EGM message yet"),
            LinkState::Lost => Some("the robot has sent no EGM message for 3 ticks"),
            LinkState::Standby(hindrance) => Some(hindrance.text()),
            LinkState::Running if self.robot.warning.is_some() => {
                Some("the robot has left its path, or is not where it was sent")
            }
            LinkState::Running => None,
        }
    }

    /// One tick: the host's bytes, and its DTR, against the newest sample of the line.
    pub fn step(&mut self, line: &mut Line, rx: &LinkBytes, cts: bool) -> BridgeOutputs {
        self.robot.look(line.sample(), line.now());
        if matches!(self.robot.sample.link, LinkState::Waiting | LinkState::Standby(_)) {
            // The robot's program has ended, and with it the function.
            self.controller = Controller::new(*self.controller.limits());
            self.robot.path = None;
            return BridgeOutputs::default();
        }
        let state = self.controller.state();
        let ended = !matches!(state, ControllerState::Running | ControllerState::Warning);
        let start = ended && self.robot.warning.is_none() && cts;
        let inputs = ControllerInputs { rx: *rx, cts, board: true, start, ..ControllerInputs::default() };
        let before = self.robot.path;
        let out = self.controller.step(&inputs, &mut self.robot);
        if let (Some((_, to)), None) = (before, &self.robot.order) {
            // Nothing was commanded: the set point stands.
            self.robot.order = Some(Order::Point { at: self.robot.now, to });
        }
        if let Some(order) = &self.robot.order {
            line.order(order);
        }
        BridgeOutputs { tx: out.tx, dtr: out.dtr, busy: out.moving || out.tx.length > 0 }
    }
}
