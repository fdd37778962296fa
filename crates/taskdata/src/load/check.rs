//! Geometry: every place the data can send the robot to must be within its reach and its joint limits.
//!
//! A pose far from where it was meant is found here, before the first tick, and not by the arm. What is checked: poses,
//! location points, every sector that an object can lie in, every grip there, and the view, approach and depart points of
//! that grip. Trajectory points are poses or location points and so are checked with these; those that are movetables are
//! followed from their start.
//!
//! The gripper axis within 2 degrees of vertical is warned of: the Euler angles of the link are singular there (VIII
//! introduction). Base poses and tray corners, which are taught vertical and not driven to, are left out (VIII.3).

use std::collections::{HashMap, HashSet};

use rcs_core::{
    frame::Frame,
    interface::subtask::LocationKind,
    kinematics::{HOME_JOINTS, JOINT_NAMES, T3},
};

use crate::files::{
    ArrayId, Location, LocptId, ObjectId, OwnerId, PathId, PathPoint, Place, PoseId, RefType, Reference,
    Target, TaskData, Traj,
};

use super::{
    origins::Origins,
    report::{Problems, Severity},
    source::At,
};

/// Nearer to vertical than this is warned of, degrees.
const VERTICAL: f64 = 2.0;

/// Check all frames; the data must be linked without error.
pub(super) fn check(data: &TaskData<'_>, origins: &Origins, problems: &mut Problems) {
    let mut checker = Checker {
        data,
        origins,
        findings: Vec::new(),
        known: HashMap::new(),
        bad_poses: HashSet::new(),
        bad_points: HashSet::new(),
    };
    checker.poses();
    checker.location_points();
    checker.trajectories();
    checker.grips();
    checker.views();
    for finding in checker.findings {
        let mut help = finding.help;
        if finding.more > 0 {
            let places = if finding.more == 1 { "place" } else { "places" };
            help = format!("{help}; the same at {} more {places}", finding.more);
        }
        problems.push(finding.severity, finding.code, finding.at, finding.message, Some(help));
    }
}

/// What is wrong with an entry at the first place where it is wrong, and at how many more.
struct Finding {
    severity: Severity,
    code: &'static str,
    at: At,
    message: String,
    help: String,
    more: usize,
}

struct Checker<'a> {
    data: &'a TaskData<'a>,
    origins: &'a Origins,
    findings: Vec<Finding>,
    /// Position in `findings` by source, first byte and code: an entry with the wild card can be wrong at every sector.
    known: HashMap<(u32, u32, &'static str), usize>,
    /// Poses and location points out of reach: what is derived from them is not complained of again.
    bad_poses: HashSet<PoseId>,
    bad_points: HashSet<LocptId>,
}

/// The origin of a record at a position.
fn origin(list: &[At], position: usize) -> At {
    list.get(position).copied().unwrap_or_default()
}

/// Degrees of the gripper axis from vertical, up or down.
fn from_vertical(frame: &Frame) -> f64 {
    let axis = frame.x();
    axis.x.hypot(axis.y).atan2(axis.z.abs()).to_degrees()
}

