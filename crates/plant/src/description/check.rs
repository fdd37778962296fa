//! What the numbers of a cell description must fulfil.

use std::{collections::BTreeSet, fmt};

use rcs_core::{
    kinematics::{JOINT_NAMES, T3},
    name::Name16,
};

use super::{
    CellDescription, DescriptionError, Fault, Faults, Gripper, Kind, Pattern, Points, Shape, commands, known,
};

impl CellDescription {
    /// Check all numbers.
    ///
    /// # Errors
    /// [`DescriptionError::Values`] with all faults.
    pub fn validate(&self) -> Result<(), DescriptionError> {
        let mut check = Check(Vec::new());
        self.check_robot(&mut check);
        self.check_gripper_and_camera(&mut check);
        self.check_changing(&mut check);
        self.check_drum(&mut check);
        self.check_pedestal(&mut check);
        self.check_vise_and_trays(&mut check);
        self.check_names_and_boxes(&mut check);
        self.check_contacts(&mut check);
        if check.0.is_empty() { Ok(()) } else { Err(DescriptionError::Values(Faults(check.0))) }
    }

    fn check_robot(&self, check: &mut Check) {
        check.within("physics.substeps", f64::from(self.physics.substeps), 4.0, 1000.0);
        check.that(
            (1..=64).contains(&self.physics.solver_iterations),
            "physics.solver_iterations",
            "1 to 64",
            self.physics.solver_iterations,
        );
        check.within("physics.contact_frequency", self.physics.contact_frequency, 10.0, 2000.0);
        check.within("physics.contact_damping", self.physics.contact_damping, 0.1, 100.0);
        check.within("robot.servo_lag_s", self.robot.servo_lag_s, 1e-3, 1.0);
        check.positive("robot.stiffness", &[self.robot.stiffness]);
        check.positive("robot.joint_speeds", &self.robot.joint_speeds);
        let outline = [self.robot.upper_arm_radius, self.robot.forearm_radius, self.robot.wrist_radius];
        check.positive("robot.*_radius", &outline);
        let hydraulics = &self.robot.hydraulics;
        check.within("robot.hydraulics.pump_delay_s", hydraulics.pump_delay_s, 0.0, 60.0);
        check.within("robot.hydraulics.droop_rate", hydraulics.droop_rate, 0.1, 90.0);
        check.within("robot.hydraulics.shot_pin", hydraulics.shot_pin, 0.0, 90.0);
        check.within("robot.hydraulics.following_error", hydraulics.following_error, 0.0, 90.0);
        let weights = [
            hydraulics.upper_arm_weight,
            hydraulics.forearm_weight,
            hydraulics.wrist_weight,
            hydraulics.tool_weight,
        ];
        check.positive("robot.hydraulics.*_weight", &weights);
        let limits = T3.limits.iter().map(|(low, high)| (low.to_degrees(), high.to_degrees()));
        for ((angle, (low, high)), joint) in self.robot.start.iter().zip(limits).zip(JOINT_NAMES) {
            check.within(&format!("robot.start ({joint})"), *angle, low, high);
        }
    }

    fn check_gripper_and_camera(&self, check: &mut Check) {
        let grippers = &self.gripper;
        check.positive("gripper: weight, jaw_speed", &[grippers.weight, grippers.jaw_speed]);
        for (name, gripper) in [("parts", &grippers.parts), ("v", &grippers.v), ("tool", &grippers.tool)] {
            let length = self.quick_change.length + gripper.plate();
            check.that(
                (length - T3.plate_to_tool).abs() < 1e-6,
                &format!("quick_change.length + gripper.{name}.body[0] + gripper.{name}.fingers[0]"),
                format!("the tool length of the arm, {} in", T3.plate_to_tool),
                length,
            );
            check_gripper(&format!("gripper.{name}"), gripper, check);
        }
        let sensors = &self.sensors;
        check.within("sensors.resolver_noise", sensors.resolver_noise, 0.0, 1000.0);
        check.within("sensors.proximity_hysteresis", sensors.proximity_hysteresis, 0.0, 0.5);
        check.within("sensors.ring_hysteresis", sensors.ring_hysteresis, 0.0, 0.5);
        for (name, delay) in [
            ("resolver", sensors.resolver_delay),
            ("converter", sensors.converter_delay),
            ("force", sensors.force_delay),
            ("switch", sensors.switch_delay),
        ] {
            check.within(&format!("sensors.{name}_delay"), f64::from(delay), 0.0, 1000.0);
        }
        let camera = &self.camera;
        check.positive("camera: view, reference_range_mm", &[camera.view, camera.reference_range_mm]);
        let noises = [
            camera.flood_noise,
            camera.precise_noise,
            camera.angle_noise,
            camera.shape_noise,
            camera.shape_tolerance,
        ];
        for noise in noises {
            check.within("camera.*_noise, shape_tolerance", noise, 0.0, 10.0);
        }
        check.within("camera.tilt", camera.tilt, -90.0, 90.0);
        check.within("camera.least_share", camera.least_share, 0.01, 1.0);
        check.within("camera.resolution", camera.resolution, 0.0, 10.0);
        check.within("camera.bloom", camera.bloom, 0.0, 10.0);
        check.within("camera.failure", camera.failure, 0.0, 1.0);
        check.that(!camera.exposures.is_empty(), "camera.exposures", "at least one", "none");
        for [darkest, brightest] in &camera.exposures {
            check.within("camera.exposures: the greatest reflectance", *brightest, 0.0, 1.0);
            check.within("camera.exposures: the least reflectance", *darkest, 0.0, *brightest);
        }
    }

