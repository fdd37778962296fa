//! Poses, movetables, location points, arrays, owners, trajectories and their points (VII.1 to VII.6).

use diagnostics::nearest;
use geometry::{frame::Frame, movetable::Movetable, pose::Pose};
use rcs_core::name::Name;

use crate::files::{
    Array, ArrayId, LocptId, Member, MovtabId, MovtabRecord, Owner, OwnerId, Path, PathId, PathPoint, PoseId,
    PoseRecord, RefType, Reference, Target, Traj, TrajPara, TrajParaId, data::NULL_NAME, index::name_key,
};

use super::{
    super::{
        collected::Collected,
        entries::{Named, OwnerEntry, PointEntry, PoseEntry, Typed},
        parallel,
    },
    Keyed, Linker, number,
};

impl Linker<'_> {
    pub(super) fn places(&mut self, all: &Collected) {
        for entry in &all.movetables {
            let movetable = Movetable::from_lines(&entry.lines).unwrap_or_default();
            self.files.movetables.push(MovtabRecord { name: entry.name.name, movetable });
        }
        for entry in &all.poses {
            let record = self.pose_record(entry);
            self.files.poses.push(record);
            self.origins.poses.push(entry.at);
        }
        let known = self.known();
        let linked = parallel::map_each(&all.locpts, |entry| known.locpt(entry));
        for (entry, linked) in all.locpts.iter().zip(linked) {
            let record = linked.unwrap_or_else(|| {
                let (pose, movetable) = (self.pose(entry.pose), self.movetable(entry.movetable));
                self.known().locpt_at(entry, pose.unwrap_or_default(), movetable.unwrap_or_default())
            });
            self.files.locpts.push(record);
        }
        self.arrays(all);
        for (i, entry) in all.owners.iter().enumerate() {
            self.owner(OwnerId::at(i), entry);
        }
        for entry in &all.trajectories {
            // An unknown end is reported; its record is kept, because the name index counts it.
            let start = self.reference(entry.start).unwrap_or(Reference::NONE);
            let end = self.reference(entry.end).unwrap_or(Reference::NONE);
            let path = self.path(&entry.points);
            self.files.trajectories.push(Traj { name: entry.name.name, start, end, path });
            self.origins.trajectories.push(entry.start.name.at.to(entry.end.name.at));
        }
    }

    /// Corrects points that are not orthogonal.
    fn pose_record(&mut self, entry: &PoseEntry) -> PoseRecord {
        let [wrist, tool, finger] = entry.points;
        let pose = Pose { wrist, tool, finger };
        let movetable = self.movetable(entry.movetable).unwrap_or_default();
        let base = match (pose.to_frame(), pose.off_square()) {
            (Ok(frame), Ok(off)) => {
                self.squareness(entry, off.to_degrees().abs());
                frame
            }
            (Err(error), _) | (_, Err(error)) => {
                self.problems.error("pose.points", entry.at, format!("{}: {error}", entry.name.name));
                Frame::identity()
            }
        };
        PoseRecord { name: entry.name.name, pose, movetable, frame: self.moved(&base, movetable) }
    }

    fn squareness(&mut self, entry: &PoseEntry, degrees: f64) {
        const WARN: f64 = 0.1;
        const REFUSE: f64 = 2.0;
        let message = format!("{} is {degrees:.2} degrees off square", entry.name.name);
        if degrees > REFUSE {
            let help = format!(
                "the finger point must be square to the axis within {REFUSE} degrees: record the pose again"
            );
            self.problems.error_help("pose.square", entry.at, message, help);
        } else if degrees > WARN {
            let help = "it is made square, with the axis from wrist to tool point kept".to_owned();
            self.problems.warning("pose.square", entry.at, message, Some(help));
        }
    }

    /// Combines dimension form and location form (VII.4).
    fn arrays(&mut self, all: &Collected) {
        let names = all.arrays_at.iter().map(|e| &e.name);
        let [(located, _)] = self.indexed([Keyed::names("an array location of this name", names)]);
        let mut unknown = Vec::new();
        for entry in &all.arrays_at {
            if self.find("array", entry.name, |i| &i.arrays).is_none() {
                unknown.push(entry.name.name.as_str());
            }
        }
        for entry in &all.arrays {
            let place = located
                .view()
                .find(name_key(&entry.name.name))
                .and_then(|n| ArrayId::new(n).of(&all.arrays_at));
            let (mut pose, mut offset) = (PoseId::NULL, MovtabId::NULL);
            match place {
                Some(place) => {
                    if place.pose.name.as_str() != NULL_NAME {
                        pose = self.pose(place.pose).unwrap_or_default();
                    }
                    offset = self.movetable(place.movetable).unwrap_or_default();
                }
                // A misspelt name is reported as such.
                None if nearest(entry.name.name.as_str(), unknown.iter().copied()).is_some() => {}
                None if self.has_elsewhere(entry.name.name.as_str()) => {}
                None => self.problems.error_help(
                    "array.location",
                    entry.name.at,
                    format!("the array {} has no location", entry.name.name),
                    "an array needs an array location form too (-ar-, VII.4)",
                ),
            }
            let column_step = self.movetable(entry.column_step).unwrap_or_default();
            let row_step = entry.row_step.and_then(|step| self.movetable(step)).unwrap_or_default();
            self.files.arrays.push(Array {
                name: entry.name.name,
                dimensions: entry.dimensions,
                columns: entry.columns,
                rows: entry.rows,
                column_step,
                row_step,
                present: entry.present,
                pose,
                offset,
            });
            if self.indexes.locpts.view().find(name_key(&entry.name.name)).is_some() {
                let message = format!("{} is a location point too", entry.name.name);
                self.problems.error("name.both", entry.name.at, message);
            }
        }
    }

    fn owner(&mut self, id: OwnerId, entry: &OwnerEntry) {
        let first = number(self.files.members.len());
        for member in &entry.members {
            if let Some(reference) = self.reference(*member) {
                self.files.members.push(Member { owner: id, member: reference });
                self.origins.members.push(member.name.at);
            }
        }
        let of_arrays = entry.members.iter().any(|m| m.kind == RefType::Array);
        if let (true, Some(member)) = (of_arrays, entry.members.first())
            && member.kind != RefType::LocationPoint
        {
            self.problems.error_help(
                "owner.first",
                member.name.at,
                format!("the first member of {} is not a location point", entry.name.name),
                "the first member of an owner of arrays is the location point at which they are used (VII.5)",
            );
        }
        let count = number(self.files.members.len()).saturating_sub(first);
        self.files.owners.push(Owner { name: entry.name.name, first, count });
    }

    /// Equal parameters share a record.
    pub(super) fn path(&mut self, entries: &[PointEntry]) -> PathId {
        let first = number(self.files.path_points.len());
        for entry in entries {
            let target = match entry.target {
                None => Some(Target::Stop),
                Some(typed) => self.target(typed),
            };
            if let Some(target) = target {
                let para = self.para(entry.para);
                self.files.path_points.push(PathPoint { para, target });
                self.origins.path_points.push(entry.at);
            }
        }
        let count = number(self.files.path_points.len()).saturating_sub(first);
        self.files.paths.push(Path { first, count });
        PathId::new(number(self.files.paths.len()))
    }

    fn target(&mut self, typed: Typed) -> Option<Target> {
        let name = Named { name: Name::clipped(typed.name.name.as_str()), at: typed.name.at };
        match typed.kind {
            RefType::Pose => self.pose(name).map(Target::Pose),
            RefType::LocationPoint => self
                .find("location point", name, |i| &i.locpts)
                .map(|n| Target::LocationPoint(LocptId::new(n))),
            RefType::Movetable => self.movetable(name).map(Target::Movetable),
            _ => None,
        }
    }

    /// Equal parameters share a record.
    pub(super) fn para(&mut self, para: TrajPara) -> TrajParaId {
        let next = TrajParaId::at(self.files.traj_paras.len());
        let id = *self.paras.entry([para.acc_fac, para.vel_max, para.smooth, para.brk_dst]).or_insert(next);
        if id == next {
            self.files.traj_paras.push(para);
        }
        id
    }
}
