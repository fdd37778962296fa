//! Finds what went wrong in the world: the first contact, lost part, or warning of the robot controller, or what ended
//! the run if no process failed. From there the commands are traced up to the workstation controller, each with its
//! row. The data that the last row used are listed with file, block and line.

use interfaces::{CommonMemory, pose_range};
use levels::ladder::ProcessId;
use record::{Log, proto::foxglove::Level, replay::generations};
use serde::Serialize;
use taskdata::{
    files::{EndEffId, LocptId, MovtabId, PoseId},
    load::{At, Store},
};

use super::{
    chain::{self, Link, Root},
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
    let (memory, generation) = moments(log)
        .map(|(moment, _)| moment)
        .take_while(|moment| moment.tick.0 <= tick)
        .last()
        .map(|moment| (moment.before, moment.external.generation))?;
    let process = mover(&code, &memory);
    let commands = chain::commands(history, Root { process, tick });
    let store = generations(log).ok().and_then(|all| all.into_iter().nth(usize::try_from(generation).ok()?));
    let data = store.map_or_else(Vec::new, |store| data(&store, process, &memory));
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

/// The data that the commands in the buffers name, with file, block and line.
fn data(store: &Store, process: ProcessId, memory: &CommonMemory) -> Vec<String> {
    let (view, origins) = (store.view(), store.origins());
    let mut told = Vec::new();
    let mut tell = |what: String, origins: &[At], position: Option<usize>| {
        if let Some(at) = position.and_then(|position| origins.get(position)) {
            told.push(format!("{what}: {}", store.place(*at)));
        }
    };
    let (order, motion) = (&memory.subtask.emove, &memory.emove.prim);
    if process == ProcessId::Grip {
        let sizes = EndEffId::from_option(order.object_parameters);
        if let (Some(object), Some(grip)) = (order.object, sizes.of(view.end_effs)) {
            let what = format!("grip {} of {object}, {} lb", grip.grip, grip.grasp_force);
            tell(what, &origins.end_effs, sizes.index());
        }
        return told;
    }
    if motion.pose < pose_range::CHANGING {
        let pose = PoseId::new(motion.pose);
        let name = pose.of(view.poses).map_or_else(String::new, |pose| pose.name.to_string());
        tell(format!("pose {name}"), &origins.poses, pose.index());
    }
    let movetable = MovtabId::from_option(motion.movetable);
    let name = movetable.of(view.movetables).map_or_else(String::new, |table| table.name.to_string());
    tell(format!("movetable {name}"), &origins.movetables, movetable.index());
    let point = view.path_points.iter().position(|point| point.para.number() == motion.trajectory_parameters);
    tell("point of the path".to_owned(), &origins.path_points, point);
    let location = LocptId::from_option(order.location_record);
    tell(format!("location {}", order.location), &origins.locpts, location.index());
    told
}
