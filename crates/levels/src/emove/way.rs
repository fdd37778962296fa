//! Continuation of an interrupted path (docs/design/recovery.md "On the way").
//!
//! ```text
//!   from ---depart---> end of depart ---trajectory---> . ---approach---> to
//!                           |     <==== back ====  robot  ==== on ===>
//!                           `---trajectory---> . ---approach---> another goal
//! ```
//!
//! The robot moves on to the same goal, or back along the path to the end of the depart leg and from there to another
//! goal. If it was stopped inside the depart leg, it first completes that leg. If a person has moved it off the path
//! with the joystick, it first returns to the path and stops there, because the goal may be a nest that is closed at
//! its sides. The points of the path are not stored: they follow from its two ends and the task data.

use geometry::{
    frame::{Frame, norm, rotation_by, rotation_vector},
    pose::Pose,
};
use interfaces::{
    CommonMemory,
    emove::{Direction, EmoveCommand, GoneTo, Leg as Part, RobotPlace, Way},
    prim::{PrimReport, PrimVerb},
    process::Inputs,
    track::Course,
};
use taskdata::files::{TaskData, TrajParaId};

use super::{
    back::Back,
    rejoin::{Origination, Rejoin, from_outside},
    robot_place::{THERE_INCHES, THERE_RADIANS, commanded_pose, is_cut_off, place, present_frame},
    route::{Ahead, Goal, Leg, LegGoal, Planning, Route, near, same_location},
    state::State,
    tables::resume::{Beginning, GoalOf, LegNow, Robot, Start, WayBack, resume},
    whereabouts::{LOST_INCHES, LOST_RADIANS},
};

/// The farthest that a commanded pose moves in a tick, in: 14 in/s (A 2.3), and a little more.
const STEP_INCHES: f64 = 0.6;
/// The farthest that it turns in a tick, radians: 1 rad/s, and a little more.
const STEP_RADIANS: f64 = 0.05;
/// Ticks of motion that a link that fails can cut off: between Prim and the arm are the queue of T3I, the
/// line, and the robot controller, which ramps down.
const CUT_OFF_TICKS: f64 = 5.0;

/// How a motion command is carried out from where the robot is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flight {
    /// The way to its goal.
    pub route: Option<Route>,
    /// The part of an interrupted way that is flown back before.
    pub back: Option<Back>,
    /// The first point of the continuation of an interrupted path.
    pub rejoin: Option<Rejoin>,
}

/// The frame of a straight segment that is nearest to a frame: its position, and as much of the segment's
/// turn as of its length lies before it.
#[must_use]
pub fn foot(present: &Frame, start: &Frame, end: &Frame) -> Frame {
    let (along, offset) = (end.position - start.position, present.position - start.position);
    let length = along.dot(&along);
    let share = if length > 0.0 { (along.dot(&offset) / length).clamp(0.0, 1.0) } else { 0.0 };
    let turn = rotation_vector(&(end.rotation * start.rotation.inverse())) * share;
    Frame { position: start.position + along * share, rotation: rotation_by(&turn) * start.rotation }
}

/// How far a frame is from a straight segment, in.
#[must_use]
pub fn beside(present: &Frame, start: &Frame, end: &Frame) -> f64 {
    norm(&(present.position - foot(present, start, end).position))
}

/// The route of a way, from its ends.
///
/// # Errors
/// The data that are missing.
pub fn route_of(way: &Way, data: &TaskData<'_>) -> Result<Route, Planning> {
    if way.straight {
        let stop = Route::between(&way.from, &way.to, data).map(|route| route.stop)?;
        Ok(Route::straight(&way.from, &way.to, stop))
    } else {
        Route::between(&way.from, &way.to, data)
    }
}

/// The segment of the way that the robot is on: its start, its end, and the records of both.
pub(super) fn segment(way: &Way, data: &TaskData<'_>) -> Option<(Frame, Frame, [TrajParaId; 2])> {
    let route = route_of(way, data).ok()?;
    let (end, parameters) = route.point(way.next, data)?;
    let (start, passed) = match way.next.checked_sub(1) {
        Some(point) => route.point(point, data)?,
        None => (way.from.pose.to_frame().ok()?, parameters),
    };
    Some((start, end, [passed, parameters]))
}

/// Is a frame on the segment of the way that the robot is on? Points are passed within their break distance.
fn is_in_corridor(present: &Frame, way: &Way, data: &TaskData<'_>) -> Option<bool> {
    let (start, end, passed) = segment(way, data)?;
    let brk_dst = |id| data.traj_para(id).map_or(0, |parameters| parameters.brk_dst.max(0));
    let cut = f64::from(passed.map(brk_dst).into_iter().max()?) / 100.0;
    let turn = start.distance(&end).radians;
    let (before, after) = (present.distance(&start).radians, present.distance(&end).radians);
    // On the shorter turn from one to the other, with the same tolerance.
    let turned = before + after <= turn + LOST_RADIANS;
    Some(beside(present, &start, &end) <= cut + LOST_INCHES && turned)
}

