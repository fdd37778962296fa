//! Checks that the arm reaches every target of a command: reach, joint limits, angle from vertical.
//!
//! Targets are location points, objects in their sectors with each grip, views, and the points of approaches, departs,
//! trajectories and relative moves there. If neither a derived target nor its base pose can be reached, the error
//! names the pose, the cause.
//!
//! Within 2 degrees of vertical there is a warning: the Euler angles of the link are singular (VIII introduction).
//! Corners of trays are vertical, but not checked, because the robot does not move to them (VIII.3).
//!
//! The wild card `$$$` is tried at the locations to which the object is assigned (VII.7.3).

use std::collections::{HashMap, HashSet};

use diagnostics::{At, Problems};
use geometry::frame::Frame;
use rcs_core::name::Name10;

use crate::files::{
    Direction, Location, LocptId, MovtabId, OwnerId, PathId, PathPoint, PoseId, RefType, Reference,
    RelativeMove, Target, TaskData, TrajId,
};

use super::{
    super::{
        guarded::{Beginning, relative_move_named},
        parallel,
    },
    Findings, Origins,
    arm::{fault, from_vertical, is_vertical},
    at_point, locations, locations_of, origin, shown,
};

const ENTRIES_AT_A_TIME: usize = 512; // tried by one processor at a time

/// Tries all targets. The data must be linked without error.
pub(crate) fn check(data: &TaskData<'_>, origins: &Origins, problems: &mut Problems) {
    let mut findings = Findings::default();
    let reach = Reach::new(data, origins, &mut findings);
    for list in [
        spread(data.trajectories.len(), |i, f| reach.trajectory(i, f)),
        spread(data.grip_locs.len(), |i, f| reach.grip(i, f)),
        spread(data.visions.len(), |i, f| reach.view(i, f)),
        spread(data.appr_depts.len(), |i, f| reach.plain(i, f)),
        spread(data.relative_moves.len(), |i, f| reach.relative(i, f)),
    ] {
        findings.merge(list);
    }
    findings.report(problems);
}

/// Tries entries `0..count` on all processors; findings are in the order of the entries.
fn spread(count: usize, entry: impl Fn(usize, &mut Findings) + Sync) -> Findings {
    let mut findings = Findings::default();
    for piece in parallel::map_pieces(count, ENTRIES_AT_A_TIME, |range| {
        let mut findings = Findings::default();
        range.for_each(|i| entry(i, &mut findings));
        findings
    }) {
        findings.merge(piece);
    }
    findings
}

type What<'a> = &'a dyn Fn() -> String; // called only for a target with a problem

struct Reach<'a> {
    data: &'a TaskData<'a>,
    origins: &'a Origins,
    bad_points: HashSet<LocptId>, // points out of reach: targets derived from them are not reported again
    relative_starts: HashMap<(u8, u32), Vec<TrajId>>, // trajectories that begin with a movetable, by start
}

impl<'a> Reach<'a> {
    fn new(data: &'a TaskData<'a>, origins: &'a Origins, findings: &mut Findings) -> Self {
        let mut relative_starts: HashMap<(u8, u32), Vec<TrajId>> = HashMap::new();
        for (i, trajectory) in data.trajectories.iter().enumerate() {
            let first = data.path(trajectory.path).first();
            if first.is_some_and(|point| matches!(point.target, Target::Movetable(_))) {
                let start = (trajectory.start.kind.code(), trajectory.start.number);
                relative_starts.entry(start).or_default().push(TrajId::at(i));
            }
        }
        let mut reach = Self { data, origins, bad_points: HashSet::new(), relative_starts };
        reach.location_points(findings);
        reach
    }

    fn corners(&self) -> HashSet<LocptId> {
        let owners = (0..self.data.owners.len()).map(|i| self.data.members_of(OwnerId::at(i)));
        let of_arrays = owners.filter(|members| members.iter().any(|m| m.member.kind == RefType::Array));
        of_arrays.filter_map(|members| members.first()).map(|m| LocptId::new(m.member.number)).collect()
    }

    /// Points at which objects are gripped or viewed: the robot moves to the object, which may be tilted.
    fn bases(&self) -> HashSet<LocptId> {
        let grips = self.data.grip_locs.iter().map(|entry| entry.at);
        let named = grips.chain(self.data.visions.iter().map(|entry| entry.at));
        named.filter(|at| at.kind == RefType::LocationPoint).map(|at| LocptId::new(at.number)).collect()
    }

    fn location_points(&mut self, findings: &mut Findings) {
        let (corners, bases) = (self.corners(), self.bases());
        let points = self.data.locpts;
        let tried = parallel::map_pieces(points.len(), ENTRIES_AT_A_TIME, |range| {
            let (mut findings, mut bad) = (Findings::default(), Vec::new());
            for i in range.filter(|i| !corners.contains(&LocptId::at(*i))) {
                let Some(point) = points.get(i) else { continue };
                let at = origin(&self.origins.locpts, i);
                let what = || format!("location point {}", point.name);
                if !self.reached(&what, &point.frame, at, point.pose, &mut findings) {
                    bad.push(LocptId::at(i));
                } else if !bases.contains(&LocptId::at(i)) {
                    vertical(&what, &point.frame, at, &mut findings);
                }
            }
            (findings, bad)
        });
        for (piece, bad) in tried {
            findings.merge(piece);
            self.bad_points.extend(bad);
        }
    }

