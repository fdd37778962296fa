//! One period of the straight motion of the tool to a goal, within the velocity limits of the end plate.
//!
//! VI.1.1 POINT: "if the limit is exceeded, the motion is scaled back". Position moves linearly, rotation about one
//! axis. Bisections find the fraction of the line. The controller checks *rounded* words, so these are checked here.
//! The unrounded frame is stored with the words, so rounding does not bend the line.
//!
//! At the pole (gripper straight up or down) only the sum or difference of D and R has a meaning. A line that leaves
//! the pole in another direction than it arrived would need a jump of D. Instead, D and R turn together, at the limit
//! and with the tool at rest, until D has the direction of the line. Thus every goal is reached.

use geometry::{
    frame::{Frame, Vector, rotation_by, rotation_vector},
    kinematics::Arm,
};
use rcs_core::Plain;

use crate::{
    Error, Limits, Plate,
    plate::{HALF_TURN, angle_between, angle_word},
};

/// This many resolve 4e-5 in on the longest line. Fewer would miss a step past a pole of a hundredth of a count.
const BISECTIONS: u32 = 24;
/// An E this near to a pole (0.01 degree) is set to the pole, which moves the tool point by less than half a count.
const POLE: i32 = 2;

/// A position commanded to the controller: its words, and the tool frame before rounding.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Position {
    /// The words on the line.
    pub plate: Plate,
    /// Tool point, inches, world.
    point: [f64; 3],
    /// Orientation of the tool as a rotation vector, radians, world.
    turn: [f64; 3],
}

impl Position {
    /// A position known only by its words, such as a reported one.
    #[must_use]
    pub fn reported(plate: Plate, arm: &Arm) -> Self {
        Self::rounded_to(plate, &plate.to_tool(arm))
    }

    fn rounded_to(plate: Plate, tool: &Frame) -> Self {
        Self { plate, point: tool.position.into(), turn: rotation_vector(&tool.rotation).into() }
    }

    /// The tool frame before rounding, inches, world.
    #[must_use]
    pub fn tool(&self) -> Frame {
        Frame { position: self.point.into(), rotation: rotation_by(&self.turn.into()) }
    }
}

/// The command for the next period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The position to command.
    pub position: Position,
    /// True if it is the goal; otherwise the motion was scaled back.
    pub reached: bool,
}

struct StraightLine<'a> {
    start: Frame,
    way: Vector,
    turn: Vector,
    goal: &'a Frame,
    arm: &'a Arm,
    from: &'a Plate,
}

impl StraightLine<'_> {
    /// The words at a fraction of the line, and the unrounded tool frame.
    fn at(&self, fraction: f64) -> Result<(Plate, Frame), Error> {
        let tool = if fraction >= 1.0 {
            *self.goal
        } else {
            Frame {
                position: self.start.position + self.way * fraction,
                rotation: rotation_by(&(self.turn * fraction)) * self.start.rotation,
            }
        };
        Ok((Plate::from_tool(&tool, self.arm, self.from)?, tool))
    }
}

/// One period from the last commanded position towards the tool frame `goal` (inches, world), never beyond `limits`.
/// Repeated steps reach every goal. Errors: [`Error`] if a position on the line has no words.
pub fn step(from: &Position, goal: &Frame, arm: &Arm, limits: &Limits) -> Result<Step, Error> {
    let full = Plate::from_tool(goal, arm, &from.plate)?;
    if limits.check(&from.plate, &full).is_ok() {
        return Ok(Step { position: Position::rounded_to(full, goal), reached: true });
    }
    let mut start = from.tool();
    let [.., e, _] = from.plate.words;
    if pole_near(e).is_some() {
        // At the pole, rounding can change D by a full turn: the words determine the rotation of the tool.
        start.rotation = from.plate.to_frame().rotation;
    }
    let line = StraightLine {
        way: goal.position - start.position,
        turn: rotation_vector(&(goal.rotation * start.rotation.inverse())),
        start,
        goal,
        arm,
        from: &from.plate,
    };
    if let Some(position) = turn_at_the_pole(&line, limits, limits.orientation())? {
        return Ok(Step { position, reached: false });
    }
    let (mut allowed, mut refused, mut plate, mut tool) = (0.0, 1.0, from.plate, start);
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(allowed, refused);
        let (there, frame) = line.at(middle)?;
        if limits.check(&from.plate, &there).is_ok() {
            (allowed, plate, tool) = (middle, there, frame);
        } else {
            refused = middle;
        }
    }
    let position = if plate == from.plate { turn_at_the_pole(&line, limits, 0)? } else { None };
    Ok(Step { position: position.unwrap_or_else(|| Position::rounded_to(plate, &tool)), reached: false })
}

