//! The quick change at the right holster: the ring as E-move sees it, the gripper on the robot or in the holster,
//! and the sensors of the holster as Prim reads them.
//!
//! A gripper that the ring releases rests on the holster, and a robot whose pins reach it pushes it along. If the
//! gripper is at the robot's flange, the ring catches it when it locks. Its fingers are set to pass through the
//! holster.

use geometry::frame::Frame;
use interfaces::{
    CommonMemory,
    device::DeviceInputs,
    quick_change::{QuickChangeReport, QuickChangeVerb, RingPosition},
};
use levels::{execution::Outcome, prim::state::State};
use rcs_core::{name::Name16, tick::Tick};
use taskdata::files::SensorSource;

use super::tool::Happens;
use crate::{
    data::data,
    holster::{self, GRIPPER, Ring, SEAT},
    image::Image,
    parts_gripper::{GripDoes, PartsGripper},
    search::Wrong,
};

/// Reach of the pins, in, also to the side. The ring catches the gripper within it.
const REACH: f64 = 0.65;
const PLAY: f64 = 0.15;
const CAUGHT: f64 = 0.05;
/// Height from which a released gripper lands, in.
const LANDS: f64 = 0.6;
/// Beyond this the lips are over the gripper's ears, and within the next distance they hold it down, in.
const LIPS: f64 = 0.75;
const HELD_DOWN: f64 = 0.15;
const DETENT: f64 = 0.1; // in from the seat, within which the gripper is drawn to it
const LARGE: f64 = 0.5;
const SMALL: f64 = 0.1;

#[derive(Clone, Copy, Debug)]
pub struct Change {
    echo: u32,
    report: QuickChangeReport,
    ring: Ring,
    turns: Option<Ring>,
    rests: Option<f64>, // in from the seat, on the holster; `None` if the ring has the gripper
    dark: bool,         // the sensors of the holster have no power
    grip: PartsGripper,
}

impl Change {
    pub fn new() -> Self {
        let object = Name16::new(GRIPPER.1).expect("a name");
        let (_, on) = data().object(&object, 1).expect("the data have the gripper");
        Self {
            echo: 0,
            report: QuickChangeReport::Idle,
            ring: Ring::Unlocked,
            turns: None,
            rests: Some(SEAT),
            dark: false,
            grip: PartsGripper::new(on.appr_size),
        }
    }

    pub const fn echo(&mut self) -> &mut u32 {
        &mut self.echo
    }

    pub const fn grip_echo(&mut self) -> &mut u32 {
        &mut self.grip.echo
    }

    pub const fn ring(&self) -> Ring {
        self.ring
    }

    pub const fn turns(&self) -> bool {
        self.turns.is_some()
    }

    pub const fn is_dark(&self) -> bool {
        self.dark
    }

    pub fn is_mated(&self, robot: &Frame) -> bool {
        let (x, z) = holster::within(robot);
        self.rests.is_none_or(|rests| (-REACH..=CAUGHT).contains(&x) && (z - rests).abs() <= PLAY)
    }

    /// `prim` and `robot` are those after this tick. It is an error to turn the ring while the robot moves, or to
    /// drop or tear off the gripper.
    pub fn does(
        &mut self,
        happens: Happens,
        robot: &Frame,
        memory: &CommonMemory,
        prim: &State,
    ) -> Result<(), Wrong> {
        let moving = prim.motion.is_some_and(|motion| !motion.is_at_rest());
        let order = &memory.emove.quick_change;
        if order.number != self.echo && order.number != 0 {
            self.echo = order.number;
            self.turns = match order.command {
                QuickChangeVerb::None | QuickChangeVerb::Pause => None,
                QuickChangeVerb::Lock => Some(Ring::Locked),
                QuickChangeVerb::Unlock => Some(Ring::Unlocked),
            };
            self.report = if self.turns() { QuickChangeReport::Executing } else { QuickChangeReport::Locked };
            if moving && self.turns() {
                return Err("the ring is turned while the robot moves");
            }
        }
        match (happens, self.turns) {
            (Happens::Arrive, Some(ring)) => self.arrives(ring, robot)?,
            (Happens::Stick, Some(_)) => {
                (self.ring, self.report, self.turns) = (Ring::Between, QuickChangeReport::Stuck, None);
            }
            (Happens::Dead, _) => self.dark = true,
            _ => {}
        }
        self.dark &= moving || prim.execution.outcome == Outcome::Executing;
        if memory.emove.dormant.grip {
            self.grip.sleep(&memory.emove.grip);
        } else {
            self.grip.does(GripDoes::Ends, &memory.emove.grip)?;
        }
        self.carry(robot)
    }