    /// True if the target can be reached. Warns near the vertical.
    fn target(&self, what: What<'_>, frame: &Frame, at: At, base: PoseId, findings: &mut Findings) -> bool {
        let reached = self.reached(what, frame, at, base, findings);
        if reached {
            vertical(what, frame, at, findings);
        }
        reached
    }

    fn reached(&self, what: What<'_>, frame: &Frame, at: At, base: PoseId, findings: &mut Findings) -> bool {
        let Some(found) = fault(frame) else { return true };
        match self.data.pose(base).and_then(|pose| Some((pose.name, fault(&pose.frame)?))) {
            Some((name, cause)) => {
                let at = origin(&self.origins.poses, base.index().unwrap_or(0));
                findings.error_once(cause.code, at, format!("pose {name}: {}", cause.message), cause.help);
            }
            None => findings.error(found.code, at, format!("{}: {}", what(), found.message), found.help),
        }
        false
    }

    fn base_of(&self, location: &Location) -> PoseId {
        self.data
            .locpt(location.place.locpt)
            .map(|point| point.pose)
            .or_else(|| self.data.array(location.place.array).map(|array| array.pose))
            .unwrap_or(PoseId::NULL)
    }

    /// Tries the location points at which a trajectory can begin; [`Reach::departures`] tries the objects there.
    fn trajectory(&self, i: usize, findings: &mut Findings) {
        let Some(record) = self.data.trajectories.get(i) else { return };
        let what = || format!("trajectory {}", record.name);
        let starts = locations(self.data, record.start);
        let mut points = starts.iter().filter(|start| start.sector.is_none());
        match points.next() {
            Some(start) => {
                self.follow(record.path, &start.frame, &what, false, findings);
                // For the other starts, only points relative to the start differ.
                if self.relative_starts.contains_key(&(record.start.kind.code(), record.start.number)) {
                    points.for_each(|start| self.follow(record.path, &start.frame, &what, false, findings));
                }
            }
            None => {
                if let Some(start) = starts.first() {
                    self.follow(record.path, &start.frame, &what, false, findings);
                }
            }
        }
    }

    /// Tries the points of a path. Movetables refer to `reference` if `fixed`, otherwise to the previous point.
    fn follow(&self, path: PathId, reference: &Frame, what: What<'_>, fixed: bool, findings: &mut Findings) {
        let data = self.data;
        let first = path.of(data.paths).map_or(0, |p| usize::try_from(p.first).unwrap_or(0));
        let upright = || is_vertical(reference);
        let mut before = *reference;
        for (i, point) in data.path(path).iter().enumerate() {
            let base = if fixed { reference } else { &before };
            let Some(frame) = data.point_frame(point, base) else { continue };
            let at = origin(&self.origins.path_points, first + i);
            let what = || format!("{}, {}", what(), self.point_name(point));
            match point.target {
                // A vertical reference already has a warning.
                Target::Movetable(_) if upright() => {
                    if let Some(fault) = fault(&frame) {
                        findings.error(fault.code, at, format!("{}: {}", what(), fault.message), fault.help);
                    }
                }
                Target::Movetable(_) => {
                    self.target(&what, &frame, at, PoseId::NULL, findings);
                }
                Target::Pose(id) => {
                    self.target(&what, &frame, at, id, findings);
                }
                // The check of the location points covers the reach. The robot moves to this point even if it is a
                // corner.
                Target::LocationPoint(_) => vertical(&what, &frame, at, findings),
                Target::Stop => {}
            }
            before = frame;
        }
    }

    fn point_name(&self, point: &PathPoint) -> String {
        match point.target {
            Target::Movetable(id) => {
                id.of(self.data.movetables).map_or("...".to_owned(), |m| m.name.to_string())
            }
            Target::Pose(id) => self.data.pose(id).map_or(String::new(), |p| p.name.to_string()),
            Target::LocationPoint(id) => self.data.locpt(id).map_or(String::new(), |l| l.name.to_string()),
            Target::Stop => "stop".to_owned(),
        }
    }

    fn good(&self, locations: Vec<Location>) -> impl Iterator<Item = Location> {
        locations.into_iter().filter(|location| !self.bad_points.contains(&location.place.locpt))
    }

