//! A robot with EGM in a run: the line to it, its DEPC function, and measurements.

use std::{
    sync::atomic::Ordering,
    thread,
    time::{Duration, Instant},
};

use ::egm::{LinkState, Pose, Sample, host::Counters};
use closed_loop::RobotInputs;
use depc::{Limits, Plate, link::LinkBytes};
use executive::egm::{Bridge, BridgeOutputs, EgmOptions, Line, Peer, Refusals, udp::UdpLine};
use executive::{
    histogram::{Histogram, Summary},
    realtime,
};
use geometry::{frame::Frame, kinematics::T3, pose::WireFrame};
use interfaces::device::{RESOLVER_COUNTS, Resolvers};

use crate::{
    config::{ClockKind, RunConfig},
    error::StartError,
    observer::Observer,
};

/// Names of the frames in the log: the position of the robot, and its last target.
pub const FRAMES: [&str; 2] = ["egm_feedback", "egm_target"];

pub struct EgmPort {
    options: EgmOptions,
    lag_ms: u16, // expected lag, ms
    line: Line,
    bridge: Bridge,
    outputs: BridgeOutputs,
    resolvers: Resolvers,
    /// Joints of a T3 at the robot's last position, which determine the next turns of base and roll.
    joints: [f64; 6],
    figures: Box<Figures>,
}

#[derive(Default)]
struct Figures {
    cycles: Histogram,
    answers: Histogram,
    squares: f64, // distances from feedback to target: sum of the squares, mm²; greatest, mm; count
    greatest: f64,
    count: u64,
}

impl EgmPort {
    /// Open the line. A simulated robot starts at once. Fails if the robot's frames or the port cannot be used.
    pub fn open(
        options: &EgmOptions,
        config: &RunConfig,
        observer: &mut dyn Observer,
    ) -> Result<Self, StartError> {
        let file = options.file(&config.data)?;
        let placement = file.placement;
        let line = match options.peer {
            Peer::Simulated => Line::Simulated(Box::new(options.simulated(&placement))),
            Peer::Udp(address) => {
                let real = config.clock == ClockKind::Real;
                let prepare = move || {
                    if real {
                        // The run reports missing settings for its own thread. This thread gets no others.
                        let _ = realtime::raise_priority(realtime::PRIORITY);
                    }
                };
                let line = UdpLine::open(address, options.from, options.settings(&placement), prepare)?;
                observer.message(&format!("EGM: a robot can send to UDP {}", line.address()));
                if options.robot.is_none() {
                    observer.message(
                        "EGM: no robot=FILE: the robot's work object is taken for the T3's world, its tool for \
                         the end plate",
                    );
                }
                Line::Udp(Box::new(line))
            }
        };
        Ok(Self {
            options: options.clone(),
            lag_ms: file.lag_ms.unwrap_or(options.lag_ms()),
            line,
            bridge: Bridge::new(Limits::NBS, placement),
            outputs: BridgeOutputs::default(),
            resolvers: Resolvers::default(),
            joints: geometry::kinematics::HOME_JOINTS,
            figures: Box::default(),
        })
    }

