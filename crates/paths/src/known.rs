//! Caches flights. A flight is simulated again only if the bodies near it have changed.

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
    flight::{MotionError, PointMotion, Robot},
    survey::{SIGHT, Seen, Survey},
};

/// From the index `opens` on, the fingers have the opening of the goal.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Points {
    pub list: Vec<(Frame, TrajPara)>,
    pub opens: usize,
}

/// All inputs of a flight except the bodies near it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FlightInputs {
    pub robot: Robot,
    pub gripper: Option<u8>,
    pub held: Option<Placed>,
    pub points: Points,
    pub openings: [f64; 2],             // inches, at start and goal
    pub commands: [&'static str; 2],    // of E-move and Subtask
    pub before: Vec<[&'static str; 2]>, // the commands that brought the robot to its start
    pub clear: bool,                    // clearances are checked
    pub tries: bool,                    // the check ends at the first contact
}

impl FlightInputs {
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

#[derive(Debug)]
pub(crate) struct Outcome {
    pub robot: Robot,
    pub flown: Vec<PointMotion>,
    pub seen: Vec<Seen>,
    pub trouble: Option<MotionError>,
}

impl Outcome {
    pub fn is_clear(&self) -> bool {
        self.trouble.is_none() && self.seen.iter().all(|seen| seen.touched.is_none())
    }
}

fn fly(asked: &FlightInputs, room: &Room, layout: &Layout, devices: &[Body]) -> (Outcome, Swept) {
    let FlightInputs { points, openings: [opening, at_goal], .. } = asked;
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
        // On the leg on which the fingers close, the wider opening applies.
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

#[derive(Debug)]
struct Flight {
    asked: FlightInputs,
    swept: Swept,
    near: Vec<Body>,
    outcome: Arc<Outcome>,
}

impl Flight {
    fn answers(&self, asked: &FlightInputs, devices: &[Body]) -> bool {
        let mut near = devices.iter().filter(|body| self.swept.passes(body, SIGHT));
        self.asked == *asked
            && self.near.iter().all(|known| near.next().is_some_and(|body| body.is_same(known)))
            && near.next().is_none()
    }
}

/// Cached flights in one cell, for any task data.
#[derive(Debug, Default)]
pub struct Known {
    flights: Mutex<HashMap<u64, Arc<Mutex<Vec<Flight>>>>>,
}

impl Known {
    /// Waits if another thread checks the same flight.
    pub(crate) fn outcome(&self, asked: FlightInputs, room: &Room, layout: &Layout) -> Arc<Outcome> {
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

/// Locks even after a panic in another thread, because entries are always complete.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
