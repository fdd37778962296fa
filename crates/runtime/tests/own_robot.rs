//! A robot of the caller instead of the T3.

use depc::{
    Plate,
    controller::{Refusal, Robot, joints_for},
    warning::Warning,
};
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
fn it_does_the_job_and_the_cell_follows_it() {
    let outcome = run(u32::MAX);
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    let part = &outcome.result.parts[0];
    assert_eq!((part.name.as_str(), part.location.as_str()), ("LINKBAR1", "UNIT_1"));
    assert!(outcome.result.simulated.is_some(), "the result says which statements are simulated");
    assert_eq!(outcome.result.link.retries, 0);
}

#[test]
fn what_it_complains_of_ends_the_job_in_words() {
    let outcome = run(300);
    let Ending::Failed(failure) = &outcome.ending else { panic!("it was stopped") };
    assert!(failure.text.contains("the robot has left its path"), "{}", failure.text);
}

#[test]
fn a_configuration_that_names_it_needs_it() {
    let mut config = config();
    config.robot.kind = runtime::RobotKind::Own;
    let refused = Run::new(config, Box::new(()));
    assert!(matches!(refused.err(), Some(StartError::NoOwnRobot)));
}