/// Does Prim still move the robot for its order, or for the one before? A GO-THRU is done before it is at
/// rest.
fn moves(memory: &CommonMemory) -> bool {
    let (order, status) = (&memory.emove.prim, &memory.prim.status);
    let pending = status.echo != order.number;
    match order.command {
        PrimVerb::RobotInit => false,
        PrimVerb::None | PrimVerb::Pause => pending || status.report == PrimReport::Executing,
        _ => true,
    }
}

/// Does a commanded pose belong to the way? It is a tick of motion from the one before. It is farther along the
/// segment after ticks in which E-move was held, and after a link that has begun anew where the arm was.
fn follows(commanded: &Pose, way: &Way, data: &TaskData<'_>) -> bool {
    let (Ok(now), Ok(before)) = (commanded.to_frame(), way.rest.to_frame()) else { return false };
    let within = |ticks: f64| near(&now, &before, ticks * STEP_INCHES, ticks * STEP_RADIANS);
    let may_be_farther = !way.cut_off || within(CUT_OFF_TICKS);
    within(1.0) || (may_be_farther && is_in_corridor(&now, way, data) == Some(true))
}

impl State {
    /// Follow the commanded pose while the robot moves, and note what may have moved it meanwhile: the operator,
    /// or a link that has failed or begun anew.
    pub(super) fn sense_way(&mut self, memory: &CommonMemory, data: &TaskData<'_>) {
        let Some(way) = &mut self.beliefs.way else { return };
        let prim = &memory.prim;
        let report = prim.status.report;
        way.by_hand |= report == PrimReport::JoystickOn;
        way.cut_off |= is_cut_off(memory);
        let moves = matches!(report, PrimReport::Executing | PrimReport::Done) && moves(memory);
        if let Some(commanded) = commanded_pose(memory).filter(|pose| moves && follows(pose, way, data)) {
            way.rest = commanded;
        }
    }

