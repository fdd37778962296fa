//! Smoothness of the spline through Prim's points: one point every 40 ms becomes a target every 4.032 ms.

use egm::{
    Limits, Pose,
    path::{Path, Times},
    pose::{Vector, norm},
};
use geometry::frame::{Frame, Vector as Inches};
use levels::prim::motion::{PrimMotion, limits::Limits as MotionLimits};

const TICK: u64 = 40_000_000;
const CYCLE: u64 = 4_032_000;

/// Points of a motion of Prim, mm: 30 in at 12 in/s, and around a corner without a stop.
fn points() -> Vec<Vector> {
    let start = Frame::identity();
    let mut motion = PrimMotion::at_rest(&start);
    let limits = MotionLimits::from_counts(4, 120, 8).unwrap();
    let mut points = vec![[0.0; 3]];
    for (goal, brake) in [([30.0, 0.0, 0.0], Some(3.0)), ([30.0, 20.0, 5.0], None)] {
        motion.go(&start.shifted(Inches::from(goal)), &limits, brake);
        while !(if brake.is_some() { motion.is_passing() } else { motion.is_at_rest() }) {
            motion.step(interfaces::device::KNOB_FULL);
            points.push((motion.frame().position * 25.4).into());
        }
    }
    points
}

/// Greatest jerk, mm/s³: third difference of the targets every 4.032 ms.
fn greatest_jerk(targets: &[Vector]) -> f64 {
    let cycle = CYCLE as f64 / 1e9;
    let third = |four: &[Vector]| {
        let along = |axis: usize| four[3][axis] - 3.0 * four[2][axis] + 3.0 * four[1][axis] - four[0][axis];
        norm(&std::array::from_fn(along)) / cycle.powi(3)
    };
    targets.windows(4).map(third).fold(0.0, f64::max)
}

/// Targets on straight lines between the points, for comparison.
fn straight(points: &[Vector]) -> Vec<Vector> {
    (0..)
        .map_while(|cycle: u64| {
            let now = cycle * CYCLE;
            let [from, to, ..] = points.get(usize::try_from(now / TICK).unwrap()..)? else { return None };
            let part = (now % TICK) as f64 / TICK as f64;
            Some(std::array::from_fn(|axis| from[axis] + part * (to[axis] - from[axis])))
        })
        .collect()
}

fn splined(points: &[Vector]) -> Vec<Vector> {
    let pose = |position: &Vector| Pose { position: *position, ..Pose::IDENTITY };
    let limits = Limits::of_speed(14.5 * 25.4, 1.75);
    let mut path = Path::new(Times::default(), pose(&points[0]));
    path.begin(0, pose(&points[0]));
    let mut targets = Vec::new();
    let mut now = 0;
    for tick in 1..points.len() + 6 {
        let at = u64::try_from(tick).unwrap() * TICK;
        while now < at {
            targets.push(path.target(now).0.position);
            now += CYCLE;
        }
        path.push(at, &pose(points.get(tick).unwrap_or(&points[points.len() - 1])), &limits).unwrap();
    }
    targets
}

#[test]
fn spline_removes_corner_jerk_and_ends_at_the_last_point() {
    let points = points();
    let (straight, splined) = (straight(&points), splined(&points));
    let jerks = [greatest_jerk(&straight), greatest_jerk(&splined)];
    eprintln!("greatest jerk: {:.0} m/s³ straight, {:.1} m/s³ splined", jerks[0] / 1e3, jerks[1] / 1e3);
    assert!(jerks[1] * 10.0 < jerks[0] && jerks[1] > 0.0, "{jerks:?} mm/s³");
    assert_eq!(splined.last(), points.last());
}