    fn grip(&self, i: usize, findings: &mut Findings) {
        let data = self.data;
        let Some(record) = data.grip_locs.get(i) else { return };
        let at = origin(&self.origins.grip_locs, i);
        let object = data.object_name(record.object);
        for location in self.good(locations_of(data, record.object, record.at)) {
            // A more exact entry may apply here.
            if data.grip_loc(&object, record.grip, &location.place).and_then(|id| id.index()) != Some(i) {
                continue;
            }
            let what = || format!("grip {} of {object} at {}", record.grip, shown(&location));
            let frame = data.moved(&location.frame, record.movetable);
            if !self.target(&what, &frame, at, self.base_of(&location), findings) {
                continue;
            }
            for (word, path) in [
                ("approach of", data.approach(&object, record.grip, &location.place)),
                ("depart of", data.depart(&object, record.grip, &location.place)),
            ] {
                self.follow(
                    path.unwrap_or_default(),
                    &frame,
                    &|| format!("{word} {}", what()),
                    true,
                    findings,
                );
            }
            self.departures(&location, &frame, &what, findings);
        }
    }

    fn departures(&self, location: &Location, frame: &Frame, what: What<'_>, findings: &mut Findings) {
        if self.relative_starts.is_empty() {
            return;
        }
        for alias in self.data.aliases(&location.place) {
            for id in self.relative_starts.get(&(alias.kind.code(), alias.number)).into_iter().flatten() {
                if let Some(record) = id.of(self.data.trajectories) {
                    let what = || format!("trajectory {} from {}", record.name, what());
                    self.follow(record.path, frame, &what, false, findings);
                }
            }
        }
    }

    /// Tries a view at all valid locations, with approach and depart. A view relative to an object has no frame yet.
    fn view(&self, i: usize, findings: &mut Findings) {
        let data = self.data;
        let Some(record) = data.visions.get(i).filter(|r| r.offset_from != RefType::Object) else { return };
        let at = origin(&self.origins.visions, i);
        let object = data.object_name(record.object);
        for location in self.good(locations_of(data, record.object, record.at)) {
            // A more exact entry may apply here.
            if data.view(&object, &location.place).and_then(|(id, _)| id.index()) != Some(i) {
                continue;
            }
            let what = || format!("view of {object} at {}", shown(&location));
            let frame = data.moved(&location.frame, record.movetable);
            if !self.target(&what, &frame, at, self.base_of(&location), findings) {
                continue;
            }
            for (word, path) in [
                ("approach of", data.view_approach(&object, record.grip, &location.place)),
                ("depart of", data.view_depart(&object, record.grip, &location.place)),
            ] {
                self.follow(
                    path.unwrap_or_default(),
                    &frame,
                    &|| format!("{word} {}", what()),
                    true,
                    findings,
                );
            }
        }
    }

    /// Tries an approach or depart of a location itself. The wild card is tried at all location points.
    fn plain(&self, i: usize, findings: &mut Findings) {
        let data = self.data;
        let Some(record) = data.appr_depts.get(i) else { return };
        if matches!(record.subject.kind, RefType::Object | RefType::View) {
            return;
        }
        let points = if record.at == Reference::ANY {
            let all = 0..data.locpts.len();
            all.filter_map(|n| at_point(data, Reference::location_point(LocptId::at(n)))).collect()
        } else {
            locations(data, record.at)
        };
        for location in self.good(points) {
            let (word, path) = match record.direction {
                Direction::Approach => ("approach", data.approach_location(&location.place)),
                Direction::Depart => ("depart", data.depart_location(&location.place)),
            };
            // The approach to an unreachable corner is not checked, because it is not a target.
            if path == Some(record.path) && fault(&location.frame).is_none() {
                let what = || format!("{word} of {}", shown(&location));
                self.follow(record.path, &location.frame, &what, true, findings);
            }
        }
    }

    fn relative(&self, i: usize, findings: &mut Findings) {
        let data = self.data;
        let Some(record) = data.relative_moves.get(i) else { return };
        let at = origin(&self.origins.relative_moves, i);
        for location in self.good(locations(data, record.at)) {
            if !data.relative_move(&record.name, &location.place).is_some_and(|r| std::ptr::eq(r, record)) {
                continue;
            }
            let frame = data.moved(&self.beginning(record, &location), record.movetable);
            let what = || format!("relative move {} at {}", record.name, shown(&location));
            self.target(&what, &frame, at, self.base_of(&location), findings);
        }
    }

    /// The start of a relative move: the location, or the end of the moves before.
    fn beginning(&self, record: &RelativeMove, location: &Location) -> Frame {
        let mut before: Vec<MovtabId> = Vec::new();
        let mut name = record.name;
        while let Some(Beginning::After(earlier)) = relative_move_named(name.as_str()).map(|m| m.from) {
            name = Name10::clipped(earlier);
            before.extend(self.data.relative_move(&name, &location.place).map(|r| r.movetable));
        }
        before.into_iter().rev().fold(location.frame, |frame, step| self.data.moved(&frame, step))
    }
}

fn vertical(what: What<'_>, frame: &Frame, at: At, findings: &mut Findings) {
    if is_vertical(frame) {
        let degrees = from_vertical(frame);
        let help = "tilt the gripper by 3 degrees or more, as LK-GRP-1 does (VIII.9.5)".to_owned();
        let message = format!("{}: the gripper is {degrees:.1} degrees from vertical", what());
        findings.warning("vertical", at, message, help);
    }
}
