//! The ladder against the controller side of the DEPC link and a plain arm: MOV-TO-LOC from the workstation's command to the
//! joints and back, in any order of the processes, with processes that are late or restarted.
//!
//! The arm here takes every set point at once; masses, lag and contacts belong to the cell's tests.

use std::{path::Path, sync::OnceLock};

use depc::{Limits, Plate, controller};
use levels::ladder::{Ladder, ProcessId};
use proptest::prelude::*;
use rcs_core::{
    digest::Digest,
    frame::Frame,
    interface::{
        CommonMemory, ExternalInputs, HwsCommand, Reason,
        device::{LinkBytes, RESOLVER_COUNTS, valve},
        hws::HwsReport,
    },
    kinematics::{HOME_JOINTS, Joints, T3},
    name::Name16,
    record::Field,
    tick::Tick,
};
use taskdata::load::Store;

fn store() -> &'static Store {
    static STORE: OnceLock<Store> = OnceLock::new();
    STORE.get_or_init(|| match Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    })
}

/// Joints that follow every accepted set point at once.
struct PlainArm {
    joints: Joints,
    plate: Plate,
}

impl controller::Robot for PlainArm {
    fn present(&self) -> Plate {
        self.plate
    }

    fn move_to(&mut self, goal: &Plate) -> Result<(), controller::JointProblem> {
        self.joints = controller::joints_for(&T3, goal, &self.joints)?;
        self.plate = *goal;
        Ok(())
    }
}

/// The controller, the link and the arm, a tick at a time.
struct Rig {
    ladder: Ladder,
    before: CommonMemory,
    external: ExternalInputs,
    tick: Tick,
    controller: controller::Controller,
    arm: PlainArm,
    opening: f64,
    force: f64,
    digest: Digest,
    warnings: u32,
}

impl Rig {
    fn new() -> Self {
        let plate =
            Plate::from_tool(&T3.forward(&HOME_JOINTS), &T3, &Plate::default()).expect("HOME has words");
        let mut rig = Self {
            ladder: Ladder::default(),
            before: CommonMemory::default(),
            external: ExternalInputs::default(),
            tick: Tick::BEFORE_START,
            controller: controller::Controller::new(Limits::NBS),
            arm: PlainArm { joints: HOME_JOINTS, plate },
            opening: 2.0,
            force: 0.0,
            digest: Digest::new(),
            warnings: 0,
        };
        rig.sense(LinkBytes::default());
        // A process that starts adopts the command it finds; the workstation speaks once Task listens.
        rig.step(ProcessId::ALL);
        rig
    }

    /// Device words for the next tick.
    fn sense(&mut self, rx: LinkBytes) {
        let devices = &mut self.external.devices;
        devices.link_rx = rx;
        devices.link_ready = true;
        for (count, angle) in devices.resolvers.counts.iter_mut().zip(self.arm.joints) {
            let turns = (angle / std::f64::consts::TAU).rem_euclid(1.0);
            *count = (turns * f64::from(RESOLVER_COUNTS)).round() as u32 % RESOLVER_COUNTS;
        }
        devices.resolvers.valid = true;
        devices.quick_change.locked = true;
        devices.quick_change.end_effector_id = 1;
        devices.joystick.velocity = 1000;
        devices.grip.potentiometer = (200.0 + 700.0 * self.opening) as u16;
        let strain = (100.0 + 40.0 * self.force) as u16;
        (devices.grip.strain_left, devices.grip.strain_right) = (strain, strain);
    }

    /// One tick with the given processes in the given order.
    fn step(&mut self, order: &[ProcessId]) {
        self.tick = self.tick.next();
        let mut after = CommonMemory::default();
        let data = store().view();
        self.ladder.step_in_order(order, self.tick, &self.before, &self.external, &data, &mut after);
        let mut scratch = vec![0; CommonMemory::SIZE];
        self.digest.add_record(&after, &mut scratch);
        self.before = after;

        let outputs = after.device_outputs();
        self.move_fingers(outputs.grip.bits);
        let inputs = controller::ControllerInputs {
            rx: outputs.link_tx,
            cts: true,
            board: true,
            start: self.controller.state() == controller::ControllerState::Off,
            // The operator answers every warning with ENTER.
            enter: self.controller.state() == controller::ControllerState::Warning,
            ..Default::default()
        };
        self.warnings += u32::from(inputs.enter);
        let answer = self.controller.step(&inputs, &mut self.arm);
        self.sense(answer.tx);
    }

