//! Trajectories that no command can use: another entry always has priority, or both ends are one location (VII.6).

use crate::files::{ArrayId, LocptId, OwnerId, Place, RefType, Reference, TaskData, TrajId};
use interfaces::location::LocationKind;

use super::{Findings, Origins, at_point, origin, owners_of};

const TRIED: usize = 64; // per end; one with more places is treated as reachable

pub(super) fn check(data: &TaskData<'_>, origins: &Origins, findings: &mut Findings) {
    for (i, trajectory) in data.trajectories.iter().enumerate() {
        let id = TrajId::at(i);
        let (starts, ends) = (places(data, trajectory.start), places(data, trajectory.end));
        if starts.len() >= TRIED || ends.len() >= TRIED {
            continue;
        }
        let at = origin(&origins.trajectories, i);
        let name = trajectory.name;
        let pairs = || starts.iter().flat_map(|from| ends.iter().map(move |to| (from, to)));
        if pairs().next().is_none() {
            findings.warning(
                "trajectory.unused",
                at,
                format!("no command can reach the trajectory {name}: nothing is at one of its ends"),
                "an array is a location through an owner or by a pose of its own (VII.4)".to_owned(),
            );
        } else if pairs().all(|(from, to)| from.has_location_of(to)) {
            findings.warning(
                "trajectory.unused",
                at,
                format!(
                    "no command can reach the trajectory {name}: it ends at the location where it starts"
                ),
                "within one location only depart and approach are followed".to_owned(),
            );
        } else if !pairs()
            .any(|(from, to)| !from.has_location_of(to) && data.trajectory_id(from, to) == Some(id))
        {
            findings.warning(
                "trajectory.unused",
                at,
                format!("no command can reach the trajectory {name}: others are found before it"),
                "the entry for the exact location points wins, then that of an array, then that of an owner"
                    .to_owned(),
            );
        }
    }
}

fn places(data: &TaskData<'_>, end: Reference) -> Vec<Place> {
    match end.kind {
        RefType::LocationPoint => at_point(data, end).map(|l| l.place).into_iter().collect(),
        RefType::Array => at_array(data, end),
        RefType::Owner => {
            let members = data.members_of(OwnerId::new(end.number)).iter().take(TRIED);
            let mut found: Vec<Place> = Vec::new();
            for member in members {
                match member.member.kind {
                    RefType::LocationPoint => found.extend(at_point(data, member.member).map(|l| l.place)),
                    RefType::Array => found.extend(at_array(data, member.member)),
                    // A pose means the location points at it.
                    RefType::Pose => {
                        let points = data.locpts.iter().enumerate();
                        let at_pose = points.filter(|(_, p)| p.pose.number() == member.member.number);
                        found.extend(at_pose.take(TRIED).map(|(i, _)| Place::point(LocptId::at(i))));
                    }
                    _ => {}
                }
            }
            found
        }
        _ => Vec::new(),
    }
}

fn at_array(data: &TaskData<'_>, array: Reference) -> Vec<Place> {
    let id = ArrayId::new(array.number);
    let corners = owners_of(data, array)
        .filter_map(|owner| data.members_of(owner).first())
        .filter_map(|member| at_point(data, member.member))
        .map(|corner| Place { kind: LocationKind::Owner, array: id, ..corner.place });
    let own = data.array(id).filter(|array| !array.pose.is_null()).map(|_| Place {
        kind: LocationKind::Array,
        locpt: LocptId::NULL,
        array: id,
    });
    corners.chain(own).take(TRIED).collect()
}
