//! Grip with its fingers, as E-move sees it: an order completes or fails after any delay.

use interfaces::{
    CommonMemory,
    grip::{Felt, GripCommand, GripReport, GripVerb},
};
use rcs_core::tick::Tick;

use crate::{image::Image, search::Wrong};

/// Openings, 0.01 in: with the part, closed and empty, and half-way through an order to open.
const PART: i32 = 66;
const PASSED: i32 = 54;
const HALF: i32 = 80;
/// Force on the part, lb.
const FORCE: i32 = 30;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GripDoes {
    /// Nothing new; a new order is taken.
    Goes,
    /// Grip ends the order. Closing fingers have a part between them.
    Ends,
    /// Grip fails. Fingers keep their object, and closing fingers have a part between them.
    Fails,
    /// Grip fails, if it has an order. The fingers lose their object.
    Loses,
}

pub const fn moves(verb: GripVerb) -> bool {
    matches!(verb, GripVerb::Position | GripVerb::OpenGrip | GripVerb::CloseGrip)
}

#[derive(Clone, Copy, Debug)]
pub struct PartsGripper {
    pub echo: u32,
    pub report: GripReport,
    pub position: i32, // opening, 0.01 in
    pub full: bool,
}

impl PartsGripper {
    pub const fn new(position: i32) -> Self {
        Self { echo: 0, report: GripReport::Idle, position, full: false }
    }

    pub fn is_busy(&self, order: &GripCommand) -> bool {
        (order.number != self.echo && order.number != 0) || self.report == GripReport::Executing
    }

    pub fn is_moving(&self, order: &GripCommand) -> bool {
        self.is_busy(order) && moves(order.command)
    }

    /// Grip takes E-move's outputs of the previous tick. The error: fingers drop an object by moving to an opening.
    pub fn does(&mut self, does: GripDoes, order: &GripCommand) -> Result<(), Wrong> {
        let busy = self.is_busy(order);
        if order.number != self.echo && order.number != 0 {
            (self.echo, self.report) = (order.number, GripReport::Executing);
            if self.full && order.command == GripVerb::Position {
                return Err("the fingers move to an opening with an object between them");
            }
        }
        let closes = order.command == GripVerb::CloseGrip;
        let opens = busy && moves(order.command) && !closes;
        match (does, order.command) {
            (GripDoes::Goes, _) => {}
            (GripDoes::Ends, GripVerb::Position | GripVerb::OpenGrip) => {
                (self.report, self.full, self.position) = (GripReport::Done, false, order.position);
            }
            (GripDoes::Ends, GripVerb::CloseGrip) => {
                (self.report, self.full, self.position) = (GripReport::Done, true, PART);
            }
            (GripDoes::Ends, _) => self.report = GripReport::Done,
            (GripDoes::Fails, _) => {
                self.report = GripReport::Serror;
                if closes {
                    (self.full, self.position) = (true, PART);
                }
            }
            (GripDoes::Loses, _) => {
                self.report = if busy { GripReport::Serror } else { self.report };
                self.full = false;
                self.position = if opens { HALF } else { PASSED };
            }
        }
        Ok(())
    }

    pub fn sleep(&mut self, order: &GripCommand) {
        let report = if order.number == 0 { GripReport::Idle } else { GripReport::Serror };
        (self.echo, self.report) = (order.number, report);
    }

    pub fn write(&self, memory: &mut CommonMemory, stamp: Tick) {
        memory.grip.header.stamp = stamp;
        memory.grip.header.republished = memory.emove.dormant.grip;
        let status = &mut memory.grip.status;
        (status.echo, status.report, status.position) = (self.echo, self.report, self.position);
        (status.initialized, status.felt) = (true, if self.full { Felt::Something } else { Felt::Nothing });
        let force = if self.full { FORCE } else { 0 };
        (status.left_force, status.right_force) = (force, force);
    }

    pub fn add_to(&self, image: &mut Image) {
        image.add(&self.echo);
        image.add(&self.report);
        image.add(&self.position);
        image.bytes.push(u8::from(self.full));
    }
}
