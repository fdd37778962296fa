//! Contact, friction and grip against closed forms, which justify the contact parameters. Steps of 2.5 ms err by half a
//! step of velocity; tolerances are a few times that.

use crate::rig::{self, CELL, PFIX, Rig, UNIT_V1, description, table};
use geometry::{
    frame::{Frame, Rotation, Vector, rotation_by, rotation_from_x_y, rotation_vector},
    movetable::System,
};
use plant::{CellDescription, CellEvent, WorkstationAction};
use rcs_core::tick::TICK_S;

const GRAVITY: f64 = 9.806_65 / 0.0254;
const FRICTION: f64 = 0.30; // coefficient of friction of parts on fixed bodies, as in `Part` and `scene`
const SLOPE: [f64; 3] = [0.0, 90.0, -20.0]; // middle of the slope, in: away from all other bodies

/// The cell with blocks of 2 x 2 x 2 in of a given weight, and a slope of 120 x 20 x 4 in that falls towards +X.
fn with_slope(degrees: f64, weight: f64) -> CellDescription {
    let [x, y, z] = SLOPE;
    let text = format!(
        "{CELL}\n[[part]]\nname = \"BLOCK\"\nsize = [2.0, 2.0, 2.0]\nweight = {weight}\n\n[[fixture]]\nname = \"slope\"\n\
         centre = [{x}, {y}, {z}]\nsize = [120.0, 20.0, 4.0]\ntilt = {degrees}\n"
    );
    CellDescription::from_toml(&text).unwrap()
}

fn put(rig: &mut Rig, frame: Frame) {
    rig.cell.workstation(&WorkstationAction::Put { part: "BLOCK".into(), frame }).unwrap();
}

fn slope_axes(degrees: f64) -> Rotation {
    rotation_by(&Vector::new(0.0, degrees.to_radians(), 0.0))
}

fn on_slope(degrees: f64, weight: f64) -> Rig {
    let mut rig = Rig::new(&with_slope(degrees, weight), 1);
    let rotation = slope_axes(degrees);
    put(
        &mut rig,
        Frame { position: Vector::from(SLOPE) + rotation * Vector::new(-40.0, 0.0, 3.0), rotation },
    );
    rig
}

/// Distance down the slope since `from`, in; height above the slope and rotation since then.
fn slid(rig: &Rig, degrees: f64, from: &Frame) -> (f64, f64, f64) {
    let at = rig.part_frame();
    let way = slope_axes(degrees).inverse() * (at.position - from.position);
    let turned = rotation_vector(&(from.rotation.inverse() * at.rotation)).norm();
    (way.x, way.z, turned)
}

/// A block on an incline stays while tan a < mu: here mu = 0.30, a = 16.70 degrees.
#[test]
fn block_on_an_incline_stays_below_the_friction_angle() {
    for degrees in [5.0, 12.0, 16.0, 16.5] {
        assert!(libm::tan(f64::to_radians(degrees)) < FRICTION);
        let mut rig = on_slope(degrees, 5.0);
        rig.ticks(25);
        let from = rig.part_frame();
        rig.ticks(1500);
        let (way, off, turned) = slid(&rig, degrees, &from);
        assert!(way.abs() < 0.004 && off.abs() < 0.001, "at {degrees} degrees {way} in a minute, off {off}");
        assert!(turned < 1e-3, "{turned}");
    }
}

/// Beyond that angle the block slides with a = g (sin a - mu cos a), independent of its weight.
#[test]
fn block_on_an_incline_slides_with_friction() {
    for (degrees, weight) in [(18.0, 5.0), (25.0, 0.5), (25.0, 5.0), (25.0, 50.0), (40.0, 5.0)] {
        let angle = f64::to_radians(degrees);
        let acceleration = GRAVITY * (libm::sin(angle) - FRICTION * libm::cos(angle));
        let mut rig = on_slope(degrees, weight);
        let from = rig.part_frame();
        // From rest; 20 ticks, or less if the slope is too short.
        let ticks = (libm::sqrt(2.0 * 60.0 / acceleration) / TICK_S).min(20.0) as u32;
        rig.ticks(ticks);
        let time = f64::from(ticks) * TICK_S;
        let expected = 0.5 * acceleration * time * time;
        let (way, off, turned) = slid(&rig, degrees, &from);
        assert!(
            (way / expected - 1.0).abs() < 0.03,
            "{degrees} degrees, {weight} lb: {way} in {time} s, expected {expected}"
        );
        assert!(off.abs() < 0.005 && turned < 0.01, "it stays on the slope: {off} {turned}");
    }
}

/// A falling part: z = h - g t²/2 until t = sqrt(2h/g), then it is at rest, without bouncing.
#[test]
fn falling_part_lands_at_the_computed_time() {
    let top = SLOPE[2] + 2.0 + 1.0;
    for height in [2.0, 10.0, 40.0] {
        let mut rig = Rig::new(&with_slope(0.0, 5.0), 1);
        let start = Vector::new(SLOPE[0], SLOPE[1], top + height);
        put(&mut rig, Frame { position: start, rotation: Rotation::identity() });
        let lands = libm::sqrt(2.0 * height / GRAVITY);
        let before = libm::floor(lands / TICK_S);
        for tick in 1..=before as u32 {
            rig.tick();
            let time = f64::from(tick) * TICK_S;
            let expected = start.z - 0.5 * GRAVITY * time * time;
            let lag = GRAVITY * time * 0.0025 / 2.0;
            let z = rig.part_frame().position.z;
            assert!(
                (z - expected).abs() < 1.1 * lag + 1e-9,
                "{height} in, {time} s: {z}, expected {expected}"
            );
        }
        rig.ticks(2);
        let lies = rig.part_frame().position;
        assert!((lies.z - top).abs() < 0.02, "landed after {lands} s: {} too low", top - lies.z);
        rig.ticks(25);
        let lies = rig.part_frame().position;
        assert!((lies.z - top).abs() < 0.002, "it has not bounced: {lies:?}");
        assert!(libm::hypot(lies.x - start.x, lies.y - start.y) < 0.01, "nor gone aside: {lies:?}");
    }
}

