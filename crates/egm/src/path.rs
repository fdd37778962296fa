//! Computes the target at any time: points arrive once per period, and the robot requests targets every 4 ms.
//!
//! Targets are a function of *time*: a period of 40 ms has 9.92 cycles of the robot. A segment of the spline needs the
//! newest point, so the target is one period later than for a robot that reaches a point one period after its arrival,
//! plus `slack`, by which points may be late.
//!
//! ```text
//!            begin                   no point in time, or stop
//!   Still ───────────► Moving ──────────────────────────────────► Stopping
//!     ▲                                                               │
//!     └───────────────────────────────────────────────────────────────┘ after `stop`
//! ```
//!
//! If no point comes in time, the segment is finished; then the speed falls to zero along the tangent, with an
//! acceleration that begins and ends at zero. A later motion begins at rest.

use crate::{
    Error, Limits,
    pose::{Pose, Twist},
    spline,
};

const MOST_WAITING: usize = 4; // until their segment

/// Times of a path, ns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Times {
    /// Time between two points.
    pub period: u64,
    /// Time by which a point may be late.
    pub slack: u64,
    /// Time in which the speed falls to zero if no point comes.
    pub stop: u64,
}

impl Default for Times {
    /// A period of 40 ms, a slack of 10 ms and a stop in 100 ms.
    fn default() -> Self {
        Self { period: 40_000_000, slack: 10_000_000, stop: 100_000_000 }
    }
}

/// State of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// The target is at rest.
    Still(Pose),
    /// The target follows the points.
    Moving,
    /// The speed falls to zero along the tangent.
    Stopping {
        /// Pose at the start of the stop.
        from: Pose,
        /// Speed at the start of the stop.
        speed: Twist,
        /// Time of the start of the stop, ns.
        since: u64,
    },
}

/// A path through points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    times: Times,
    motion: Motion,
    window: [Pose; 4],           // of the segment, newest last
    segment: u64,                // start, ns
    begun: u64,                  // start of the path, ns
    count: u64,                  // points since the start
    queue: [Pose; MOST_WAITING], // for later segments; `waiting` are valid
    waiting: usize,
}

fn seconds(nanoseconds: u64) -> f64 {
    core::time::Duration::from_nanos(nanoseconds).as_secs_f64()
}

impl Path {
    /// A path at rest.
    #[must_use]
    pub const fn new(times: Times, at: Pose) -> Self {
        let motion = Motion::Still(at);
        Self { times, motion, window: [at; 4], segment: 0, begun: 0, count: 0, queue: [at; 4], waiting: 0 }
    }

    /// State of the path.
    #[must_use]
    pub const fn motion(&self) -> Motion {
        self.motion
    }

    /// The last accepted point.
    #[must_use]
    pub fn last_point(&self) -> Pose {
        let [.., last] = self.window;
        self.waiting.checked_sub(1).and_then(|at| self.queue.get(at)).copied().unwrap_or(last)
    }

    /// Stops the target at `at` immediately.
    pub const fn hold(&mut self, at: Pose) {
        *self = Self::new(self.times, at);
    }

    /// Begins a path at `at`, ns, from rest at `from`; the first point is due one period after `at`.
    pub const fn begin(&mut self, at: u64, from: Pose) {
        let segment = at.saturating_add(self.times.slack);
        let still = Self::new(self.times, from);
        *self = Self { motion: Motion::Moving, begun: at, segment, ..still };
    }

    /// Takes a point that arrived at `at`, ns. Errors: [`Error::NotReady`] if the path is not moving, or the point is
    /// more than half a period early or late; [`Error::Full`]; [`Error::TooFast`] or [`Error::Outside`].
    pub fn push(&mut self, at: u64, point: &Pose, limits: &Limits) -> Result<(), Error> {
        if self.motion != Motion::Moving {
            return Err(Error::NotReady);
        }
        let count = self.count.saturating_add(1);
        let due = self.begun.saturating_add(count.saturating_mul(self.times.period));
        if at.abs_diff(due) > self.times.period / 2 {
            return Err(Error::NotReady);
        }
        limits.check(&self.last_point(), point, seconds(self.times.period))?;
        let slot = self.queue.get_mut(self.waiting).ok_or(Error::Full)?;
        (*slot, self.waiting, self.count) = (*point, self.waiting.saturating_add(1), count);
        Ok(())
    }

    /// Target and speed at `now`, ns; `now` must not decrease.
    pub fn target(&mut self, now: u64) -> (Pose, Twist) {
        while self.motion == Motion::Moving && now >= self.segment.saturating_add(self.times.period) {
            self.segment = self.segment.saturating_add(self.times.period);
            if !self.next_segment() {
                let (from, speed) = spline::evaluate(&self.window, 1.0, seconds(self.times.period));
                self.stop(self.segment, from, speed);
            }
        }
        match self.motion {
            Motion::Still(at) => (at, Twist::default()),
            Motion::Moving => {
                let period = seconds(self.times.period);
                let u = seconds(now.saturating_sub(self.segment)) / period;
                spline::evaluate(&self.window, u, period)
            }
            Motion::Stopping { from, speed, since } => {
                self.stopping(&from, &speed, now.saturating_sub(since))
            }
        }
    }

