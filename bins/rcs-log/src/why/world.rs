//! The first failure in the world: the commands and rows that led to it, and the data of the last row with its line.

use closed_loop::{
    account::Account,
    chain::{Chain, Link},
    failure::Failure,
};
use interfaces::{CommonMemory, emove::Way};
use record::{Log, replay::generations};
use serde::Serialize;

use super::data;
use crate::story::moments;

#[derive(Debug, Serialize)]
pub struct World {
    #[serde(flatten)]
    pub account: Account,
    pub commands: Vec<Link>, // the commands that led to the event, from the workstation controller down
    pub data: Vec<String>,   // the data that the last row used, with file, block and line
}

/// The last command to Prim, and the path of E-move at that time.
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

pub fn first(log: &Log, account: Account, chain: &Chain) -> World {
    let Failure { tick, kind, .. } = account.first;
    let mut world = World { account, commands: chain.commands.clone(), data: Vec::new() };
    let (mut motion, mut last) = (Motion::default(), None);
    for (moment, _) in moments(log).take_while(|(moment, _)| moment.tick <= tick) {
        motion.note(&moment.before);
        last = Some((moment.before, moment.external.generation));
    }
    let Some((memory, generation)) = last else { return world };
    let Some(process) = kind.mover(memory.emove.prim.end_effector_id) else { return world };
    let generation = usize::try_from(generation).unwrap_or(usize::MAX);
    let store = generations(log).ok().and_then(|all| all.into_iter().nth(generation));
    world.data = store.map_or_else(Vec::new, |store| data::used(&store, process, &memory, motion.way));
    world
}