/// Turns D and R if the line leaves the pole in a direction that differs from D by more than `near` (0.01 degree).
fn turn_at_the_pole(line: &StraightLine<'_>, limits: &Limits, near: i32) -> Result<Option<Position>, Error> {
    let [.., d, e, r] = line.from.words;
    let Some((pole, sense)) = pole_near(e) else { return Ok(None) };
    let [.., way_out, _, _] = way_out(line)?.words;
    let missing = angle_between(d, way_out);
    if missing.saturating_abs() <= near {
        return Ok(None);
    }
    let most = limits.orientation();
    let turn = missing.clamp(most.saturating_neg(), most);
    let turned = |word: i16, by: i32| angle_word(i32::from(word).saturating_add(by), word);
    let angles = Plate { words: [0, 0, 0, turned(d, turn), pole, turned(r, turn.saturating_mul(sense))] };
    let tool = Frame { position: line.start.position, rotation: angles.to_frame().rotation };
    let plate = Plate::from_tool(&tool, line.arm, &angles)?;
    Ok(limits.check(line.from, &plate).is_ok().then(|| Position::rounded_to(plate, &tool)))
}

/// E of the pole near `e`, and the sign of R in D ± R: straight down only R - D matters, straight up R + D.
fn pole_near(e: i16) -> Option<(i16, i32)> {
    let e = i32::from(e);
    if e <= POLE {
        Some((0, -1))
    } else if e >= HALF_TURN.saturating_sub(POLE) {
        i16::try_from(HALF_TURN).ok().map(|down| (down, 1))
    } else {
        None
    }
}