    fn check_changing(&self, check: &mut Check) {
        let change = &self.quick_change;
        check.positive(
            "quick_change: length, radius, travel_time_s, pins_reach, pins_play, tolerance, tolerance_degrees",
            &[
                change.length,
                change.radius,
                change.travel_time_s,
                change.pins_reach,
                change.pins_play,
                change.tolerance,
                change.tolerance_degrees,
            ],
        );
        let holsters = &self.holsters;
        let poses = [("right", holsters.right), ("left", holsters.left), ("centre", holsters.centre)];
        for (name, points) in poses {
            check.frame(&format!("holsters.{name}"), &points);
        }
        check.positive("holsters.ears", &holsters.ears);
        check.positive(
            "holsters: seat, detent, catch_height, catch_aside, large_range, small_range",
            &[
                holsters.seat,
                holsters.detent,
                holsters.catch_height,
                holsters.catch_aside,
                holsters.large_range,
                holsters.small_range,
            ],
        );
        check.within("holsters.catch_height", holsters.catch_height, 0.0, change.pins_reach);
        check.within("holsters.detent", holsters.detent, 0.0, change.pins_play);
        let force = &self.gripper.force;
        check.positive("gripper.force.weight", &[force.weight]);
        check.within("gripper.force.behind_tool", force.behind_tool, 0.0, T3.plate_to_tool);
        check.within("gripper.force.weight_at", force.weight_at, 0.0, force.behind_tool);
        check.within("gripper.force.noise", force.noise, 0.0, 100.0);
        for offset in force.offsets {
            check.within("gripper.force.offsets", offset, -1000.0, 1000.0);
        }
    }

    fn check_drum(&self, check: &mut Check) {
        let drum = &self.drum;
        check.frame("drum.pose", &drum.pose);
        check.positive(
            "drum: finger_reach, detent_length, stop_force, seated, seated_degrees",
            &[drum.finger_reach, drum.detent_length, drum.stop_force, drum.seated, drum.seated_degrees],
        );
        check.within("drum.detent_length", drum.detent_length, 0.0, drum.finger_reach);
        check.within("drum.insertion_force", drum.insertion_force, 0.0, drum.stop_force);
        check.within("drum.extraction_force", drum.extraction_force, 0.0, drum.stop_force);
        check.within("drum.friction", drum.friction, 0.0, 2.0);
        for plate in &drum.plate {
            let ascending = plate.low.iter().zip(plate.high).all(|(low, high)| *low < high);
            let entry = format!("drum.plate {}: low, high", plate.name);
            check.that(ascending, &entry, "low below high", format!("{:?}, {:?}", plate.low, plate.high));
        }
    }

