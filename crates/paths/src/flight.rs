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

const PASSING_TICKS: u32 = 2; // docs/design/motion.md "Flying on"
const SETTLES: u32 = 3; // docs/design/motion.md "Rest"
const LONGEST: u32 = 15_000; // ticks: ten minutes
const LAG: u32 = 100; // ticks until the servos come to rest

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionError {
    Joints {
        problem: JointProblem,
        /// Index of the joint and degrees beyond its limit; `None` if the point is out of reach.
        joint: Option<(usize, f64)>,
        at: [f64; 3], // tool point, inches, world
    },
    Words, // no DEPC words for the position
    /// A parameter is not positive, so the motion would never end.
    Parameters,
    Endless,
}

#[derive(Clone, Debug)]
pub struct PointMotion {
    pub ticks: u32,     // since the previous point
    pub held_back: u32, // ticks in which the limits of the link slowed the robot
    pub margin: Margin, // of the joint nearest to a limit
}

/// A simulated robot: the last position sent to its controller, and the arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    position: Position,
    joints: Joints,
    arm: Arm,
}

impl Robot {
    /// A robot at rest at these joint angles (radians); `None` if DEPC words cannot encode the position.
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

    /// Simulates one tick; `look` receives the joint angles.
    fn tick(&mut self, look: &mut impl FnMut(&Joints)) {
        self.arm.advance(TICK_S, false, &[]);
        look(self.arm.joints());
    }

    fn command(&mut self, point: &Frame, look: &mut impl FnMut(&Joints)) -> Result<u32, MotionError> {
        for ticks in 1..LONGEST {
            let next = step(&self.position, point, &T3, &LinkLimits::NBS).map_err(|_| MotionError::Words)?;
            let plate = next.position.plate;
            self.joints = joints_for(&T3, &plate, &self.joints).map_err(|problem| MotionError::Joints {
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
        Err(MotionError::Endless)
    }

    /// Moves through the points to rest. In each tick `look` gets the index of the point and the joint angles,
    /// radians.
    pub fn fly(
        &mut self,
        points: &[(Frame, TrajPara)],
        mut look: impl FnMut(usize, &Joints),
    ) -> (Vec<PointMotion>, Option<MotionError>) {
        let mut flown = Vec::new();
        let mut motion = PrimMotion::at_rest(&self.tool());
        for (number, (goal, parameters)) in points.iter().enumerate() {
            let margin = T3.margin(&self.joints);
            let mut one = PointMotion { ticks: 0, held_back: 0, margin };
            let trouble = (|| {
                let through = number + 1 < points.len();
                let brake = through.then(|| f64::from(parameters.brk_dst) / 100.0);
                let limits = Limits::from_counts(parameters.acc_fac, parameters.vel_max, parameters.smooth)
                    .ok_or(MotionError::Parameters)?;
                motion.go(goal, &limits, brake);
                let mut passed = 0;
                while passed < if through { PASSING_TICKS } else { SETTLES } {
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
                        return Err(MotionError::Endless);
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

/// The joint (index from 0) that is farthest beyond a limit, and the degrees beyond it.
fn beyond(plate: &Plate, near: &Joints) -> Option<(usize, f64)> {
    let joints = T3.inverse(&plate.to_tool(&T3), near).ok()?;
    let margin = T3.margin(&joints);
    (margin.radians < 0.0).then(|| (margin.joint, -margin.radians.to_degrees()))
}

/// Ticks of Prim's motion from rest to each point, without the limits of link and arm.
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
        while ticks < LONGEST && passed < if through.is_some() { PASSING_TICKS } else { SETTLES } {
            motion.step(KNOB_FULL);
            ticks += 1;
            let there = if through.is_some() { motion.is_passing() } else { motion.is_at_rest() };
            passed += u32::from(there);
        }
        times.push(ticks);
    }
    times
}