    /// Waits until the robot follows. If it does not in time, the run begins, and fails with a reason that names it.
    pub fn gather(&mut self, config: &RunConfig, observer: &mut dyn Observer) {
        let started = Instant::now();
        let limit = Duration::from_secs(config.wait.into());
        let mut said = None;
        while self.options.peer != Peer::Simulated && !config.stop.load(Ordering::Relaxed) {
            self.read();
            let sample = self.line.sample();
            if sample.link == LinkState::Running {
                observer.message("EGM: the robot follows");
                return;
            }
            let trouble = trouble(&sample);
            if started.elapsed() >= limit {
                observer.message(&format!("EGM: after {} s: {}", config.wait, self.with_refusals(trouble)));
                return;
            }
            let state = (trouble, self.line.refusals().last);
            if said != Some(state) {
                observer.message(&format!("waiting for the EGM robot: {}", self.with_refusals(trouble)));
                said = Some(state);
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Before the controller's tick, reads the answers of the DEPC function and the position of the robot.
    pub fn receive(&mut self) -> RobotInputs {
        self.read();
        let sample = self.line.sample();
        if sample.link != LinkState::Waiting {
            self.resolvers = self.resolvers_at(&sample);
        }
        RobotInputs {
            rx: self.outputs.tx,
            ready: self.outputs.dtr,
            unsent: false,
            resolvers: Some(self.resolvers),
        }
    }

    /// Passes the host's bytes on, or holds the robot. `exact` is Prim's tool frame, rounded for T3I and unrounded.
    pub fn send(&mut self, tx: &LinkBytes, hold: bool, exact: Option<(WireFrame, Frame)>) {
        if let Some((wire, exact)) = exact {
            self.bridge.offer(&wire, &exact);
        }
        self.read();
        self.outputs = self.bridge.step(&mut self.line, tx, true, hold);
    }

    pub fn advance(&mut self, by: Duration) {
        self.line.advance(u64::try_from(by.as_nanos()).unwrap_or(u64::MAX));
    }

    /// Position of the robot in DEPC words, if it is within the range of the words.
    #[must_use]
    pub fn feedback(&self) -> Option<Plate> {
        self.bridge.feedback()
    }

    /// The trouble that prevents the robot from following, as text, with the refused datagrams.
    #[must_use]
    pub fn trouble(&self) -> Option<String> {
        self.bridge.trouble().map(|trouble| self.with_refusals(trouble))
    }

    fn with_refusals(&self, trouble: &str) -> String {
        match self.line.refusals() {
            refusals if refusals.count() == 0 => trouble.to_owned(),
            refusals => format!("{trouble}; {refusals}"),
        }
    }

    #[must_use]
    pub const fn lag_ms(&self) -> u16 {
        self.lag_ms
    }

    #[must_use]
    pub fn refusals(&self) -> Refusals {
        self.line.refusals()
    }

    /// Poses of robot and target, as the T3's end plate in its world: [`FRAMES`].
    #[must_use]
    pub fn frames(&self) -> [Pose; 2] {
        let sample = self.line.sample();
        [sample.feedback, sample.target].map(|pose| self.bridge.placement().plate_pose(&pose))
    }

    #[must_use]
    pub fn counters(&self) -> Counters {
        self.line.sample().counters
    }

    /// Times between two messages of the robot.
    #[must_use]
    pub fn cycles(&self) -> Summary {
        self.figures.cycles.summary()
    }

    /// Times from a message to its answer.
    #[must_use]
    pub fn answers(&self) -> Summary {
        self.figures.answers.summary()
    }

    /// Root mean square and greatest distance from the robot to its target, mm.
    #[must_use]
    pub fn errors(&self) -> [f64; 2] {
        let Figures { squares, greatest, count, .. } = *self.figures;
        [(squares / count.max(1) as f64).sqrt(), greatest]
    }

    fn read(&mut self) {
        let figures = &mut self.figures;
        self.line.reports(|report| {
            if let Some(cycle) = report.cycle {
                figures.cycles.add(cycle);
                figures.answers.add(report.answered);
            }
            let sample = &report.sample;
            if sample.is_moving {
                let (error, _) = sample.target.distance(&sample.feedback);
                figures.squares += error * error;
                figures.greatest = figures.greatest.max(error);
                figures.count += 1;
            }
        });
    }

    /// Resolver readings of a T3 at the robot's position; invalid where a T3 cannot reach the position.
    fn resolvers_at(&mut self, sample: &Sample) -> Resolvers {
        let tool = self.bridge.placement().tool_frame(&sample.feedback);
        let Ok(joints) = T3.inverse(&tool, &self.joints) else {
            return Resolvers { valid: false, ..self.resolvers };
        };
        self.joints = joints;
        let steps = f64::from(RESOLVER_COUNTS);
        let count = |joint: f64| {
            let turn = (joint / std::f64::consts::TAU * steps).round().rem_euclid(steps);
            // The value is below 2^17 and not negative.
            turn as u32 % RESOLVER_COUNTS
        };
        Resolvers { counts: joints.map(count), valid: true }
    }
}

fn trouble(sample: &Sample) -> &'static str {
    match sample.link {
        LinkState::Waiting => "no message has arrived yet",
        LinkState::Lost => "it has sent no message for 3 ticks",
        LinkState::Standby(hindrance) => hindrance.text(),
        LinkState::Running => "it follows",
    }
}
