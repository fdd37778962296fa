//! The host: answers each message of the robot with a target.

use crate::{
    Error, Limits, LinkState, Pose, Twist,
    message::{Robot, Sensor},
    path::{Motion, Path, Times},
    session::{Arrival, Session},
};

/// Settings of the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Limits of the targets.
    pub limits: Limits,
    /// Times of the path.
    pub times: Times,
    /// Time without a message after which the robot is lost, ns.
    pub silence: u64,
    /// Gap between two messages after which the path continues only if the robot has kept up with it, ns.
    pub gap: u64,
    /// Send the speed of the target with the target.
    pub speed_ref: bool,
    /// A path can begin only if the robot is within this distance of its rest position, mm.
    pub tolerance: f64,
    /// The same for its rotation, rad.
    pub turn_tolerance: f64,
}

impl Settings {
    /// Default settings: 120 ms of silence, gaps of 60 ms, 5 mm and 0.02 rad, speeds given.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            times: Times::default(),
            silence: 120_000_000,
            gap: 60_000_000,
            speed_ref: true,
            tolerance: 5.0,
            turn_tolerance: 0.02,
        }
    }
}

/// Numbers of events since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// New messages from the robot.
    pub received: u64,
    /// Messages that arrived out of order or twice.
    pub old: u64,
    /// Datagrams that are not valid messages.
    pub refused: u64,
    /// Targets sent.
    pub sent: u64,
    /// Points accepted.
    pub points: u64,
    /// Motions that ended because no point or no message came in time.
    pub interrupted: u64,
    /// Targets that were not sent because they exceeded the limits.
    pub beyond: u64,
}

/// State of the host after a message, or after a time without one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Arrival time of the last message, ns.
    pub heard: u64,
    /// State of the link.
    pub link: LinkState,
    /// Pose of the robot, mm.
    pub feedback: Pose,
    /// The last target.
    pub target: Pose,
    /// Speed of the last target.
    pub speed: Twist,
    /// True while a path is moving: the host accepts points.
    pub is_moving: bool,
    /// Where a path may begin or continue; `None` if the robot does not follow, is not at its target, or is stopping.
    pub start: Option<Pose>,
    /// Utilization of the robot by the motion, percent; `None` if the robot does not send it.
    pub utilization: Option<f64>,
    /// Numbers of events since the start.
    pub counters: Counters,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sent {
    at: u64,
    pose: Pose,
    speed: Twist,
    lag: (f64, f64), // of the robot from this target when sent, mm and rad
}

fn seconds(nanoseconds: u64) -> f64 {
    core::time::Duration::from_nanos(nanoseconds).as_secs_f64()
}

/// The host's side of the link to one robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Host {
    settings: Settings,
    session: Session,
    path: Path,
    feedback: Pose,
    utilization: Option<f64>,
    sent: Option<Sent>, // while the robot follows
    seqno: u32,
    counters: Counters,
}

