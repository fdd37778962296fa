//! The entries of the task data that a walk uses, and the names of the points of its routes.

use interfaces::emove::{EmoveCommand, EmoveVerb};
use taskdata::{
    files::{Location, MovtabId, PathId, PathPoint, Target},
    load::At,
};

use crate::{
    plan::{Datum, Entry, Phase},
    walk::Walk,
};

pub(crate) struct Point {
    pub part: &'static str,
    pub name: String,
    pub at: Option<At>,
    pub datum: Option<Datum>,
}

impl Point {
    pub const fn new(part: &'static str, name: String) -> Self {
        Self { part, name, at: None, datum: None }
    }
}

impl Walk<'_> {
    pub(crate) fn points(
        &self,
        depart: PathId,
        between: PathId,
        approach: PathId,
        end: Option<Datum>,
    ) -> Vec<Point> {
        let mut points = Vec::new();
        for (part, path) in [("depart", depart), ("trajectory", between), ("approach", approach)] {
            let first = path.of(self.data.paths).and_then(|p| usize::try_from(p.first).ok()).unwrap_or(0);
            for (i, point) in self.data.path(path).iter().enumerate() {
                if point.target != Target::Stop {
                    let at = self.store.origins().path_points.get(first + i).copied();
                    let datum = self.datum(point.target);
                    points.push(Point { at, datum, ..Point::new(part, self.point_name(point)) });
                }
            }
        }
        let stop = self.data.path(approach).last().filter(|point| point.target == Target::Stop);
        let at = stop.and_then(|_| {
            let path = approach.of(self.data.paths)?;
            let last = path.first.checked_add(path.count)?.checked_sub(1)?;
            self.store.origins().path_points.get(usize::try_from(last).ok()?).copied()
        });
        let name = if stop.is_some() { "stop" } else { "goal" }.to_owned();
        points.push(Point { at, datum: end, ..Point::new("goal", name) });
        points
    }

    pub(crate) fn datum(&self, target: Target) -> Option<Datum> {
        let (data, origins) = (&self.data, self.store.origins());
        let (name, at) = match target {
            Target::Movetable(id) => {
                (id.of(data.movetables)?.name.to_string(), origins.movetables.get(id.index()?))
            }
            Target::Pose(id) => (data.pose(id)?.name.to_string(), origins.poses.get(id.index()?)),
            Target::LocationPoint(id) => (data.locpt(id)?.name.to_string(), origins.locpts.get(id.index()?)),
            Target::Stop => return None,
        };
        Some(Datum { name, at: *at? })
    }

    /// The datum of the end: the movetable of the grip there, or else the pose of the location.
    pub(crate) fn end_datum(&self, command: &EmoveCommand) -> Option<Datum> {
        let data = &self.data;
        let place = command.site.place();
        let grip = command.object.and_then(|object| data.grip_movetable(&object, command.grip, &place));
        match grip.filter(|_| command.command != EmoveVerb::MovToVu) {
            Some(movetable) => self.datum(Target::Movetable(movetable)),
            None => self.datum(Target::Pose(data.locpt(place.locpt)?.pose)),
        }
    }

    pub(crate) fn point_name(&self, point: &PathPoint) -> String {
        let data = &self.data;
        match point.target {
            Target::Movetable(id) => id.of(data.movetables).map_or("...".to_owned(), |m| m.name.to_string()),
            Target::Pose(id) => data.pose(id).map_or(String::new(), |p| p.name.to_string()),
            Target::LocationPoint(id) => data.locpt(id).map_or(String::new(), |l| l.name.to_string()),
            Target::Stop => "stop".to_owned(),
        }
    }

    pub(crate) fn entry(
        &self,
        phase: &mut Phase,
        what: &'static str,
        origins: &[At],
        position: Option<usize>,
    ) {
        if let Some(at) = position.and_then(|i| origins.get(i)) {
            phase.entries.push(Entry { what, at: self.store.place(*at) });
            phase.used.push(*at);
        }
    }

    pub(crate) fn location_use(&self, phase: &mut Phase, location: &Location) {
        let (origins, place) = (self.store.origins(), location.place);
        let point = self.data.locpt(place.locpt);
        let records = [
            place.locpt.index().and_then(|index| origins.locpts.get(index)),
            place.array.index().and_then(|index| origins.arrays.get(index)),
            point.and_then(|point| origins.poses.get(point.pose.index()?)),
        ];
        phase.used.extend(records.into_iter().flatten());
    }

    pub(crate) fn use_object(&self, phase: &mut Phase, command: &EmoveCommand, location: &Location) {
        let (data, origins, place) = (&self.data, self.store.origins(), &location.place);
        let Some(object) = &command.object else { return };
        let named = |id: MovtabId| id.index().and_then(|index| origins.movetables.get(index));
        let vision = data.view(object, place).filter(|(_, view)| view.enabled);
        let record = data.object_named(object);
        let assigned = data.obj_locs.iter().zip(&origins.obj_locs);
        let grips = data.obj_grips.iter().zip(&origins.obj_grips);
        phase.used.extend(
            [
                data.object(object, command.grip).and_then(|(id, _)| origins.end_effs.get(id.index()?)),
                data.grip_loc(object, command.grip, place).and_then(|id| origins.grip_locs.get(id.index()?)),
                data.grip_movetable(object, command.grip, place).and_then(named),
                vision.and_then(|(id, _)| origins.visions.get(id.index()?)),
                vision.and_then(|(_, view)| named(view.movetable)),
            ]
            .into_iter()
            .flatten()
            .chain(assigned.filter(|(entry, _)| Some(entry.object) == record).map(|(_, at)| at))
            .chain(grips.filter(|(entry, _)| Some(entry.object) == record).map(|(_, at)| at)),
        );
    }

    pub(crate) fn location_entries(&self, phase: &mut Phase, location: &Location) {
        let origins = self.store.origins();
        let place = location.place;
        self.entry(phase, "location", &origins.locpts, place.locpt.index());
        self.entry(phase, "array", &origins.arrays, place.array.index());
        let pose = self.data.locpt(place.locpt).and_then(|point| point.pose.index());
        self.entry(phase, "pose", &origins.poses, pose);
    }

    pub(crate) fn path_entries(
        &self,
        phase: &mut Phase,
        command: &EmoveCommand,
        depart: PathId,
        between: PathId,
        approach: PathId,
    ) {
        let (data, origins) = (&self.data, self.store.origins());
        let place = command.site.place();
        match command.command {
            EmoveVerb::MovToVu => {
                let view = command
                    .object
                    .and_then(|object| data.view(&object, &place))
                    .and_then(|(id, _)| id.index());
                self.entry(phase, "view", &origins.visions, view);
            }
            EmoveVerb::MovToLoc => {}
            _ => {
                let object = command.object.as_ref();
                let grip = object.and_then(|object| data.grip_loc(object, command.grip, &place));
                self.entry(phase, "grip", &origins.grip_locs, grip.and_then(|id| id.index()));
                let sizes = object
                    .and_then(|object| data.object(object, command.grip))
                    .and_then(|(id, _)| id.index());
                self.entry(phase, "sizes", &origins.end_effs, sizes);
            }
        }
        let directed = |path: PathId| data.appr_depts.iter().position(|r| !path.is_null() && r.path == path);
        self.entry(phase, "depart", &origins.appr_depts, directed(depart));
        let flown = data.trajectories.iter().position(|r| !between.is_null() && r.path == between);
        self.entry(phase, "trajectory", &origins.trajectories, flown);
        self.entry(phase, "approach", &origins.appr_depts, directed(approach));
    }
}