    fn check_pedestal(&self, check: &mut Check) {
        let pedestal = &self.pedestal;
        check.positive("pedestal.stiffness", &[pedestal.stiffness]);
        let stand = self.fixture.iter().any(|fixture| fixture.name == pedestal.stand);
        check.that(stand, "pedestal.stand", "the name of a fixture", &pedestal.stand);
        check_gripper("pedestal.hand", &pedestal.hand, check);
        let table = &pedestal.table;
        let [minus, plus] = table.limits;
        check.that(minus < plus, "pedestal.table.limits", "ascending", format!("{:?}", table.limits));
        check.within("pedestal.table.start", table.start, minus, plus);
        check.within("pedestal.table.square", table.square, minus, plus);
        check.positive("pedestal.table.flip", &table.flip);
        check.positive("pedestal.table: speed, acceleration", &[table.speed, table.acceleration]);
        for (limit, name) in table.limits.iter().zip(["-", "+"]) {
            let counts = table.potentiometer_offset + table.potentiometer_scale * limit;
            check.within(&format!("pedestal.table: potentiometer at the {name} limit"), counts, 1.0, 4095.0);
        }
        check.within("pedestal.table.noise", table.noise, 0.0, 100.0);
    }

    fn check_vise_and_trays(&self, check: &mut Check) {
        let vise = &self.vise;
        check.positive("vise.jaw", &vise.jaw);
        check.positive(
            "vise: speed, force, friction, body_height",
            &[vise.speed, vise.force, vise.friction, vise.body_height],
        );
        check.that(!vise.program.is_empty(), "vise.program", "at least one", "none");
        for program in &vise.program {
            let entry = |what: &str| format!("vise.program {}: {what}", program.name);
            check.within(&entry("back"), program.back, 0.0, vise.jaw[0]);
            check.within(&entry("depth"), program.depth, 0.0, vise.jaw[1]);
            check.within(&entry("ledge"), program.ledge, -vise.jaw[2], 0.0);
            let closed = 2.0 * program.depth;
            check.within(&entry("opening_partial"), program.opening_partial, closed, program.opening_open);
            check.within(&entry("opening_open"), program.opening_open, closed, 20.0);
        }
        check.that(vise.body_x[0] < vise.body_x[1], "vise.body_x", "ascending", format!("{:?}", vise.body_x));
        check.that(vise.body_y[0] < vise.body_y[1], "vise.body_y", "ascending", format!("{:?}", vise.body_y));
        let shape = &self.tray_shape;
        check.positive("tray_shape", &[shape.inside, shape.wall, shape.rim, shape.floor_thickness]);
        check.within("tray_shape.random_offset", shape.random_offset, 0.0, shape.inside / 2.0);
        for tray in &self.tray {
            check.that(
                !tray.sectors.is_empty(),
                &format!("tray {}: sectors", tray.unit),
                "at least one",
                "none",
            );
            for (number, [x, y]) in tray.sectors.iter().enumerate() {
                let [cx, cy] = tray.centre;
                let away = (x - cx).abs().max((y - cy).abs());
                let entry = format!("tray {}: sector {}, distance from the centre", tray.unit, number + 1);
                check.within(&entry, away, 0.0, shape.inside / 2.0);
            }
        }
    }

    fn check_names_and_boxes(&self, check: &mut Check) {
        let mut names = BTreeSet::new();
        let parts = self.part.iter().map(|p| ("part", &p.name));
        let trays = self.tray.iter().map(|t| ("tray", &t.unit));
        let fixtures = self.fixture.iter().map(|f| ("fixture", &f.name));
        let programs = self.vise.program.iter().map(|p| ("vise.program", &p.name));
        let vise = [("vise", &self.vise.location)];
        for (kind, name) in parts.chain(trays).chain(fixtures).chain(programs).chain(vise) {
            check.that(!name.is_empty(), kind, "a name", "an empty one");
            check.that(names.insert((kind, name)), &format!("{kind} {name}"), "one entry for a name", "two");
            if kind == "part" || kind == "tray" {
                let fits = Name16::new(name);
                check.that(
                    fits.is_ok(),
                    &format!("{kind} {name}"),
                    "a name of at most 16 printable characters",
                    name,
                );
            }
        }
        check.that(!self.part.is_empty(), "part", "at least one", "none");
        for part in &self.part {
            check.positive(&format!("part {}: size", part.name), &part.size);
            check.positive(&format!("part {}: weight", part.name), &[part.weight]);
            check.within(&format!("part {}: reflectance", part.name), part.reflectance, 0.0, 1.0);
            let [x, y, z] = part.size;
            let round = match part.shape {
                Shape::Box => true,
                Shape::CylinderX => y == z,
                Shape::CylinderZ => x == y,
            };
            let entry = format!("part {}: size", part.name);
            check.that(round, &entry, "one diameter across a cylinder", format!("{:?}", part.size));
        }
        for nest in &self.nest {
            let entry = format!("nest {} {}", nest.location, nest.sector);
            check.frame(&format!("{entry}: seat"), &nest.seat);
            for part in &nest.parts {
                let known = self.part(part).is_some();
                check.that(known, &format!("{entry}: parts"), "parts of this description", part);
            }
            if let Some(tolerance) = nest.machining {
                let tolerance = [tolerance.inches, tolerance.degrees];
                check.positive(&format!("{entry}: machining"), &tolerance);
            }
        }
        for fixture in &self.fixture {
            check.positive(&format!("fixture {}: size", fixture.name), &fixture.size);
        }
    }

