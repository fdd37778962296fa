//! What the numbers and names of a cell description must fulfil.
//!
//! Every check names its entry by the way to it (`gripper.parts.body[0]`), so that it can be found and underlined in the text.

use std::collections::{BTreeMap, BTreeSet};

use diagnostics::{
    Diagnostics, Problem, Problems,
    toml::{Path, StandIns, element, join},
};
use geometry::kinematics::{JOINT_NAMES, T3};
use rcs_core::name::Name16;

use super::{
    CellDescription, DescriptionError, Gripper, Kind, Nest, PartType, Pattern, Points, Shape, ViseProgram,
    commands, known,
};
/// Nests whose seats are so near to each other are at one place, in: less than any part is wide.
const SAME_PLACE: f64 = 0.1;

impl CellDescription {
    /// Check all numbers and names.
    ///
    /// # Errors
    /// [`DescriptionError::Mistakes`] with all mistakes, without their places.
    pub fn validate(&self) -> Result<(), DescriptionError> {
        let mut problems = Problems::default();
        problems.extend(self.problems(&StandIns::default()).0);
        if problems.is_empty() {
            return Ok(());
        }
        Err(DescriptionError::Mistakes(Diagnostics::without_text(problems)))
    }

    /// All problems of the entries that have no stand-ins, and the entries that must be more than 0.
    pub(super) fn problems(&self, stand_ins: &StandIns) -> (Vec<Problem>, BTreeSet<Path>) {
        let mut check = Check { problems: Vec::new(), positive: BTreeSet::new(), stand_ins };
        self.check_physics_and_robot(&mut check);
        self.check_hydraulics(&mut check);
        self.check_sensors(&mut check);
        self.check_grippers(&mut check);
        self.check_camera(&mut check);
        self.check_changing(&mut check);
        self.check_drum(&mut check);
        self.check_pedestal(&mut check);
        self.check_vise(&mut check);
        self.check_trays(&mut check);
        self.check_names(&mut check);
        self.check_parts_and_boxes(&mut check);
        self.check_nests(&mut check);
        self.check_contacts(&mut check);
        (check.problems, check.positive)
    }

    fn check_physics_and_robot(&self, check: &mut Check<'_>) {
        let physics = &self.physics;
        check.within("physics.substeps", f64::from(physics.substeps), 4.0, 1000.0);
        check.that(
            (1..=64).contains(&physics.solver_iterations),
            "physics.solver_iterations",
            "1 to 64",
            || physics.solver_iterations.to_string(),
        );
        check.within("physics.contact_frequency", physics.contact_frequency, 10.0, 2000.0);
        check.within("physics.contact_damping", physics.contact_damping, 0.1, 100.0);
        let robot = &self.robot;
        check.within("robot.servo_lag_s", robot.servo_lag_s, 1e-3, 1.0);
        check.positive(
            "robot",
            &[
                ("stiffness", robot.stiffness),
                ("upper_arm_radius", robot.upper_arm_radius),
                ("forearm_radius", robot.forearm_radius),
                ("wrist_radius", robot.wrist_radius),
            ],
        );
        check.all_positive("robot.joint_speeds", &robot.joint_speeds);
        let limits = T3.limits.iter().map(|(low, high)| (low.to_degrees(), high.to_degrees()));
        for (joint, (angle, (low, high))) in robot.start.iter().zip(limits).enumerate() {
            let expected = format!("the {} angle from {low:.0} to {high:.0} degrees", JOINT_NAMES[joint]);
            let inside = (low - 1e-9..=high + 1e-9).contains(angle);
            check.that(inside, &element("robot.start", joint), &expected, || angle.to_string());
        }
    }

