//! The records of the task data that a command uses.

use interfaces::{HwsCommand, emove::RobotPlace};
use rcs_core::name::Name16;
use taskdata::load::{At, Store};

use crate::{
    holster::wanted,
    steps::{Step, exchange, steps},
    walk::Walk,
};

/// The robot before a command.
#[derive(Clone, Copy, Debug, Default)]
pub struct Present {
    /// Where it is; the default if that is not known.
    pub place: RobotPlace,
    pub gripper: Option<u8>,
    /// The held object with its grip, if it is known.
    pub held: Option<(Name16, i32)>,
}

/// The places of the records that a command uses, on its way from where the robot is. A command whose names are not in
/// the task data uses none.
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
