//! The first failure in the world, with the commands that led to it from the workstation controller down, each
//! with its row, and the data that the last row used, with file, block and line.

use closed_loop::{
    account::{Account, Kind},
    failure::Failure,
};
use interfaces::{CommonMemory, emove::Way};
use levels::ladder::ProcessId;
use record::{Log, replay::generations};
use serde::Serialize;

use super::{
    chain::{self, Link, Root},
    data,
    history::History,
};
use crate::story::moments;

/// End effector id of the gripper whose hand is the process Grip.
const PARTS_GRIPPER: u8 = 1;

/// The first failure in the world and its consequences.
#[derive(Debug, Serialize)]
pub struct World {
    /// The failures in order.
    #[serde(flatten)]
    pub account: Account,
    /// The commands that led to the event, from the workstation controller down.
    pub commands: Vec<Link>,
    /// The data that the last row used, with file, block and line.
    pub data: Vec<String>,
}

/// The last command to Prim, and the path of E-move when it gave that command.
#[derive(Default)]
struct Motion {
    number: u32,
    way: Option<Way>,
}

impl Motion {
    fn note(&mut self, memory: &CommonMemory) {
        let number = memory.emove.prim.number;
        if number != self.number {
            *self = Self { number, way: memory.emove.estimates.way };
        }
    }
}

/// The first failure. It has commands and data if a command can have caused it.
pub fn first(log: &Log, history: &History, account: Account) -> World {
    let Failure { tick, kind, .. } = account.first;
    let mut world = World { account: account.clone(), commands: Vec::new(), data: Vec::new() };
    if !is_commanded(kind) {
        return world;
    }
    let (mut motion, mut last) = (Motion::default(), None);
    for (moment, _) in moments(log).take_while(|(moment, _)| moment.tick <= tick) {
        motion.note(&moment.before);
        last = Some((moment.before, moment.external.generation));
    }
    let Some((memory, generation)) = last else { return world };
    let process = mover(kind, &memory);
    world.commands = chain::commands(history, Root { process, tick: tick.0 });
    let generation = usize::try_from(generation).unwrap_or(usize::MAX);
    let store = generations(log).ok().and_then(|all| all.into_iter().nth(generation));
    world.data = store.map_or_else(Vec::new, |store| data::used(&store, process, &memory, motion.way));
    world
}

/// True if the command of a process can have caused it.
const fn is_commanded(kind: Kind) -> bool {
    !matches!(kind, Kind::EmergencyStop | Kind::Power | Kind::Link | Kind::Device | Kind::Program)
}

/// The lowest process whose command caused the failure: the gripper for a part that it lost, T3I for a warning of the
/// robot controller, Prim for all other motion.
fn mover(kind: Kind, memory: &CommonMemory) -> ProcessId {
    let by_parts_gripper = memory.emove.prim.end_effector_id == Some(PARTS_GRIPPER);
    match kind {
        Kind::RobotController => ProcessId::T3i,
        Kind::Lost if by_parts_gripper => ProcessId::Grip,
        _ => ProcessId::Prim,
    }
}
