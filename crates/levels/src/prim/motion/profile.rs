//! Distance along a segment over time: a jerk-limited profile in closed form.
//!
//! A profile changes the velocity to a cruise velocity, cruises, and stops at the goal: up to seven phases of
//! constant jerk, from any velocity and acceleration. The change and the stop may have different limits. A profile
//! is continuous in time and only its *samples* are sent. So differences of samples are means of the true velocity,
//! acceleration and jerk, and stay within the limits, wherever the phases begin between the ticks.
//!
//! The cruise velocity is the highest from which the profile can stop in the remaining distance. A fixed number of
//! bisections over the closed forms finds it; the remaining distance is cruised, so that the end is exact.

use rcs_core::Plain;

use super::limits::Limits;

/// With this many, the error of 14 in/s over 2^48 is less than a rounding error of the path.
const BISECTIONS: u32 = 48;
/// Shorter paths are treated as no motion, inches.
pub const NO_PATH: f64 = 1e-9;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SegmentState {
    pub position: f64,     // in, from the start
    pub velocity: f64,     // in/s, negative only by rounding
    pub acceleration: f64, // in/s²
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JerkPhase {
    pub duration: f64, // s
    pub jerk: f64,     // in/s³
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Profile {
    pub start: SegmentState,    // state at clock 0
    pub change: [JerkPhase; 3], // to the cruise velocity
    pub cruise: f64,            // s
    pub stop: [JerkPhase; 3],   // from the cruise velocity to rest
    pub to_goal: bool,          // otherwise the profile ends where it comes to rest
    pub clock: f64,             // s since `start`
}

impl SegmentState {
    #[must_use]
    fn after(&self, time: f64, jerk: f64) -> Self {
        let (v, a) = (self.velocity, self.acceleration);
        Self {
            position: self.position + time * (v + time * (a / 2.0 + time * (jerk / 6.0))),
            velocity: v + time * (a + time * (jerk / 2.0)),
            acceleration: a + time * jerk,
        }
    }

    #[must_use]
    fn after_all(&self, phases: &[JerkPhase; 3]) -> Self {
        phases.iter().fold(*self, |state, phase| state.after(phase.duration, phase.jerk))
    }

    /// The velocity after the acceleration has been reduced to zero.
    #[must_use]
    fn settled(&self, limits: &Limits) -> f64 {
        self.velocity + self.acceleration * self.acceleration.abs() / (2.0 * limits.jerk)
    }
}

fn duration(phases: &[JerkPhase; 3]) -> f64 {
    phases.iter().map(|phase| phase.duration).sum()
}

/// The fastest change from a state to a velocity without acceleration.
fn change(from: &SegmentState, velocity: f64, limits: &Limits) -> [JerkPhase; 3] {
    // A slow-down is a mirrored speed-up.
    let side = if velocity >= from.settled(limits) { 1.0 } else { -1.0 };
    let gain = side * (velocity - from.velocity);
    let begin = side * from.acceleration;
    // Velocity gained from `begin` up to the peak and down to zero: (2 peak² - begin²) / 2 jerk.
    let peak = libm::sqrt((limits.jerk * gain + begin * begin / 2.0).max(0.0)).min(limits.acceleration);
    let level = gain - (peak * peak - begin * begin / 2.0) / limits.jerk;
    [
        JerkPhase { duration: ((peak - begin) / limits.jerk).max(0.0), jerk: side * limits.jerk },
        JerkPhase { duration: if peak > 0.0 { (level / peak).max(0.0) } else { 0.0 }, jerk: 0.0 },
        JerkPhase { duration: peak / limits.jerk, jerk: -side * limits.jerk },
    ]
}

fn stopping_path(velocity: f64, limits: &Limits) -> f64 {
    let ramp = limits.acceleration / limits.jerk;
    let time = if velocity >= limits.acceleration * ramp {
        velocity / limits.acceleration + ramp
    } else {
        2.0 * libm::sqrt(velocity.max(0.0) / limits.jerk)
    };
    velocity * time / 2.0
}

fn end(from: &SegmentState, velocity: f64, change_limits: &Limits, stop_limits: &Limits) -> f64 {
    from.after_all(&change(from, velocity, change_limits)).position + stopping_path(velocity, stop_limits)
}

/// The highest cruise velocity with an end no later than `goal`. `None` if the goal would be overrun, or if a dip
/// to a lower `cap` needs more than the remaining path.
fn cruise_velocity(from: &SegmentState, goal: f64, cap: f64, up: &Limits, down: &Limits) -> Option<f64> {
    if end(from, cap, up, down) <= goal {
        return Some(cap);
    }
    // The end grows with the cruise velocity only above the settled velocity; below it no search is needed.
    let (mut low, mut high) = (from.settled(up).max(0.0), cap);
    if low >= high || end(from, low, up, down) > goal {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = (low + high) / 2.0;
        if end(from, middle, up, down) <= goal {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

impl Profile {
    /// The profile has `cap` in/s at most, speed changes within `up` and a stop within `down`. `None` if impossible
    /// from this state; then the old profile remains in use.
    #[must_use]
    pub fn to_goal(from: &SegmentState, goal: f64, cap: f64, up: &Limits, down: &Limits) -> Option<Self> {
        let nothing = Self { start: *from, to_goal: true, ..Self::default() };
        if goal - from.position < NO_PATH && from.velocity.abs() < NO_PATH {
            return Some(nothing);
        }
        let velocity = cruise_velocity(from, goal, cap, up, down)?;
        let left = goal - end(from, velocity, up, down);
        let cruise = if velocity > 0.0 { left / velocity } else { return None };
        let level = SegmentState { velocity, ..SegmentState::default() };
        let profile =
            Self { change: change(from, velocity, up), cruise, stop: change(&level, 0.0, down), ..nothing };
        Some(profile)
    }

    /// The fastest stop within `limits`, before the goal. `None` if the goal would be overrun.
    #[must_use]
    pub fn to_rest(from: &SegmentState, goal: f64, limits: &Limits) -> Option<Self> {
        let change = change(from, 0.0, limits);
        (from.after_all(&change).position <= goal).then_some(Self { start: *from, change, ..Self::default() })
    }

    /// Clock time of the start of the stop at the goal; `None` if the profile ends elsewhere.
    #[must_use]
    pub fn braking_point(&self) -> Option<f64> {
        self.to_goal.then(|| duration(&self.change) + self.cruise)
    }

    #[must_use]
    pub fn is_braking(&self) -> bool {
        self.braking_point().is_some_and(|begin| self.clock >= begin)
    }

    /// Seconds until rest; 0 or less at rest.
    #[must_use]
    pub fn remaining(&self) -> f64 {
        duration(&self.change) + self.cruise + duration(&self.stop) - self.clock
    }

    #[must_use]
    pub fn now(&self) -> SegmentState {
        let cruise = JerkPhase { duration: self.cruise, jerk: 0.0 };
        let [a, b, c] = self.change;
        let [d, e, f] = self.stop;
        let mut left = self.clock;
        let mut run = |state: SegmentState, phases: &[JerkPhase]| {
            phases.iter().fold(state, |state, phase| {
                let time = left.clamp(0.0, phase.duration.max(0.0));
                left -= time;
                state.after(time, phase.jerk)
            })
        };
        let mut state = run(self.start, &[a, b, c]);
        if self.clock > duration(&self.change) {
            // A rounding error of the acceleration would grow with the square of the cruise time.
            state.acceleration = 0.0;
        }
        run(state, &[cruise, d, e, f])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn limits() -> impl Strategy<Value = Limits> {
        (1_i32..60, 1_i32..200, 1_i32..100).prop_map(|(a, v, s)| Limits::from_counts(a, v, s).unwrap())
    }

    fn at(profile: &Profile, clock: f64) -> SegmentState {
        Profile { clock, ..*profile }.now()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        /// The end is the goal and the limits hold, also from the middle of a profile with another cap.
        #[test]
        fn ends_at_the_goal_within_limits(
            up in limits(), down in limits(), goal in 1e-6_f64..200.0,
            cap in 0.01_f64..1.0, when in 0.0_f64..1.0, second in 0.0_f64..1.0,
        ) {
            let first = Profile::to_goal(&SegmentState::default(), goal, cap * up.velocity, &up, &down).unwrap();
            let when = when * first.braking_point().unwrap();
            let state = at(&first, when);
            let new = if second < 0.1 {
                Profile::to_rest(&state, goal, &up)
            } else {
                Profile::to_goal(&state, goal, second * up.velocity, &up, &down)
            };
            let plan = new.unwrap_or(Profile { start: first.start, ..first });
            let whole = plan.remaining();
            let last = at(&plan, whole);
            prop_assert!(last.position <= goal + 1e-9, "{last:?} after {goal}");
            if plan.to_goal {
                prop_assert!((last.position - goal).abs() < 1e-9, "{last:?} for {goal}");
            }
            prop_assert!(last.velocity.abs() < 1e-6, "{last:?}");
            let (mut before, ceiling) = (plan.start, state.velocity.max(second.max(cap) * up.velocity));
            for k in 0..=200 {
                let now = at(&plan, whole * f64::from(k) / 200.0);
                prop_assert!(now.position >= before.position - 1e-9);
                prop_assert!(now.velocity >= -1e-6, "{now:?}");
                prop_assert!(now.velocity <= ceiling + 1e-6, "{now:?} over {ceiling}");
                prop_assert!(now.acceleration <= up.acceleration + 1e-6);
                prop_assert!(now.acceleration >= -up.acceleration.max(down.acceleration) - 1e-6);
                before = now;
            }
        }
    }

    #[test]
    fn long_move_has_the_printed_duration() {
        // 10 in/s, 10 in/s², 500 in/s³ over 30 in: 2 ramps of 1.02 s, and a cruise of 19.8 in.
        let limits = Limits::from_counts(4, 100, 8).unwrap();
        let profile = Profile::to_goal(&SegmentState::default(), 30.0, 10.0, &limits, &limits).unwrap();
        assert!((profile.remaining() - (2.0 * 1.02 + 1.98)).abs() < 1e-9, "{}", profile.remaining());
        assert!((profile.braking_point().unwrap() - 3.0).abs() < 1e-9);
    }

    #[test]
    fn unreachable_goal_is_refused() {
        let limits = Limits::from_counts(4, 100, 8).unwrap();
        let fast = SegmentState { position: 0.0, velocity: 10.0, acceleration: 0.0 };
        assert_eq!(Profile::to_goal(&fast, 4.0, 10.0, &limits, &limits), None);
        assert_eq!(Profile::to_rest(&fast, 4.0, &limits), None);
        assert!(Profile::to_rest(&fast, 5.2, &limits).is_some());
    }
}
