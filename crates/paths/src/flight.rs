//! Simulates motion through points: the motion of Prim at full speed, the limits of the link (A 2.3), the joints of the
//! T3 with accumulated roll, and its servos with their lag.

use depc::{
    Limits as LinkLimits, Plate,
    controller::{JointProblem, joints_for},
    step::{Position, step},
};
use geometry::{
    frame::Frame,
    kinematics::{Joints, Margin, T3},
};
use interfaces::device::KNOB_FULL;
use levels::prim::motion::{PrimMotion, limits::Limits};
use plant::{arm::Arm, description::Actuators};
use rcs_core::tick::TICK_S;
use taskdata::files::TrajPara;

/// Ticks from passing a through point until Prim has its next goal (docs/design/motion.md "Flying on").
const FLIES_ON: u32 = 2;
/// Ticks for which Prim must see the robot at rest (docs/design/motion.md "Rest").
const SETTLES: u32 = 3;
/// Longest motion, ticks: ten minutes.
const LONGEST: u32 = 15_000;
/// Greatest number of ticks until the servos come to rest.
const LAG: u32 = 100;

/// Why a flight ends before its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// The joints cannot reach the position.
    Joints {
        /// The problem, with the name that the robot controller uses.
        problem: JointProblem,
        /// Joint from 0, and degrees beyond its limit; `None` if the position is out of reach.
        joint: Option<(usize, f64)>,
        /// Tool point, inches, world.
        at: [f64; 3],
    },
    /// The position cannot be encoded as DEPC words.
    Words,
    /// A parameter of the motion is not positive, so that the motion would never end.
    Parameters,
    /// The motion takes longer than ten minutes.
    Endless,
}

/// Result of the motion to a point.
#[derive(Clone, Debug)]
pub struct Flown {
    /// Ticks since the previous point.
    pub ticks: u32,
    /// Number of these ticks in which the limits of the link slowed the robot.
    pub held_back: u32,
    /// The joint that comes nearest to a limit, with its margin.
    pub margin: Margin,
}

/// The simulated robot: the last position sent to its controller, and the arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    position: Position,
    joints: Joints,
    arm: Arm,
}

impl Robot {
    /// A robot at rest at the given joint angles, radians; `None` if its position cannot be encoded as DEPC words.
    #[must_use]
    pub fn standing(actuators: &Actuators, joints: &Joints) -> Option<Self> {
        let plate = Plate::from_frame(&T3.forward_plate(joints), &Plate::default()).ok()?;
        let position = Position::reported(plate, &T3);
        Some(Self { position, joints: *joints, arm: Arm::new(actuators, *joints) })
    }

    /// Joint angles of the arm, radians.
    #[must_use]
    pub fn joints(&self) -> &Joints {
        self.arm.joints()
    }

    /// The last commanded tool frame, inches, world.
    #[must_use]
    pub fn tool(&self) -> Frame {
        self.position.tool()
    }

    /// Simulates one tick of the arm, and calls `look` with its joint angles.
    fn tick(&mut self, look: &mut impl FnMut(&Joints)) {
        self.arm.advance(TICK_S, false, &[]);
        look(self.arm.joints());
    }

    /// Moves to a point of Prim as T3 Interface does: as fast as the link allows. Returns the number of ticks.
    fn command(&mut self, point: &Frame, look: &mut impl FnMut(&Joints)) -> Result<u32, Trouble> {
        for ticks in 1..LONGEST {
            let next = step(&self.position, point, &T3, &LinkLimits::NBS).map_err(|_| Trouble::Words)?;
            let plate = next.position.plate;
            self.joints = joints_for(&T3, &plate, &self.joints).map_err(|problem| Trouble::Joints {
                problem,
                joint: beyond(&plate, &self.joints),
                at: point.position.into(),
            })?;
            self.position = next.position;
            self.arm.reach(self.joints, TICK_S);
            self.tick(look);
            if next.reached {
                return Ok(ticks);
            }
        }
        Err(Trouble::Endless)
    }

    /// Moves through the points to the last one and comes to rest. Calls `look` in each tick with the index of the
    /// point and the joint angles of the arm, radians. Returns the results for each point, and why the flight ended
    /// early.
    pub fn fly(
        &mut self,
        points: &[(Frame, TrajPara)],
        mut look: impl FnMut(usize, &Joints),
    ) -> (Vec<Flown>, Option<Trouble>) {
        let mut flown = Vec::new();
        let mut motion = PrimMotion::at_rest(&self.tool());
        for (number, (goal, parameters)) in points.iter().enumerate() {
            let margin = T3.margin(&self.joints);
            let mut one = Flown { ticks: 0, held_back: 0, margin };
            let trouble = (|| {
                let through = number + 1 < points.len();
                let brake = through.then(|| f64::from(parameters.brk_dst) / 100.0);
                let limits = Limits::from_counts(parameters.acc_fac, parameters.vel_max, parameters.smooth)
                    .ok_or(Trouble::Parameters)?;
                motion.go(goal, &limits, brake);
                let mut passed = 0;
                while passed < if through { FLIES_ON } else { SETTLES } {
                    motion.step(KNOB_FULL);
                    let took = self.command(&motion.frame(), &mut |joints| look(number, joints))?;
                    one.ticks += took;
                    one.held_back += took - 1;
                    let margin = T3.margin(&self.joints);
                    if margin.radians < one.margin.radians {
                        one.margin = margin;
                    }
                    passed += u32::from(if through { motion.is_passing() } else { motion.is_at_rest() });
                    if one.ticks > LONGEST {
                        return Err(Trouble::Endless);
                    }
                }
                Ok(())
            })();
            flown.push(one);
            if let Err(trouble) = trouble {
                return (flown, Some(trouble));
            }
        }
        let last = points.len().saturating_sub(1);
        for _ in 0..LAG {
            if self.arm.settled() {
                break;
            }
            self.tick(&mut |joints| look(last, joints));
        }
        self.arm.settle();
        (flown, None)
    }
}

/// The joint that is farthest beyond a limit at an unreachable position, from 0, and degrees beyond it.
fn beyond(plate: &Plate, near: &Joints) -> Option<(usize, f64)> {
    let joints = T3.inverse(&plate.to_tool(&T3), near).ok()?;
    let margin = T3.margin(&joints);
    (margin.radians < 0.0).then(|| (margin.joint, -margin.radians.to_degrees()))
}

/// Number of ticks of Prim's motion from rest at a frame to each point, without the limits of link and arm.
#[must_use]
pub fn time(start: &Frame, points: &[(Frame, TrajPara)]) -> Vec<u32> {
    let mut motion = PrimMotion::at_rest(start);
    let mut times = Vec::new();
    for (number, (goal, parameters)) in points.iter().enumerate() {
        let through = (number + 1 < points.len()).then(|| f64::from(parameters.brk_dst) / 100.0);
        let limits = Limits::from_counts(parameters.acc_fac, parameters.vel_max, parameters.smooth);
        let Some(limits) = limits else { break };
        motion.go(goal, &limits, through);
        let (mut ticks, mut passed) = (0, 0);
        while ticks < LONGEST && passed < if through.is_some() { FLIES_ON } else { SETTLES } {
            motion.step(KNOB_FULL);
            ticks += 1;
            let there = if through.is_some() { motion.is_passing() } else { motion.is_at_rest() };
            passed += u32::from(there);
        }
        times.push(ticks);
    }
    times
}
