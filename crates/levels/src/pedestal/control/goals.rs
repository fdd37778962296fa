use interfaces::{
    CommonMemory,
    pedestal::{PedestalCommand, PedestalVerb, TableVerb},
};

use super::tables::{Object, Situation};
use crate::{
    confirm::{Evidence, Proof},
    goal::{Goal, Sensor},
};

const OPEN_WITHIN: i32 = 10; // 0.01 in (ASSUMED)
const AT_ANGLE: u32 = 10; // 0.1 degree: several steps of the motor (ASSUMED)

pub static REST: Goal = Goal {
    holds: "the hand has finished its last command, and the table has stopped",
    sensors: &[Sensor::Below],
    tolerance: "",
    age: 1,
    unconfirmed: &[],
};
pub static READY: Goal = Goal {
    holds: "the hand is open to the size, and the table is at its angle",
    sensors: &[Sensor::Hand, Sensor::Table],
    tolerance: "0.10 in, 1.0 degree",
    age: 1,
    unconfirmed: &[],
};
pub static HELD: Goal = Goal {
    holds: "the hand holds the object",
    sensors: &[Sensor::Hand],
    tolerance: "1 lb on each finger; wider than the grasp size",
    age: 1,
    unconfirmed: &[],
};
pub static TURNED: Goal = Goal {
    holds: "the table is at its angle, and the hand has not lost the object",
    sensors: &[Sensor::Table, Sensor::Hand],
    tolerance: "1.0 degree",
    age: 1,
    unconfirmed: &[],
};
pub static RELEASED: Goal = Goal {
    holds: "the hand is open to the size",
    sensors: &[Sensor::Hand],
    tolerance: "0.10 in",
    age: 1,
    unconfirmed: &[],
};

pub(super) fn proof(command: &PedestalCommand, situation: &Situation, memory: &CommonMemory) -> Proof {
    let is_open = || {
        let opening = memory.hand.status.position.saturating_add(OPEN_WITHIN);
        Proof::when(opening >= command.grasp_size, Evidence::HandNarrow)
    };
    let is_turned = || {
        let order = &memory.pedestal.table;
        let at = memory.table.status.position.is_some_and(|angle| angle.abs_diff(order.angle) <= AT_ANGLE);
        Proof::when(at && order.command == TableVerb::Turn, Evidence::TableElsewhere)
    };
    match command.command {
        PedestalVerb::None | PedestalVerb::Pause => Proof::HOLDS,
        PedestalVerb::PreGrip => is_open().and(is_turned()),
        PedestalVerb::Grip => Proof::when(situation.object == Object::Held, Evidence::HandEmpty),
        PedestalVerb::Flip => {
            is_turned().and(Proof::when(situation.object != Object::Lost, Evidence::HandEmpty))
        }
        PedestalVerb::Release => is_open(),
    }
}