    fn check_hydraulics(&self, check: &mut Check<'_>) {
        let hydraulics = &self.robot.hydraulics;
        check.within("robot.hydraulics.pump_delay_s", hydraulics.pump_delay_s, 0.0, 60.0);
        check.within("robot.hydraulics.droop_rate", hydraulics.droop_rate, 0.1, 90.0);
        check.within("robot.hydraulics.shot_pin", hydraulics.shot_pin, 0.0, 90.0);
        check.within("robot.hydraulics.following_error", hydraulics.following_error, 0.0, 90.0);
        let weights = [
            ("upper_arm_weight", hydraulics.upper_arm_weight),
            ("forearm_weight", hydraulics.forearm_weight),
            ("wrist_weight", hydraulics.wrist_weight),
            ("tool_weight", hydraulics.tool_weight),
        ];
        check.positive("robot.hydraulics", &weights);
    }

    fn check_sensors(&self, check: &mut Check<'_>) {
        let sensors = &self.sensors;
        let values = [
            ("resolver_noise", sensors.resolver_noise, 1000.0),
            ("proximity_hysteresis", sensors.proximity_hysteresis, 0.5),
            ("ring_hysteresis", sensors.ring_hysteresis, 0.5),
            ("resolver_delay", f64::from(sensors.resolver_delay), 1000.0),
            ("converter_delay", f64::from(sensors.converter_delay), 1000.0),
            ("force_delay", f64::from(sensors.force_delay), 1000.0),
            ("switch_delay", f64::from(sensors.switch_delay), 1000.0),
        ];
        for (key, value, greatest) in values {
            check.within(&join("sensors", key), value, 0.0, greatest);
        }
    }

    fn check_grippers(&self, check: &mut Check<'_>) {
        let grippers = &self.gripper;
        check.positive("gripper", &[("weight", grippers.weight), ("jaw_speed", grippers.jaw_speed)]);
        for (name, gripper) in [("parts", &grippers.parts), ("v", &grippers.v), ("tool", &grippers.tool)] {
            let path = join("gripper", name);
            let (body, fingers) = (element(&join(&path, "body"), 0), element(&join(&path, "fingers"), 0));
            let length = self.quick_change.length + gripper.plate();
            if check.trusts("quick_change.length") && check.trusts(&fingers) {
                let expected = format!(
                    "with quick_change.length and {fingers} the tool length of the arm, {} in",
                    T3.plate_to_tool
                );
                let fits = (length - T3.plate_to_tool).abs() < 1e-6;
                check.that(fits, &body, &expected, || length.to_string());
            }
            check_gripper(&path, gripper, check);
        }
        let force = &grippers.force;
        check.positive("gripper.force", &[("weight", force.weight)]);
        check.within("gripper.force.behind_tool", force.behind_tool, 0.0, T3.plate_to_tool);
        check.up_to(
            "gripper.force.weight_at",
            force.weight_at,
            ("gripper.force.behind_tool", force.behind_tool),
        );
        check.within("gripper.force.noise", force.noise, 0.0, 100.0);
        for (bridge, offset) in force.offsets.iter().enumerate() {
            check.within(&element("gripper.force.offsets", bridge), *offset, -1000.0, 1000.0);
        }
    }

    fn check_camera(&self, check: &mut Check<'_>) {
        let camera = &self.camera;
        let sizes = [("view", camera.view), ("reference_range_mm", camera.reference_range_mm)];
        check.positive("camera", &sizes);
        let noises = [
            ("flood_noise", camera.flood_noise),
            ("precise_noise", camera.precise_noise),
            ("angle_noise", camera.angle_noise),
            ("shape_noise", camera.shape_noise),
            ("shape_tolerance", camera.shape_tolerance),
        ];
        for (key, noise) in noises {
            check.within(&join("camera", key), noise, 0.0, 10.0);
        }
        check.within("camera.tilt", camera.tilt, -90.0, 90.0);
        check.within("camera.least_share", camera.least_share, 0.01, 1.0);
        check.within("camera.resolution", camera.resolution, 0.0, 10.0);
        check.within("camera.bloom", camera.bloom, 0.0, 10.0);
        check.within("camera.failure", camera.failure, 0.0, 1.0);
        check.that(!camera.exposures.is_empty(), "camera.exposures", "at least one", || "none".into());
        for (number, [darkest, brightest]) in camera.exposures.iter().enumerate() {
            let path = element("camera.exposures", number);
            check.within(&element(&path, 1), *brightest, 0.0, 1.0);
            check.up_to(&element(&path, 0), *darkest, (&element(&path, 1), *brightest));
        }
    }

