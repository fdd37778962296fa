//! The ladder with the controller side of the DEPC link, a plain arm and fingers.

use std::{path::Path, sync::OnceLock};

use depc::{Limits, Plate, controller};
use geometry::{
    frame::Frame,
    kinematics::{HOME_JOINTS, Joints, T3},
};
use interfaces::{
    CommonMemory, ExternalInputs, HwsCommand, Reason,
    device::{LinkBytes, RESOLVER_COUNTS},
    hws::HwsReport,
};
use levels::ladder::{Ladder, ProcessId};
use rcs_core::{Plain, digest::Digest, name::Name16, tick::Tick};
use taskdata::load::Store;

use crate::fingers::Fingers;

pub fn store() -> &'static Store {
    static STORE: OnceLock<Store> = OnceLock::new();
    STORE.get_or_init(|| match Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    })
}

/// Joints that follow every accepted set point at once.
pub struct PlainArm {
    pub joints: Joints,
    pub plate: Plate,
}

impl controller::Robot for PlainArm {
    fn present(&mut self) -> Plate {
        self.plate
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), controller::Refusal> {
        self.joints = controller::joints_for(&T3, goal, &self.joints)?;
        self.plate = *goal;
        Ok(())
    }
}

/// The controller, the link and the arm, a tick at a time.
pub struct Rig {
    pub ladder: Ladder,
    pub before: CommonMemory,
    pub external: ExternalInputs,
    pub tick: Tick,
    controller: controller::Controller,
    pub arm: PlainArm,
    pub fingers: Fingers,
    /// Gripper on the quick change.
    pub gripper: u8,
    pub digest: Digest,
    pub warnings: u32,
}

impl Rig {
    pub fn new() -> Self {
        let plate =
            Plate::from_tool(&T3.forward(&HOME_JOINTS), &T3, &Plate::default()).expect("HOME has words");
        let mut rig = Self {
            ladder: Ladder::default(),
            before: CommonMemory::default(),
            external: ExternalInputs::default(),
            tick: Tick::BEFORE_START,
            controller: controller::Controller::new(Limits::NBS),
            arm: PlainArm { joints: HOME_JOINTS, plate },
            fingers: Fingers { opening: 2.0, force: 0.0 },
            gripper: 1,
            digest: Digest::new(),
            warnings: 0,
        };
        rig.sense(LinkBytes::default());
        // A process that starts adopts the command it finds; the workstation speaks once Task listens.
        rig.step(ProcessId::ALL);
        rig
    }

    /// Device words for the next tick.
    pub fn sense(&mut self, rx: LinkBytes) {
        let devices = &mut self.external.devices;
        devices.link_rx = rx;
        devices.link_ready = true;
        for (count, angle) in devices.resolvers.counts.iter_mut().zip(self.arm.joints) {
            let turns = (angle / std::f64::consts::TAU).rem_euclid(1.0);
            *count = (turns * f64::from(RESOLVER_COUNTS)).round() as u32 % RESOLVER_COUNTS;
        }
        devices.resolvers.valid = true;
        devices.quick_change.locked = true;
        devices.quick_change.end_effector_id = self.gripper;
        devices.joystick.velocity = 1000;
        self.fingers.show(&mut devices.grip);
    }

    /// One tick with the given processes in the given order.
    pub fn step(&mut self, order: &[ProcessId]) {
        self.tick = self.tick.next();
        let mut after = CommonMemory::default();
        let data = store().view();
        self.ladder.step_in_order(order, self.tick, &self.before, &self.external, &data, &mut after);
        let mut scratch = vec![0; CommonMemory::SIZE];
        self.digest.add_record(&after, &mut scratch);
        self.before = after;

        let outputs = after.device_outputs();
        self.fingers.advance(outputs.grip.bits);
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

    pub fn command(&mut self, verb: &str, destination: &str) {
        let hws = &mut self.external.hws;
        *hws = HwsCommand {
            number: hws.number + 1,
            command: Name16::new(verb).unwrap(),
            destination: Name16::new(destination).ok().filter(|name| !name.is_empty()),
            ..HwsCommand::default()
        };
    }

    /// Run until the last command has ended.
    pub fn finish(&mut self, order: &[ProcessId], limit: u32) -> (HwsReport, Reason) {
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

    pub fn at(&self, location: &str) -> bool {
        let name = Name16::new(location).unwrap();
        let goal: Frame = store().view().resolve_location(&name, None, None::<&Name16>).unwrap().frame;
        let distance = T3.forward(&self.arm.joints).distance(&goal);
        distance.inches < 0.02 && distance.radians < 0.002
    }
}