    fn arrives(&mut self, ring: Ring, robot: &Frame) -> Result<(), Wrong> {
        let (x, z) = holster::within(robot);
        self.turns = None;
        self.ring = ring;
        self.report = match ring {
            Ring::Locked => QuickChangeReport::Locked,
            Ring::Unlocked | Ring::Between => QuickChangeReport::Unlocked,
        };
        match (ring, self.rests) {
            (Ring::Locked, Some(rests)) if x.abs() <= CAUGHT && (z - rests).abs() <= CAUGHT => {
                self.rests = None
            }
            (Ring::Unlocked, None)
                if (-LANDS..=CAUGHT).contains(&x) && (-PLAY..=SEAT + PLAY).contains(&z) =>
            {
                self.rests = Some(z);
            }
            (Ring::Unlocked, None) => return Err("a gripper falls"),
            _ => {}
        }
        Ok(())
    }

    fn carry(&mut self, robot: &Frame) -> Result<(), Wrong> {
        let (x, z) = holster::within(robot);
        let mated = self.is_mated(robot);
        match &mut self.rests {
            None if (z - SEAT).abs() <= LIPS && (HELD_DOWN..LANDS).contains(&-x) => {
                return Err("a gripper is torn out of its holster");
            }
            Some(rests) if mated => {
                let pushed = rests.clamp(z - CAUGHT, z + CAUGHT);
                *rests = if pushed >= SEAT - DETENT { SEAT } else { pushed };
            }
            None | Some(_) => {}
        }
        Ok(())
    }

    /// The bits of the sensors that detect the gripper; the large ones are the lower bits.
    fn sees(&self, robot: &Frame) -> u8 {
        let (x, z) = self.rests.map_or_else(|| holster::within(robot), |rests| (0.0, rests));
        let large = x.abs() <= LARGE && (-LARGE..=SEAT + LARGE).contains(&z);
        let small = x.abs() <= SMALL && (z - SEAT).abs() <= SMALL;
        match (self.dark, large, small) {
            (true, ..) | (_, false, _) => 0,
            (_, true, false) => 0b0011,
            (_, true, true) => 0b1111,
        }
    }

    pub fn is_met(&self, robot: &Frame, prim: &State) -> bool {
        let sees = self.sees(robot);
        prim.target.sensor.is_some_and(|sensor| match sensor.source {
            SensorSource::Near => sees & 0b0011 == 0b0011,
            SensorSource::Seated => sees & 0b1100 == 0b1100,
            _ => false,
        })
    }

    pub fn write(&self, robot: &Frame, memory: &mut CommonMemory, devices: &mut DeviceInputs, stamp: Tick) {
        let mated = self.is_mated(robot);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (self.echo, self.report);
        status.end_effector_id = mated.then_some(GRIPPER.0);
        status.ring = match self.ring {
            Ring::Locked => RingPosition::Locked,
            Ring::Unlocked => RingPosition::Unlocked,
            Ring::Between => RingPosition::Between,
        };
        let ring = &mut devices.quick_change;
        (ring.locked, ring.unlocked) = (self.ring == Ring::Locked, self.ring == Ring::Unlocked);
        ring.end_effector_id = if mated { GRIPPER.0 } else { 0 };
        devices.holsters.right = self.sees(robot);
        memory.prim.status.holster_right = self.sees(robot);
        self.grip.write(memory, stamp);
    }

    pub fn add_to(&self, image: &mut Image) {
        image.add(&self.echo);
        image.add(&self.report);
        let turns = self.turns.map_or(255, Ring::code);
        image.bytes.extend([self.ring.code(), turns, u8::from(self.rests.is_some()), u8::from(self.dark)]);
        image.add(&self.rests.unwrap_or_default());
        self.grip.add_to(image);
    }
}
