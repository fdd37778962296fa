//! Prim and the robot, as E-move sees them. A motion is one step: the robot stays in place until it is at its goal.

use geometry::pose::Pose;
use interfaces::{
    ChangingPose, CommonMemory, EmoveOutputs, Reason,
    emove::EmoveVerb,
    pose_range,
    prim::{PrimCommand, PrimReport, PrimVerb},
};
use levels::places::pose_of;
use rcs_core::tick::Tick;

use crate::{data::data, image::Image, search::Wrong};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrimDoes {
    /// Nothing new; a new order is taken.
    Goes,
    /// Prim ends the order, with the robot at its goal.
    Ends,
    /// Prim fails. The robot stays in place.
    Fails,
    /// Prim fails, because the link does. The robot stays in place.
    LinkFails,
    /// The robot has gone half of the way from a goal, and continues.
    Half,
    /// The robot is at its goal, and Prim does not report it yet.
    Arrives,
    /// Prim ends a GO-UNTIL whose condition is not met.
    Misses,
}

pub const fn moves(verb: PrimVerb) -> bool {
    matches!(
        verb,
        PrimVerb::GoThru | PrimVerb::GotoPt | PrimVerb::GoUntil | PrimVerb::GoWhile | PrimVerb::DeltaMove
    )
}

pub const fn goes(verb: EmoveVerb) -> bool {
    matches!(verb, EmoveVerb::MovToLoc | EmoveVerb::MovToObj | EmoveVerb::MovObjTo)
}

pub const THERE: f64 = 0.021; // in, within which the robot is at its place

pub fn is_at(goal: &Pose, at: &Pose) -> bool {
    goal.to_frame().is_ok_and(|goal| at.to_frame().is_ok_and(|at| goal.distance(&at).inches <= THERE))
}

/// The middle of two poses of the same orientation.
fn middle(from: &Pose, to: &Pose) -> Pose {
    let middle = |a: [i32; 3], b: [i32; 3]| [0, 1, 2].map(|axis| i32::midpoint(a[axis], b[axis]));
    Pose {
        wrist: middle(from.wrist, to.wrist),
        tool: middle(from.tool, to.tool),
        finger: middle(from.finger, to.finger),
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Robot {
    pub echo: u32,
    pub report: PrimReport,
    pub link: bool,
    pub at: Pose,
    pub goal: Option<Pose>, // the goal; for a GO-UNTIL, where its condition is met
    pub far: Pose,          // end of a GO-UNTIL whose condition is not met
    pub half: bool,         // the robot has gone half of the way from a goal
    pub there: u8,          // ticks at the goal, up to SETTLED
}

/// Ticks at rest at the goal until Prim can report it, in a search that counts them.
pub const SETTLED: u8 = 2;

impl Robot {
    pub const fn new(at: Pose) -> Self {
        Self { echo: 0, report: PrimReport::Idle, link: true, at, goal: None, far: at, half: false, there: 0 }
    }

    pub fn is_busy(&self, order: &PrimCommand) -> bool {
        (order.number != self.echo && order.number != 0) || self.report == PrimReport::Executing
    }

    pub fn is_moving(&self, order: &PrimCommand) -> bool {
        self.goal.is_some() || (order.number != self.echo && moves(order.command))
    }

    /// Prim takes E-move's outputs of the previous tick. The error is an order that names no existing record.
    pub fn take(&mut self, memory: &CommonMemory) -> Result<(), Wrong> {
        let order = &memory.emove.prim;
        if order.number != self.echo && order.number != 0 {
            (self.echo, self.report) = (order.number, PrimReport::Executing);
            (self.goal, self.far, self.there) = (None, self.at, 0);
            if moves(order.command) {
                let base = pose_of(order.pose, memory, &data()).ok_or("the order to Prim names no record")?;
                let goal = data().moved(&base, order.movetable);
                self.far = Pose::from_frame(&goal);
                self.goal = Some(self.far);
            }
        }
        Ok(())
    }

    pub fn does(&mut self, does: PrimDoes) {
        if self.there > 0 {
            self.there = (self.there + 1).min(SETTLED);
        }
        match does {
            PrimDoes::Goes => return,
            PrimDoes::Arrives => {
                (self.at, self.there, self.half) = (self.goal.unwrap_or(self.at), 1, false);
                return;
            }
            PrimDoes::Half => {
                let goal = self.goal.unwrap_or(self.at);
                (self.at, self.half) = (middle(&self.at, &goal), true);
                return;
            }
            PrimDoes::Ends => {
                (self.report, self.link) = (PrimReport::Done, true);
                if let Some(goal) = self.goal {
                    (self.at, self.half) = (goal, false);
                }
            }
            PrimDoes::Misses => (self.report, self.at) = (PrimReport::NotDetected, self.far),
            PrimDoes::Fails => self.report = PrimReport::Error,
            PrimDoes::LinkFails => (self.report, self.link) = (PrimReport::T3LinkOff, false),
        }
        (self.goal, self.far, self.there) = (None, self.at, 0);
    }

    /// Clear the text of a taken order and, if `over`, the poses of E-move, to which no order leads then.
    pub fn forget_order(&self, out: &mut EmoveOutputs, over: bool) {
        let PrimCommand { number, command, .. } = out.prim;
        if self.echo == number || number == 0 {
            out.prim = PrimCommand { number, command, ..PrimCommand::default() };
            if over {
                out.poses = Default::default();
            }
        }
    }

    pub fn write(&self, memory: &mut CommonMemory, stamp: Tick) {
        let prim = &mut memory.prim;
        prim.header.stamp = stamp;
        prim.poses[0] = ChangingPose { number: Some(pose_range::PRIM + 1), pose: self.at };
        let status = &mut prim.status;
        (status.echo, status.report, status.reason) = (self.echo, self.report, Reason::None);
        status.link_running = self.link;
        (status.present_pose, status.sensor_pose) = (prim.poses[0].number, prim.poses[0].number);
    }

    pub fn add_to(&self, image: &mut Image) {
        image.add(&self.echo);
        image.add(&self.report);
        image.bytes.push(u8::from(self.link));
        image.add(&self.at);
        image.add(&self.goal.unwrap_or_default());
        image.add(&self.far);
        image.bytes.extend([u8::from(self.goal.is_some()), u8::from(self.half), self.there]);
    }
}