    fn check_changing(&self, check: &mut Check<'_>) {
        let change = &self.quick_change;
        check.positive(
            "quick_change",
            &[
                ("length", change.length),
                ("radius", change.radius),
                ("travel_time_s", change.travel_time_s),
                ("pins_reach", change.pins_reach),
                ("pins_play", change.pins_play),
                ("tolerance", change.tolerance),
                ("tolerance_degrees", change.tolerance_degrees),
            ],
        );
        let holsters = &self.holsters;
        check.frame("holsters.right", &holsters.right);
        check.frame("holsters.left", &holsters.left);
        check.frame("holsters.centre", &holsters.centre);
        check.all_positive("holsters.ears", &holsters.ears);
        check.positive(
            "holsters",
            &[
                ("seat", holsters.seat),
                ("detent", holsters.detent),
                ("catch_height", holsters.catch_height),
                ("catch_aside", holsters.catch_aside),
                ("large_range", holsters.large_range),
                ("small_range", holsters.small_range),
            ],
        );
        check.up_to(
            "holsters.catch_height",
            holsters.catch_height,
            ("quick_change.pins_reach", change.pins_reach),
        );
        check.up_to("holsters.detent", holsters.detent, ("quick_change.pins_play", change.pins_play));
    }

    fn check_drum(&self, check: &mut Check<'_>) {
        let drum = &self.drum;
        check.frame("drum.pose", &drum.pose);
        check.positive(
            "drum",
            &[
                ("finger_reach", drum.finger_reach),
                ("detent_length", drum.detent_length),
                ("stop_force", drum.stop_force),
                ("seated", drum.seated),
                ("seated_degrees", drum.seated_degrees),
            ],
        );
        check.up_to("drum.detent_length", drum.detent_length, ("drum.finger_reach", drum.finger_reach));
        check.up_to("drum.insertion_force", drum.insertion_force, ("drum.stop_force", drum.stop_force));
        check.up_to("drum.extraction_force", drum.extraction_force, ("drum.stop_force", drum.stop_force));
        check.within("drum.friction", drum.friction, 0.0, 2.0);
        for (number, plate) in drum.plate.iter().enumerate() {
            let path = join(&element("drum.plate", number), "high");
            let expected = format!("more than its low, {:?}, on every axis", plate.low);
            let ascending = plate.low.iter().zip(plate.high).all(|(low, high)| *low < high);
            check.that(ascending, &path, &expected, || format!("{:?}", plate.high));
        }
    }

    fn check_pedestal(&self, check: &mut Check<'_>) {
        let pedestal = &self.pedestal;
        check.positive("pedestal", &[("stiffness", pedestal.stiffness)]);
        let fixtures: Vec<&str> = self.fixture.iter().map(|fixture| fixture.name.as_str()).collect();
        check.known("pedestal.stand", "the name of a fixture", &pedestal.stand, &fixtures);
        check_gripper("pedestal.hand", &pedestal.hand, check);
        let table = &pedestal.table;
        let [minus, plus] = table.limits;
        check.ascending("pedestal.table.limits", table.limits);
        if check.trusts("pedestal.table.limits") {
            check.within("pedestal.table.start", table.start, minus, plus);
            check.within("pedestal.table.square", table.square, minus, plus);
        }
        check.all_positive("pedestal.table.flip", &table.flip);
        let motor = [("speed", table.speed), ("acceleration", table.acceleration)];
        check.positive("pedestal.table", &motor);
        let scale_is_known =
            check.trusts("pedestal.table.limits") && check.trusts("pedestal.table.potentiometer_offset");
        for limit in table.limits.into_iter().filter(|_| scale_is_known) {
            let counts = table.potentiometer_offset + table.potentiometer_scale * limit;
            let expected = format!("such that a 12-bit converter reads the limit at {limit} degrees");
            check.counts("pedestal.table.potentiometer_scale", &expected, counts);
        }
        check.within("pedestal.table.noise", table.noise, 0.0, 100.0);
    }

