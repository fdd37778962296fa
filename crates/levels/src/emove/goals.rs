use geometry::frame::Frame;
use interfaces::{
    CommonMemory, EmoveOutputs, Unconfirmed,
    emove::{EmoveCommand, EmoveVerb, Holding},
    grip::Felt,
};
use rcs_core::handshake::Lower;

use super::{
    EmoveInputs, State,
    gripper::EmoveGripper,
    localization::returning::offset_of_place,
    robot_place::{commanded_pose, offset},
    senses::Senses,
    tables::{EmoveHolster, Fingers, Lock, Mate},
};
use crate::{
    confirm::{Evidence, Proof},
    goal::{AT_PLACE, Goal, Sensor},
    held::Held,
};

pub static REST: Goal = Goal {
    holds: "Prim commands no motion, or has lost the link",
    sensors: &[Sensor::Below],
    tolerance: "",
    age: 1,
    unconfirmed: &[],
};
/// Goal of MOV-TO-LOC, MOV-TO-OBJ, MOV-TO-HOL, MOV-TO-VU and LOCATE-OBJ.
pub static PLACE: Goal = Goal {
    holds: "the robot is at the goal pose",
    sensors: &[Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 2,
    unconfirmed: &[Unconfirmed::Position],
};
pub static LOCATED: Goal = Goal {
    holds: "the camera has seen the object, and the robot is over it",
    sensors: &[Sensor::Camera, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 2,
    unconfirmed: &[Unconfirmed::Position],
};
pub static BROUGHT: Goal = Goal {
    holds: "the robot is at the goal pose and holds the object",
    sensors: &[Sensor::Resolvers, Sensor::Fingers, Sensor::StrainGages],
    tolerance: AT_PLACE,
    age: 2,
    unconfirmed: &[Unconfirmed::Position, Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static HELD: Goal = Goal {
    holds: "the fingers are at the size of the object, and detect it",
    sensors: &[Sensor::Fingers, Sensor::StrainGages],
    tolerance: "parts gripper: 1 lb on each finger; jaws: 0.10 in",
    age: 1,
    unconfirmed: &[Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};
pub static RELEASED: Goal = Goal {
    holds: "the fingers are empty",
    sensors: &[Sensor::Fingers, Sensor::StrainGages],
    tolerance: "parts gripper: 1 lb on each finger; jaws: open by the depart size",
    age: 1,
    unconfirmed: &[],
};
pub static ATTACHED: Goal = Goal {
    holds: "the gripper is mated, the ring is locked, and the holster is not full",
    sensors: &[Sensor::IdPins, Sensor::RingSensors, Sensor::HolsterSensors],
    tolerance: "",
    age: 1,
    unconfirmed: &[],
};
pub static DETACHED: Goal = Goal {
    holds: "no gripper is mated",
    sensors: &[Sensor::IdPins],
    tolerance: "",
    age: 1,
    unconfirmed: &[],
};
pub static WITHDRAWN: Goal = Goal {
    holds: "the robot is where Prim has sent it",
    sensors: &[Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 2,
    unconfirmed: &[Unconfirmed::Position],
};
pub static INSERTED: Goal = Goal {
    holds: "the robot is where Prim has sent it, with the tool held, and the drum has it",
    sensors: &[Sensor::Resolvers, Sensor::Fingers],
    tolerance: AT_PLACE,
    age: 2,
    unconfirmed: &[Unconfirmed::ToolInDrum, Unconfirmed::PartInFingers],
};
pub static TOOL_RELEASED: Goal = Goal {
    holds: "the fingers are empty, the robot is where Prim has sent it, and the drum has the tool",
    sensors: &[Sensor::Fingers, Sensor::Resolvers],
    tolerance: AT_PLACE,
    age: 2,
    unconfirmed: &[Unconfirmed::ToolInDrum, Unconfirmed::PartInFingers],
};
pub static REMOVED: Goal = Goal {
    holds: "the robot is where Prim has sent it, with the tool held",
    sensors: &[Sensor::Resolvers, Sensor::Fingers],
    tolerance: AT_PLACE,
    age: 2,
    unconfirmed: &[Unconfirmed::Position, Unconfirmed::GraspForce, Unconfirmed::PartInFingers],
};

/// The opening is the size of the object, and the parts gripper also detects a force.
fn is_grasped(senses: &Senses<'_>, memory: &CommonMemory) -> Proof {
    let attached = EmoveGripper::attached(memory);
    if senses.fingers() != Fingers::Gripping {
        return Proof::of(Evidence::NotHeld);
    }
    match attached.felt(memory) {
        _ if attached.has_stops() => Proof::HOLDS,
        Felt::Something => Proof::HOLDS,
        Felt::Nothing => Proof::of(Evidence::NotHeld),
        Felt::NotKnown => Proof::of(Evidence::NotKnown),
    }
}

impl State {
    pub(super) fn proof(
        &self,
        senses: &Senses<'_>,
        present: Option<&Frame>,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
        outputs: &EmoveOutputs,
    ) -> Proof {
        let memory = inputs.memory;
        let force = if EmoveGripper::attached(memory).has_stops() {
            Proof::unsensed(Unconfirmed::GraspForce)
        } else {
            Proof::HOLDS
        };
        let at_goal = || {
            let [_, goal, ..] = &outputs.poses;
            let seen = self.motion.goal().map_or_else(
                || offset(&goal.pose, present),
                |to| offset_of_place(to, present, self.holding(memory), inputs),
            );
            Proof::at(seen)
        };
        let at_command = || {
            commanded_pose(memory)
                .map_or(Proof::unsensed(Unconfirmed::Position), |pose| Proof::at(offset(&pose, present)))
        };
        let is_held = || match senses.held() {
            Held::Right => force,
            Held::NotKnown => Proof::of(Evidence::NotKnown),
            Held::Nothing | Held::Other | Held::Something => Proof::of(Evidence::NotHeld),
        };
        let is_free = || match self.holding(memory) {
            Holding::Nothing => Proof::HOLDS,
            Holding::Object(_) => Proof::of(Evidence::StillHeld),
            Holding::Something => Proof::of(Evidence::Unknown),
            Holding::NotKnown => Proof::of(Evidence::NotKnown),
        };
        let seat = self.held.seat();
        match command.command {
            EmoveVerb::None | EmoveVerb::Pause => {
                let moves = matches!(senses.prim(), Lower::Pending | Lower::Executing);
                Proof::when(!moves, Evidence::Moving)
            }
            EmoveVerb::MovToLoc
            | EmoveVerb::MovToObj
            | EmoveVerb::MovToVu
            | EmoveVerb::MovToHol
            | EmoveVerb::LocateObj => at_goal(),
            EmoveVerb::MovObjTo => is_held().and(at_goal()).with_part(seat),
            EmoveVerb::GraspObj | EmoveVerb::AcquireTool => {
                is_grasped(senses, memory).and(force).with_part(seat)
            }
            EmoveVerb::Release => is_free(),
            EmoveVerb::QcAttach => Proof::when(senses.mate() == Mate::Right, Evidence::GripperOff)
                .and(Proof::when(senses.lock() == Lock::Locked, Evidence::Ring))
                .and(Proof::when(senses.holster() != EmoveHolster::Full, Evidence::GripperOff)),
            EmoveVerb::QcDetach => Proof::when(senses.mate() == Mate::None, Evidence::GripperOn),
            EmoveVerb::Withdraw => at_command(),
            EmoveVerb::InsertTool => {
                is_held().and(at_command()).and_unsensed(Unconfirmed::ToolInDrum).with_part(seat)
            }
            EmoveVerb::ReleaseTool => {
                is_free().and(at_command()).and_unsensed(Unconfirmed::ToolInDrum).with_part(seat)
            }
            EmoveVerb::RemoveTool => is_held().and(at_command()).with_part(seat),
        }
    }
}
