//! Trays, nests, parts, boxes and contacts of a description.

use std::collections::BTreeMap;

use diagnostics::toml::{element, join};
use geometry::units::Length;
use rcs_core::name::Name16;

use super::Check;
use crate::description::{CellDescription, Kind, Nest, PartType, Pattern, Shape, commands, known};

/// Nests whose seats are within this distance are at the same place, in; it is less than the width of any part.
const SAME_PLACE: f64 = 0.1;

impl CellDescription {
    pub(super) fn check_trays(&self, check: &mut Check<'_>) {
        let shape = &self.tray_shape;
        check.within("placing_tolerance", self.placing_tolerance, 0.001, 5.0);
        check.positive(
            "tray_shape",
            &[
                ("inside", shape.inside),
                ("wall", shape.wall),
                ("rim", shape.rim),
                ("floor_thickness", shape.floor_thickness),
            ],
        );
        let inside_is_known = check.trusts("tray_shape.inside");
        if inside_is_known {
            check.within("tray_shape.random_offset", shape.random_offset, 0.0, shape.inside / 2.0);
        }
        for (number, tray) in self.tray.iter().enumerate() {
            let path = join(&element("tray", number), "sectors");
            check.that(!tray.sectors.is_empty(), &path, "at least one", || "none".into());
            let [x, y] = tray.centre;
            let is_known = inside_is_known && check.trusts(&join(&element("tray", number), "centre"));
            for (sector, at) in tray.sectors.iter().enumerate().filter(|_| is_known) {
                let inside = (at[0] - x).abs().max((at[1] - y).abs()) <= shape.inside / 2.0;
                let expected = format!(
                    "a point in the tray, within {} of {x:.2}, {y:.2} in",
                    Length(shape.inside / 2.0)
                );
                check.that(inside, &element(&path, sector), &expected, || format!("{at:?}"));
            }
        }
    }

    /// Check that names are present, valid and unique.
    pub(super) fn check_names(&self, check: &mut Check<'_>) {
        let named = |list: &'static str, key: &'static str, names: Vec<&String>| {
            let paths = (0..names.len()).map(move |number| join(&element(list, number), key));
            (list, paths.zip(names.into_iter().cloned()).collect::<Vec<_>>())
        };
        let lists = [
            named("part", "name", self.part.iter().map(|part| &part.name).collect()),
            named("tray", "unit", self.tray.iter().map(|tray| &tray.unit).collect()),
            named("fixture", "name", self.fixture.iter().map(|fixture| &fixture.name).collect()),
            named("drum.plate", "name", self.drum.plate.iter().map(|plate| &plate.name).collect()),
            named("vise.program", "name", self.vise.program.iter().map(|one| &one.name).collect()),
        ];
        for (list, names) in &lists {
            let mut first: BTreeMap<&str, &str> = BTreeMap::new();
            for (path, name) in names.iter().filter(|(path, _)| check.trusts(path)).collect::<Vec<_>>() {
                check.that(!name.is_empty(), path, "a name", || "an empty one".into());
                if let Some(other) = first.insert(name, path) {
                    let expected = format!("another name than that of {other}");
                    check.that(false, path, &expected, || name.clone());
                }
                if *list == "part" || *list == "tray" {
                    let fits = Name16::new(name).is_ok();
                    check.that(fits, path, "a name of at most 16 printable characters", || name.clone());
                }
                let group = Kind::ALL.iter().any(|kind| kind.groups().contains(&name.as_str()));
                check.that(!group, path, "another name than that of a group", || name.clone());
            }
        }
        check.that(!self.vise.location.is_empty(), "vise.location", "a name", || "an empty one".into());
        check.that(!self.part.is_empty(), "part", "at least one", || "none".into());
    }