    fn check_contacts(&self, check: &mut Check) {
        type Side<'a> = (&'static str, &'a [Pattern], fn(Kind) -> bool);
        let known = known(self);
        let means = |pattern: &Pattern, side: fn(Kind) -> bool| {
            known.iter().any(|(name, kind)| side(*kind) && pattern.matches(name, *kind))
        };
        for (number, permit) in self.contact.0.iter().enumerate() {
            let entry = |what: &str| format!("contact {}: {what}", number + 1);
            let mover: Side<'_> = ("mover", &permit.mover, Kind::is_mover);
            let obstacle: Side<'_> = ("obstacle", &permit.obstacle, Kind::is_obstacle);
            for (what, patterns, side) in [mover, obstacle] {
                check.that(!patterns.is_empty(), &entry(what), "at least one", "none");
                for pattern in patterns {
                    let expected = format!("a name, a group or a pattern of something that can be a {what}");
                    check.that(means(pattern, side), &entry(what), expected, pattern);
                }
            }
            for verb in &permit.during {
                let is_one = commands().any(|command| command == verb);
                check.that(is_one, &entry("during"), "commands of E-move or Subtask", verb);
            }
            check.within(&entry("depth"), permit.depth.unwrap_or(1.0), 0.001, 10.0);
            check.that(!permit.why.is_empty(), &entry("why"), "a reason", "none");
        }
    }
}

fn check_gripper(name: &str, gripper: &Gripper, check: &mut Check) {
    let entry = |what: &str| format!("{name}{what}");
    check.positive(&entry(".body"), &gripper.body);
    check.positive(&entry(".fingers"), &gripper.fingers);
    let [least, greatest] = gripper.opening;
    check.within(&entry(".opening"), greatest, least.max(0.0) + 0.1, 20.0);
    check.within(&entry(".opening[0]"), least, 0.0, greatest);
    check.within(&entry(".initial_opening"), gripper.initial_opening, least, greatest);
    check.within(&entry(".friction"), gripper.friction, 0.01, 2.0);
    check.positive(
        &entry(": finger_weight, compressibility, greatest_force, vent_time_s"),
        &[gripper.finger_weight, gripper.compressibility, gripper.greatest_force, gripper.vent_time_s],
    );
    let sensors = &gripper.sensors;
    let full = sensors.potentiometer_offset + sensors.potentiometer_scale * greatest;
    check.within(&entry(".sensors: potentiometer at the greatest opening"), full, 1.0, 4095.0);
    let gages = sensors.strain_offsets.iter().zip(sensors.strain_scales);
    for (offset, scale) in gages.filter(|(_, scale)| *scale != 0.0) {
        let full = offset + scale * gripper.greatest_force;
        check.within(&entry(".sensors: strain gage at the greatest force"), full, 1.0, 4095.0);
    }
    check.within(&entry(".sensors.noise"), sensors.noise, 0.0, 100.0);
}

/// Collects faults.
struct Check(Vec<Fault>);

impl Check {
    fn that(&mut self, holds: bool, entry: &str, expected: impl fmt::Display, found: impl fmt::Display) {
        if !holds {
            self.0.push(Fault {
                entry: entry.into(),
                expected: expected.to_string(),
                found: found.to_string(),
            });
        }
    }

    fn within(&mut self, entry: &str, value: f64, low: f64, high: f64) {
        self.that((low..=high).contains(&value), entry, format!("{low} to {high}"), value);
    }

    fn frame(&mut self, entry: &str, points: &Points) {
        let expected = "three points that do not stand on a line";
        self.that(points.frame().is_some(), entry, expected, format!("{points:?}"));
    }

    fn positive(&mut self, entry: &str, values: &[f64]) {
        let holds = values.iter().all(|v| v.is_finite() && *v > 0.0);
        self.that(holds, entry, "more than 0", format!("{values:?}"));
    }
}