/// Move over a block of a given weight in sector 4 and close on it. Returns the rig and the frame of the block.
fn grip_block(weight: f64, force: f64) -> (Rig, Frame) {
    let mut rig = Rig::new(&with_slope(0.0, weight), 1);
    let sector = description().tray("UNIT_1").unwrap().sector(4).unwrap();
    put(&mut rig, sector.shifted(Vector::new(-1.001, 0.0, 0.0)));
    let grip = table(&[(System::Tool, [-60, 0, 0]), (System::ToolOrigin, [-300, 0, 0])]).apply(&sector);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(3.0);
    rig.go(grip.shifted(Vector::new(-8.0, 0.0, 0.0)), 10.0);
    rig.go_and_stop(grip, 4.0);
    rig.close(force);
    (rig, grip)
}

/// A part between pads with force F and friction mu hangs while it weighs less than 2 F mu. The rounded words of the
/// lift add 2 % in jolts; F is the final force of the fingers.
#[test]
fn gripped_part_slips_at_twice_force_times_friction() {
    let friction = description().gripper.parts.friction;
    for force in [20.0, 45.0, 70.0] {
        let (mut held, mut lost) = (0, 0);
        for step in 0..9 {
            let weight = 2.0 * force * friction * (0.88 + 0.04 * f64::from(step));
            let (mut rig, grip) = grip_block(weight, force);
            let share = weight / (2.0 * rig.cell.fingers().1 * friction);
            if (share - 1.0).abs() < 0.03 {
                continue;
            }
            rig.go_and_stop(grip.shifted(Vector::new(-1.0, 0.0, 0.0)), 0.2);
            let slipped = rig.log.iter().any(|event| matches!(event, CellEvent::Slipped { .. }));
            assert_eq!(slipped, share > 1.0, "{force} lb, {share} of the limit: {:?}", rig.log);
            let risen = rig.part().position[2] > -15.0;
            assert_eq!(risen, share < 1.0, "{force} lb, {share} of the limit: {:?}", rig.part());
            (held, lost) = if slipped { (held, lost + 1) } else { (held + 1, lost) };
        }
        assert!(held >= 2 && lost >= 2, "{force} lb: {held} weights held, {lost} lost");
    }
}

/// A bar on its edge falls to the side of its middle: it stands up to atan(0.0375 / 2) = 1.074 degrees (cell proposal,
/// §2).
#[test]
fn bar_on_the_ledge_tips_when_its_middle_passes_the_edge() {
    let critical = libm::atan2(0.0375, 2.0).to_degrees();
    assert!((critical - 1.074).abs() < 1e-3);
    let fixture = PFIX.to_frame().unwrap();
    let square = rotation_from_x_y(&Vector::x(), &Vector::y()).unwrap();
    for (lean, stands) in [(critical - 0.10, true), (critical + 0.10, false)] {
        let mut rig = Rig::new(&description(), 1);
        let turn = rotation_by(&Vector::new(0.0, -lean.to_radians(), 0.0));
        let edge = Vector::new(0.0, 0.0, -3.25);
        let middle = Vector::new(0.0375, 0.16, -1.2499);
        let frame =
            fixture.compose(&Frame { position: edge + turn * (middle - edge), rotation: turn * square });
        rig.cell.workstation(&WorkstationAction::Put { part: "LINKBAR1_BH".into(), frame }).unwrap();
        rig.ticks(75);
        assert_eq!(rig.part().location == "PFIXTURE", stands, "{lean} degrees: {:?}", rig.part());
    }
}

/// At rest the bar is pressed against the notch with F = k x: 2000 lb/in and 0.015 in give 30 lb.
#[test]
fn pressed_bar_force_is_stiffness_times_over_travel() {
    let mut rig = Rig::new(&description(), 1);
    let square = rotation_from_x_y(&Vector::x(), &Vector::y()).unwrap();
    let frame = Frame { position: Vector::new(0.0375, 0.152, -1.2499), rotation: square };
    let frame = PFIX.to_frame().unwrap().compose(&frame);
    rig.cell.workstation(&WorkstationAction::Put { part: "LINKBAR1_BH".into(), frame }).unwrap();
    rig.go(rig::FIX_V1.to_frame().unwrap(), 10.0);
    rig.outputs.grip.bits = 0;
    rig.go(Rig::fixture(&rig::HOLD, 5.0, 0.0), 4.0);
    rig.go(Rig::fixture(&rig::HOLD, 0.0, 0.0), 1.0);
    rig.go_and_stop(Rig::fixture(&rig::SEAT, 0.0, 0.0), 0.5);
    let command = Rig::fixture(&rig::SEAT, 0.0, 0.0).position.x;
    // The fingertips stop 0.015 in before the command: their springs take up the whole over-travel.
    let given = command - rig.cell.tool().position.x;
    assert!((given - 0.015).abs() < 0.004, "{given}");
    let seated = rig.in_fixture().position;
    assert!((seated.x - 0.0975).abs() < 0.004, "at the back of the notch: {seated:?}");
}
