//! The trajectory generator: the manual's Traj-program, which it does not describe (V.1).
//!
//! Each segment is a straight line with its own jerk-limited [`profile`]. Every profile stops at the end of its
//! line, also at through points, so that the motion can stop at any time and needs no next goal. At a through point
//! two motions are superposed: the old segment continues to brake (the *residual*) while the new one starts from
//! rest *at the through point*:
//!
//! ```text
//!  velocity   old ________                       frame = new segment's frame, displaced by
//!                         \      ________ new            the rest of the residual
//!                          \    /
//!                           \  /
//!                            \/
//!                            /\
//!   ________________________/__\__________ time
//!                          ^ new segment starts: not before the old one brakes
//! ```
//!
//! * The new segment starts no earlier than the old one brakes, and accelerates no faster than it brakes. So the sum
//!   of both velocities never exceeds the larger limit, and a straight passage runs at full speed if its next goal
//!   arrives in time.
//! * Braking towards a through point and starting over a residual use half of acceleration and jerk each, so the
//!   vector sum keeps the limits at any angle. Starts without a residual and the last stop use all of them.
//! * At most two motions are superposed: a through point is passed only when no older residual is left.
//! * Knob, PAUSE and an early new goal are a new velocity for the running profile. After a stop the next segment
//!   starts where the stop ended.
//!
//! Rotations are superposed as world rotations. Their acceleration then has a small extra term, at most the product
//! of both angular velocities.

pub mod limits;
pub mod profile;
pub mod segment;
#[cfg(test)]
mod tests;

use geometry::frame::Frame;
use rcs_core::{Plain, tick::TICK_S};

use self::{
    limits::Limits,
    profile::{Profile, SegmentState},
    segment::{FrameData, Segment, SegmentOrder},
};

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimMotion {
    pub at: FrameData,
    pub goal: FrameData, // goal of the last order; after a halt, the commanded frame
    pub residual: Option<Segment>, // the previous segment, which brakes into its through point
    pub current: Option<Segment>,
    pub next: Option<SegmentOrder>,
    pub halting: bool, // the motion comes to rest before the next segment starts
}

impl PrimMotion {
    #[must_use]
    pub fn at_rest(frame: &Frame) -> Self {
        let at = FrameData::from(frame);
        Self { at, goal: at, ..Self::default() }
    }

    #[must_use]
    pub fn frame(&self) -> Frame {
        self.at.frame()
    }