    fn check_vise(&self, check: &mut Check<'_>) {
        let vise = &self.vise;
        check.all_positive("vise.jaw", &vise.jaw);
        check.positive(
            "vise",
            &[
                ("speed", vise.speed),
                ("force", vise.force),
                ("friction", vise.friction),
                ("body_height", vise.body_height),
            ],
        );
        check.ascending("vise.body_x", vise.body_x);
        check.ascending("vise.body_y", vise.body_y);
        check.that(!vise.program.is_empty(), "vise.program", "at least one", || "none".into());
        for (number, program) in vise.program.iter().enumerate() {
            let path = |key: &str| join(&element("vise.program", number), key);
            if check.trusts("vise.jaw") {
                check.within(&path("back"), program.back, 0.0, vise.jaw[0]);
                check.within(&path("depth"), program.depth, 0.0, vise.jaw[1]);
                check.within(&path("ledge"), program.ledge, -vise.jaw[2], 0.0);
            }
            let (closed, open) = (2.0 * program.depth, program.opening_open);
            let swallows = |other: &&ViseProgram| {
                let over = other.back >= program.back
                    && other.ledge <= program.ledge
                    && other.depth >= program.depth;
                let differs =
                    [other.back, other.ledge, other.depth] != [program.back, program.ledge, program.depth];
                over && differs
            };
            if let Some(other) = vise.program.iter().find(swallows) {
                let expected = format!("a step that the step of {} does not cut away", other.name);
                check.that(false, &path("back"), &expected, || program.back.to_string());
            }
            if check.trusts(&path("depth")) && check.trusts(&path("opening_open")) {
                check.within(&path("opening_partial"), program.opening_partial, closed, open);
                check.within(&path("opening_open"), open, closed, 20.0);
            }
        }
    }

