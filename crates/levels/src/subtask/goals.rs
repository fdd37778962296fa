use interfaces::{
    Unconfirmed,
    emove::{EmoveStatus, Holding, Pins},
    pedestal::PedestalStatus,
    subtask::{SubtaskCommand, SubtaskVerb},
};

use super::{
    pedestal_hand::pedestal_hand,
    tables::{GripHeld, PedestalLoad, Situation, SubtaskExchange, SubtaskGripper, Where},
};
use crate::{
    confirm::{Evidence, Proof},
    emove::gripper::EmoveGripper,
    goal::{AT_PLACE, Goal, Sensor},
    held::Held,
};

const GRASP: &str = "as GRASP-OBJ of E-move";

pub static REST: Goal = Goal {
    holds: "E-move and the pedestal pause, or do not answer",
    sensors: &[Sensor::Below],
    tolerance: "",
    age: 2,
    unconfirmed: &[],
};
pub static ATTACHED: Goal = Goal {
    holds: "the id pins name the gripper, and the robot is clear of the holsters",
    sensors: &[Sensor::IdPins, Sensor::RingSensors, Sensor::Resolvers],
    tolerance: "",
    age: 3,
    unconfirmed: &[],
};
pub static HELD: Goal = Goal {
    holds: "the object is held",
    sensors: &[Sensor::Fingers, Sensor::StrainGages],
    tolerance: GRASP,
    age: 2,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static REGRIPPED: Goal = Goal {
    holds: "the object is held in the destination grip, and the pedestal's hand holds nothing",
    sensors: &[Sensor::Fingers, Sensor::StrainGages, Sensor::Hand],
    tolerance: GRASP,
    age: 2,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static PLACED: Goal = Goal {
    holds: "the fingers have released the object at the location, and hold nothing",
    sensors: &[Sensor::Fingers, Sensor::StrainGages, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 3,
    unconfirmed: &[Unconfirmed::PartInFingers],
};
/// Goal of MOVE-OBJ>D.
pub static BROUGHT: Goal = Goal {
    holds: "the robot is at the location and holds the object in the destination grip",
    sensors: &[Sensor::Resolvers, Sensor::Fingers, Sensor::StrainGages],
    tolerance: AT_PLACE,
    age: 3,
    unconfirmed: &[Unconfirmed::Position, Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
/// Goal of GOTO-ENDPT, GOTO-DEST and >POSITION.
pub static PLACE: Goal = Goal {
    holds: "the robot is at the location",
    sensors: &[Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 3,
    unconfirmed: &[Unconfirmed::Position],
};
pub static RELEASED: Goal = Goal {
    holds: "the gripper is empty",
    sensors: &[Sensor::Fingers, Sensor::StrainGages],
    tolerance: "as RELEASE of E-move",
    age: 2,
    unconfirmed: &[],
};
pub static INSERTED: Goal = Goal {
    holds: "the tool is held, and the fingers are in the drum with it",
    sensors: &[Sensor::Fingers, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 3,
    unconfirmed: &[Unconfirmed::ToolInDrum, Unconfirmed::PartInFingers],
};
pub static TOOL_RELEASED: Goal = Goal {
    holds: "the gripper is empty, the fingers are out of the drum, and the drum has the tool",
    sensors: &[Sensor::Fingers, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 3,
    unconfirmed: &[Unconfirmed::ToolInDrum, Unconfirmed::PartInFingers],
};
pub static ACQUIRED: Goal = Goal {
    holds: "the tool is held, and the fingers are in the drum with it",
    sensors: &[Sensor::Fingers, Sensor::Resolvers],
    tolerance: GRASP,
    age: 3,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static REMOVED: Goal = Goal {
    holds: "the tool is held, and the fingers are out of the drum",
    sensors: &[Sensor::Fingers, Sensor::Resolvers],
    tolerance: GRASP,
    age: 3,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};

pub(super) fn proof(
    command: &SubtaskCommand,
    situation: &Situation,
    emove: &EmoveStatus,
    pedestal: &PedestalStatus,
) -> Proof {
    let is_held = || match situation.held {
        Held::Right => force(emove.end_effector_id),
        Held::NotKnown => Proof::of(Evidence::NotKnown),
        Held::Nothing | Held::Other | Held::Something => Proof::of(Evidence::NotHeld),
    };
    let in_destination_grip = || Proof::when(situation.grip == GripHeld::Destination, Evidence::OtherGrip);
    let at_place = || at(emove, command);
    let in_drum = || Proof::when(emove.drum, Evidence::OutsideDrum);
    let out_of_drum = || Proof::when(!emove.drum, Evidence::InsideDrum);
    match command.command {
        SubtaskVerb::None | SubtaskVerb::Pause => Proof::HOLDS,
        SubtaskVerb::GetEndeff => {
            Proof::when(situation.gripper == SubtaskGripper::Right, Evidence::GripperOff)
                .and(Proof::when(emove.pins == Pins::Agree, Evidence::PinsDiffer))
                .and(Proof::when(situation.exchange == SubtaskExchange::None, Evidence::InHolster))
        }
        SubtaskVerb::GetObject => is_held().with_part(emove.seat),
        SubtaskVerb::FixGrip => {
            let free = pedestal_hand(pedestal) == PedestalLoad::Free;
            is_held()
                .and(in_destination_grip())
                .and(Proof::when(free, Evidence::InPedestal))
                .with_part(emove.seat)
        }
        SubtaskVerb::PlaceObj => is_free(emove.held)
            .and(Proof::when(situation.placed == Where::There, Evidence::NotPlaced))
            .with_part(emove.seat),
        SubtaskVerb::MoveObjToDest => {
            is_held().and(in_destination_grip()).and(at_place()).with_part(emove.seat)
        }
        SubtaskVerb::GotoEndpt | SubtaskVerb::GotoDest | SubtaskVerb::Position => at_place(),
        SubtaskVerb::Release => is_free(emove.held),
        SubtaskVerb::InsertTool => {
            is_held().and(in_drum()).and_unsensed(Unconfirmed::ToolInDrum).with_part(emove.seat)
        }
        SubtaskVerb::ReleaseTool => {
            is_free(emove.held).and(out_of_drum()).and_unsensed(Unconfirmed::ToolInDrum).with_part(emove.seat)
        }
        SubtaskVerb::AcquireTool => is_held().and(in_drum()).with_part(emove.seat),
        SubtaskVerb::RemoveTool => is_held().and(out_of_drum()).with_part(emove.seat),
    }
}

/// Proof of the grasp force. Only the parts gripper senses it.
pub(crate) fn force(end_effector_id: Option<u8>) -> Proof {
    if EmoveGripper::of(end_effector_id).has_stops() {
        Proof::unsensed(Unconfirmed::GraspForce)
    } else {
        Proof::HOLDS
    }
}

pub(crate) const fn is_free(held: Holding) -> Proof {
    match held {
        Holding::Nothing => Proof::HOLDS,
        Holding::Object(_) => Proof::of(Evidence::StillHeld),
        Holding::Something => Proof::of(Evidence::Unknown),
        Holding::NotKnown => Proof::of(Evidence::NotKnown),
    }
}

fn at(emove: &EmoveStatus, command: &SubtaskCommand) -> Proof {
    match emove.at {
        Some(at) if at.site == command.site => Proof::at(emove.offset),
        Some(_) | None => Proof::of(Evidence::Elsewhere),
    }
}
