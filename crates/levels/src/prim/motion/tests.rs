use std::collections::VecDeque;

use geometry::{
    frame::{Frame, INCHES_PER_RADIAN, Rotation, Vector, norm, rotation_by, rotation_vector},
    movetable::straight_down,
};
use proptest::prelude::*;
use rcs_core::tick::TICK_S;

use super::{PrimMotion, limits::Limits};

/// SplitMix64: a seed identifies a run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn vector(&mut self) -> Vector {
        Vector::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5)
    }

    fn limits(&mut self) -> Limits {
        let mut count = |high: u64| 1 + self.below(high) as i32;
        Limits::from_counts(3 + count(12), 4 + count(140), 4 + count(60)).unwrap()
    }

    /// A goal near a frame: one in four does not turn, one in eight does not move.
    fn goal(&mut self, from: &Frame) -> Frame {
        let size = [0.02, 0.5, 3.0, 12.0][self.below(4) as usize];
        let translation = if self.below(8) == 0 { Vector::zeros() } else { self.vector() * size };
        let turn = if self.below(4) == 0 { Vector::zeros() } else { self.vector() * (size / 8.0) };
        let rotation = rotation_by(&turn) * from.rotation;
        // Exactly orthonormal, like poses from forms.
        let rotation = geometry::frame::rotation_from_x_y(
            &rotation.matrix().column(0).into_owned(),
            &rotation.matrix().column(1).into_owned(),
        );
        Frame { position: from.position + translation, rotation: rotation.unwrap() }
    }
}

/// A rate of change: of the position in in/s^n, of the orientation in rad/s^n.
#[derive(Clone, Copy, Debug)]
struct Rate {
    linear: Vector,
    angular: Vector,
}

impl Rate {
    fn between(a: &Frame, b: &Frame) -> Self {
        let turn: Rotation = b.rotation * a.rotation.inverse();
        Self { linear: (b.position - a.position) / TICK_S, angular: rotation_vector(&turn) / TICK_S }
    }