impl Host {
    /// A host that waits for a robot.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            path: Path::new(settings.times, Pose::IDENTITY),
            settings,
            session: Session::default(),
            feedback: Pose::IDENTITY,
            utilization: None,
            sent: None,
            seqno: 0,
            counters: Counters::default(),
        }
    }

    /// Handles a datagram that arrived at `now`, ns. Send the answer, at the end of `buffer`, at once. An old message
    /// gets none, because the robot reads one answer per cycle. After an error only a counter changes.
    pub fn receive<'a>(
        &mut self,
        now: u64,
        datagram: &[u8],
        buffer: &'a mut [u8],
    ) -> Result<Option<&'a [u8]>, Error> {
        let read = Robot::decode(datagram).and_then(|message| Ok((message, message.essentials()?)));
        let (message, (seqno, feedback)) =
            read.inspect_err(|_| self.counters.refused = self.counters.refused.saturating_add(1))?;
        self.poll(now);
        let before = self.session.state();
        if self.session.accept(now, seqno, &message) == Arrival::Old {
            self.counters.old = self.counters.old.saturating_add(1);
            return Ok(None);
        }
        self.counters.received = self.counters.received.saturating_add(1);
        (self.feedback, self.utilization) = (feedback, message.utilization_rate);
        if self.session.state() != LinkState::Running || before != LinkState::Running {
            self.rest_at_feedback(); // the target of a robot that does not follow yet is its own position
        }
        let target = self.target(now);
        if self.session.state() == LinkState::Running {
            self.sent = Some(target);
        }
        self.seqno = self.seqno.wrapping_add(1); // sequence numbers and times of messages wrap around
        let tm = u32::try_from((now / 1_000_000) & u64::from(u32::MAX)).unwrap_or_default();
        let speed = Some(&target.speed).filter(|_| self.settings.speed_ref);
        let answer = Sensor::target(self.seqno, tm, &target.pose, speed).encode(buffer)?;
        self.counters.sent = self.counters.sent.saturating_add(1);
        Ok(Some(answer))
    }

    /// Handles the passage of time without a message, up to `now`, ns.
    pub fn poll(&mut self, now: u64) {
        self.session.poll(now, self.settings.silence);
        if self.session.state() == LinkState::Lost && self.sent.is_some() {
            self.interrupt();
            self.rest_at_feedback();
        }
    }

    /// Begins a path from rest at the start pose of the last [`Sample`]; `at` in ns. Errors: [`Error::NotReady`].
    pub fn begin(&mut self, at: u64, from: &Pose) -> Result<(), Error> {
        let start = self.start().ok_or(Error::NotReady)?;
        if !self.are_near(&start, from) {
            return Err(Error::NotReady);
        }
        if self.path.motion() != Motion::Moving {
            self.path.begin(at, start);
        }
        Ok(())
    }

    /// Takes the next point, which arrived at `at`, ns. A refused point ends the path.
    pub fn push(&mut self, at: u64, point: &Pose) -> Result<(), Error> {
        let pushed = self.path.push(at, point, &self.settings.limits);
        match pushed {
            Ok(()) => self.counters.points = self.counters.points.saturating_add(1),
            Err(_) => self.stop(at),
        }
        pushed
    }

    /// Brings the target to rest along the path's tangent, from `now`, ns.
    pub fn stop(&mut self, now: u64) {
        if self.path.motion() != Motion::Moving {
            return;
        }
        self.interrupt();
        match self.sent {
            Some(sent) => self.path.stop(now.max(sent.at), sent.pose, sent.speed),
            None => self.rest_at_feedback(),
        }
    }

    /// Makes the robot's last position the target: the robot stops, and does not move on to the old target.
    pub fn hold(&mut self) {
        if !matches!(self.path.motion(), Motion::Still(_)) {
            self.interrupt();
        }
        self.rest_at_feedback();
    }

    /// The present state.
    #[must_use]
    pub fn sample(&self) -> Sample {
        let (target, speed) =
            self.sent.map_or((self.feedback, Twist::default()), |sent| (sent.pose, sent.speed));
        Sample {
            heard: self.session.heard(),
            link: self.session.state(),
            feedback: self.feedback,
            target,
            speed,
            is_moving: self.path.motion() == Motion::Moving,
            start: self.start(),
            utilization: self.utilization,
            counters: self.counters,
        }
    }

    /// The target at `now`, ns, within the limits from the previous one.
    fn target(&mut self, now: u64) -> Sent {
        let Some(sent) = self.sent else {
            let (pose, speed) = self.path.target(now);
            return self.sending(now, pose, speed);
        };
        let moving = self.path.motion() == Motion::Moving;
        let (mut pose, mut speed) = self.path.target(now);
        if moving && self.path.motion() != Motion::Moving {
            self.interrupt();
        } else if moving
            && now.saturating_sub(sent.at) > self.settings.gap
            && !self.can_reach_target(&sent, &pose)
        {
            self.stop(now);
            (pose, speed) = self.path.target(now);
        }
        let elapsed = seconds(now.saturating_sub(sent.at));
        if pose == sent.pose || self.settings.limits.check(&sent.pose, &pose, elapsed).is_ok() {
            return self.sending(now, pose, speed);
        }
        self.counters.beyond = self.counters.beyond.saturating_add(1);
        self.path.hold(sent.pose);
        self.sending(now, sent.pose, Twist::default())
    }

    fn sending(&self, at: u64, pose: Pose, speed: Twist) -> Sent {
        Sent { at, pose, speed, lag: pose.distance(&self.feedback) }
    }

    /// True if the robot has kept up during a gap, in which it continues with its last speed reference. Its distance
    /// from the next target may exceed its earlier lag by what the limits allow in the longest permitted gap.
    fn can_reach_target(&self, sent: &Sent, target: &Pose) -> bool {
        let (way, turn) = target.distance(&self.feedback);
        let (Limits { speed, turn: rate, .. }, gap) = (self.settings.limits, seconds(self.settings.gap));
        way <= sent.lag.0 + speed * gap && turn <= sent.lag.1 + rate * gap
    }

    fn rest_at_feedback(&mut self) {
        self.sent = None;
        self.path.hold(self.feedback);
    }

    const fn interrupt(&mut self) {
        self.counters.interrupted = self.counters.interrupted.saturating_add(1);
    }

    /// The path's last point, or the resting target if the robot is there.
    fn start(&self) -> Option<Pose> {
        match self.path.motion() {
            Motion::Moving => Some(self.path.last_point()),
            Motion::Still(at) => Some(at)
                .filter(|at| self.session.state() == LinkState::Running && self.are_near(at, &self.feedback)),
            Motion::Stopping { .. } => None,
        }
    }

    fn are_near(&self, a: &Pose, b: &Pose) -> bool {
        let (way, turn) = a.distance(b);
        way <= self.settings.tolerance && turn <= self.settings.turn_tolerance
    }
}
