//! Show mode follows a pointer, such as `pose-^-in`, to its record (IV.2.6, VII.1).

use geometry::{movetable::System, pose::Pose};
use interfaces::{CommonMemory, pose_range};
use paths::stand::movetable_form;
use taskdata::files::{EndEffId, LocptId, MovtabId, ObjGripsId, PoseId, TaskData, TrajParaId, VisionId};

use super::library::Library;
use crate::rcs_console::{model::buffers, picture::Picture};

/// The file of a pointer, from the end of its field's path.
#[derive(Clone, Copy)]
enum File {
    Pose,
    Movetable,
    Parameters,
    Location,
    Grip,
    Gripper,
    View,
}

/// The pointers of chapter V, by the last names of their paths.
const POINTERS: [(&str, File); 12] = [
    ("pose", File::Pose),
    ("reference_pose", File::Pose),
    ("present_pose", File::Pose),
    ("sensor_pose", File::Pose),
    ("detected_pose", File::Pose),
    ("recorded_pose", File::Pose),
    ("movetable", File::Movetable),
    ("trajectory_parameters", File::Parameters),
    ("record", File::Location),
    ("object_parameters", File::Grip),
    ("object_grips", File::Gripper),
    ("object_vision", File::View),
];

/// The record of a pointer as lines; `None` if the field is not a pointer, or is empty.
#[must_use]
pub fn target(path: &str, picture: &Picture, library: &mut Library) -> Vec<String> {
    let end = path.rsplit('.').next().unwrap_or_default();
    let Some((_, file)) = POINTERS.iter().find(|(name, _)| *name == end) else { return Vec::new() };
    let fields = buffers::under(&[path], picture, None);
    let [field] = fields.as_slice() else { return Vec::new() };
    let Ok(number) = field.value.parse::<u32>() else { return Vec::new() };
    if number == 0 {
        return Vec::new();
    }
    let lines = match *file {
        File::Pose if number >= pose_range::CHANGING => changing(&picture.memory, number),
        file => library.store().and_then(|store| of_data(file, number, &store.view())),
    };
    lines.unwrap_or_else(|| vec!["  this record is not in the blocks that this console has".to_owned()])
}

/// A record that changes during the run: its writer and, for Task, its name in VII.1.
fn changing(memory: &CommonMemory, number: u32) -> Option<Vec<String>> {
    let pose = memory.changing_pose(number)?;
    let of_task = memory.task.poses.iter().position(|record| record.number == Some(number));
    let name = match (of_task, number & pose_range::WRITER) {
        (Some(position), _) => format!("T-POSE-{}", position + 1),
        (_, pose_range::SUBTASK) => "a pose of Subtask".to_owned(),
        (_, pose_range::EMOVE) => "a pose of E-move".to_owned(),
        _ => "a pose of Prim".to_owned(),
    };
    Some(named(&name, &nine(pose)))
}

fn of_data(file: File, number: u32, data: &TaskData<'_>) -> Option<Vec<String>> {
    match file {
        File::Pose => {
            let record = data.pose(PoseId::new(number))?;
            Some(named(record.name.as_str(), &nine(&record.pose)))
        }
        File::Movetable => {
            let record = MovtabId::new(number).of(data.movetables)?;
            let lines = record.movetable.lines.iter();
            let used: Vec<_> = lines.filter(|line| line.system != System::None).copied().collect();
            Some(named(record.name.as_str(), &movetable_form(record.name.as_str(), &used)))
        }
        File::Parameters => {
            let para = data.traj_para(TrajParaId::new(number))?;
            let (acc, max) = (para.acc_fac, para.vel_max);
            Some(vec![format!("  fac {acc}  max {max}  acc {}  dist {}", para.smooth, para.brk_dst)])
        }
        File::Location => {
            let record = data.locpt(LocptId::new(number))?;
            let pose = data.pose(record.pose)?;
            Some(vec![format!("  {}, at {}", record.name, pose.name)])
        }
        File::Grip => {
            let record = data.end_eff(EndEffId::new(number))?;
            let sizes = format!("{} {} {}", record.appr_size, record.grasp_size, record.depart_size);
            let object = data.object_name(record.object);
            Some(vec![format!(
                "  {object} grip {}: sizes {sizes} (0.01 in), force {} lb",
                record.grip, record.grasp_force
            )])
        }
        File::Gripper => {
            let record = ObjGripsId::new(number).of(data.obj_grips)?;
            let (gripper, grip) = (record.endeff_id, record.tray_grip);
            Some(vec![format!(
                "  {}: gripper {gripper}, grip {grip} in a tray",
                data.object_name(record.object)
            )])
        }
        File::View => {
            let record = data.vision_para(VisionId::new(number))?;
            let (grip, id, range) = (record.grip, record.id, record.range);
            let object = data.object_name(record.object);
            Some(vec![format!("  {object} grip {grip}: number {id} for vision, range {range} mm")])
        }
    }
}

fn named(name: &str, values: &[String]) -> Vec<String> {
    std::iter::once(format!("  {name}")).chain(values.iter().map(|line| format!("    {line}"))).collect()
}

/// The nine numbers of a pose in the layout of Figure VII.1: wrist, tool and finger point, 0.01 in.
#[must_use]
pub fn nine(pose: &Pose) -> [String; 3] {
    [pose.wrist, pose.tool, pose.finger].map(|[x, y, z]| format!("{x:>7} {y:>8} {z:>8}"))
}
