//! What the numbers of a cell description must fulfil.

use std::{collections::BTreeSet, fmt};

use rcs_core::{
    kinematics::{JOINT_NAMES, T3},
    name::Name16,
};

use super::{CellDescription, DescriptionError, Fault, Faults, Gripper};

impl CellDescription {
    /// Check all numbers.
    ///
    /// # Errors
    /// [`DescriptionError::Values`] with all faults.
    pub fn validate(&self) -> Result<(), DescriptionError> {
        let mut check = Check(Vec::new());
        self.check_robot(&mut check);
        self.check_gripper_and_camera(&mut check);
        self.check_pedestal(&mut check);
        self.check_vise_and_trays(&mut check);
        self.check_names_and_boxes(&mut check);
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
        let limits = T3.limits.iter().map(|(low, high)| (low.to_degrees(), high.to_degrees()));
        for ((angle, (low, high)), joint) in self.robot.start.iter().zip(limits).zip(JOINT_NAMES) {
            check.within(&format!("robot.start ({joint})"), *angle, low, high);
        }
    }

    fn check_gripper_and_camera(&self, check: &mut Check) {
        let (change, gripper) = (&self.quick_change, &self.gripper);
        check.positive("quick_change: length, radius", &[change.length, change.radius]);
        let length = change.length + gripper.body[0] + gripper.fingers[0];
        check.that(
            (length - T3.plate_to_tool).abs() < 1e-6,
            "quick_change.length + gripper.body[0] + gripper.fingers[0]",
            format!("the tool length of the arm, {} in", T3.plate_to_tool),
            length,
        );
        check_gripper("gripper", gripper, check);
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
    }

    fn check_pedestal(&self, check: &mut Check) {
        let pedestal = &self.pedestal;
        check.positive("pedestal.stiffness", &[pedestal.stiffness]);
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
        check.within("vise.notch_back", vise.notch_back, 0.0, vise.jaw[0]);
        check.within("vise.notch_depth", vise.notch_depth, 0.0, vise.jaw[1]);
        let closed = 2.0 * vise.notch_depth;
        check.within("vise.opening_partial", vise.opening_partial, closed, vise.opening_open);
        check.within("vise.opening_open", vise.opening_open, closed, 20.0);
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
        for (kind, name) in parts.chain(trays).chain(fixtures).chain([("vise", &self.vise.location)]) {
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
        }
        for fixture in &self.fixture {
            check.positive(&format!("fixture {}: size", fixture.name), &fixture.size);
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
    for (offset, scale) in sensors.strain_offsets.iter().zip(sensors.strain_scales) {
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

    fn positive(&mut self, entry: &str, values: &[f64]) {
        let holds = values.iter().all(|v| v.is_finite() && *v > 0.0);
        self.that(holds, entry, "more than 0", format!("{values:?}"));
    }
}
