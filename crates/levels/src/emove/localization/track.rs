//! The path on which the joystick box moves the robot (docs/design/recovery.md "Return").
//!
//! ```text
//!   known place . - - point ---- point            the robot is at the end; a detour that it has
//!                       |                         retraced is removed from the record
//!                     point ------------ end
//! ```
//!
//! The resolvers are recorded, thinned to straight segments.

use geometry::{
    frame::{Distance, Vector, norm},
    pose::{POINT_DISTANCE, Pose},
    units::inches,
};
use interfaces::{
    CommonMemory,
    prim::PrimVerb,
    track::{Course, Track},
};

use super::Localization;
use crate::emove::{
    robot_place::{is_cut_off, is_moved_by_hand},
    tables::{
        Knowledge, PlaceKnowledge,
        track::{EmoveLine, Mover, TrackChange, TrackStep, Tracking, track},
    },
};

/// Distance between two recorded poses. The box moves the robot 0.2 in per tick, and a process may miss two ticks.
const STEP_INCHES: f64 = 0.6;
const STEP_RADIANS: f64 = 0.05;
const SPACING_INCHES: f64 = 0.1; // between recorded poses
const SPACING_RADIANS: f64 = core::f64::consts::PI / 180.0; // 1 degree
/// Distance from the start of a segment that sets its direction. Less is inexact, since poses are rounded to 0.01 in.
const AIM_INCHES: f64 = 0.5;
/// Distance from the line of a segment that is extended; less than the spacing, so that a corner starts a new one.
const ASIDE_INCHES: f64 = 0.05;
const TURN_RADIANS: f64 = 2.0 * core::f64::consts::PI / 180.0; // 2 degrees
const AGAIN_RADIANS: f64 = 0.5 * core::f64::consts::PI / 180.0; // half a degree: the robot is on a recorded segment

fn vector([x, y, z]: [i32; 3]) -> Vector {
    Vector::new(inches(x), inches(y), inches(z))
}

fn apart(a: &Pose, b: &Pose) -> Distance {
    let [tool, wrist, finger] =
        [(a.tool, b.tool), (a.wrist, b.wrist), (a.finger, b.finger)].map(|(a, b)| vector(b) - vector(a));
    let turned = norm(&(tool - wrist)).max(norm(&(finger - tool)));
    Distance { inches: norm(&tool), radians: turned / POINT_DISTANCE }
}

/// Distance along the line, and from it, in.
fn on_line(pose: &Pose, from: &Pose, heading: &Vector) -> (f64, f64) {
    let offset = vector(pose.tool) - vector(from.tool);
    let along = offset.dot(heading);
    (along, norm(&(offset - heading * along)))
}

/// Zero if the poses coincide.
fn heading(from: &Pose, to: &Pose) -> Vector {
    let way = vector(to.tool) - vector(from.tool);
    let length = norm(&way);
    if length > 0.0 { way / length } else { Vector::zeros() }
}

/// The recorded points, the oldest first.
pub(super) fn points(track: &Track) -> impl DoubleEndedIterator<Item = &Pose> + ExactSizeIterator {
    track.points.get(..usize::from(track.count)).unwrap_or_default().iter()
}

fn last(track: &Track) -> Option<&Pose> {
    points(track).next_back()
}

fn is_on(pose: &Pose, from: &Pose, to: &Pose) -> bool {
    let (along, aside) = on_line(pose, from, &heading(from, to));
    if aside > ASIDE_INCHES || along < -ASIDE_INCHES {
        return false;
    }
    let length = apart(from, to);
    let turned = apart(pose, from).radians + apart(pose, to).radians;
    along <= length.inches + ASIDE_INCHES && turned <= length.radians + AGAIN_RADIANS
}

/// Number of points up to the start of the recorded segment that contains a pose.
fn found(track: &Track, pose: &Pose) -> Option<u8> {
    let ends = points(track).skip(1).chain([&track.end]);
    let on = points(track).zip(ends).position(|(from, to)| is_on(pose, from, to));
    u8::try_from(on?.saturating_add(1)).ok()
}