impl Checker<'_> {
    fn note(&mut self, severity: Severity, code: &'static str, at: At, message: String, help: String) {
        let next = self.findings.len();
        let position = *self.known.entry((at.source, at.start, code)).or_insert(next);
        match self.findings.get_mut(position) {
            Some(finding) => finding.more += 1,
            None => self.findings.push(Finding { severity, code, at, message, help, more: 0 }),
        }
    }

    /// Note a frame that the arm cannot take; true if it can.
    fn reach(&mut self, what: &str, frame: &Frame, at: At) -> bool {
        let joints = match T3.inverse(frame, &HOME_JOINTS) {
            Ok(joints) => T3.within_limits(&joints),
            Err(error) => {
                let p = frame.position;
                let help = format!("its tool point is at ({:.2}, {:.2}, {:.2}) in", p.x, p.y, p.z);
                self.note(Severity::Error, "reach", at, format!("{what}: {error}"), help);
                return false;
            }
        };
        let margin = T3.margin(&joints);
        if margin.radians >= 0.0 {
            return true;
        }
        let name = JOINT_NAMES.get(margin.joint).copied().unwrap_or("joint");
        let angle = joints.get(margin.joint).copied().unwrap_or_default().to_degrees();
        let (low, high) = T3.limits.get(margin.joint).copied().unwrap_or_default();
        let message = format!(
            "{what}: {name} at {angle:.1} degrees, {:.1} beyond its limit",
            -margin.radians.to_degrees()
        );
        let help =
            format!("the limits of {name} are {:.0} and {:.0} degrees", low.to_degrees(), high.to_degrees());
        self.note(Severity::Error, "limit", at, message, help);
        false
    }

    /// Like [`Self::reach`], and a warning near the vertical.
    fn target(&mut self, what: &str, frame: &Frame, at: At) -> bool {
        let reached = self.reach(what, frame, at);
        if reached {
            self.vertical(what, frame, at);
        }
        reached
    }

    fn vertical(&mut self, what: &str, frame: &Frame, at: At) {
        let degrees = from_vertical(frame);
        if degrees < VERTICAL {
            let help = "tilt the gripper by 3 degrees or more, as LK-GRP-1 does (VIII.9.5)".to_owned();
            let message = format!("{what}: the gripper is {degrees:.1} degrees from vertical");
            self.note(Severity::Warning, "vertical", at, message, help);
        }
    }

    fn poses(&mut self) {
        for (i, pose) in self.data.poses.iter().enumerate() {
            if !self.reach(&format!("pose {}", pose.name), &pose.frame, origin(&self.origins.poses, i)) {
                self.bad_poses.insert(PoseId::at(i));
            }
        }
    }

    /// Location points at which arrays are used.
    fn corners(&self) -> HashSet<LocptId> {
        let owners = (0..self.data.owners.len()).map(|i| self.data.members_of(OwnerId::at(i)));
        let of_arrays = owners.filter(|members| members.iter().any(|m| m.member.kind == RefType::Array));
        of_arrays.filter_map(|members| members.first()).map(|m| LocptId::new(m.member.number)).collect()
    }

    fn location_points(&mut self) {
        let corners = self.corners();
        for (i, point) in self.data.locpts.iter().enumerate() {
            let at = origin(&self.origins.locpts, i);
            let what = format!("location point {}", point.name);
            // The corner of a tray is a base for its sectors (VIII.3).
            let corner = corners.contains(&LocptId::at(i));
            let good = !self.bad_poses.contains(&point.pose)
                && if corner {
                    self.reach(&what, &point.frame, at)
                } else {
                    self.target(&what, &point.frame, at)
                };
            if !good {
                self.bad_points.insert(LocptId::at(i));
            }
        }
    }

    /// Points of trajectories that are movetables are applied to the point before them.
    fn trajectories(&mut self) {
        let data = self.data;
        for traj in data.trajectories {
            let starts = self.start_frames(traj);
            for start in starts {
                self.follow(traj.path, &start, &format!("trajectory {}", traj.name), false);
            }
        }
    }

    /// Where a trajectory can begin: its location point, or those of its owner.
    fn start_frames(&self, traj: &Traj) -> Vec<Frame> {
        let frame = |r: Reference| {
            (r.kind == RefType::LocationPoint)
                .then(|| self.data.locpt(LocptId::new(r.number)).map(|l| l.frame))
                .flatten()
        };
        match traj.start.kind {
            RefType::Owner => {
                let members = self.data.members_of(OwnerId::new(traj.start.number));
                members.iter().filter_map(|m| frame(m.member)).collect()
            }
            _ => frame(traj.start).into_iter().collect(),
        }
    }

    /// Check the points of a path; `fixed` if all its movetables refer to `reference`, else each to the point before it.
    fn follow(&mut self, path: PathId, reference: &Frame, what: &str, fixed: bool) {
        let data = self.data;
        let first = path.of(data.paths).map_or(0, |p| usize::try_from(p.first).unwrap_or(0));
        let upright = from_vertical(reference) < VERTICAL;
        let mut before = *reference;
        for (i, point) in data.path(path).iter().enumerate() {
            let base = if fixed { reference } else { &before };
            let Some(frame) = data.point_frame(point, base) else { continue };
            let at = origin(&self.origins.path_points, first + i);
            let what = format!("{what}, {}", self.point_name(point));
            match point.target {
                // Where the reference is vertical and warned of, its points need no warning of their own.
                Target::Movetable(_) if upright => {
                    self.reach(&what, &frame, at);
                }
                Target::Movetable(_) => {
                    self.target(&what, &frame, at);
                }
                // Their reach was checked where they are defined; here they are driven to.
                Target::Pose(_) | Target::LocationPoint(_) => self.vertical(&what, &frame, at),
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

    /// The locations at which an object can be: the sectors that are assigned to it, at all owners, and the location points
    /// that a record names.
    fn locations(&self, object: ObjectId, at: Reference) -> Vec<Location> {
        let data = self.data;
        let mut found = Vec::new();
        for assigned in data.object_locations(object) {
            found.extend(self.at_point(assigned));
            for (i, _) in data.owners.iter().enumerate() {
                let owner = OwnerId::at(i);
                if assigned.kind == RefType::Array && data.is_member(owner, assigned) {
                    found.extend(self.at_owner(owner, assigned));
                }
            }
        }
        found.retain(|location| {
            at.kind == RefType::Any || data.aliases(&location.place).any(|alias| alias == at)
        });
        if found.is_empty() {
            match at.kind {
                RefType::LocationPoint => found.extend(self.at_point(at)),
                RefType::Owner => {
                    let members = data.members_of(OwnerId::new(at.number)).iter();
                    found.extend(members.filter_map(|m| self.at_point(m.member)));
                }
                _ => {}
            }
        }
        found.retain(|location| !self.bad_points.contains(&location.place.locpt));
        found
    }

    fn at_point(&self, at: Reference) -> Option<Location> {
        let id = LocptId::new(at.number);
        let point = self.data.locpt(id).filter(|_| at.kind == RefType::LocationPoint)?;
        Some(Location { name: point.name, place: self.data.place_of(id), sector: 0, frame: point.frame })
    }

    /// All sectors of an array at an owner, or the location point itself.
    fn at_owner(&self, owner: OwnerId, assigned: Reference) -> Vec<Location> {
        let data = self.data;
        if assigned.kind == RefType::LocationPoint {
            return self.at_point(assigned).into_iter().collect();
        }
        let array_id = ArrayId::new(assigned.number);
        let corner = data.members_of(owner).first().and_then(|m| self.at_point(m.member));
        let (Some(array), Some(corner)) = (data.array(array_id), corner) else { return Vec::new() };
        let place = Place { kind: LocationKind::Owner, array: array_id, ..corner.place };
        let sector = |n| {
            let frame = data.sector_frame(array, &corner.frame, n)?;
            Some(Location { name: corner.name, place, sector: n, frame })
        };
        (1..=array.sectors()).filter_map(sector).collect()
    }

    /// Each grip wherever it is valid, with its approach and depart.
    fn grips(&mut self) {
        let data = self.data;
        for (i, record) in data.grip_locs.iter().enumerate() {
            let at = origin(&self.origins.grip_locs, i);
            let object = data.object_name(record.object);
            for location in self.locations(record.object, record.at) {
                // A more exact entry may hold at this location.
                if data.grip_movetable(&object, record.grip, &location.place) != Some(record.movetable) {
                    continue;
                }
                let what = format!("grip {} of {object} at {}", record.grip, shown(&location));
                let frame = data.moved(&location.frame, record.movetable);
                if !self.target(&what, &frame, at) {
                    continue;
                }
                for (word, path) in [
                    ("approach of", data.approach(&object, record.grip, &location.place)),
                    ("depart of", data.depart(&object, record.grip, &location.place)),
                ] {
                    self.follow(path.unwrap_or_default(), &frame, &format!("{word} {what}"), true);
                }
            }
        }
    }

    /// Each view wherever it is valid, with its approach. A view that refers to the object has no frame before the
    /// object is found.
    fn views(&mut self) {
        let data = self.data;
        for (i, record) in data.visions.iter().enumerate() {
            if record.offset_from == RefType::Object {
                continue;
            }
            let at = origin(&self.origins.visions, i);
            let object = data.object_name(record.object);
            for location in self.locations(record.object, record.at) {
                // A more exact entry may hold at this location.
                if data.view(&object, &location.place).is_none_or(|(_, view)| view != record) {
                    continue;
                }
                let what = format!("view of {object} at {}", shown(&location));
                let frame = data.moved(&location.frame, record.movetable);
                if !self.target(&what, &frame, at) {
                    continue;
                }
                let path = data.view_approach(&object, record.grip, &location.place);
                self.follow(path.unwrap_or_default(), &frame, &format!("approach of {what}"), true);
            }
        }
    }
}

/// A location and its sector in words.
fn shown(location: &Location) -> String {
    if location.sector == 0 {
        location.name.to_string()
    } else {
        format!("{} sector {}", location.name, location.sector)
    }
}