    /// Stops along the tangent, beginning with a pose and a speed at the time `since`, ns.
    pub const fn stop(&mut self, since: u64, from: Pose, speed: Twist) {
        self.hold(from);
        self.motion = Motion::Stopping { from, speed, since };
    }

    fn next_segment(&mut self) -> bool {
        let Some(rest) = self.waiting.checked_sub(1) else { return false };
        let [_, second, third, fourth] = self.window;
        let [next, ..] = self.queue;
        self.window = [second, third, fourth, next];
        self.queue.rotate_left(1);
        self.waiting = rest;
        true
    }

    /// The speed falls as (1 - s)^2 (1 + 2 s), with `s` from 0 to 1 in the stopping time.
    fn stopping(&mut self, from: &Pose, speed: &Twist, elapsed: u64) -> (Pose, Twist) {
        let stop = seconds(self.times.stop);
        let s = (seconds(elapsed) / stop).min(1.0);
        let way = speed.scaled(stop * (s - s * s * s + s * s * s * s / 2.0));
        let pose = from.moved(&way);
        if s >= 1.0 {
            self.hold(pose);
            return (pose, Twist::default());
        }
        (pose, speed.scaled((1.0 - s) * (1.0 - s) * (1.0 + 2.0 * s)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::norm;

    const MS: u64 = 1_000_000;
    const LIMITS: Limits = Limits::of_speed(400.0, 1.2);

    fn at(x: f64) -> Pose {
        Pose { position: [x, 0.0, 0.0], ..Pose::IDENTITY }
    }

    fn moving(points: u32) -> Path {
        let mut path = Path::new(Times::default(), at(0.0));
        path.begin(0, at(0.0));
        for point in 1..=points {
            let now = u64::from(point) * 40 * MS;
            path.target(now);
            path.push(now, &at(f64::from(point) * 10.0), &LIMITS).unwrap();
        }
        path
    }

    #[test]
    fn a_steady_path_lags_by_one_period_and_the_slack() {
        let mut path = moving(10);
        // Point 10 arrived at 400 ms, for 440 ms, at 100 mm. The target is there 50 ms later.
        let (pose, speed) = path.target(449 * MS);
        assert!((pose.position[0] - 90.0 + 0.25).abs() < 1e-9, "{pose:?}");
        assert!((speed.linear[0] - 250.0).abs() < 1e-9, "{speed:?}");
    }

    #[test]
    fn points_that_repeat_are_ended_at_exactly() {
        let mut path = moving(5);
        for point in 6..12_u64 {
            path.target(point * 40 * MS);
            path.push(point * 40 * MS, &at(50.0), &LIMITS).unwrap();
        }
        assert_eq!(path.target(12 * 40 * MS), (at(50.0), Twist::default()));
    }

    #[test]
    fn a_late_point_ends_the_motion_along_its_tangent_and_without_a_jump() {
        let mut path = moving(10);
        let mut last = path.target(440 * MS);
        for now in (440 * MS..700 * MS).step_by(4_032_000) {
            let (pose, speed) = path.target(now);
            let way = norm(&crate::pose::subtract(&pose.position, &last.0.position));
            assert!(way <= 250.0 * 0.00404 && pose.position[0] >= last.0.position[0], "{way} mm at {now}");
            let braked = last.1.linear[0] - speed.linear[0];
            assert!((-1e-9..=250.0 * 1.5 / 0.1 * 0.00404).contains(&braked), "{braked} mm/s at {now}");
            last = (pose, speed);
        }
        assert_eq!(path.motion(), Motion::Still(last.0));
        // The segment ends at 90 mm; 250 mm/s times half of 100 ms adds 12.5 mm.
        assert!((last.0.position[0] - 102.5).abs() < 1e-9, "{last:?}");
        assert_eq!(
            path.push(700 * MS, &at(110.0), &LIMITS),
            Err(Error::NotReady),
            "nothing continues by itself"
        );
    }

    #[test]
    fn points_off_their_time_beyond_limits_or_beyond_room_are_refused() {
        let mut path = moving(3);
        assert_eq!(path.push(200 * MS, &at(40.0), &LIMITS), Err(Error::NotReady), "a period late");
        assert_eq!(path.push(130 * MS, &at(40.0), &LIMITS), Err(Error::NotReady), "a period early");
        assert!(matches!(path.push(160 * MS, &at(60.0), &LIMITS), Err(Error::TooFast { .. })));
        for (point, room) in (4..8_u64).zip([true, true, true, false]) {
            let pushed = path.push(point * 40 * MS, &at(30.0), &LIMITS);
            assert_eq!(pushed, if room { Ok(()) } else { Err(Error::Full) });
        }
    }
}
