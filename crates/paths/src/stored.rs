//! Checks each segment of the stored trajectories once, forward and back, with open and empty fingers.
//!
//! A segment leads from one pose or location point to the next. Approach and depart of objects depend on the object and
//! are checked with the jobs.

use std::collections::HashSet;

use geometry::{
    frame::Frame,
    kinematics::{HOME_JOINTS, T3},
};
use plant::{
    description::Actuators,
    room::{Layout, Room},
};
use taskdata::{
    files::{Direction, LocptId, PathPoint, Place, RefType, Reference, Target, TaskData, TrajPara},
    load::{At, Store},
};

use crate::{
    flight::Robot,
    judge::in_words,
    known::{FlightInputs, Known, Points},
};

#[derive(Clone, Debug)]
pub struct StoredFinding {
    pub at: At, // end of the segment
    pub message: String,
}

#[derive(Clone, Debug, Default)]
pub struct Stored {
    pub segments: usize, // each forward and back
    pub findings: Vec<StoredFinding>,
}

/// A point whose pose does not depend on the destination.
struct Fixed {
    name: String,
    frame: Frame,
    parameters: TrajPara,
    at: At,
}

/// The task data must be valid. `known` caches flights in the same cell.
#[must_use]
pub fn walk_stored(store: &Store, room: &Room, known: &Known) -> Stored {
    let data = store.view();
    let mut stored = Stored::default();
    let mut walked = HashSet::new();
    for (number, record) in data.trajectories.iter().enumerate() {
        let Some(&at) = store.origins().trajectories.get(number) else { continue };
        let mut points = vec![end_of(&data, record.start, Direction::Depart, at)];
        let first = record.path.of(data.paths).and_then(|path| usize::try_from(path.first).ok()).unwrap_or(0);
        for (offset, point) in data.path(record.path).iter().enumerate() {
            let at = store.origins().path_points.get(first + offset).copied().unwrap_or(at);
            points.push(fixed(&data, point, at));
        }
        points.push(end_of(&data, record.end, Direction::Approach, at).map(|end| {
            let last = data.path(record.path).last().and_then(|point| data.traj_para(point.para)).copied();
            Fixed { parameters: last.unwrap_or(end.parameters), ..end }
        }));
        for pair in points.windows(2) {
            let [Some(from), Some(to)] = pair else { continue };
            for (from, to, at) in [(from, to, to.at), (to, from, to.at)] {
                if !walked.insert((from.name.clone(), to.name.clone())) {
                    continue;
                }
                stored.segments += 1;
                let parameters = if from.parameters.vel_max < to.parameters.vel_max {
                    from.parameters
                } else {
                    to.parameters
                };
                if let Some(what) = segment(room, known, &from.frame, &to.frame, parameters) {
                    let message =
                        format!("trajectory {}, from {} to {}: {what}", record.name, from.name, to.name);
                    stored.findings.push(StoredFinding { at, message });
                }
            }
        }
    }
    stored
}

/// Parameters where a point has none of its own.
const FREE: TrajPara = TrajPara { acc_fac: 4, vel_max: 100, smooth: 8, brk_dst: 0 };

/// If the end is a location point, returns its last depart point or first approach point.
fn end_of(data: &TaskData<'_>, end: Reference, direction: Direction, at: At) -> Option<Fixed> {
    let id = (end.kind == RefType::LocationPoint).then(|| LocptId::new(end.number))?;
    let (point, place) = (data.locpt(id)?, Place::point(id));
    let path = match direction {
        Direction::Depart => data.depart_location(&place).and_then(|path| data.path(path).last()),
        Direction::Approach => data.approach_location(&place).and_then(|path| data.path(path).first()),
    };
    let frame = path.and_then(|path| data.point_frame(path, &point.frame)).unwrap_or(point.frame);
    Some(Fixed { name: point.name.to_string(), frame, parameters: FREE, at })
}

fn fixed(data: &TaskData<'_>, point: &PathPoint, at: At) -> Option<Fixed> {
    let (name, frame) = match point.target {
        Target::Pose(id) => data.pose(id).map(|pose| (pose.name, pose.frame)),
        Target::LocationPoint(id) => data.locpt(id).map(|point| (point.name, point.frame)),
        Target::Movetable(_) | Target::Stop => None,
    }?;
    let parameters = data.traj_para(point.para).copied()?;
    Some(Fixed { name: name.to_string(), frame, parameters, at })
}

fn segment(room: &Room, known: &Known, from: &Frame, to: &Frame, parameters: TrajPara) -> Option<String> {
    let joints = T3.within_limits(&T3.inverse(from, &HOME_JOINTS).ok()?);
    let robot = Robot::standing(&Actuators::from(&room.cell().robot), &joints)?;
    let start = room.at_start();
    let opening = room.worn(&start).map_or(start.opening, |gripper| gripper.opening[1]);
    let layout = Layout { opening, ..start };
    let asked = FlightInputs {
        robot,
        gripper: layout.gripper,
        held: None,
        points: Points { list: vec![(*to, parameters)], opens: 0 },
        openings: [opening, opening],
        // Without commands no contact is permitted: contacts at the ends belong to the approaches.
        commands: ["", ""],
        before: Vec::new(),
        clear: true,
        tries: false,
    };
    let outcome = known.outcome(asked, room, &layout);
    let touched = || outcome.seen.iter().find_map(|seen| seen.touched.as_ref()).map(ToString::to_string);
    outcome.trouble.map(|trouble| in_words(trouble).0).or_else(touched)
}
