//! The tool gripper on the robot at the tool drum: its fingers as E-move sees them, and its force sensor as Prim
//! reads it.
//!
//! The condition of a guarded move is met at its start, where most of it is over, at its end, or never. The force
//! disappears when the robot rests after it.

use geometry::{frame::Frame, pose::WireFrame};
use interfaces::{
    CommonMemory,
    device::{DeviceInputs, FORCE_COUNTS_PER_LB, FORCE_ZERO, ForceSensor, MOMENT_COUNTS_PER_IN_LB},
    emove::EmoveVerb,
    grip::Felt,
    jaws::{JawsReport, JawsVerb},
};
use levels::{
    emove::motion::relative::Relative,
    execution::Outcome,
    jaws::{JawsKind as _, ToolGripper},
    prim::state::State,
};
use rcs_core::tick::Tick;
use taskdata::files::{SensorPara, SensorSource};

use crate::{
    data::{data, emove_command, place},
    image::Image,
    search::Wrong,
};

pub const TOOL: (&str, i32, i32) = ("DRILL-2", 1, 175); // name, grip, size in 0.01 in
pub const GRIPPER: u8 = 3;
pub const DRUM: &str = "TOOL-TRNS";
const AROUND: f64 = 0.5; // in from the tool: the fingers are around it

const NEUTRAL: ForceSensor = ForceSensor { x: ZERO, y: ZERO, z: ZERO, moment: ZERO, valid: true };
const ZERO: u16 = FORCE_ZERO as u16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Happens {
    Nothing,
    /// Moving fingers arrive. If they close at the tool, the tool is then between them.
    Arrive,
    Stick,
    Contact, // the condition of the guarded move is met
    Free,
    Dead, // the sensor has no power in this tick
}

#[derive(Clone, Copy, Debug)]
pub struct Tool {
    echo: u32,
    report: JawsReport,
    size: i32,    // opening, 0.01 in
    closes: bool, // air closes the fingers; otherwise it opens them
    at: Frame,    // pose of the robot with its fingers around the tool
    pub force: ForceSensor,
}

fn open() -> i32 {
    (ToolGripper::PARAMETERS.opened * 100.0).round() as i32
}

fn closed() -> i32 {
    (ToolGripper::PARAMETERS.closed * 100.0).round() as i32
}

impl Tool {
    pub fn new() -> Self {
        let (object, grip, _) = TOOL;
        let command = emove_command(EmoveVerb::InsertTool, object, grip, DRUM);
        let seat = Relative::InsIn.record(&command.site, &data()).expect("the data have the move");
        let at = data().moved(&place(DRUM).frame, seat.movetable);
        Self { echo: 0, report: JawsReport::Idle, size: open(), closes: false, at, force: NEUTRAL }
    }

    pub const fn echo(&mut self) -> &mut u32 {
        &mut self.echo
    }

    pub const fn holds(&self) -> bool {
        self.closes && self.size == TOOL.2
    }

    pub fn is_open(&self) -> bool {
        self.size == open()
    }

    pub const fn moves(&self) -> bool {
        matches!(self.report, JawsReport::Executing)
    }

    pub fn is_loaded(&self) -> bool {
        (self.force.z, self.force.moment) != (ZERO, ZERO)
    }

