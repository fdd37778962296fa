use interfaces::{
    Unconfirmed,
    emove::{Holding, Pins},
    subtask::SubtaskStatus,
};

use super::{
    plan::{Handling, Plan, PlanSite, TOOL_GRIPPER, TaskVerb},
    tables::DataBase,
};
use crate::{
    confirm::{Evidence, Proof},
    goal::{AT_PLACE, Goal, Sensor},
    held::Held,
    subtask::goals::{force, is_free},
};

const GRASP: &str = "as GRASP-OBJ of E-move";

pub static REST: Goal = Goal {
    holds: "Subtask pauses, or does not answer",
    sensors: &[Sensor::Below],
    tolerance: "",
    age: 3,
    unconfirmed: &[],
};
pub static TRANSFERRED: Goal = Goal {
    holds: "the fingers have released the object at the destination and hold nothing; the robot is at the end-at \
            location",
    sensors: &[Sensor::Fingers, Sensor::StrainGages, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 4,
    unconfirmed: &[Unconfirmed::Position, Unconfirmed::PartInFingers],
};
pub static MOVED: Goal = Goal {
    holds: "the robot is at the destination, and holds the object if one is named",
    sensors: &[Sensor::Resolvers, Sensor::Fingers, Sensor::StrainGages],
    tolerance: AT_PLACE,
    age: 4,
    unconfirmed: &[Unconfirmed::Position, Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static POSITIONED: Goal = Goal {
    holds: "the gripper is empty, and the robot is at the position",
    sensors: &[Sensor::Fingers, Sensor::StrainGages, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 4,
    unconfirmed: &[Unconfirmed::Position],
};
pub static HELD: Goal = Goal {
    holds: "the object is held",
    sensors: &[Sensor::Fingers, Sensor::StrainGages],
    tolerance: GRASP,
    age: 3,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static REFIXTURED: Goal = Goal {
    holds: "the robot is at the destination and holds the object in the destination grip",
    sensors: &[Sensor::Resolvers, Sensor::Fingers, Sensor::StrainGages],
    tolerance: AT_PLACE,
    age: 4,
    unconfirmed: &[Unconfirmed::Position, Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static INSERTED: Goal = Goal {
    holds: "the tool gripper holds the tool, and is in the drum with it",
    sensors: &[Sensor::IdPins, Sensor::Fingers, Sensor::Resolvers],
    tolerance: GRASP,
    age: 4,
    unconfirmed: &[Unconfirmed::ToolInDrum, Unconfirmed::PartInFingers],
};
pub static TOOL_RELEASED: Goal = Goal {
    holds: "the tool gripper is empty and out of the drum, the drum has the tool, and the robot is at the end-at \
            location",
    sensors: &[Sensor::IdPins, Sensor::Fingers, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 4,
    unconfirmed: &[Unconfirmed::ToolInDrum, Unconfirmed::PartInFingers],
};
pub static ACQUIRED: Goal = Goal {
    holds: "the tool gripper holds the tool, and is in the drum with it",
    sensors: &[Sensor::IdPins, Sensor::Fingers, Sensor::Resolvers],
    tolerance: GRASP,
    age: 4,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static REMOVED: Goal = Goal {
    holds: "the tool gripper holds the tool out of the drum, and the robot is at the end-at location",
    sensors: &[Sensor::IdPins, Sensor::Fingers, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 4,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static CONNECTED: Goal = Goal {
    holds: "the Data System has done the last command",
    sensors: &[Sensor::DataSystem],
    tolerance: "",
    age: 1,
    unconfirmed: &[],
};
pub static DISCONNECTED: Goal = Goal {
    holds: "Task sends nothing more to the Data System",
    sensors: &[Sensor::Below],
    tolerance: "",
    age: 0,
    unconfirmed: &[],
};

pub(super) fn proof(plan: &Plan, below: &SubtaskStatus, data_base: DataBase) -> Proof {
    let force = force(below.end_effector_id);
    let is_held = || match Held::of(below.held, plan.object) {
        Held::Right => force,
        Held::NotKnown => Proof::of(Evidence::NotKnown),
        Held::Nothing | Held::Other | Held::Something => Proof::of(Evidence::NotHeld),
    };
    let in_grip = |grip: i32| match below.held {
        Holding::Object(held) => Proof::when(held.grip == grip, Evidence::OtherGrip),
        Holding::Nothing | Holding::Something | Holding::NotKnown => Proof::HOLDS,
    };
    let has_tool = || match below.held {
        _ if below.end_effector_id != Some(TOOL_GRIPPER) => Proof::of(Evidence::GripperOff),
        Holding::Object(held) if plan.object.is_none_or(|object| object == held.object) => force,
        Holding::NotKnown => Proof::of(Evidence::NotKnown),
        Holding::Object(_) | Holding::Nothing | Holding::Something => Proof::of(Evidence::NotHeld),
    };
    let has_tool_gripper = || {
        Proof::when(below.end_effector_id == Some(TOOL_GRIPPER), Evidence::GripperOff)
            .and(Proof::when(below.pins == Pins::Agree, Evidence::PinsDiffer))
    };
    let in_drum = || Proof::when(below.drum, Evidence::OutsideDrum);
    let out_of_drum = || Proof::when(!below.drum, Evidence::InsideDrum);
    let destination = || at(&plan.destination, below);
    let end = || at(&plan.end_at, below);
    match plan.verb {
        TaskVerb::None | TaskVerb::Pause | TaskVerb::Shutdown => Proof::HOLDS,
        TaskVerb::Startup => Proof::when(data_base == DataBase::Done, Evidence::NoAnswer),
        TaskVerb::Transfer => is_free(below.held)
            .and(Proof::when(is_placed(plan, below), Evidence::NotPlaced))
            .and(if plan.end_at.location.is_some() { end() } else { destination() })
            .with_part(below.seat),
        TaskVerb::Move if plan.handling() == Handling::NoObject => destination(),
        TaskVerb::Move => is_held().and(destination()).with_part(below.seat),
        TaskVerb::Position => is_free(below.held).and(at(plan.position_site(), below)),
        TaskVerb::Acquire => is_held().with_part(below.seat),
        TaskVerb::Refixture => {
            is_held().and(in_grip(plan.destination.grip)).and(destination()).with_part(below.seat)
        }
        TaskVerb::InsertTool => {
            has_tool().and(in_drum()).and_unsensed(Unconfirmed::ToolInDrum).with_part(below.seat)
        }
        TaskVerb::ReleaseTool => has_tool_gripper()
            .and(is_free(below.held))
            .and(out_of_drum())
            .and(end())
            .and_unsensed(Unconfirmed::ToolInDrum)
            .with_part(below.seat),
        TaskVerb::AcquireTool => has_tool().and(in_drum()).with_part(below.seat),
        TaskVerb::RemoveTool => has_tool().and(out_of_drum()).and(end()).with_part(below.seat),
    }
}

fn is_placed(plan: &Plan, below: &SubtaskStatus) -> bool {
    let destination = plan.destination.site();
    below.placed.is_some_and(|placed| plan.object == Some(placed.object) && destination == Some(placed.site))
}

/// The robot is at a location, if one is named.
fn at(site: &PlanSite, below: &SubtaskStatus) -> Proof {
    let Some(location) = site.site() else { return Proof::HOLDS };
    match below.at {
        Some(at) if at.site == location => Proof::at(below.offset),
        Some(_) | None => Proof::of(Evidence::Elsewhere),
    }
}
