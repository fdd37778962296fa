//! Supervision: the resolvers against the sent path, with robots that lag, freeze, jump and stop.

use std::collections::VecDeque;

use interfaces::t3i::{Following, PathLeft};

use super::*;

struct Lagging {
    bench: Bench,
    ticks: usize,
    past: VecDeque<[u32; 6]>,
    frozen: bool,
    x: f64,
}

impl Lagging {
    fn by(ticks: usize) -> Self {
        let bench = Bench::running();
        let mut robot = Self { bench, ticks, past: VecDeque::new(), frozen: false, x: 0.0 };
        robot.rest(30);
        assert_eq!(robot.following(), Following::OnPath);
        robot
    }

    fn following(&self) -> Following {
        self.bench.memory.t3i.status.following
    }

    fn tick(&mut self) {
        self.bench.step();
        let counts = &mut self.bench.external.devices.resolvers.counts;
        self.past.push_back(*counts);
        if self.frozen || self.past.len() <= self.ticks {
            *counts = self.past[0];
        }
        while !self.frozen && self.past.len() > self.ticks {
            *counts = self.past.pop_front().unwrap();
        }
    }

    fn rest(&mut self, ticks: u32) {
        (0..ticks).for_each(|_| self.tick());
    }

    /// Sends up to `points` points along X until the robot is off its path. True if it follows to the last one.
    fn goes(&mut self, points: u32, inches: f64) -> bool {
        for _ in 0..points {
            self.x += inches;
            self.bench.point(&beside(self.x));
            self.tick();
            if self.following() == Following::OffPath {
                return false;
            }
        }
        self.rest(60);
        self.following() == Following::OnPath
    }

    fn left(&self) -> PathLeft {
        self.bench.memory.t3i.status.left.unwrap()
    }

    fn apart(&self) -> f64 {
        let PathLeft { commanded, fed_back, .. } = self.left();
        commanded.to_frame().unwrap().distance(&fed_back.to_frame().unwrap()).inches
    }
}

#[test]
fn robot_within_the_expected_lag_follows_at_every_speed() {
    for inches in [0.01, 0.1, 0.2, 0.4, 0.55] {
        for ticks in 0..=5 {
            let mut robot = Lagging::by(ticks);
            assert!(robot.goes(50, inches), "{ticks} ticks, {inches} in per tick: {:?}", robot.left());
            assert_eq!(robot.bench.memory.t3i.status.left, None);
        }
    }
}

#[test]
fn robot_beyond_the_expected_lag_stops_within_half_an_inch() {
    for inches in [0.1, 0.2, 0.4, 0.55] {
        for ticks in [13, 25, 75] {
            let mut robot = Lagging::by(ticks);
            assert!(!robot.goes(75, inches), "{ticks} ticks, {inches} in per tick");
            let least = 0.5 + 6.0 * inches;
            assert!((least - 0.05..least + inches).contains(&robot.apart()), "{}", robot.apart());
        }
    }
    let mut slow = Lagging::by(20);
    assert!(slow.goes(100, 0.02), "0.4 in behind at 0.5 in/s");
}

#[test]
fn expected_lag_comes_from_the_robot() {
    for (lag, ticks, follows) in
        [(Some(400), 10, true), (Some(400), 13, false), (Some(0), 3, false), (None, 5, true)]
    {
        let mut robot = Lagging::by(ticks);
        robot.bench.external.devices.robot_lag = lag;
        assert_eq!(robot.goes(50, 0.4), follows, "{lag:?}, {ticks} ticks");
    }
}

#[test]
fn stop_or_jump_is_off_the_path_and_rest_is_not() {
    let mut robot = Lagging::by(2);
    assert!(robot.goes(20, 0.3));
    robot.frozen = true;
    assert!(!robot.goes(20, 0.3), "frozen feedback");
    assert!(robot.apart() < 0.5 + 7.0 * 0.3);
    for (joint, by, what) in [(0, 0.02, "1.4 in"), (5, 0.04, "2.3 degrees")] {
        let mut robot = Lagging::by(2);
        robot.rest(500);
        assert_eq!(robot.following(), Following::OnPath);
        let mut joints = robot.bench.world.line.robot.joints;
        joints[joint] += by;
        robot.bench.external.devices.resolvers.counts = counts(&joints);
        robot.bench.step();
        assert_eq!(robot.following(), Following::OffPath, "a jump of {what} at rest");
    }
}

#[test]
fn invalid_resolvers_are_not_compared() {
    let mut robot = Lagging::by(2);
    robot.bench.external.devices.resolvers.valid = false;
    robot.frozen = true;
    assert!(robot.goes(50, 0.4));
    assert_eq!(robot.bench.memory.t3i.status.deviation, 0);
}

#[test]
pub(super) fn a_robot_off_its_path_gets_nothing_until_a_restart() {
    let mut robot = Lagging::by(2);
    robot.frozen = true;
    assert!(!robot.goes(50, 0.4));
    let Lagging { bench, x, .. } = &mut robot;
    let found = bench.memory.t3i.status;
    assert_eq!((bench.report(), bench.row()), (T3iReport::Error, ("TROUBLE", 3)));
    assert!(bench.memory.device_outputs().robot_stop);
    let stood = bench.at();
    // Points in transit, PAUSE, a restart of the process.
    for command in [T3iVerb::Point, T3iVerb::Point, T3iVerb::Pause, T3iVerb::Point] {
        *x += 0.4;
        bench.memory.prim.t3i.frame = WireFrame::from_frame(&beside(*x));
        bench.command(command);
        bench.step();
        assert_eq!((bench.sent(), bench.report(), bench.at()), (None, T3iReport::Error, stood));
    }
    bench.restart();
    for _ in 0..5 {
        bench.step();
        assert_eq!((bench.sent(), bench.report(), bench.at()), (None, T3iReport::Error, stood));
    }
    let status = bench.memory.t3i.status;
    assert_eq!((status.following, status.left), (Following::OffPath, found.left));
    bench.command(T3iVerb::Restart);
    bench.wait(40);
    let status = bench.memory.t3i.status;
    assert_eq!(
        (bench.report(), status.following, status.left),
        (T3iReport::Finished, Following::OnPath, None)
    );
    assert!(!bench.memory.device_outputs().robot_stop);
    let x = bench.robot_tool().position.x;
    bench.point(&beside(x + 0.1));
    bench.step();
    assert!((bench.robot_tool().position.x - x - 0.1).abs() < 0.02);
}

/// The resolvers of the simulated cell detect a robot at a serial port only after its report.
#[test]
pub(super) fn the_resolvers_have_a_second_to_come_near_a_reported_position() {
    let mut bench = Bench::new();
    bench.step();
    bench.command(T3iVerb::Restart);
    let elsewhere = counts(&HOME_JOINTS.map(|joint| joint + 0.1));
    for tick in 1..=40 {
        bench.external.devices.resolvers.counts = elsewhere;
        bench.step();
        let running = bench.memory.t3i.status.link_running;
        let expected = if tick < 20 { Following::Joining } else { Following::OffPath };
        assert!(tick < 2 || running);
        if !(20..30).contains(&tick) {
            assert_eq!(bench.memory.t3i.status.following, expected, "tick {tick}");
        }
    }
    bench.command(T3iVerb::Restart);
    bench.wait(40);
    assert_eq!(bench.memory.t3i.status.following, Following::OnPath);
}
