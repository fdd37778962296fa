//! The records of the task data that a command uses.

use interfaces::{HwsCommand, emove::RobotPlace};
use rcs_core::name::Name16;
use taskdata::load::{At, Store};

use crate::{
    holster::wanted,
    steps::{Step, exchange, steps},
    walk::Walk,
};

#[derive(Clone, Copy, Debug, Default)]
pub struct Present {
    pub place: RobotPlace, // default: unknown
    pub gripper: Option<u8>,
    pub held: Option<(Name16, i32)>, // with its grip, if known
}

/// The records that a command uses from the robot's place; none if a name is unknown.
#[must_use]
pub fn used(command: &HwsCommand, store: &Store, present: &Present) -> Vec<At> {
    let data = store.view();
    let change = match wanted(command, present.gripper, &data) {
        Some(wanted) => exchange(present.gripper, wanted, &data).unwrap_or_default(),
        None => Vec::new(),
    };
    let Ok(own) = steps(command, present.held, &data) else { return Vec::new() };
    let mut walk = Walk::at(store, present.place);
    let regrips = own.iter().any(|step| matches!(step, Step::Pedestal(_)));
    let mut used: Vec<At> = change.iter().chain(&own).flat_map(|step| walk.step(step).used).collect();
    let pedestal = command.object.filter(|_| regrips).and_then(|object| data.ped_para(&object));
    used.extend(pedestal.and_then(|(id, _)| store.origins().ped_paras.get(id.index()?)));
    used
}
