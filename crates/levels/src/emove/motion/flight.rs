//! The execution of a motion command from the robot's place, or from an interrupted path (docs/design/recovery.md "On
//! the way").
//!
//! ```text
//!   from ---depart---> end of depart ---trajectory---> . ---approach---> to
//!                           |     <==== back ====  robot  ==== on ===>
//!                           `---trajectory---> . ---approach---> another goal
//! ```
//!
//! A motion to the same goal continues. For another goal the robot moves back along the path to the end of the depart
//! leg, and from there to the goal; in the depart leg it first completes that leg. A robot that the operator moved off
//! the path returns to it and stops there, because the goal may be a nest with closed sides.

use geometry::pose::Pose;
use interfaces::{
    emove::{Direction, GoneTo, RobotPlace, Way},
    track::{Course, Track},
};
use rcs_core::Plain;
use taskdata::files::{TaskData, TrajParaId};

use super::route::{Ahead, EmoveGoal, EmoveLeg, LegGoal, Planning, Route, slower};
use crate::emove::{
    localization::{
        path::route_of,
        returning::{StartPlace, settle_at},
    },
    robot_place::{is_same_goal, is_same_pose},
    tables::resume::{CurrentLeg, EmoveRobot, GoalOf, MotionBeginning, MotionStart, ReturnPath, resume},
};

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Flight {
    pub route: Option<Route>,
    pub back: Option<Back>,     // the part of an interrupted way that is retraced first
    pub rejoin: Option<Rejoin>, // points of the return to the place or path
}

/// Progress of a motion. The same order after progress is not a repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Progress {
    pub on: u16,       // points of the route that were sent
    pub back: u16,     // the next point on the way back
    pub is_back: bool, // the robot has been sent to the end of its way back
    pub rejoin: u8,    // points left on the return to the place or path
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Back {
    pub route: Route,
    pub next: u16,      // the point after the robot; the robot moves to the one before
    pub complete: bool, // the end of the depart leg has been commanded
}

/// The points to which the robot moves before its route begins: first back along the record of manual motion.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Rejoin {
    pub track: u8,                 // points of the record that are left; the last one is next
    pub points: [Option<Pose>; 2], // the points after the record
    pub parameters: TrajParaId,
}

impl Back {
    fn leg(&self, data: &TaskData<'_>) -> Option<EmoveLeg> {
        let (_, from) = self.route.point(self.next, data)?;
        let (frame, to) = match self.next.checked_sub(1) {
            Some(point) => self.route.point(point, data)?,
            None => (self.route.from.pose.to_frame().ok()?, from),
        };
        Some(EmoveLeg { at: LegGoal::Computed(frame), parameters: slower(from, to, data) })
    }

    fn advance(&mut self, data: &TaskData<'_>) {
        if self.next <= self.route.depart_points(data) {
            self.complete = true;
        } else {
            self.next = self.next.saturating_sub(1);
        }
    }
}

impl Rejoin {
    pub(in crate::emove) const fn to(pose: Pose, parameters: TrajParaId) -> Self {
        Self { track: 0, points: [None, Some(pose)], parameters }
    }

    fn ahead(&self) -> u8 {
        self.points.iter().flatten().fold(self.track, |ahead, _| ahead.saturating_add(1))
    }

    fn next(&mut self, record: &Track) -> Option<Pose> {
        if record.course != Course::Tracked {
            // The robot is back near its place or path, and moves straight to it.
            self.track = 0;
        }
        if let Some(before) = self.track.checked_sub(1) {
            self.track = before;
            return record.points.get(usize::from(before)).copied();
        }
        self.points.iter_mut().find_map(Option::take)
    }
}

fn way(route: &Route, next: u16, rest: Pose, data: &TaskData<'_>) -> Way {
    Way {
        from: route.from,
        to: route.to,
        next,
        leg: route.part(next, data),
        direction: Direction::Forward,
        straight: false,
        rest,
        by_hand: false,
        cut_off: false,
    }
}

/// The way from a place whose depart leg is complete. The error is the reason why no way exists.
fn from_outside(from: &RobotPlace, to: &RobotPlace, data: &TaskData<'_>) -> Result<Route, Planning> {
    let route = Route::between(from, to, data)?;
    Ok(Route { commanded: route.depart_points(data), ..route })
}