    pub(super) fn check_parts_and_boxes(&self, check: &mut Check<'_>) {
        for (number, part) in self.part.iter().enumerate() {
            let path = element("part", number);
            let size = join(&path, "size");
            check.all_positive(&size, &part.size);
            check.positive(&path, &[("weight", part.weight)]);
            check.within(&join(&path, "reflectance"), part.reflectance, 0.0, 1.0);
            let [x, y, z] = part.size;
            let round = match part.shape {
                Shape::Box => true,
                Shape::CylinderX => y == z,
                Shape::CylinderZ => x == y,
            };
            check.that(round, &size, "one diameter across a cylinder", || format!("{:?}", part.size));
            let inside = self.tray_shape.inside;
            let fits = self.has_a_nest(part) || y.max(z) < inside;
            let expected = format!("a part that has a nest, or lies in a tray {} wide", Length(inside));
            if check.trusts("tray_shape") && check.trusts("nest") {
                check.that(fits, &size, &expected, || format!("{:?}", part.size));
            }
        }
        for (number, fixture) in self.fixture.iter().enumerate() {
            check.all_positive(&join(&element("fixture", number), "size"), &fixture.size);
        }
    }

    fn has_a_nest(&self, part: &PartType) -> bool {
        self.nest.iter().any(|nest| nest.takes(part))
    }

    pub(super) fn check_nests(&self, check: &mut Check<'_>) {
        let parts: Vec<&str> = self.part.iter().map(|part| part.name.as_str()).collect();
        for (number, nest) in self.nest.iter().enumerate() {
            let path = element("nest", number);
            check.frame(&join(&path, "seat"), &nest.seat);
            for (part, name) in nest.parts.iter().enumerate() {
                let path = element(&join(&path, "parts"), part);
                check.known(&path, "a part of this description", name, &parts);
            }
            let mut earlier = self.nest.iter().take(number);
            let same = |other: &Nest| {
                let is_there = other.location == nest.location && other.sector == nest.sector;
                let near = (other.frame().position - nest.frame().position).norm() < SAME_PLACE;
                // Parts of another size have another seat in the same nest.
                (is_there || near) && other.parts.iter().any(|part| nest.parts.contains(part))
            };
            if let Some(other) = earlier.position(same) {
                let expected = format!("another place than that of nest[{other}]");
                check.that(false, &join(&path, "location"), &expected, || match nest.sector {
                    0 => nest.location.clone(),
                    sector => format!("{} sector {sector}", nest.location),
                });
            }
            if let Some(tolerance) = nest.machining {
                let allowed = [("inches", tolerance.inches), ("degrees", tolerance.degrees)];
                check.positive(&join(&path, "machining"), &allowed);
            }
        }
    }

    pub(super) fn check_contacts(&self, check: &mut Check<'_>) {
        type Side<'a> = (&'static str, &'a [Pattern], fn(Kind) -> bool);
        let known = known(self);
        let verbs: Vec<&str> = commands().collect();
        for (number, permit) in self.contact.0.iter().enumerate() {
            let path = |key: &str| join(&element("contact", number), key);
            let mover: Side<'_> = ("mover", &permit.mover, Kind::is_mover);
            let obstacle: Side<'_> = ("obstacle", &permit.obstacle, Kind::is_obstacle);
            for (key, patterns, side) in [mover, obstacle] {
                check.that(!patterns.is_empty(), &path(key), "at least one", || "none".into());
                let there: Vec<_> = known.iter().filter(|(_, kind)| side(*kind)).collect();
                let groups = there.iter().flat_map(|(_, kind)| kind.groups().iter().copied());
                let names: Vec<&str> = there.iter().map(|(name, _)| name.as_str()).chain(groups).collect();
                for (which, pattern) in patterns.iter().enumerate() {
                    let means = there.iter().any(|(name, kind)| pattern.matches(name, *kind));
                    let expected = format!(
                        "a name or a group of what can be a{} {key}",
                        if key == "mover" { "" } else { "n" }
                    );
                    let wanted = if means { names.first().copied().unwrap_or_default() } else { &pattern.0 };
                    check.known(&element(&path(key), which), &expected, wanted, &names);
                }
            }
            for (which, verb) in permit.during.iter().enumerate() {
                let path = element(&path("during"), which);
                check.known(&path, "a command of E-move or Subtask", verb, &verbs);
            }
            check.within(&path("depth"), permit.depth.unwrap_or(1.0), 0.001, 10.0);
            check.that(!permit.why.is_empty(), &path("why"), "a reason", || "none".into());
        }
    }
}