    fn move_fingers(&mut self, bits: u8) {
        if bits & valve::VENT != 0 {
            self.force = 0.0;
        }
        if bits & valve::SUPPLY == 0 || bits & valve::VENT != 0 {
            return;
        }
        let flows = [
            (valve::OPEN_FINE, 0.25),
            (valve::OPEN_MEDIUM, 1.0),
            (valve::OPEN_COARSE, 4.0),
            (valve::CLOSE_FINE, -0.25),
            (valve::CLOSE_MEDIUM, -1.0),
            (valve::CLOSE_COARSE, -4.0),
        ];
        let speed: f64 = flows.iter().filter(|(bit, _)| bits & bit != 0).map(|(_, flow)| flow).sum();
        self.opening = (self.opening + speed * 0.04).clamp(0.1, 5.0);
        // Against the closed end the fingers press on each other.
        self.force = if self.opening > 0.1 { 0.0 } else { (self.force - speed * 20.0).clamp(0.0, 80.0) };
    }

    fn command(&mut self, verb: &str, destination: &str) {
        let hws = &mut self.external.hws;
        *hws = HwsCommand {
            number: hws.number + 1,
            command: Name16::new(verb).unwrap(),
            destination: Name16::new(destination).unwrap(),
            ..HwsCommand::default()
        };
    }

    /// Run until the last command has ended.
    fn finish(&mut self, order: &[ProcessId], limit: u32) -> (HwsReport, Reason) {
        for _ in 0..limit {
            self.step(order);
            let status = self.before.task.status;
            if status.echo == self.external.hws.number
                && !matches!(status.report, HwsReport::Executing | HwsReport::Idle)
            {
                return (status.report, status.reason);
            }
        }
        panic!("{:?} did not end: {:#?}", self.external.hws.command, self.before);
    }

    fn at(&self, location: &str) -> bool {
        let name = Name16::new(location).unwrap();
        let goal: Frame = store().view().resolve_location(&name, 0, None::<&Name16>).unwrap().frame;
        let distance = T3.forward(&self.arm.joints).distance(&goal);
        distance.inches < 0.02 && distance.radians < 0.002
    }
}

const FINISHED: (HwsReport, Reason) = (HwsReport::Finished, Reason::None);

#[test]
fn the_robot_moves_to_a_location_and_back() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    for location in ["SAFE", "HOME", "PFIXTURE", "HOME"] {
        rig.command("MOVE", location);
        assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED, "to {location}");
        assert!(rig.at(location), "the robot is at {location}");
    }
    assert_eq!(rig.warnings, 0);
}

#[test]
fn a_command_that_is_done_already_is_done_at_once() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    // The arrows of the arm are not quite where the pose was taught: a short distance (IV.3.3 step 19).
    rig.command("MOVE", "HOME");
    assert_eq!(rig.finish(ProcessId::ALL, 200), FINISHED);
    assert!(rig.at("HOME"));
    rig.command("MOVE", "HOME");
    let start = rig.tick;
    assert_eq!(rig.finish(ProcessId::ALL, 50), FINISHED);
    assert!(rig.tick.since(start) < 12);
}

