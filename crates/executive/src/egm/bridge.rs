//! The adapter between the DEPC function of the controller and an EGM robot.
//!
//! A step takes the host's bytes and the newest sample, and gives at most one order. While the function runs, every
//! tick orders a point, the new position or the previous one again: the path ends exactly at its last point.
//!
//! | state of the robot | state of the DEPC function |
//! |---|---|
//! | motors off; RAPID or EGM stopped | ended: no answers, DTR off |
//! | follows, and rests at its last target | can begin, with a report of that position |
//! | no message for 3 ticks | warns: no answers; DTR stays on, because the robot's program may still run |
//! | off its path | is held where it is; warns |
//! | path interrupted, or not at its last target | warns; answers the host's restart when the robot is at rest |

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, Refusal, Robot},
    exact::ExactFrames,
    link::LinkBytes,
    track::{LIMIT_INCHES, Track},
    warning::Warning,
};
use egm::{LinkState, Pose, Sample};
use geometry::{frame::Frame, kinematics::T3, pose::WireFrame};

use crate::egm::{Line, Order, Placement};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BridgeOutputs {
    pub tx: LinkBytes,
    pub dtr: bool,
    /// A data command was acknowledged or refused, or a report was sent.
    pub busy: bool,
}

pub struct Bridge {
    controller: Controller,
    robot: Border,
    supervision: Option<Supervision>, // the supervision of the robot, if the host does not supervise it
}

/// The path of the robot, and its expected lag, ms.
struct Supervision {
    track: Track,
    lag_ms: u16,
}

/// The robot as the DEPC function sees it.
struct Border {
    placement: Placement,
    exact: ExactFrames,
    sample: Sample,
    /// The last position of the path: its DEPC words, and the target pose that they stand for. `None` without a path.
    path: Option<(Plate, Pose)>,
    near: Plate,              // the angles D and R of the next report are chosen near these
    warning: Option<Warning>, // why a path cannot continue or begin
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
        if self.path.take().is_some() {
            self.order = Some(Order::Stop { at: self.now });
        }
    }
}

impl Border {
    fn hold(&mut self) {
        if self.path.take().is_some() {
            (self.order, self.warning) = (Some(Order::Hold), Some(Warning::OffPath));
        }
    }

    /// Evaluates the newest sample for the path; `now` is ns of the line's clock.
    fn look(&mut self, sample: Sample, now: u64) {
        // A path that began in the previous tick is moving by now, unless the robot has refused it.
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
            supervision: None,
        }
    }

    /// Supervises the robot: a robot off the path of its expected lag is stopped. This is for hosts without feedback
    /// from the robot. The T3 Interface supervises the robot itself (docs/design/link.md "Following").
    #[must_use]
    pub fn supervised(self, lag_ms: u16) -> Self {
        Self { supervision: Some(Supervision { track: Track::default(), lag_ms }), ..self }
    }

    #[must_use]
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    #[must_use]
    pub const fn placement(&self) -> &Placement {
        &self.robot.placement
    }

    /// Records that Prim commanded the tool frame `exact` (inches, world), which T3I received rounded, as `wire`.
    pub fn offer(&mut self, wire: &WireFrame, exact: &Frame) {
        self.robot.exact.offer(wire, exact);
    }

    /// The robot's position as DEPC words; `None` before the first message, or if the pose has no DEPC words.
    #[must_use]
    pub fn feedback(&self) -> Option<Plate> {
        let sample = &self.robot.sample;
        let known = sample.link != LinkState::Waiting;
        known.then(|| self.robot.placement.words(&sample.feedback, &self.robot.near)).flatten()
    }

    /// Why the robot does not follow, as text for messages; `None` if it does.
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

    /// Executes one tick: passes the host's bytes and its DTR (here `cts`) to the DEPC function. With `hold` the robot
    /// stays where it is, until the host begins a path again.
    pub fn step(&mut self, line: &mut Line, rx: &LinkBytes, cts: bool, hold: bool) -> BridgeOutputs {
        self.robot.look(line.sample(), line.now());
        if hold || self.is_off_path() {
            self.robot.hold();
        }
        if matches!(self.robot.sample.link, LinkState::Waiting | LinkState::Standby(_)) {
            self.controller = Controller::new(*self.controller.limits());
            self.robot.path = None;
            self.follow();
            return BridgeOutputs::default();
        }
        let state = self.controller.state();
        let ended = !matches!(state, ControllerState::Running | ControllerState::Warning);
        let start = ended && self.robot.warning.is_none() && cts;
        let inputs = ControllerInputs { rx: *rx, cts, board: true, start, ..ControllerInputs::default() };
        let before = self.robot.path;
        let out = self.controller.step(&inputs, &mut self.robot);
        if let (Some((_, to)), None) = (before, &self.robot.order) {
            self.robot.order = Some(Order::Point { at: self.robot.now, to });
        }
        if let Some(order) = &self.robot.order {
            line.order(order);
        }
        self.follow();
        BridgeOutputs { tx: out.tx, dtr: out.dtr, busy: out.moving || out.tx.length > 0 }
    }
    fn is_off_path(&self) -> bool {
        let Some(Supervision { track, lag_ms }) = &self.supervision else { return false };
        let here = self.robot.placement.tool_frame(&self.robot.sample.feedback);
        let period = u16::try_from(self.controller.limits().period_us() / 1000).unwrap_or(u16::MAX);
        track.distance(&here, *lag_ms, period, &T3).is_some_and(|inches| inches > LIMIT_INCHES)
    }

    /// Adds the position of this tick to the supervised path.
    fn follow(&mut self) {
        let Some(Supervision { track, .. }) = &mut self.supervision else { return };
        match self.robot.path {
            Some((words, _)) if track.newest().is_none() => track.begin(words),
            Some((words, _)) => track.push(words),
            None => *track = Track::default(),
        }
    }
}