/// The first position off the pole, at doubling distances on the line; the goal if there is none.
fn way_out(line: &StraightLine<'_>) -> Result<Plate, Error> {
    let mut fraction = libm::ldexp(1.0, -20);
    loop {
        let (plate, _) = line.at(fraction)?;
        let [.., e, _] = plate.words;
        if fraction >= 1.0 || pole_near(e).is_none() {
            return Ok(plate);
        }
        fraction *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use geometry::frame::norm;
    use geometry::kinematics::T3;
    use proptest::prelude::*;

    const HOME: Plate = Plate { words: [0, -6293, -636, -9000, 13500, 0] };

    fn tool(words: [i16; 6]) -> Frame {
        Plate { words }.to_tool(&T3)
    }

    fn walk(from: Plate, goal: &Frame, most: usize) -> Vec<Plate> {
        let mut way = vec![from];
        let mut here = Position::reported(from, &T3);
        for _ in 0..most {
            let step = step(&here, goal, &T3, &Limits::NBS).unwrap();
            assert_eq!(Limits::NBS.check(&here.plate, &step.position.plate), Ok(()), "{here:?} {step:?}");
            here = step.position;
            way.push(here.plate);
            if step.reached {
                assert_eq!(here.plate, Plate::from_tool(goal, &T3, &here.plate).unwrap());
                return way;
            }
        }
        panic!("{from:?} does not come to {:?} in {most} steps: {:?}", goal, &way[way.len() - 5..]);
    }

    /// Steps that the limits require, plus two turns of D and R at the poles.
    fn enough(from: &Plate, goal: &Frame) -> usize {
        let distance = from.to_tool(&T3).distance(goal);
        let plate = distance.inches + 12.0 * distance.radians;
        (plate / 0.5) as usize + (distance.radians / 0.035) as usize + 400
    }

    #[test]
    fn a_permitted_command_is_sent_at_once() {
        let goal = tool([30, -6290, -640, -8950, 13450, 20]);
        let step = step(&Position::reported(HOME, &T3), &goal, &T3, &Limits::NBS).unwrap();
        assert_eq!((step.position.plate.words, step.reached), ([30, -6290, -640, -8950, 13450, 20], true));
    }

    #[test]
    fn long_step_is_scaled_back_and_stays_on_the_line() {
        let goal = tool([0, -7293, -636, -9000, 13500, 0]);
        let way = walk(HOME, &goal, 18);
        assert_eq!(way.len(), 19);
        assert!(way.iter().all(|p| p.words[0] == 0 && p.words[2..] == HOME.words[2..]), "{way:?}");
    }

    #[test]
    fn a_turn_about_the_tool_point_keeps_the_tool_point() {
        let mut goal = HOME.to_tool(&T3);
        goal.rotation = rotation_by(&Vector::new(0.0, 0.0, 0.5)) * goal.rotation;
        for here in walk(HOME, &goal, 40) {
            let off = here.to_tool(&T3).position - goal.position;
            assert!(norm(&off) < 0.011, "{off:?}");
        }
    }

    #[test]
    fn through_the_pole_d_and_r_turn_with_the_tool_still() {
        // From a tilt of 5 degrees to the opposite one, exactly through straight down.
        let from = Plate { words: [3000, -4000, 500, 0, 17_500, 3000] };
        let mut goal = from.to_tool(&T3);
        goal.rotation = rotation_by(&Vector::new(0.0, 10.0 * PI / 180.0, 0.0)) * goal.rotation;
        let goal_words = Plate::from_tool(&goal, &T3, &from).unwrap().words;
        assert_eq!(goal_words[4], 17_500);
        assert_eq!(angle_between(goal_words[3], 0).abs(), HALF_TURN);
        let way = walk(from, &goal, 100);
        let still: Vec<_> = way.iter().filter(|p| p.words[4] == 18_000).collect();
        assert!(still.len() > 70, "{} steps at the pole", still.len());
        for pair in still.windows(2) {
            let moved = pair[0].to_tool(&T3).distance(&pair[1].to_tool(&T3));
            assert!(moved.inches < 0.02 && moved.radians < 6e-4, "{moved:?}");
        }
    }

    /// R, which turns with both D and the tool, needs slightly more than the limit; D does not.
    #[test]
    fn pole_is_left_if_only_r_exceeds_the_limit() {
        let from = Plate { words: [1009, 2021, 2990, 13_308, 18_000, 7560] };
        let goal = tool([1010, 2020, 2990, 13_537, 17_996, 7793]);
        let way = walk(from, &goal, 3);
        assert_eq!(way[1].words, [1009, 2021, 2990, 13_537, 18_000, 7789]);
    }

    #[test]
    fn codes_without_text_are_refused() {
        let home = Position::reported(HOME, &T3);
        let mut goal = HOME.to_tool(&T3);
        goal.position.x = 400.0;
        assert!(matches!(step(&home, &goal, &T3, &Limits::NBS), Err(Error::OutOfRange { axis: 0, .. })));
        goal.position.x = f64::INFINITY;
        assert_eq!(step(&home, &goal, &T3, &Limits::NBS), Err(Error::NotFinite));
    }

    fn anywhere() -> impl Strategy<Value = [i16; 6]> {
        let coordinate = || -9000_i16..9000;
        (coordinate(), coordinate(), coordinate(), any::<i16>(), 0_i16..=18_000, any::<i16>())
            .prop_map(<[i16; 6]>::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn every_goal_is_reached(
            a in anywhere(),
            b in anywhere(),
        ) {
            let (from, goal) = (Plate { words: a }, tool(b));
            let start = from.to_tool(&T3).position;
            let along = (goal.position - start).normalize();
            for here in walk(from, &goal, enough(&from, &goal)) {
                let off = here.to_tool(&T3).position - start;
                prop_assert!(norm(&(off - along * off.dot(&along))) < 0.02, "{:?} is off the line", here);
            }
        }

        #[test]
        fn every_goal_at_the_pole_is_reached(
            near in 0_i16..60, far in 0_i16..60, up: bool, over: bool,
            d in any::<i16>(), r in any::<i16>(), to_d in any::<i16>(), to_r in any::<i16>(),
        ) {
            let e = |lean: i16, up: bool| if up { lean } else { 18_000 - lean };
            let from = Plate { words: [1000, 2000, 3000, d, e(near, up), r] };
            let goal = tool([1010, 2020, 2990, to_d, e(far, up ^ over), to_r]);
            walk(from, &goal, enough(&from, &goal));
        }

        #[test]
        fn a_line_through_the_pole_is_passed(
            lean in 1_i16..2000, sideways in -40.0_f64..40.0, roll in -3.0_f64..3.0, d in any::<i16>(), r in any::<i16>(),
        ) {
            let from = Plate { words: [1000, 2000, 3000, d, 18_000 - lean, r] };
            let mut goal = from.to_tool(&T3);
            let across = goal.x().cross(&-Vector::z()).normalize();
            let tip = across * (f64::from(lean) * 2.0 * PI / 18_000.0);
            let aside = (goal.x() + Vector::z()).normalize() * (sideways * PI / 18_000.0);
            goal.rotation = rotation_by(&(tip + aside)) * goal.rotation * rotation_by(&Vector::new(roll, 0.0, 0.0));
            walk(from, &goal, enough(&from, &goal));
        }
    }
}
