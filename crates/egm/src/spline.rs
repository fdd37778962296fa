//! A uniform cubic B-spline of poses: four points, one per period, define the segment between the middle two.
//!
//! It is continuous to the second derivative, stays in the convex hull of its points, and rests exactly at three equal
//! points; other points it passes nearby. In the cumulative form each basis function weights the step between two
//! points, so orientations are treated like positions: each factor is a slerp by that part of the step.

use crate::pose::{Pose, Twist, add, from_rotation_vector, product, rotate, scaled};

/// The cumulative basis functions of the three steps at `u`, 0 to 1.
fn basis(u: f64) -> [f64; 3] {
    let (square, cube) = (u * u, u * u * u);
    [
        (5.0 + 3.0 * u - 3.0 * square + cube) / 6.0,
        (1.0 + 3.0 * u + 3.0 * square - 2.0 * cube) / 6.0,
        cube / 6.0,
    ]
}

/// The derivatives of the basis functions with respect to `u`.
fn slope(u: f64) -> [f64; 3] {
    let square = u * u;
    [(1.0 - u) * (1.0 - u) / 2.0, (1.0 + 2.0 * u - 2.0 * square) / 2.0, square / 2.0]
}

/// Pose and speed in the segment of `points` at `u`, 0 to 1; `seconds` is the length of a period.
#[must_use]
pub fn evaluate(points: &[Pose; 4], u: f64, seconds: f64) -> (Pose, Twist) {
    let [first, second, third, fourth] = points;
    let steps = [first.way_to(second), second.way_to(third), third.way_to(fourth)];
    let mut pose = *first;
    let mut speed = Twist::default();
    for ((step, part), slope) in steps.iter().zip(basis(u)).zip(slope(u)) {
        let turn = from_rotation_vector(&scaled(&step.angular, part));
        pose.position = add(&pose.position, &scaled(&step.linear, part));
        pose.orientation = product(&turn, &pose.orientation);
        speed.linear = add(&speed.linear, &scaled(&step.linear, slope));
        speed.angular = add(&rotate(&turn, &speed.angular), &scaled(&step.angular, slope));
    }
    (pose, speed.scaled(1.0 / seconds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::norm;
    use proptest::prelude::*;

    fn points(count: usize) -> impl Strategy<Value = Vec<Pose>> {
        let way = (prop::array::uniform3(-14.0_f64..14.0), prop::array::uniform3(-0.04_f64..0.04));
        prop::collection::vec(way, count).prop_map(|ways| {
            let mut at = Pose::IDENTITY;
            let moved = ways.into_iter().map(|(linear, angular)| {
                at = at.moved(&Twist { linear, angular });
                at
            });
            moved.collect()
        })
    }

    fn window(points: &[Pose], from: usize) -> [Pose; 4] {
        std::array::from_fn(|place| points[from + place])
    }

    proptest! {
        #[test]
        fn segments_meet_with_equal_speed_and_acceleration(points in points(5)) {
            let (before, after) = (window(&points, 0), window(&points, 1));
            let (left, left_speed) = evaluate(&before, 1.0, 0.04);
            let (right, right_speed) = evaluate(&after, 0.0, 0.04);
            let (way, turn) = left.distance(&right);
            prop_assert!(way < 1e-9 && turn < 1e-9, "{way} mm, {turn} rad");
            let speed = left_speed.way(&right_speed);
            prop_assert!(speed < 1e-7, "{speed}");
            let h = 1e-4; // on both sides of the knot, each from within its segment
            let change = |points: &[Pose; 4], from: f64, to: f64| {
                let (a, b) = (evaluate(points, from, 0.04).1, evaluate(points, to, 0.04).1);
                scaled(&crate::pose::subtract(&b.linear, &a.linear), 1.0 / (0.04 * h))
            };
            let (end, start) = (change(&before, 1.0 - h, 1.0), change(&after, 0.0, h));
            let jump = norm(&crate::pose::subtract(&end, &start));
            prop_assert!(jump < 30.0, "the acceleration jumps by {jump} mm/s2 of up to 17500");
        }

        #[test]
        fn the_speed_is_the_derivative(points in points(4), u in 0.001_f64..0.999) {
            let points = window(&points, 0);
            let h = 1e-6;
            let (_, speed) = evaluate(&points, u, 0.04);
            let (before, after) = (evaluate(&points, u - h, 0.04).0, evaluate(&points, u + h, 0.04).0);
            let seen = before.way_to(&after).scaled(1.0 / (2.0 * h * 0.04));
            prop_assert!(seen.way(&speed) < 1e-3, "{seen:?} {speed:?}");
        }

        #[test]
        fn it_is_never_faster_than_its_points(points in points(4), u in 0.0_f64..1.0) {
            let points = window(&points, 0);
            let ways = points.windows(2).map(|pair| pair[0].distance(&pair[1]));
            let (far, wide) = ways.fold((0.0, 0.0), |(a, b): (f64, f64), (c, d)| (a.max(c), b.max(d)));
            let (_, speed) = evaluate(&points, u, 0.04);
            prop_assert!(norm(&speed.linear) <= far / 0.04 + 1e-9);
            prop_assert!(norm(&speed.angular) <= wide / 0.04 + 1e-9);
        }
    }

    impl Twist {
        fn way(&self, other: &Self) -> f64 {
            norm(&crate::pose::subtract(&self.linear, &other.linear))
                .max(norm(&crate::pose::subtract(&self.angular, &other.angular)))
        }
    }

    #[test]
    fn three_equal_points_are_reached_exactly() {
        let end = Pose { position: [10.0, 0.0, 5.0], ..Pose::IDENTITY };
        let (pose, speed) = evaluate(&[Pose::IDENTITY, end, end, end], 1.0, 0.04);
        let (way, turn) = pose.distance(&end);
        assert!(way < 1e-12 && turn < 1e-12 && norm(&speed.linear) < 1e-12);
    }
}