fn start(goal: &RobotPlace, begin: &StartPlace, data: &TaskData<'_>) -> MotionStart {
    let robot = match (&begin.place, &begin.way) {
        (Some(_), _) => EmoveRobot::AtPlace,
        (None, Some(_)) => EmoveRobot::OnWay,
        (None, None) => EmoveRobot::Lost,
    };
    let is_here = begin.place.is_some_and(|from| is_same_pose(&from, goal));
    let Some(way) = begin.way.as_ref().filter(|_| robot == EmoveRobot::OnWay) else {
        let goal = if is_here { GoalOf::Place } else { GoalOf::Another };
        return MotionStart { robot, goal, back: ReturnPath::Free, leg: CurrentLeg::Later };
    };
    let route = route_of(way, data).unwrap_or_default();
    let departs = way.next < route.depart_points(data);
    let here = way.from.site.has_location_of(&way.to.site);
    let closed = here
        && !way.straight
        && route.depart_points(data) == 0
        && matches!(way.from.gone_to, GoneTo::Object(_) | GoneTo::Brought(_))
        && matches!(way.to.gone_to, GoneTo::Object(_));
    MotionStart {
        robot,
        goal: if is_same_goal(&way.to, goal) { GoalOf::Way } else { GoalOf::Another },
        back: if closed { ReturnPath::Closed } else { ReturnPath::Free },
        leg: if departs { CurrentLeg::Depart } else { CurrentLeg::Later },
    }
}

impl Flight {
    /// `to` is the place of the goal. The error is the reason why no motion exists.
    pub(in crate::emove) fn plan(
        goal: &EmoveGoal,
        to: &RobotPlace,
        begin: &StartPlace,
        data: &TaskData<'_>,
    ) -> Result<Self, Planning> {
        let rejoin = begin.rejoin;
        let flight = |route, back| Self { route: Some(route), back, rejoin };
        if let (Some(nest), true) = (&begin.place, begin.is_out) {
            return Ok(flight(Route { opening: goal.opening, ..from_outside(nest, to, data)? }, None));
        }
        match (resume((), &start(to, begin, data)).action, begin.place, begin.way) {
            (MotionBeginning::Depart, Some(from), _) => {
                Ok(flight(Route { opening: goal.opening, ..Route::between(&from, to, data)? }, None))
            }
            (MotionBeginning::Settle, Some(from), _) => {
                let back = settle_at(&from, begin.offset, data)?;
                let route = Route::here(&from, to, goal.opening);
                Ok(Self { rejoin: rejoin.or(back), ..flight(route, None) })
            }
            (MotionBeginning::GoOn, _, Some(way)) => {
                let on = Route { commanded: way.next, opening: goal.opening, ..route_of(&way, data)? };
                Ok(flight(on, None))
            }
            (MotionBeginning::GoOut, _, Some(way)) => {
                let out = Route::between(&way.from, to, data)?;
                Ok(flight(Route { commanded: way.next, opening: goal.opening, ..out }, None))
            }
            (MotionBeginning::GoBack, _, Some(way)) => {
                let (route, then) = (route_of(&way, data)?, Route::between(&way.from, to, data)?);
                let back = Back { route, next: way.next, complete: false };
                let commanded = route.depart_points(data);
                Ok(flight(Route { commanded, opening: goal.opening, ..then }, Some(back)))
            }
            (MotionBeginning::RefuseBack, ..) => Err(Planning::ForwardOnly),
            _ => Err(Planning::NoStart),
        }
    }

    /// The next point: on the return to the way, then on the way back, then on the route.
    pub(in crate::emove) fn ahead(&self, data: &TaskData<'_>) -> Ahead {
        match (&self.back, &self.route) {
            _ if self.rejoin.is_some() => Ahead::Rejoin,
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

    /// True while the fingers must not move: during a return, on the way back, and while the next point is a depart
    /// point (docs/design/motion.md "Finger opening").
    pub(in crate::emove) fn departing(&self, data: &TaskData<'_>) -> bool {
        let back = self.back.as_ref().is_some_and(|back| !back.complete);
        self.rejoin.is_some() || back || self.route.as_ref().is_some_and(|route| route.departing(data))
    }

    /// Records the leg as commanded, and returns the resulting path of the robot too.
    pub(super) fn next_leg(
        &mut self,
        track: &Track,
        is_straight: bool,
        rest: Pose,
        data: &TaskData<'_>,
    ) -> (Option<EmoveLeg>, Option<Way>) {
        if let Some(rejoin) = &mut self.rejoin {
            let (next, parameters) = (rejoin.next(track), rejoin.parameters);
            if rejoin.ahead() == 0 {
                self.rejoin = None;
            }
            let frame = next.and_then(|pose| pose.to_frame().ok());
            return (frame.map(|frame| EmoveLeg { at: LegGoal::Computed(frame), parameters }), None);
        }
        if let Some(back) = self.back.as_mut().filter(|back| !back.complete) {
            let leg = back.leg(data);
            let way = Way {
                direction: Direction::Back,
                straight: is_straight,
                ..way(&back.route, back.next, rest, data)
            };
            back.advance(data);
            return (leg, Some(way));
        }
        let Some(route) = &mut self.route else { return (None, None) };
        let leg = route.leg(data);
        route.advance(data);
        (leg, Some(way(route, route.heading(), rest, data)))
    }

    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress {
            on: self.route.as_ref().map_or(0, |route| route.commanded),
            back: self.back.as_ref().map_or(0, |back| back.next),
            is_back: self.back.as_ref().is_some_and(|back| back.complete),
            rejoin: self.rejoin.as_ref().map_or(0, Rejoin::ahead),
        }
    }
}