    fn check_trays(&self, check: &mut Check<'_>) {
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
                let expected = format!("a point in the tray, within {} in of {x}, {y}", shape.inside / 2.0);
                check.that(inside, &element(&path, sector), &expected, || format!("{at:?}"));
            }
        }
    }

    /// Names are there, fit, and are given once.
    fn check_names(&self, check: &mut Check<'_>) {
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

    fn check_parts_and_boxes(&self, check: &mut Check<'_>) {
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
            let expected = format!("a part that has a nest, or lies in a tray {inside} in wide");
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

    fn check_nests(&self, check: &mut Check<'_>) {
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
                // Parts of another size lie elsewhere in the same nest.
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

    fn check_contacts(&self, check: &mut Check<'_>) {
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

fn check_gripper(name: &str, gripper: &Gripper, check: &mut Check<'_>) {
    let path = |key: &str| join(name, key);
    check.all_positive(&path("body"), &gripper.body);
    check.all_positive(&path("fingers"), &gripper.fingers);
    let [least, greatest] = gripper.opening;
    check.within(&element(&path("opening"), 0), least, 0.0, greatest);
    check.within(&element(&path("opening"), 1), greatest, least.max(0.0) + 0.1, 20.0);
    let opening_is_known = check.trusts(&path("opening"));
    if opening_is_known {
        check.within(&path("initial_opening"), gripper.initial_opening, least, greatest);
    }
    check.within(&path("friction"), gripper.friction, 0.01, 2.0);
    check.positive(
        name,
        &[
            ("finger_weight", gripper.finger_weight),
            ("compressibility", gripper.compressibility),
            ("greatest_force", gripper.greatest_force),
            ("vent_time_s", gripper.vent_time_s),
        ],
    );
    let sensors = &gripper.sensors;
    let full = sensors.potentiometer_offset + sensors.potentiometer_scale * greatest;
    let expected = "such that a 12-bit converter reads the greatest opening";
    if opening_is_known && check.trusts(&path("sensors.potentiometer_offset")) {
        check.counts(&path("sensors.potentiometer_scale"), expected, full);
    }
    let gages = sensors.strain_offsets.iter().zip(sensors.strain_scales).enumerate();
    let force_is_known =
        check.trusts(&path("greatest_force")) && check.trusts(&path("sensors.strain_offsets"));
    for (gage, (offset, scale)) in gages.filter(|(_, (_, scale))| *scale != 0.0 && force_is_known) {
        let full = offset + scale * gripper.greatest_force;
        let expected = "such that a 12-bit converter reads the greatest force";
        check.counts(&element(&path("sensors.strain_scales"), gage), expected, full);
    }
    check.within(&path("sensors.noise"), sensors.noise, 0.0, 100.0);
}

/// Collects problems.
struct Check<'s> {
    problems: Vec<Problem>,
    /// Entries that must be more than 0: radii, lengths, weights.
    positive: BTreeSet<Path>,
    stand_ins: &'s StandIns,
}

impl Check<'_> {
    fn trusts(&self, path: &str) -> bool {
        self.stand_ins.trusts(path)
    }

    fn that(&mut self, holds: bool, path: &str, expected: &str, found: impl FnOnce() -> String) {
        if !holds && self.trusts(path) {
            self.problems.push(Problem::unlike("cell.value", path, expected, found()));
        }
    }

    fn within(&mut self, path: &str, value: f64, low: f64, high: f64) {
        let inside = (low..=high).contains(&value);
        self.that(inside, path, &format!("{low} to {high}"), || value.to_string());
    }

    /// From 0 to what another entry says.
    fn up_to(&mut self, path: &str, value: f64, (other, greatest): (&str, f64)) {
        if self.trusts(other) {
            let expected = format!("0 to the {greatest} of {other}");
            self.that((0.0..=greatest).contains(&value), path, &expected, || value.to_string());
        }
    }

    /// A 12-bit converter that has to read `counts` can.
    fn counts(&mut self, path: &str, expected: &str, counts: f64) {
        self.that((1.0..=4095.0).contains(&counts), path, expected, || format!("{counts:.0} counts"));
    }

    fn ascending(&mut self, path: &str, [low, high]: [f64; 2]) {
        self.that(low < high, path, "two numbers, the second one greater", || format!("{low}, {high}"));
    }

    fn frame(&mut self, path: &str, points: &Points) {
        let expected = "three points that do not stand on a line";
        self.that(points.frame().is_some(), path, expected, || {
            format!("{:?}, {:?}, {:?}", points.wrist, points.tool, points.finger)
        });
    }

    /// Some keys of a table.
    fn positive(&mut self, table: &str, values: &[(&str, f64)]) {
        for (key, value) in values {
            self.above_zero(join(table, key), *value);
        }
    }

    /// All elements of an array.
    fn all_positive(&mut self, array: &str, values: &[f64]) {
        for (number, value) in values.iter().enumerate() {
            self.above_zero(element(array, number), *value);
        }
    }

    fn above_zero(&mut self, path: Path, value: f64) {
        self.that(value > 0.0, &path, "more than 0", || value.to_string());
        self.positive.insert(path);
    }

    /// A name is one of those that are known. A known name that could not be read may be the one that is meant.
    fn known(&mut self, path: &str, expected: &str, name: &str, known: &[&str]) {
        let names_are_read =
            !self.stand_ins.iter().any(|path| path.ends_with("name") || path.ends_with("unit"));
        if !known.contains(&name) && names_are_read && self.trusts(path) {
            self.problems.push(Problem::unlike("cell.name", path, expected, name).near(name, known));
        }
    }
}