#[test]
fn a_bad_command_is_refused_and_nothing_moves() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    let joints = rig.arm.joints;
    for (verb, location, reason) in [
        ("DANCE", "SAFE", Reason::UnknownCommand),
        ("MOVE", "NOWHERE", Reason::UnknownLocation),
        ("MOVE", "", Reason::NoDestination),
        ("MOVE", "UNIT", Reason::UnknownLocation),
        ("TRANSFER", "SAFE", Reason::NoObjectNamed),
        // No trajectory leads from HOME to the pedestal's neighbour as written.
        ("MOVE", "UNIT-SAFE", Reason::NoTrajectory),
    ] {
        rig.command(verb, location);
        assert_eq!(rig.finish(ProcessId::ALL, 100), (HwsReport::Error, reason), "{verb} {location}");
    }
    assert_eq!(rig.arm.joints, joints);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// DESIGN 4: the order of processes within a tick cannot change a bit of the result.
    #[test]
    fn order_does_not_matter(seed in prop::collection::vec(Just(ProcessId::ALL.to_vec()).prop_shuffle(), 1..20)) {
        let run = |orders: &[Vec<ProcessId>]| {
            let mut rig = Rig::new();
            rig.command("PAUSE", "");
            for k in 0..600 {
                if k == 250 {
                    rig.command("MOVE", "SAFE");
                }
                rig.step(&orders[k % orders.len()]);
            }
            rig.digest
        };
        prop_assert_eq!(run(&seed), run(&[ProcessId::ALL.to_vec()]));
    }
}

/// What goes wrong in a tick.
#[derive(Clone, Debug)]
enum Mishap {
    /// A process is not stepped for some ticks.
    Late(ProcessId, u8),
    /// A process forgets everything.
    Restart(ProcessId),
}

fn mishap() -> impl Strategy<Value = Mishap> {
    let process = || prop::sample::select(ProcessId::ALL.to_vec());
    prop_oneof![
        (process(), 1_u8..12).prop_map(|(p, n)| Mishap::Late(p, n)),
        process().prop_map(Mishap::Restart)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    /// Whatever is late or restarted: the robot is never asked to jump, a command that is reported finished is finished, no
    /// command is left without an end, and a PAUSE leads back to work.
    #[test]
    fn mishaps_end_in_a_stop_and_a_report(
        mishaps in prop::collection::vec((0_u16..500, mishap()), 1..5),
        order in Just(ProcessId::ALL.to_vec()).prop_shuffle(),
    ) {
        let mut rig = Rig::new();
        rig.command("PAUSE", "");
        rig.finish(&order, 2000);
        rig.command("MOVE", "SAFE");
        let mut late: Vec<(ProcessId, u8)> = Vec::new();
        for k in 0..520_u16 {
            for (_, mishap) in mishaps.iter().filter(|(at, _)| *at == k) {
                match mishap {
                    Mishap::Late(process, ticks) => late.push((*process, *ticks)),
                    Mishap::Restart(process) => rig.ladder.restart(*process),
                }
            }
            let stepped: Vec<ProcessId> =
                order.iter().copied().filter(|p| !late.iter().any(|(l, _)| l == p)).collect();
            late.iter_mut().for_each(|(_, ticks)| *ticks -= 1);
            late.retain(|(_, ticks)| *ticks > 0);
            rig.step(&stepped);
        }
        let (report, _) = rig.finish(&order, 5000);
        prop_assert!(report != HwsReport::Finished || rig.at("SAFE"));
        prop_assert_eq!(rig.warnings, 0, "the controller was asked for a jump");

        rig.command("PAUSE", "");
        prop_assert_eq!(rig.finish(&order, 3000), FINISHED);
        let joints = rig.arm.joints;
        for _ in 0..50 {
            rig.step(&order);
        }
        prop_assert_eq!(rig.arm.joints, joints, "a pausing robot moves");
        if rig.at("SAFE") || rig.at("HOME") {
            rig.command("MOVE", "HOME");
            prop_assert_eq!(rig.finish(&order, 5000), FINISHED);
            prop_assert!(rig.at("HOME"));
        }
    }
}

#[test]
fn a_lost_process_below_is_an_error() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    rig.finish(ProcessId::ALL, 2000);
    rig.command("MOVE", "SAFE");
    for _ in 0..100 {
        rig.step(ProcessId::ALL);
    }
    let without_emove: Vec<_> = ProcessId::ALL.iter().copied().filter(|p| *p != ProcessId::Emove).collect();
    assert_eq!(rig.finish(&without_emove, 100), (HwsReport::Error, Reason::NeighbourLost));
}
