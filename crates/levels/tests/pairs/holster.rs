//! The right holster with the parts gripper: the robot's places, the commands of Subtask, and their conditions.

use geometry::frame::Frame;
use interfaces::{
    EmoveOutputs,
    emove::{EmoveCommand, EmoveVerb},
    prim::PrimCommand,
};
use levels::emove::motion::relative::Relative;

use crate::{
    data::{data, emove_command, place, pose_of_point},
    robot,
    search::Wrong,
};

pub const GRIPPER: (u8, &str, &str) = (1, "GRIPPER-1", "HOLSTER-R");
/// Place of the seated gripper in the axes of the holster, in.
pub const SEAT: f64 = 1.5;
/// The robot is clear of the holster above this, in the axes of the holster, in.
const CLEAR: f64 = -2.9;
/// A robot this far aside is not in the holster but elsewhere, in.
const ELSEWHERE_INCHES: f64 = 0.25;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ring {
    Locked,
    Unlocked,
    Between,
}

impl Ring {
    pub const fn code(self) -> u8 {
        match self {
            Self::Locked => 0,
            Self::Unlocked => 1,
            Self::Between => 2,
        }
    }
}

pub fn holster() -> Frame {
    place(GRIPPER.2).frame
}

/// A robot in the axes of the holster: X down into it, Z to the seat, in.
pub fn within(robot: &Frame) -> (f64, f64) {
    let at = holster().inverse().compose(robot).position;
    (at.x, at.z)
}

/// A command of Subtask at the holster; PAUSE names none. With grip 2 the bare robot moves there.
pub fn command(number: u32, verb: EmoveVerb) -> EmoveCommand {
    let (id, object, location) = GRIPPER;
    let grip = if verb == EmoveVerb::QcDetach { 1 } else { 2 };
    if verb == EmoveVerb::Pause {
        return EmoveCommand { number, command: verb, ..EmoveCommand::default() };
    }
    EmoveCommand {
        number,
        pose: Some(pose_of_point(location)),
        end_effector_id: Some(id),
        ..emove_command(verb, object, grip, location)
    }
}

/// With a gripper on an unlocked ring the robot moves only to the seat, or from there out of a gripper that stays.
/// `order` is the new order to Prim for a command of Subtask.
pub fn judge_order(command: &EmoveCommand, order: &PrimCommand, ring: Ring) -> Result<(), Wrong> {
    if !robot::moves(order.command) {
        return Ok(());
    }
    let is = |relative: Relative| {
        let record = relative.record(&command.site, &data());
        record.is_some_and(|record| order.movetable == record.movetable)
    };
    match ring {
        Ring::Locked => Ok(()),
        Ring::Unlocked if is(Relative::QcaSlow) || is(Relative::QcdSeat) || is(Relative::QcdUp) => Ok(()),
        Ring::Between if is(Relative::QcaSlow) => Ok(()),
        Ring::Unlocked | Ring::Between => Err("the robot is moved with a gripper that is not locked"),
    }
}

pub fn judge_done(
    command: &EmoveCommand,
    out: &EmoveOutputs,
    robot: &Frame,
    (mated, ring): (bool, Ring),
) -> Result<(), Wrong> {
    let at = holster().inverse().compose(robot).position;
    let clear = at.x < CLEAR || at.y.abs() > ELSEWHERE_INCHES;
    match command.command {
        EmoveVerb::QcAttach if !mated => Err("done, and the gripper is not on"),
        EmoveVerb::QcAttach if ring != Ring::Locked => Err("done, and the ring is not locked"),
        EmoveVerb::QcAttach if out.status.end_effector_id != command.end_effector_id => {
            Err("done, and the id of the gripper is not read")
        }
        EmoveVerb::QcDetach if mated => Err("done, and the gripper is on"),
        EmoveVerb::QcDetach if ring != Ring::Unlocked => Err("done, and the ring is not open"),
        EmoveVerb::QcAttach | EmoveVerb::QcDetach if !clear => {
            Err("done, and the robot is not clear of the holster")
        }
        EmoveVerb::None => Err("an unknown command is done"),
        _ => Ok(()),
    }
}
