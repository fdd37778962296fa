//! Finds what went wrong in the world: the first contact, lost part, or warning of the robot controller, or what ended
//! the run if no process failed. From there the commands are traced up to the workstation controller, each with its
//! row. The data that the last row used are listed with file, block and line.

use interfaces::{CommonMemory, emove::Way};
use levels::ladder::ProcessId;
use record::{Log, proto::foxglove::Level, replay::generations};
use serde::Serialize;

use super::{
    chain::{self, Link, Root},
    data,
    history::History,
};
use crate::story::moments;

/// End effector id of the gripper whose hand is the process Grip.
const PARTS_GRIPPER: u8 = 1;

/// The first thing that went wrong in the world.
#[derive(Debug, Serialize)]
pub struct World {
    /// The tick of the event.
    pub tick: u64,
    /// Description of the event.
    pub text: String,
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
            *self = Self { number, way: memory.emove.beliefs.way };
        }
    }
}

/// The first thing that went wrong; `None` if nothing did.
pub fn first(log: &Log, history: &History) -> Option<World> {
    // The cell reports an event with the tick after it.
    let of_world = |source: &str| matches!(source, "cell" | "robot");
    let grave = log.lines().find(|line| of_world(&line.source) && line.level == Level::Error);
    let (tick, text, code) = match grave {
        Some(line) => (line.tick.0.saturating_sub(1), line.text, line.code),
        None => {
            let end = log.end.as_ref()?;
            (end.get("failed_at")?.parse().ok()?, end.get("result")?.clone(), String::new())
        }
    };
    let (mut motion, mut last) = (Motion::default(), None);
    for (moment, _) in moments(log).take_while(|(moment, _)| moment.tick.0 <= tick) {
        motion.note(&moment.before);
        last = Some((moment.before, moment.external.generation));
    }
    let (memory, generation) = last?;
    let process = mover(&code, &memory);
    let commands = chain::commands(history, Root { process, tick });
    let store = generations(log).ok().and_then(|all| all.into_iter().nth(usize::try_from(generation).ok()?));
    let data = store.map_or_else(Vec::new, |store| data::used(&store, process, &memory, motion.way));
    Some(World { tick, text, commands, data })
}

/// The lowest process whose command caused the event: the gripper for a lost part, T3I for a warning of the robot
/// controller, Prim for all other motion.
fn mover(code: &str, memory: &CommonMemory) -> ProcessId {
    let by_parts_gripper = memory.emove.prim.end_effector_id == Some(PARTS_GRIPPER);
    match code {
        "cell.warning" | "robot.refuses" => ProcessId::T3i,
        "cell.dropped" if by_parts_gripper => ProcessId::Grip,
        _ => ProcessId::Prim,
    }
}
