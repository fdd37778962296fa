use std::{path::Path, sync::OnceLock};

use geometry::pose::Pose;
use interfaces::{
    ChangingPose, HwsCommand,
    emove::{EmoveCommand, EmoveVerb},
    pose_range,
    subtask::{SubtaskCommand, SubtaskVerb},
};
use rcs_core::name::Name16;
use taskdata::{
    files::{EndEffId, Location, TaskData, VisionId},
    load::{Step, Store, job::own_command},
};

const GRIP: i32 = 2; // grip of the objects in commands of Subtask

fn store() -> &'static Store {
    static STORE: OnceLock<Store> = OnceLock::new();
    STORE.get_or_init(|| match Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    })
}

pub fn data() -> TaskData<'static> {
    store().view()
}

/// Commands from their lines in a job, without `==`.
pub fn commands(lines: &[&str]) -> Vec<HwsCommand> {
    let read = |line: &&str| match own_command(line, store()).map(|line| line.step) {
        Ok(Step::Command(command)) => command,
        other => panic!("{line}: {other:?}"),
    };
    lines.iter().map(read).collect()
}

pub fn emove_command(verb: EmoveVerb, object: &str, grip: i32, location: &str) -> EmoveCommand {
    let (object, at) = (Name16::new(object).expect("a name"), place(location));
    EmoveCommand {
        number: 0,
        command: verb,
        object: Some(object),
        grip,
        object_parameters: data().object(&object, grip).map_or(EndEffId::NULL, |(id, _)| id),
        object_grips: data().obj_grips_id(&object).unwrap_or_default(),
        object_vision: VisionId::NULL,
        site: at.site(),
        pose: None,
        end_effector_id: Some(1),
    }
}

pub fn pose_of_point(name: &str) -> u32 {
    let found = data().locpt_named(&Name16::new(name).expect("a name")).and_then(|id| data().locpt(id));
    found.expect("the data have the point").pose.number()
}

pub fn place(name: &str) -> Location {
    let name = Name16::new(name).expect("a name");
    data().resolve_location(&name, None, None::<&Name16>).expect("the data have the location")
}

/// A command for an object in grip 2 with the parts gripper, or for a location. `nth` is the number of the pose.
pub fn subtask_command(
    verb: SubtaskVerb,
    object: Option<&str>,
    location: &str,
    sector: Option<i32>,
    nth: u32,
) -> (SubtaskCommand, ChangingPose) {
    let object = object.map(|object| Name16::new(object).expect("a name"));
    let name = Name16::new(location).expect("a name");
    let at = data().resolve_location(&name, sector, object.as_ref()).expect("the data have the location");
    let number = Some(pose_range::TASK + nth);
    let grip = if object.is_some() { GRIP } else { 0 };
    let command = SubtaskCommand {
        number: 0,
        command: verb,
        object,
        end_effector_id: object.map(|_| 1),
        source_grip: grip,
        destination_grip: grip,
        object_parameters: object
            .and_then(|object| data().object(&object, grip))
            .map_or(EndEffId::NULL, |(id, _)| id),
        site: at.site(),
        pose: number,
    };
    (command, ChangingPose { number, pose: Pose::from_frame(&at.frame) })
}