    fn change(&self, later: &Self) -> Self {
        Self {
            linear: (later.linear - self.linear) / TICK_S,
            angular: (later.angular - self.angular) / TICK_S,
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Allowed {
    limits: Limits,
    superposed: bool,
}

impl Allowed {
    fn with(self, b: &Limits) -> Self {
        let a = self.limits;
        let limits = Limits {
            velocity: a.velocity.max(b.velocity),
            acceleration: a.acceleration.max(b.acceleration),
            jerk: a.jerk.max(b.jerk),
        };
        Self { limits, ..self }
    }

    fn and(self, other: &Self) -> Self {
        Self { superposed: self.superposed || other.superposed, ..self.with(&other.limits) }
    }
}

struct Watch {
    frames: VecDeque<Frame>,
    allowed: VecDeque<Allowed>,
    ticks: u64,
}

impl Watch {
    fn new(motion: &PrimMotion) -> Self {
        Self {
            frames: VecDeque::from([motion.frame(); 4]),
            allowed: VecDeque::from([Allowed::default(); 3]),
            ticks: 0,
        }
    }

    fn step(&mut self, motion: &mut PrimMotion, knob: u16) -> Result<(), String> {
        let before = *motion;
        motion.step(knob);
        let mut allowed = Allowed::default();
        for segment in [before.residual, before.current, motion.residual, motion.current].iter().flatten() {
            allowed = allowed.with(&segment.order.limits);
        }
        if let (Some(next), None) = (before.next, motion.next) {
            // A short move may end in the tick in which it starts.
            allowed = allowed.with(&next.limits);
        }
        allowed.superposed = before.residual.is_some() || motion.residual.is_some();
        self.frames.pop_front();
        self.frames.push_back(motion.frame());
        self.allowed.pop_front();
        self.allowed.push_back(allowed);
        self.ticks += 1;
        self.check().and_then(|()| on_the_line(motion)).map_err(|text| format!("{text} in {motion:#?}"))
    }

    fn check(&self) -> Result<(), String> {
        let allowed = self.allowed.iter().fold(Allowed::default(), |all, one| all.and(one));
        let f = &self.frames;
        let v = [Rate::between(&f[0], &f[1]), Rate::between(&f[1], &f[2]), Rate::between(&f[2], &f[3])];
        let a = [v[0].change(&v[1]), v[1].change(&v[2])];
        let j = a[0].change(&a[1]);
        // Two simultaneous rotations have an extra acceleration, the product of their velocities, and twice that in
        // changes.
        let product =
            if allowed.superposed { allowed.limits.velocity.powi(2) / INCHES_PER_RADIAN } else { 0.0 };
        let limits = allowed.limits;
        for (what, rate, limit, extra, rounding) in [
            ("velocity", v[2], limits.velocity, 0.0, 1e-9),
            ("acceleration", a[1], limits.acceleration, product / 2.0, 1e-7),
            ("jerk", j, limits.jerk, if allowed.superposed { f64::INFINITY } else { 0.0 }, 1e-5),
        ] {
            let rounding = rounding + limit * 1e-9;
            if norm(&rate.linear) > limit + rounding {
                return Err(format!("{what} {} over {limit}", norm(&rate.linear)));
            }
            let angular = norm(&rate.angular) * INCHES_PER_RADIAN;
            // A rotation vector is exact to about 1e-9 rad.
            if angular > limit + extra + rounding * 1e3 {
                return Err(format!("angular {what} {angular} over {limit} + {extra}"));
            }
        }
        Ok(())
    }
}

/// While only one segment is active, the tool point is on its line and not beyond its goal.
fn on_the_line(motion: &PrimMotion) -> Result<(), String> {
    let (None, Some(segment)) = (&motion.residual, &motion.current) else { return Ok(()) };
    let line = Vector::from(segment.translation);
    let missing = segment.order.goal.frame().position - motion.frame().position;
    let length = norm(&line);
    if length < 1e-9 {
        return if norm(&missing) < 1e-8 { Ok(()) } else { Err("left the point".into()) };
    }
    let along = missing.dot(&line) / length;
    let off = norm(&(missing - line * (along / length)));
    if off > 1e-9 || along < -1e-9 || along > length + 1e-9 {
        return Err(format!("{off} in off the line, {along} in to go of {length}"));
    }
    Ok(())
}

/// Executes `moves` random moves with random interference; returns the number of ticks.
fn run(seed: u64, moves: u32) -> Result<u64, String> {
    let mut random = Random(seed);
    let mut motion = PrimMotion::at_rest(&straight_down(Vector::new(-66.5, -5.5, -14.0)));
    let mut watch = Watch::new(&motion);
    let (mut knob, mut goal) = (1000_u16, motion.frame());
    for number in 0..moves {
        let at = |text: String| format!("seed {seed}, move {number}: {text}");
        let limits = random.limits();
        goal = random.goal(&goal);
        let through = (random.below(3) > 0).then(|| [0.0, 0.05, 0.5, 3.0, 20.0][random.below(5) as usize]);
        motion.go(&goal, &limits, through);
        let trouble = random.below(4) == 0;
        if !trouble {
            knob = 1000;
        }
        let (mut steps_left, mut nearest) = (100_000_u32, f64::INFINITY);
        loop {
            if trouble && random.below(20) == 0 {
                knob = [0, 1, 100, 500, 1000, 1000][random.below(6) as usize];
            }
            watch.step(&mut motion, knob).map_err(&at)?;
            nearest = nearest.min(motion.frame().distance(&goal).path());
            if trouble && random.below(60) == 0 {
                motion.halt();
                rest(&mut motion, &mut watch, knob).map_err(&at)?;
                goal = motion.frame();
                break;
            }
            if trouble && random.below(60) == 0 {
                break; // the next goal comes before its time
            }
            if through.is_some() && motion.is_passing() {
                let within = through.unwrap_or(0.0);
                if nearest > within {
                    return Err(at(format!("passed at {nearest} of {within}")));
                }
                break;
            }
            if motion.is_at_rest() {
                if motion.frame() != goal {
                    return Err(at(format!("came to rest at {:?} for {goal:?}", motion.frame())));
                }
                break;
            }
            steps_left -= 1;
            if steps_left == 0 {
                return Err(at(format!("never ends: {motion:#?}")));
            }
            if trouble && steps_left % 500 == 0 {
                knob = 1000;
            }
        }
    }
    Ok(watch.ticks)
}

/// After a halt the motion comes to rest in bounded time and stays at rest.
fn rest(motion: &mut PrimMotion, watch: &mut Watch, knob: u16) -> Result<(), String> {
    let all = [&motion.residual, &motion.current];
    let longest = all.into_iter().flatten().map(|s| {
        let slow = s.order.limits.share();
        slow.velocity / slow.acceleration + 2.0 * slow.acceleration / slow.jerk
    });
    // In the worst case a residual and the segment over it stop one after the other, within the smaller of both
    // limits.
    let slowest = 4.0 * longest.fold(0.0, f64::max) + 1.0;
    let mut left = (slowest / TICK_S) as u32 + 2;
    while !motion.is_at_rest() {
        watch.step(motion, knob)?;
        left = left.checked_sub(1).ok_or_else(|| format!("no rest: {motion:#?}"))?;
    }
    let frame = motion.frame();
    for _ in 0..5 {
        watch.step(motion, knob)?;
    }
    if motion.frame() == frame { Ok(()) } else { Err("creeps after a halt".into()) }
}

/// Number of moves; `RCS_MOVES` overrides it (a million in docs/design/motion.md "Limits").
fn moves() -> u32 {
    std::env::var("RCS_MOVES").ok().and_then(|text| text.parse().ok()).unwrap_or(200_000)
}

#[test]
fn random_moves_break_no_limit() {
    let shares = 8;
    let ticks: u64 = std::thread::scope(|scope| {
        let all: Vec<_> =
            (0..shares).map(|seed| scope.spawn(move || run(seed, moves() / shares as u32))).collect();
        all.into_iter().map(|one| one.join().unwrap().unwrap_or_else(|text| panic!("{text}"))).sum()
    });
    println!("{} moves, {ticks} ticks", moves());
    assert!(ticks > u64::from(moves()));
}

fn printed() -> Limits {
    Limits::from_counts(4, 100, 8).unwrap()
}

fn shifted(frame: &Frame, x: f64, y: f64) -> Frame {
    Frame { position: frame.position + Vector::new(x, y, 0.0), ..*frame }
}

#[test]
fn straight_passage_runs_at_full_speed() {
    let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
    let (via, end) = (shifted(&start, 20.0, 0.0), shifted(&start, 40.0, 0.0));
    let mut motion = PrimMotion::at_rest(&start);
    motion.go(&via, &printed(), Some(12.0));
    let (mut slowest, mut last) = (f64::INFINITY, start);
    while !motion.is_at_rest() {
        if motion.is_passing() && motion.goal.frame() == via {
            motion.go(&end, &printed(), None);
        }
        motion.step(1000);
        let speed = norm(&(motion.frame().position - last.position)) / TICK_S;
        last = motion.frame();
        if (via.position - last.position).x.abs() < 8.0 {
            slowest = slowest.min(speed);
        }
    }
    assert_eq!(last, end);
    assert!(slowest > 10.0 - 1e-6, "{slowest}");
}

#[test]
fn corner_is_cut_within_the_brake_distance() {
    let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
    let (via, end) = (shifted(&start, 20.0, 0.0), shifted(&start, 20.0, 20.0));
    let mut motion = PrimMotion::at_rest(&start);
    motion.go(&via, &printed(), Some(3.0));
    let mut nearest = f64::INFINITY;
    while !motion.is_at_rest() {
        if motion.is_passing() && motion.goal.frame() == via {
            motion.go(&end, &printed(), None);
        }
        motion.step(1000);
        nearest = nearest.min(motion.frame().distance(&via).path());
    }
    assert!(nearest > 0.1 && nearest < 2.0, "{nearest}");
    assert_eq!(motion.frame(), end);
}

#[test]
fn knob_at_zero_holds_and_at_full_resumes() {
    let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
    let goal = shifted(&start, 20.0, 0.0);
    let mut motion = PrimMotion::at_rest(&start);
    motion.go(&goal, &printed(), None);
    let mut watch = Watch::new(&motion);
    for tick in 0..200 {
        watch.step(&mut motion, if tick < 20 { 1000 } else { 0 }).unwrap();
    }
    let held = motion.frame();
    assert!(!motion.is_at_rest() && held.distance(&goal).inches > 5.0);
    for _ in 0..25 {
        watch.step(&mut motion, 0).unwrap();
        assert_eq!(motion.frame(), held);
    }
    while !motion.is_at_rest() {
        watch.step(&mut motion, 1000).unwrap();
    }
    assert_eq!(motion.frame(), goal);
}

#[test]
fn point_without_brake_distance_is_passed_at_rest() {
    let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
    let via = shifted(&start, 5.0, 0.0);
    let mut motion = PrimMotion::at_rest(&start);
    motion.go(&via, &printed(), Some(0.0));
    while !motion.is_passing() {
        motion.step(1000);
    }
    assert_eq!(motion.frame(), via);
    assert!(motion.is_at_rest());
}

#[test]
fn halt_discards_the_goal() {
    let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
    let mut motion = PrimMotion::at_rest(&start);
    motion.go(&shifted(&start, 20.0, 0.0), &printed(), None);
    for _ in 0..30 {
        motion.step(1000);
    }
    motion.halt();
    while !motion.is_at_rest() {
        motion.step(1000);
    }
    assert_eq!(motion.goal, motion.at);
    assert!(motion.distance() < 1e-12);
}

#[test]
fn halt_before_the_first_tick_discards_the_goal() {
    let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
    let mut motion = PrimMotion::at_rest(&start);
    assert_eq!(motion.distance(), 0.0);
    motion.go(&shifted(&start, 20.0, 0.0), &printed(), None);
    motion.halt();
    assert_eq!((motion.is_at_rest(), motion.distance()), (true, 0.0));
}

#[test]
fn stopped_robot_continues_to_its_goal() {
    let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
    let goal = shifted(&start, 20.0, 0.0);
    let mut motion = PrimMotion::at_rest(&start);
    motion.go(&goal, &printed(), None);
    for _ in 0..30 {
        motion.step(1000);
    }
    let here = motion.frame();
    motion.stand();
    assert_eq!((motion.frame(), motion.current), (here, None));
    assert!((motion.distance() - here.distance(&goal).path()).abs() < 1e-12);
    // A robot that is moved by other means keeps its goal.
    motion.put(&start);
    assert_eq!((motion.frame(), motion.goal.frame()), (start, goal));
    while !motion.is_at_rest() {
        motion.step(1000);
    }
    assert_eq!(motion.frame(), goal);
    motion.stand();
    assert!(motion.is_at_rest());
    // At rest, the robot's only goal is its new position.
    motion.put(&start);
    assert_eq!((motion.frame(), motion.distance()), (start, 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// The failing case shrinks to the shortest run.
    #[test]
    fn short_runs_break_no_limit(seed in any::<u64>(), moves in 1_u32..40) {
        run(seed, moves).map_err(TestCaseError::fail)?;
    }

    /// Extreme counts cause neither a hang nor a value that is not finite.
    #[test]
    fn extreme_counts_stay_finite(
        a in prop::sample::select(vec![1, 1000, i32::MAX]),
        v in prop::sample::select(vec![1, i32::MAX]),
        s in prop::sample::select(vec![1, 1000, i32::MAX]),
        x in -3e7_f64..3e7,
    ) {
        let start = straight_down(Vector::new(-60.0, 0.0, 0.0));
        let mut motion = PrimMotion::at_rest(&start);
        motion.go(&shifted(&start, x, 0.0), &Limits::from_counts(a, v, s).unwrap(), None);
        for tick in 0..200 {
            motion.step(if tick % 70 < 60 { 1000 } else { 0 });
            prop_assert!(motion.frame().is_finite());
        }
    }
}
