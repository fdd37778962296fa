//! The path on which the robot is. Its points are not stored: they follow from its ends and the task data.

use geometry::{
    frame::{Frame, norm, rotation_by, rotation_vector},
    pose::Pose,
};
use interfaces::{
    CommonMemory,
    emove::{Direction, Leg, RobotPlace, Way},
    prim::{PrimReport, PrimVerb},
    track::Course,
};
use taskdata::files::{TaskData, TrajParaId};

use super::{LOST_INCHES, LOST_RADIANS, Localization};
use crate::emove::{
    EmoveInputs,
    motion::route::{Planning, Route},
    robot_place::{commanded_pose, is_cut_off, near, present_frame},
};

const STEP_INCHES: f64 = 0.6; // per tick: 14 in/s (A 2.3) plus a margin
const STEP_RADIANS: f64 = 0.05; // per tick: 1 rad/s plus a margin
const CUT_OFF_TICKS: f64 = 5.0; // of motion lost with the link: queue, line, ramp of the controller

/// The frame of a straight segment nearest to `present`. It turns in proportion to the distance from the start.
#[must_use]
pub fn foot(present: &Frame, start: &Frame, end: &Frame) -> Frame {
    let (along, offset) = (end.position - start.position, present.position - start.position);
    let length = along.dot(&along);
    let share = if length > 0.0 { (along.dot(&offset) / length).clamp(0.0, 1.0) } else { 0.0 };
    let turn = rotation_vector(&(end.rotation * start.rotation.inverse())) * share;
    Frame { position: start.position + along * share, rotation: rotation_by(&turn) * start.rotation }
}

/// Distance of a frame from a straight segment, in.
#[must_use]
pub fn beside(present: &Frame, start: &Frame, end: &Frame) -> f64 {
    norm(&(present.position - foot(present, start, end).position))
}

/// The error is the missing data.
pub fn route_of(way: &Way, data: &TaskData<'_>) -> Result<Route, Planning> {
    if way.straight {
        let stop = Route::between(&way.from, &way.to, data).map(|route| route.stop)?;
        Ok(Route::straight(&way.from, &way.to, stop))
    } else {
        Route::between(&way.from, &way.to, data)
    }
}

/// The robot's segment of the way: start, end, and the records of both.
pub(super) fn segment(way: &Way, data: &TaskData<'_>) -> Option<(Frame, Frame, [TrajParaId; 2])> {
    let route = route_of(way, data).ok()?;
    let (end, parameters) = route.point(way.next, data)?;
    let (start, passed) = match way.next.checked_sub(1) {
        Some(point) => route.point(point, data)?,
        None => (way.from.pose.to_frame().ok()?, parameters),
    };
    Some((start, end, [passed, parameters]))
}

/// True if a frame is on the robot's segment of the way. Points are passed within their break distance.
fn is_in_corridor(present: &Frame, way: &Way, data: &TaskData<'_>) -> Option<bool> {
    let (start, end, passed) = segment(way, data)?;
    let brk_dst = |id| data.traj_para(id).map_or(0, |parameters| parameters.brk_dst.max(0));
    let cut = f64::from(passed.map(brk_dst).into_iter().max()?) / 100.0;
    let turn = start.distance(&end).radians;
    let (before, after) = (present.distance(&start).radians, present.distance(&end).radians);
    // Compare along the shorter turn between the two, with the same tolerance.
    let turned = before + after <= turn + LOST_RADIANS;
    Some(beside(present, &start, &end) <= cut + LOST_INCHES && turned)
}

/// True if Prim moves the robot for its present or previous order. A GO-THRU is done before the robot is at rest.
fn moves(memory: &CommonMemory) -> bool {
    let (order, status) = (&memory.emove.prim, &memory.prim.status);
    let pending = status.echo != order.number;
    match order.command {
        PrimVerb::RobotInit => false,
        PrimVerb::None | PrimVerb::Pause => pending || status.report == PrimReport::Executing,
        _ => true,
    }
}

/// True if a commanded pose is at most one tick of motion from the previous one. After ticks in which E-move was held,
/// it may be farther along the segment; after a restart of the link, it may be where the arm was.
fn follows(commanded: &Pose, way: &Way, data: &TaskData<'_>) -> bool {
    let (Ok(now), Ok(before)) = (commanded.to_frame(), way.rest.to_frame()) else { return false };
    let within = |ticks: f64| near(&now, &before, ticks * STEP_INCHES, ticks * STEP_RADIANS);
    let may_be_farther = !way.cut_off || within(CUT_OFF_TICKS);
    within(1.0) || (may_be_farther && is_in_corridor(&now, way, data) == Some(true))
}

impl Localization {
    /// Also records other causes of motion: the operator, or a link that has failed or restarted.
    pub(in crate::emove) fn sense_path(&mut self, memory: &CommonMemory, data: &TaskData<'_>) {
        let Some(way) = &mut self.way else { return };
        let prim = &memory.prim;
        let report = prim.status.report;
        way.by_hand |= report == PrimReport::JoystickOn;
        way.cut_off |= is_cut_off(memory);
        let moves = matches!(report, PrimReport::Executing | PrimReport::Done) && moves(memory);
        if let Some(commanded) = commanded_pose(memory).filter(|pose| moves && follows(pose, way, data)) {
            way.rest = commanded;
        }
    }

    /// The robot's path; `None` if the robot has left it.
    pub(super) fn on_path(&self, inputs: &EmoveInputs<'_>) -> Option<Way> {
        let (way, present) = (self.way?, present_frame(inputs.memory)?);
        let rest = way.rest.to_frame().ok()?;
        let at_rest = near(&rest, &present, LOST_INCHES, LOST_RADIANS);
        let (inches, radians) = (CUT_OFF_TICKS * STEP_INCHES, CUT_OFF_TICKS * STEP_RADIANS);
        let may_be_beside = way.by_hand || (way.cut_off && near(&rest, &present, inches, radians));
        let beside = |way: &Way| may_be_beside && is_in_corridor(&present, way, inputs.data) == Some(true);
        if at_rest || beside(&way) {
            return Some(way);
        }
        // The cut-off motion may have begun before the point that Prim had passed.
        let before = way.next.checked_sub(1).filter(|_| way.cut_off && way.direction == Direction::Forward);
        before.map(|next| Way { next, ..way }).filter(beside)
    }

    /// `way` is `None` if the robot returns to the last one.
    pub(in crate::emove) fn depart(&mut self, way: Option<Way>, rest: Pose) {
        if way.is_some() {
            (self.place, self.way) = (None, way);
        } else if let (Some(way), Course::Known) = (&mut self.way, self.track.course) {
            // A robot that returns from farther away has left its path and is at no place, so both stay as they are.
            way.rest = rest;
        }
    }

    /// The camera moves straight from one view to the next.
    pub(in crate::emove) fn leave_view(&mut self, to: RobotPlace, memory: &CommonMemory) {
        let Some(from) = self.place.take() else { return };
        self.way = Some(Way {
            from,
            to,
            next: 0,
            leg: Leg::Approach,
            straight: true,
            direction: Direction::Forward,
            rest: commanded_pose(memory).unwrap_or_default(),
            by_hand: false,
            cut_off: false,
        });
    }

    pub(in crate::emove) fn is_straight(&self) -> bool {
        self.way.is_some_and(|way| way.straight)
    }
}
