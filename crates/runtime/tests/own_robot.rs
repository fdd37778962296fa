//! A robot of the caller instead of the T3.

use closed_loop::account::Kind;
use depc::{
    Plate,
    controller::{JointProblem, Refusal, Robot, joints_for},
    warning::Warning,
};
use std::{collections::VecDeque, time::Duration};

use geometry::kinematics::{HOME_JOINTS, Joints, T3};
use runtime::{Ending, LogTarget, OwnRobot, Run, RunConfig, RunOutcome, StartError};

/// Reaches each point one tick later, and reports a fault after a number of points.
struct Follower {
    joints: Joints,
    goal: Plate,
    at: Plate,
    points: u32,
    complains_after: u32,
}

impl Robot for Follower {
    fn present(&mut self) -> Plate {
        self.goal
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.goal = *goal;
        self.points += 1;
        Ok(())
    }

    fn warning(&self) -> Option<Warning> {
        (self.points >= self.complains_after).then_some(Warning::OffPath)
    }
}

impl OwnRobot for Follower {
    fn advance(&mut self) {
        self.at = self.goal;
    }

    fn position(&self) -> Option<Plate> {
        Some(self.at)
    }
}

fn config() -> RunConfig {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");
    RunConfig { log: LogTarget::None, shared_memory: false, ..RunConfig::new(data, "linkbar") }
}

fn run(complains_after: u32) -> RunOutcome {
    let at = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default()).unwrap();
    let robot = Follower { joints: HOME_JOINTS, goal: at, at, points: 0, complains_after };
    Run::with_robot(config(), Box::new(robot), Box::new(())).unwrap().complete()
}

#[test]
fn own_robot_does_the_job_and_the_cell_follows() {
    let outcome = run(u32::MAX);
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    let part = &outcome.result.parts[0];
    assert_eq!((part.name.as_str(), part.location.as_str()), ("LINKBAR1", "UNIT_1"));
    assert!(outcome.result.simulated.is_some(), "the result says which statements are simulated");
    assert_eq!(outcome.result.link.retries, 0);
}

#[test]
fn workstation_error_ends_the_job_with_a_message() {
    let outcome = run(300);
    let Ending::Failed(account) = &outcome.ending else { panic!("it was stopped") };
    assert!(account.first.text.contains("the robot has left its path"), "{account}");
}

/// A robot that shows its position some ticks late, and may have a fault.
struct Lagging {
    robot: Follower,
    lag: Lag,
    path: VecDeque<Plate>, // positions that it has not yet shown
    stopped: bool,
}

/// The kind of lag. A fault begins after this number of accepted points.
#[derive(Clone, Copy)]
struct Lag {
    ticks: usize,
    stated: Duration,
    fault: Fault,
}

#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    Frozen(u32),
    /// The robot waits for 1 s, and catches up.
    Waits(u32),
    Jumps(u32),
}

const MOVES: u32 = 150; // more points than a linkbar has before its first motion: the robot moves

impl Robot for Lagging {
    fn present(&mut self) -> Plate {
        if std::mem::take(&mut self.stopped) {
            self.path.clear();
            self.robot.goal = self.robot.at;
        }
        self.robot.goal
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        assert!(!self.stopped, "a robot that was stopped gets no point");
        self.robot.accept(goal)
    }

    fn stop(&mut self) {
        self.stopped = true;
    }
}

impl OwnRobot for Lagging {
    fn advance(&mut self) {
        let since = |from: u32| self.robot.points.checked_sub(from);
        if self.stopped {
            return;
        }
        self.path.push_back(self.robot.goal);
        let wait = match self.lag.fault {
            Fault::Frozen(from) => since(from).is_some(),
            Fault::Waits(from) => since(from).is_some_and(|points| points < 25),
            Fault::None | Fault::Jumps(_) => false,
        };
        while !wait && self.path.len() > self.lag.ticks.max(1) {
            self.robot.at = self.path.pop_front().unwrap();
        }
        if let Fault::Jumps(from) = self.lag.fault
            && since(from).is_some()
        {
            self.robot.at.words[2] += 300;
        }
    }

