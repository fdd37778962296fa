//! Checks of claims about the robot, its gripper and its controller.

use geometry::{frame::Frame, kinematics::T3};
use plant::{Cell, RingState, t3::Stage};

use super::{
    contradiction::{Contradiction, expect},
    history::apart,
    tolerance::{LAG_INCHES, OPENING_INCHES, STOP_INCHES, TOUCH_INCHES},
};

pub fn is_at(
    cell: &Cell,
    goals: &[Frame],
    name: &str,
    inches: f64,
    degrees: f64,
) -> Result<(), Contradiction> {
    let tool = cell.t3().arm().tool();
    let away = |goal: &Frame| {
        let distance = tool.distance(goal);
        (distance.inches, distance.radians.to_degrees())
    };
    let share = |(far, turned): &(f64, f64)| (far / inches).max(turned / degrees);
    let nearest = goals.iter().map(away).min_by(|a, b| share(a).total_cmp(&share(b)));
    let Some((far, turned)) = nearest else { return Ok(()) };
    expect(far <= inches && turned <= degrees, || {
        format!(
            "the robot is {far:.3} in and {turned:.2} degrees from {name}, {inches} in and {degrees} degrees allowed"
        )
    })
}

pub fn is_near(cell: &Cell, goal: &Frame, inches: f64) -> Result<(), Contradiction> {
    let far = apart(&cell.t3().arm().tool().position, &goal.position);
    let most = inches + LAG_INCHES;
    expect(far <= most, || {
        format!("the robot is {far:.2} in from the point that it passes, {most:.2} in allowed")
    })
}

pub fn is_open(cell: &Cell, inches: f64) -> Result<(), Contradiction> {
    let (opening, _) = cell.fingers();
    expect(cell.gripper().is_none() || opening >= inches - OPENING_INCHES, || {
        format!("the fingers are {opening:.2} in open, {inches:.2} in expected")
    })
}

pub fn check_gripper_on(cell: &Cell, id: u8) -> Result<(), Contradiction> {
    match (cell.gripper(), cell.ring()) {
        (Some(on), RingState::Locked) if on == id => Ok(()),
        (Some(on), RingState::Locked) => {
            Err(Contradiction::sensed(format!("gripper {on} is on the robot, not {id}")))
        }
        (Some(on), _) => {
            Err(Contradiction::sensed(format!("gripper {on} hangs on a ring that is not locked")))
        }
        (None, _) => Err(Contradiction::sensed("no gripper is on the robot".to_owned())),
    }
}

pub fn check_no_gripper(cell: &Cell, id: Option<u8>) -> Result<(), Contradiction> {
    if let Some(on) = cell.gripper() {
        return Err(Contradiction::sensed(format!("gripper {on} is still on the robot")));
    }
    expect(cell.ring() == RingState::Open, || "the ring of the quick change is not open".to_owned())?;
    let Some(id) = id else { return Ok(()) };
    expect(cell.is_holstered(id), || format!("gripper {id} is not in the seat of its holster"))
}

pub fn touches(cell: &Cell) -> Result<(), Contradiction> {
    let touching = cell.contacts().iter().any(|contact| contact.depth > -TOUCH_INCHES);
    expect(touching, || "neither the robot nor what it holds touches anything".to_owned())
}

pub fn stops(cell: &Cell) -> Result<(), Contradiction> {
    let arm = cell.t3().arm();
    let behind = apart(&T3.forward(&arm.command()).position, &arm.tool().position);
    expect(!arm.has_pressure() || behind <= STOP_INCHES, || {
        format!("the robot is {behind:.2} in behind its commanded point, {STOP_INCHES} in allowed")
    })
}

pub fn is_linked(cell: &Cell) -> Result<(), Contradiction> {
    let stage = cell.t3().stage();
    expect(stage == Stage::Depc, || format!("the robot controller does not execute DEPC: {}", stage.text()))
}