    /// `prim` and `robot` are those after this tick. It is an error to move the fingers while the robot moves.
    pub fn does(
        &mut self,
        happens: Happens,
        robot: &Frame,
        memory: &CommonMemory,
        prim: &State,
    ) -> Result<(), Wrong> {
        let order = &memory.emove.tool_grip;
        let moving = prim.motion.is_some_and(|motion| !motion.is_at_rest());
        if order.number != self.echo && order.number != 0 {
            (self.echo, self.report) = (order.number, JawsReport::Executing);
            match order.command {
                JawsVerb::None | JawsVerb::Pause => self.report = JawsReport::AtPosition,
                JawsVerb::Grasp => self.closes = true,
                JawsVerb::Release | JawsVerb::Pose => self.closes = false,
            }
            if moving && self.moves() {
                return Err("fingers are moved while the robot moves");
            }
        }
        if prim.target.sensor.is_none() || (prim.execution.outcome != Outcome::Executing && !moving) {
            self.force = NEUTRAL;
        }
        self.force.valid = happens != Happens::Dead;
        match happens {
            Happens::Nothing | Happens::Dead => {}
            Happens::Arrive if self.closes => {
                let around = robot.distance(&self.at).inches <= AROUND;
                (self.size, self.report) = (if around { TOOL.2 } else { closed() }, JawsReport::Closed);
            }
            Happens::Arrive => (self.size, self.report) = (open(), JawsReport::Opened),
            Happens::Stick => self.report = JawsReport::Stuck,
            Happens::Contact => self.press(prim),
            Happens::Free => self.force = NEUTRAL,
        }
        if self.size == TOOL.2 {
            self.at = *robot;
        }
        Ok(())
    }

    /// Counts of the watched axis, its bias, and counts per pound or inch pound.
    fn axis(&mut self, sensor: &SensorPara, prim: &State) -> Option<(&mut u16, f64, i32)> {
        let bias = prim.calibration.bias?;
        match sensor.source {
            SensorSource::Fx => Some((&mut self.force.z, bias[0], FORCE_COUNTS_PER_LB)),
            SensorSource::My => Some((&mut self.force.moment, bias[3], MOMENT_COUNTS_PER_IN_LB)),
            _ => None,
        }
    }

    /// Set the force to the least multiple of the threshold that meets the condition of Prim.
    fn press(&mut self, prim: &State) {
        let Some(sensor) = prim.target.sensor else { return };
        for times in 1..5 {
            if let Some((counts, _, unit)) = self.axis(&sensor, prim) {
                *counts = u16::try_from(FORCE_ZERO + times * sensor.threshold * unit).unwrap_or_default();
            }
            if self.is_pressed(prim) {
                return;
            }
        }
    }

    pub fn is_pressed(&self, prim: &State) -> bool {
        let Some(sensor) = prim.target.sensor.filter(|_| self.force.valid) else { return false };
        let mut it = *self;
        let Some((counts, bias, unit)) = it.axis(&sensor, prim) else { return false };
        let value = (f64::from(*counts) - f64::from(FORCE_ZERO) - bias) / f64::from(unit);
        let threshold = f64::from(sensor.threshold);
        if threshold < 0.0 { value <= threshold } else { value >= threshold }
    }

    pub fn is_blind(&self, prim: &State) -> bool {
        prim.target.sensor.is_some() && (!self.force.valid || prim.calibration.bias.is_none())
    }

    pub fn write(&self, memory: &mut CommonMemory, devices: &mut DeviceInputs, stamp: Tick) {
        let outputs = &mut memory.tool_grip;
        (outputs.header.stamp, outputs.header.republished) = (stamp, memory.emove.dormant.tool_grip);
        (outputs.valves.close, outputs.valves.open) = (self.closes, !self.closes);
        let status = &mut outputs.status;
        (status.echo, status.report, status.size) = (self.echo, self.report, self.size);
        status.felt = if self.size == TOOL.2 { Felt::Something } else { Felt::Nothing };
        memory.quick_change.status.end_effector_id = Some(GRIPPER);
        devices.quick_change.end_effector_id = GRIPPER;
        devices.force = self.force;
    }

    pub fn add_to(&self, image: &mut Image) {
        image.add(&self.echo);
        image.add(&self.report);
        image.add(&self.size);
        image.bytes.extend([u8::from(self.closes), u8::from(self.force.valid)]);
        image.add(&WireFrame::from_frame(&self.at));
        image.add(&self.force.z);
        image.add(&self.force.moment);
    }
}
