//! The task data of the last commands, each with file, block and line: the point of the path, the grip with movetable
//! and sizes, the location. Records are found by number, because two forms can have the same text.

use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb, Way},
    pose_range,
    prim::{PrimCommand, PrimVerb},
};
use levels::{
    emove::{localization::path::route_of, motion::relative::Relative},
    ladder::ProcessId,
};
use taskdata::{
    files::{MovtabId, PathPoint, PoseId, RelativeMove, TaskData},
    load::{At, Store},
};

/// The data that the last command of a process used. `way` is E-move's path at the time of Prim's last command.
pub fn used(store: &Store, process: ProcessId, memory: &CommonMemory, way: Option<Way>) -> Vec<String> {
    let (order, motion) = (&memory.subtask.emove, &memory.emove.prim);
    let mut found = Found { store, view: store.view(), lines: Vec::new() };
    if process == ProcessId::Grip {
        found.sizes(order);
        return found.lines;
    }
    found.motion(order, motion, way);
    found.grip(order);
    found.location(order);
    found.lines
}

struct Found<'s> {
    store: &'s Store,
    view: TaskData<'s>,
    lines: Vec<String>,
}

impl Found<'_> {
    /// Adds the place where a record was entered, if it is known.
    fn add(&mut self, what: &str, origins: &[At], position: Option<usize>) {
        if let Some(at) = position.and_then(|position| origins.get(position)) {
            let line = format!("{what}: {}", self.store.place(*at));
            if !self.lines.contains(&line) {
                self.lines.push(line);
            }
        }
    }

    /// The pose, the movetable and the line of the path, or the relative move, of Prim's command.
    fn motion(&mut self, order: &EmoveCommand, motion: &PrimCommand, way: Option<Way>) {
        let (view, origins) = (self.view, self.store.origins());
        if motion.pose < pose_range::CHANGING {
            let pose = PoseId::new(motion.pose);
            let name = pose.of(view.poses).map_or_else(String::new, |pose| pose.name.to_string());
            self.add(&format!("pose {name}"), &origins.poses, pose.index());
        }
        self.movetable("", motion.movetable);
        match motion.command {
            PrimVerb::GoUntil | PrimVerb::GoWhile | PrimVerb::DeltaMove => {
                let record = relative_move(&view, order, motion);
                let position = record.and_then(|record| position(view.relative_moves, record));
                let name = record.map_or_else(String::new, |record| record.name.to_string());
                self.add(&format!("relative move {name}"), &origins.relative_moves, position);
            }
            _ => {
                let point = way.and_then(|way| path_point(&view, &way, motion));
                let point = point.and_then(|point| position(view.path_points, point));
                self.add("point of the path", &origins.path_points, point);
            }
        }
    }

    /// The grip or the view of the object in E-move's command, with its movetable and sizes.
    fn grip(&mut self, order: &EmoveCommand) {
        let Some(object) = order.object else { return };
        let (view, origins) = (self.view, self.store.origins());
        let place = order.site.place();
        if matches!(order.command, EmoveVerb::MovToVu | EmoveVerb::LocateObj) {
            let id = order.object_vision;
            self.add(&format!("view of {object} at {}", order.site.location), &origins.visions, id.index());
            self.movetable(" of the view", id.of(view.visions).map_or(MovtabId::NULL, |view| view.movetable));
            return;
        }
        let id = view.grip_loc(&object, order.grip, &place);
        let what = format!("grip {} of {object} at {}", order.grip, order.site.location);
        self.add(&what, &origins.grip_locs, id.and_then(|id| id.index()));
        let movetable = view.grip_movetable(&object, order.grip, &place);
        self.movetable(" of the grip", movetable.unwrap_or(MovtabId::NULL));
        self.sizes(order);
    }

    fn sizes(&mut self, order: &EmoveCommand) {
        let id = order.object_parameters;
        if let (Some(object), Some(grip)) = (order.object, id.of(self.view.end_effs)) {
            let what = format!("sizes and force of grip {} of {object}, {} lb", grip.grip, grip.grasp_force);
            self.add(&what, &self.store.origins().end_effs, id.index());
        }
    }

    fn location(&mut self, order: &EmoveCommand) {
        let origins = self.store.origins();
        let (point, array) = (order.site.record, order.site.array);
        self.add(&format!("location {}", order.site.location), &origins.locpts, point.index());
        let name = array.of(self.view.arrays).map_or_else(String::new, |array| array.name.to_string());
        self.add(&format!("array {name}"), &origins.arrays, array.index());
    }

    fn movetable(&mut self, of: &str, id: MovtabId) {
        let name = id.of(self.view.movetables).map_or_else(String::new, |table| table.name.to_string());
        self.add(&format!("movetable {name}{of}"), &self.store.origins().movetables, id.index());
    }
}

/// The line of the path to which a command sends Prim.
fn path_point<'a>(data: &TaskData<'a>, way: &Way, motion: &PrimCommand) -> Option<&'a PathPoint> {
    let written = route_of(way, data).ok()?.written(way.next, data)?;
    // The parameters differ for a command without a path, such as PAUSE.
    (written.para == motion.trajectory_parameters).then_some(written)
}

/// The relative move of a command to Prim.
fn relative_move<'a>(
    data: &TaskData<'a>,
    order: &EmoveCommand,
    motion: &PrimCommand,
) -> Option<&'a RelativeMove> {
    let is_meant = |record: &&RelativeMove| {
        record.movetable == motion.movetable
            && record.para == motion.trajectory_parameters
            && motion.sensor.is_none_or(|sensor| sensor == record.sensor)
    };
    Relative::ALL.iter().filter_map(|relative| relative.record(&order.site, data)).find(is_meant)
}

/// The number of a record of a file. Records with equal contents are still different records.
fn position<T>(file: &[T], record: &T) -> Option<usize> {
    file.iter().position(|candidate| std::ptr::eq(candidate, record))
}