    /// The way that the robot is on, if it has not left it.
    pub(super) fn on_way(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Option<Way> {
        let (way, present) = (self.beliefs.way?, present_frame(inputs.memory)?);
        let rest = way.rest.to_frame().ok()?;
        let at_rest = near(&rest, &present, LOST_INCHES, LOST_RADIANS);
        let (inches, radians) = (CUT_OFF_TICKS * STEP_INCHES, CUT_OFF_TICKS * STEP_RADIANS);
        let may_be_beside = way.by_hand || (way.cut_off && near(&rest, &present, inches, radians));
        let beside = |way: &Way| may_be_beside && is_in_corridor(&present, way, inputs.data) == Some(true);
        if at_rest || beside(&way) {
            return Some(way);
        }
        // What the link has cut off may have begun before the point that Prim had passed.
        let before = way.next.checked_sub(1).filter(|_| way.cut_off && way.direction == Direction::Forward);
        before.map(|next| Way { next, ..way }).filter(beside)
    }

    /// The state variables of RESUME for a goal.
    fn start(&self, goal: &RobotPlace, begin: &Origination, data: &TaskData<'_>) -> Start {
        let robot = match (&begin.place, &begin.way) {
            (Some(_), _) => Robot::AtPlace,
            (None, Some(_)) => Robot::OnWay,
            (None, None) => Robot::Lost,
        };
        let is_here = begin.place.is_some_and(|from| is_same_pose(&from, goal));
        let Some(way) = begin.way.as_ref().filter(|_| robot == Robot::OnWay) else {
            let goal = if is_here { GoalOf::Place } else { GoalOf::Another };
            return Start { robot, goal, back: WayBack::Free, leg: LegNow::Later };
        };
        let route = route_of(way, data).unwrap_or_default();
        let departs = way.next < route.depart_points(data);
        let here = same_location(&place(&way.from), &place(&way.to));
        let closed = here
            && !way.straight
            && route.depart_points(data) == 0
            && matches!(way.from.gone_to, GoneTo::Object(_) | GoneTo::Brought(_))
            && matches!(way.to.gone_to, GoneTo::Object(_));
        Start {
            robot,
            goal: if is_same(&way.to, goal) { GoalOf::Way } else { GoalOf::Another },
            back: if closed { WayBack::Closed } else { WayBack::Free },
            leg: if departs { LegNow::Depart } else { LegNow::Later },
        }
    }

    /// Plan the way of a motion command from where the robot is.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn flight(
        &self,
        command: &EmoveCommand,
        goal: &Goal,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Result<Flight, Planning> {
        let data = inputs.data;
        let to = goal.place(command);
        let begin = self.origination(inputs)?;
        let rejoin = begin.rejoin;
        let flight = |route, back| Flight { route: Some(route), back, rejoin };
        if let (Some(nest), true) = (&begin.place, begin.is_out) {
            return Ok(flight(Route { opening: goal.opening, ..from_outside(nest, &to, data)? }, None));
        }
        match (resume((), &self.start(&to, &begin, data)).action, begin.place, begin.way) {
            (Beginning::Depart, Some(from), _) => {
                Ok(flight(Route { opening: goal.opening, ..Route::between(&from, &to, data)? }, None))
            }
            (Beginning::Settle, Some(from), _) => {
                let back = self.settle_at(&from, begin.offset, data)?;
                let route = Route::here(&from, &to, goal.opening);
                Ok(Flight { rejoin: rejoin.or(back), ..flight(route, None) })
            }
            (Beginning::GoOn, _, Some(way)) => {
                let on = Route { commanded: way.next, opening: goal.opening, ..route_of(&way, data)? };
                Ok(flight(on, None))
            }
            (Beginning::GoOut, _, Some(way)) => {
                let out = Route::between(&way.from, &to, data)?;
                Ok(flight(Route { commanded: way.next, opening: goal.opening, ..out }, None))
            }
            (Beginning::GoBack, _, Some(way)) => {
                let (route, then) = (route_of(&way, data)?, Route::between(&way.from, &to, data)?);
                let back = Back { route, next: way.next, complete: false };
                let commanded = route.depart_points(data);
                Ok(flight(Route { commanded, opening: goal.opening, ..then }, Some(back)))
            }
            (Beginning::RefuseBack, ..) => Err(Planning::ForwardOnly),
            _ => Err(Planning::NoStart),
        }
    }

    /// What lies ahead: first the way itself, if the robot is beside it, then the way back, then the route.
    pub(super) fn ahead(&self, data: &TaskData<'_>) -> Ahead {
        match (&self.back, &self.route) {
            _ if self.rejoin.is_some() => Ahead::Beside,
            (Some(back), _) if !back.complete => {
                if back.leg(data).is_some() {
                    Ahead::Through
                } else {
                    Ahead::Missing
                }
            }
            (_, Some(route)) => route.ahead(data),
            (_, None) => Ahead::Nothing,
        }
    }

    /// True while the fingers must not move yet: beside the way, on the way back, and as long as the next point is a depart
    /// point (docs/design/motion.md "Finger opening").
    pub(super) fn departing(&self, data: &TaskData<'_>) -> bool {
        let back = self.back.is_some_and(|back| !back.complete);
        self.rejoin.is_some() || back || self.route.is_some_and(|route| route.departing(data))
    }

    /// The next leg, which is noted as commanded, with the way that the robot is then on.
    pub(super) fn next_leg(&mut self, memory: &CommonMemory, data: &TaskData<'_>) -> Option<Leg> {
        let rest = commanded_pose(memory).unwrap_or_default();
        if let Some(rejoin) = &mut self.rejoin {
            let (next, parameters) = (rejoin.next(&self.beliefs.track), rejoin.parameters);
            if rejoin.ahead() == 0 {
                self.rejoin = None;
            }
            // A robot that comes back from farther away has left its path, and is at no place: both stay as they are.
            match &mut self.beliefs.way {
                Some(way) if self.beliefs.track.course == Course::Known => way.rest = rest,
                _ => {}
            }
            return Some(Leg { at: LegGoal::Computed(next?.to_frame().ok()?), parameters });
        }
        self.beliefs.place = None;
        let way = |route: &Route, next, direction| Way {
            from: route.from,
            to: route.to,
            next,
            leg: route.part(next, data),
            direction,
            straight: false,
            rest,
            by_hand: false,
            cut_off: false,
        };
        if let Some(back) = self.back.as_mut().filter(|back| !back.complete) {
            let leg = back.leg(data);
            self.beliefs.way = Some(Way {
                straight: self.beliefs.way.is_some_and(|way| way.straight),
                ..way(&back.route, back.next, Direction::Back)
            });
            back.advance(data);
            return leg;
        }
        let route = self.route.as_mut()?;
        let leg = route.leg(data);
        route.advance(data);
        self.beliefs.way = Some(way(route, route.heading(), Direction::Forward));
        leg
    }
}

impl State {
    /// The camera goes straight from one view to the next.
    pub(super) fn leave_view(&mut self, to: RobotPlace, memory: &CommonMemory) {
        let Some(from) = self.beliefs.place.take() else { return };
        self.beliefs.way = Some(Way {
            from,
            to,
            next: 0,
            leg: Part::Approach,
            straight: true,
            direction: Direction::Forward,
            rest: commanded_pose(memory).unwrap_or_default(),
            by_hand: false,
            cut_off: false,
        });
    }
}

/// True if both places are the same pose at the same location, whatever the robot goes to there.
#[must_use]
pub fn is_same_pose(a: &RobotPlace, b: &RobotPlace) -> bool {
    let (Ok(a_frame), Ok(b_frame)) = (a.pose.to_frame(), b.pose.to_frame()) else { return false };
    same_location(&place(a), &place(b)) && near(&a_frame, &b_frame, THERE_INCHES, THERE_RADIANS)
}

/// Is it the same goal: same kind, place, object and grip, and the same pose?
fn is_same(a: &RobotPlace, b: &RobotPlace) -> bool {
    a.gone_to == b.gone_to && place(a) == place(b) && is_same_pose(a, b)
}