/// Cut the record off at a pose on the segment that starts with the `count`th point.
fn cut(track: &mut Track, count: u8, pose: &Pose) {
    let next = track.points.get(usize::from(count)).filter(|_| count < track.count).copied();
    let to = next.unwrap_or(track.end);
    track.count = count;
    if let Some(from) = last(track) {
        track.heading = heading(from, &to).into();
    }
    track.end = *pose;
}

fn begin(track: &mut Track, pose: &Pose) {
    let [first, ..] = &mut track.points;
    *first = track.end;
    track.count = 1;
    track.heading = heading(&track.end, pose).into();
    track.end = *pose;
    track.course = Course::Tracked;
}

/// False if the record is full.
fn add(track: &mut Track, pose: &Pose) -> bool {
    let moved = apart(&track.end, pose);
    if moved.inches < SPACING_INCHES && moved.radians < SPACING_RADIANS {
        return true;
    }
    let line = Vector::from(track.heading);
    if let Some(from) = last(track) {
        let (along, aside) = on_line(pose, from, &line);
        if along >= 0.0 && aside <= ASIDE_INCHES && apart(from, pose).radians <= TURN_RADIANS {
            if along <= AIM_INCHES {
                track.heading = heading(from, pose).into();
            }
            track.end = *pose;
            return true;
        }
    }
    if let Some(count) = found(track, pose) {
        cut(track, count, pose);
        return true;
    }
    let (end, count) = (track.end, track.count);
    let Some(free) = track.points.get_mut(usize::from(count)) else { return false };
    *free = end;
    track.count = count.saturating_add(1);
    track.heading = heading(&end, pose).into();
    track.end = *pose;
    true
}

const fn is_motion(order: PrimVerb) -> bool {
    matches!(
        order,
        PrimVerb::GoThru | PrimVerb::GotoPt | PrimVerb::GoUntil | PrimVerb::GoWhile | PrimVerb::DeltaMove
    )
}

impl Localization {
    pub(in crate::emove) fn sense_track(&mut self, place: PlaceKnowledge, memory: &CommonMemory) {
        let Some(present) = memory.prim.status.sensor_pose.and_then(|pose| memory.changing_pose(pose)) else {
            return;
        };
        let record = &mut self.track;
        let (led, sent) = (is_moved_by_hand(memory), is_motion(memory.emove.prim.command));
        record.by_hand = led || (record.by_hand && !sent);
        let gap = apart(&record.end, present);
        let near = gap.inches <= STEP_INCHES && gap.radians <= STEP_RADIANS;
        let has_left = !near && record.course == Course::Tracked && (led || !sent);
        let back = if has_left { found(record, present) } else { None };
        let tracking = Tracking {
            place: if place == PlaceKnowledge::Known { Knowledge::Known } else { Knowledge::Unknown },
            course: record.course,
            mover: match record.by_hand {
                _ if sent && !led => Mover::Emove,
                true => Mover::Box,
                false => Mover::Hold,
            },
            line: if is_cut_off(memory) { EmoveLine::Failed } else { EmoveLine::Sound },
            step: match back {
                _ if near => TrackStep::Near,
                Some(_) => TrackStep::Back,
                None => TrackStep::Far,
            },
        };
        match track((), &tracking).action {
            TrackChange::Keep => {}
            TrackChange::Note if record.course == Course::Known => record.end = *present,
            TrackChange::Note => {
                let by_hand = record.by_hand;
                *record = Track { course: Course::Known, by_hand, end: *present, ..Track::default() };
            }
            TrackChange::Begin => begin(record, present),
            TrackChange::Add if add(record, present) => {}
            TrackChange::Shorten => cut(record, back.unwrap_or_default(), present),
            TrackChange::Add | TrackChange::Break => record.course = Course::Broken,
            TrackChange::Drift => record.course = Course::Adrift,
        }
    }
}