    fn position(&self) -> Option<Plate> {
        Some(self.robot.at)
    }

    fn lag(&self) -> Duration {
        self.lag.stated
    }
}

fn lagging(ticks: usize, stated_ms: u64, fault: Fault) -> RunOutcome {
    let at = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default()).unwrap();
    let robot = Follower { joints: HOME_JOINTS, goal: at, at, points: 0, complains_after: u32::MAX };
    let lag = Lag { ticks, stated: Duration::from_millis(stated_ms), fault };
    let robot = Lagging { robot, lag, path: VecDeque::new(), stopped: false };
    Run::with_robot(config(), Box::new(robot), Box::new(())).unwrap().complete()
}

#[test]
fn robot_with_its_stated_lag_does_the_job() {
    // The simulated arm, which the resolvers read, adds its own 80 ms.
    for (ticks, stated) in [(1, 200), (2, 200), (8, 500)] {
        let outcome = lagging(ticks, stated, Fault::None);
        assert!(outcome.is_finished(), "{ticks} ticks: {:?}", outcome.result.failure);
    }
}

#[test]
fn robot_off_its_path_is_stopped_and_reported() {
    let constant = [9, 13, 25, 75].map(|ticks| (ticks, Fault::None));
    let faults = [Fault::Frozen(MOVES), Fault::Waits(MOVES), Fault::Jumps(MOVES)].map(|fault| (2, fault));
    for (ticks, fault) in constant.into_iter().chain(faults) {
        let outcome = lagging(ticks, 200, fault);
        let Ending::Failed(account) = &outcome.ending else { panic!("{ticks} ticks: it was not stopped") };
        assert_eq!(account.first.kind, Kind::OffPath, "{account}");
        let text = &account.first.text;
        assert!(text.starts_with("Prim: the robot is off its commanded path: "), "{ticks} ticks: {text}");
        let inches: f64 = text.split(": ").nth(2).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((0.4..4.5).contains(&inches), "{ticks} ticks: {text}");
        assert!(text.contains(" in), fed back ("), "{text}");
    }
}

/// A robot that refuses points from a number on, as at a joint limit, and then stays at its previous position.
struct Refusing(Follower, Plate);

impl Robot for Refusing {
    fn present(&mut self) -> Plate {
        self.0.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        if self.0.points >= MOVES {
            self.0.at = self.1;
            return Err(Refusal::Joints(JointProblem::ShoulderUp));
        }
        self.0.accept(goal)
    }
}

impl OwnRobot for Refusing {
    fn advance(&mut self) {
        self.0.advance();
    }

    fn position(&self) -> Option<Plate> {
        self.0.position()
    }
}

#[test]
fn refused_point_is_in_the_last_line_and_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("refused.mcap");
    let config = RunConfig { log: LogTarget::File(log.clone()), ..config() };
    let at = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default()).unwrap();
    let robot = Follower { joints: HOME_JOINTS, goal: at, at, points: 0, complains_after: u32::MAX };
    let outcome = Run::with_robot(config, Box::new(Refusing(robot, at)), Box::new(())).unwrap().complete();
    let Ending::Failed(account) = &outcome.ending else { panic!("it was stopped") };
    let refused = "the robot does not accept the commanded position: P05 (joint 2, the shoulder";
    assert_eq!(account.first.kind, Kind::RobotController, "{account}");
    assert!(account.first.text.starts_with(refused), "{account}");
    let log = record::Log::open(&log).unwrap();
    let line = log.lines().find(|line| line.text.starts_with(refused)).expect("a line of the log");
    assert_eq!((line.source.as_str(), line.code.as_str()), ("robot", "robot.refuses"));
}

#[test]
fn configuration_with_own_robot_needs_one() {
    let mut config = config();
    config.robot.kind = runtime::RobotKind::Own;
    let refused = Run::new(config, Box::new(()));
    assert!(matches!(refused.err(), Some(StartError::NoOwnRobot)));
}
