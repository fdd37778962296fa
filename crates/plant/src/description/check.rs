//! Checks of the numbers and names. Each names its entry by its path, so that the message can underline it.

mod collector;
mod parts;

use std::collections::BTreeSet;

use diagnostics::{
    Diagnostics, Problem, Problems,
    toml::{Defaulted, Path, element, join},
};
use geometry::{
    kinematics::{JOINT_NAMES, T3},
    units::Length,
};

use self::collector::Check;
use super::{CellDescription, DescriptionError, Gripper, ViseProgram};

impl CellDescription {
    /// Check all numbers and names. Fails with [`DescriptionError::Mistakes`] with all mistakes, without their places.
    pub fn validate(&self) -> Result<(), DescriptionError> {
        let mut problems = Problems::default();
        problems.extend(self.problems(&Defaulted::default()).0);
        if problems.is_empty() {
            return Ok(());
        }
        Err(DescriptionError::Mistakes(Diagnostics::without_text(problems)))
    }

    /// All problems of the entries without stand-ins, and the entries that must be more than 0.
    pub(super) fn problems(&self, stand_ins: &Defaulted) -> (Vec<Problem>, BTreeSet<Path>) {
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
                    "with quick_change.length and {fingers} the tool length of the arm, {}",
                    Length(T3.plate_to_tool)
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
