//! Teaching: a recorded pose becomes a form in a block (III.3.3, VII.1, VII.2), which the editor shows with the joints.

use std::path::Path;

use diagnostics::alternatives;
use geometry::pose::Pose;
use paths::stand::{Standing, movetable_between, movetable_form, pose_form};
use plant::{CellDescription, room::Room};
use rcs_core::name::{Name, Name10};
use taskdata::load::{BlockNumber, Source, Store};

use super::editor::Editor;
use crate::rcs_console::picture::Picture;

const CELL: &str = "cell.toml"; // name of the cell description in a data directory

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PoseLesson {
    pub number: BlockNumber,
    pub name: String,
    /// The named pose to which the movetable is relative; `None` for a pose.
    pub relative: Option<String>,
}

fn recorded(picture: &Picture) -> Option<Pose> {
    let number = picture.memory.prim.status.recorded_pose?;
    picture.memory.changing_pose(number).copied()
}

impl PoseLesson {
    /// Open the editor with the form. Fails if no pose was recorded, the robot cannot reach it, or the block has no
    /// room.
    pub fn begin(&self, picture: &Picture, directory: &Path, sources: &[Source]) -> Result<Editor, String> {
        let pose = recorded(picture).ok_or(
            "no pose has been recorded: drive the robot with the joystick box, and press its record button (m on \
             screen 6)",
        )?;
        let name: Name10 = Name::new(&self.name)
            .map_err(|_| format!("{} is not a name of up to 10 characters", self.name))?;
        let (store, _) = Store::from_sources(sources.to_vec())
            .map_err(|_| "the task data have errors: rcs-run check shows them".to_owned())?;
        let data = store.view();
        let path = directory.join(CELL);
        let cell = CellDescription::load(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let standing = Standing::of(&pose, &data, &Room::new(&cell))?;
        // The form contains the points, so they are omitted. The most important lines come first.
        let mut about: Vec<String> = standing.to_string().lines().skip(3).map(str::to_owned).collect();
        about.sort_by_key(|line| !(line.starts_with("limits") || line.starts_with("cell")));
        if !standing.is_usable() {
            return Err(format!("the robot cannot stand there: {}", about.join("; ")));
        }
        let form = match &self.relative {
            None => pose_form(name.as_str(), "...", &pose),
            Some(from) => {
                let known = Name::<10>::new(from).ok().and_then(|from| data.pose_named(&from));
                let from = known.and_then(|id| data.pose(id)).ok_or_else(|| {
                    let poses: Vec<String> = data.poses.iter().map(|pose| pose.name.to_string()).collect();
                    let others = alternatives(from, poses.iter().map(String::as_str), "there are");
                    format!("no pose is named {from}: {others}")
                })?;
                let to = pose.to_frame().map_err(|error| error.to_string())?;
                movetable_form(name.as_str(), &movetable_between(&from.frame, &to))
            }
        };
        Editor::begin(self.number, directory, sources)?.with_form(&form, about)
    }
}