    /// Path from the commanded frame to the goal of the last order, inches.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.frame().distance(&self.goal.frame()).path()
    }

    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.current.is_none() && self.residual.is_none() && self.next.is_none() && !self.halting
    }

    /// After a GO-THRU, the next order may be given: no older residual is left, and the point is within brake distance.
    #[must_use]
    pub fn is_passing(&self) -> bool {
        let alone = self.residual.is_none() && self.next.is_none() && !self.halting;
        let near = |segment: &Segment| segment.order.through.is_some_and(|brake| self.distance() < brake);
        alone && self.current.as_ref().is_none_or(near)
    }

    /// Go directly if the motion [`is_passing`](Self::is_passing) a through point, else after a halt.
    pub fn go(&mut self, goal: &Frame, limits: &Limits, through: Option<f64>) {
        self.halting = !self.is_passing();
        let goal = FrameData::from(goal);
        self.goal = goal;
        self.next = Some(SegmentOrder { goal, through, limits: *limits });
    }

    /// Come to rest as soon as the limits allow, and discard the goal.
    pub fn halt(&mut self) {
        self.next = None;
        self.halting = self.current.is_some() || self.residual.is_some();
        if !self.halting {
            self.goal = self.at;
        }
    }

    /// Set the position of a robot that was moved by other means. A waiting order starts there.
    pub fn put(&mut self, frame: &Frame) {
        self.at = FrameData::from(frame);
        if self.next.is_none() {
            self.goal = self.at;
        }
    }

    /// Continue from rest at the last point, straight to the goal of the last order. The robot may be anywhere.
    pub fn stand(&mut self) {
        let under_way = self.current.filter(|_| !self.halting).map(|segment| segment.order);
        let next = self.next.or(under_way);
        let rested = Self::at_rest(&self.frame());
        *self = if next.is_some() { Self { goal: self.goal, next, ..rested } } else { rested };
    }

    /// `knob` is the velocity knob, 0 to 1000.
    pub fn step(&mut self, knob: u16) {
        if let (Some(order), None, None) = (self.next, &self.current, &self.residual) {
            self.start_from_rest(&order, knob);
        }
        self.follow(knob);
        let before = self.current.map_or(0.0, |current| current.profile.clock);
        for segment in [&mut self.residual, &mut self.current].into_iter().flatten() {
            segment.profile.clock += TICK_S;
        }
        if let (Some(order), Some(current), false) = (self.next, self.current, self.halting) {
            self.hand_over(&order, current, before, knob);
        }
        self.at = FrameData::from(&self.superposed());
        self.retire();
    }

    fn superposed(&self) -> Frame {
        let frame = self
            .current
            .as_ref()
            .map_or_else(|| self.at.frame(), |current| current.missing().apply(&current.order.goal.frame()));
        self.residual.as_ref().map_or(frame, |residual| residual.missing().apply(&frame))
    }

    fn start_from_rest(&mut self, order: &SegmentOrder, knob: u16) {
        self.current = Some(Segment::new(&self.at.frame(), order));
        self.next = None;
        self.halting = false;
        self.plan(&SegmentState::default(), knob);
    }

    fn follow(&mut self, knob: u16) {
        let current = self.current.as_ref().filter(|current| {
            !current.profile.is_braking() && self.velocity(&current.order, knob) != current.velocity
        });
        if let Some(now) = current.map(|current| current.profile.now()) {
            self.plan(&now, knob);
        }
    }

    /// The permitted velocity, in/s.
    fn velocity(&self, order: &SegmentOrder, knob: u16) -> f64 {
        if self.halting { 0.0 } else { order.limits.velocity_at(knob) }
    }

    /// If no plan is possible from this state, the old one remains and ends at the goal; the next tick tries again.
    fn plan(&mut self, from: &SegmentState, knob: u16) {
        let Some(current) = &self.current else { return };
        let (order, length) = (current.order, current.length);
        let velocity = self.velocity(&order, knob);
        let (up, overlap) = match &self.residual {
            Some(residual) => {
                let share = order.limits.share().within(&residual.order.limits.share());
                (share, residual.profile.remaining())
            }
            None => (order.limits, 0.0),
        };
        let plan = if velocity > 0.0 {
            let stop = |down: &Limits| Profile::to_goal(from, length, velocity, &up, down);
            // A last stop uses all of the limits, unless the residual still needs its share when the stop begins.
            let whole = if order.through.is_some() { None } else { stop(&order.limits) };
            whole
                .filter(|plan| plan.braking_point().is_some_and(|begin| begin >= overlap))
                .or_else(|| stop(&order.limits.share()))
        } else {
            Profile::to_rest(from, length, &up)
        };
        if let (Some(profile), Some(current)) = (plan, &mut self.current) {
            (current.profile, current.velocity) = (profile, velocity);
        }
    }

    /// The next segment starts as soon as the `old` one brakes. `before` is the old clock in the previous tick.
    fn hand_over(&mut self, order: &SegmentOrder, old: Segment, before: f64, knob: u16) {
        let clock = old.profile.clock;
        let Some(braking_point) = old.profile.braking_point().filter(|begin| clock >= *begin) else {
            return;
        };
        let begin = before.max(braking_point);
        let late = clock - begin;
        let at =
            |clock, segment: Segment| Segment { profile: Profile { clock, ..segment.profile }, ..segment };
        // Plan for the moment at which the new segment begins, possibly between two ticks.
        self.residual = Some(at(begin, old));
        self.current = Some(Segment::new(&old.order.goal.frame(), order));
        self.next = None;
        self.plan(&SegmentState::default(), knob);
        self.residual = Some(at(begin + late, old));
        self.current = self.current.map(|current| at(late, current));
    }

    fn retire(&mut self) {
        self.residual = self.residual.filter(|residual| !residual.is_at_rest());
        let Some(current) = &self.current else { return };
        let ended = current.is_at_rest() && (current.profile.to_goal || self.halting);
        if self.residual.is_some() || !ended {
            return;
        }
        self.current = None;
        self.halting &= self.next.is_some();
        if self.next.is_none() {
            self.goal = self.at;
        }
    }
}
