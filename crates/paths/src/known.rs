//! Flights that were looked at: one that comes again with the same things near it, in another job or with a part
//! in another place, is not flown again.

use std::{
    collections::HashMap,
    hash::{DefaultHasher, Hash, Hasher},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use geometry::{frame::Frame, kinematics::Joints};
use plant::{
    clearance::Body,
    room::{Layout, Placed, Room},
    swept::Swept,
};
use taskdata::files::TrajPara;

use crate::{
    flight::{Flown, Robot, Trouble},
    survey::{SIGHT, Seen, Survey},
};

/// Points, and from which of them on the fingers are as open as at the goal.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Points {
    pub list: Vec<(Frame, TrajPara)>,
    pub opens: usize,
}

/// What a flight depends on, but for what stands near it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Asked {
    pub robot: Robot,
    pub gripper: Option<u8>,
    pub held: Option<Placed>,
    pub points: Points,
    /// Opening of the fingers at the start and at the goal, in.
    pub openings: [f64; 2],
    /// Commands of E-move and Subtask.
    pub commands: [&'static str; 2],
    /// Those under which the robot has come to its start.
    pub before: Vec<[&'static str; 2]>,
    /// Clearances are looked at.
    pub clear: bool,
    /// After the first contact nothing is looked at any more.
    pub tries: bool,
}

impl Asked {
    /// A number that is the same for all that are the same.
    fn number(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let tool = self.robot.tool().position;
        let goals = self.points.list.iter().map(|(goal, _)| goal.position);
        for at in goals.chain([tool]) {
            [at.x, at.y, at.z].map(f64::to_bits).hash(&mut hasher);
        }
        (self.commands, self.gripper, self.clear, self.tries).hash(&mut hasher);
        hasher.finish()
    }
}

/// A flight and what was seen on it.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub robot: Robot,
    pub flown: Vec<Flown>,
    pub seen: Vec<Seen>,
    pub trouble: Option<Trouble>,
}

impl Outcome {
    pub fn is_clear(&self) -> bool {
        self.trouble.is_none() && self.seen.iter().all(|seen| seen.touched.is_none())
    }
}

/// Fly, and look at the robot among the devices of a layout.
fn fly(asked: &Asked, room: &Room, layout: &Layout, devices: &[Body]) -> (Outcome, Swept) {
    let Asked { points, openings: [opening, at_goal], .. } = asked;
    let mut robot = asked.robot.clone();
    let start = *robot.joints();
    let mut survey = Survey::new(room, layout, devices, asked.commands, &start, &asked.before);
    let mut seen: Vec<Seen> = Vec::new();
    let mut touched = false;
    let (flown, trouble) = robot.fly(&points.list, |leg, joints: &Joints| {
        if !asked.clear || (asked.tries && touched) {
            return;
        }
        while seen.len() < leg {
            seen.push(survey.take());
        }
        // Fingers need time: they are taken to be as wide as before on the leg on which they close.
        if leg > points.opens || (leg == points.opens && at_goal > opening) {
            survey.open(*at_goal);
        }
        survey.look(leg, joints);
        touched = survey.touches();
    });
    seen.push(survey.take());
    seen.resize_with(flown.len(), Seen::default);
    (Outcome { robot, flown, seen, trouble }, survey.into_swept())
}

/// A flight that was looked at.
#[derive(Debug)]
struct Flight {
    asked: Asked,
    swept: Swept,
    /// What it may have come near.
    near: Vec<Body>,
    outcome: Arc<Outcome>,
}

impl Flight {
    /// The same flight with the same things near it.
    fn answers(&self, asked: &Asked, devices: &[Body]) -> bool {
        let mut near = devices.iter().filter(|body| self.swept.passes(body, SIGHT));
        self.asked == *asked
            && self.near.iter().all(|known| near.next().is_some_and(|body| body.is_same(known)))
            && near.next().is_none()
    }
}

/// The flights in one cell: of one check, or of several whose task data differ.
#[derive(Debug, Default)]
pub struct Known {
    flights: Mutex<HashMap<u64, Arc<Mutex<Vec<Flight>>>>>,
}

impl Known {
    /// What comes of a flight in a layout of the cell. A flight that another thread is about to look at is waited for.
    pub(crate) fn outcome(&self, asked: Asked, room: &Room, layout: &Layout) -> Arc<Outcome> {
        let devices = room.devices(layout);
        let alike = Arc::clone(locked(&self.flights).entry(asked.number()).or_default());
        let mut alike = locked(&alike);
        if let Some(known) = alike.iter().find(|known| known.answers(&asked, &devices)) {
            return Arc::clone(&known.outcome);
        }
        let (outcome, swept) = fly(&asked, room, layout, &devices);
        let outcome = Arc::new(outcome);
        let near = devices.iter().filter(|body| swept.passes(body, SIGHT)).cloned().collect();
        alike.push(Flight { asked, swept, near, outcome: Arc::clone(&outcome) });
        outcome
    }
}

/// A thread that panicked has left no flight half noted.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
