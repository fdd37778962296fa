//! The ladder in the ideal cell, stepped one tick at a time with its processes in any order.

use std::{path::Path, sync::OnceLock};

use geometry::{frame::Frame, kinematics::Joints};
use interfaces::{
    CommonMemory, DeviceInputs, ExternalInputs, HwsCommand, Reason, device::JoystickBox, hws::HwsReport,
};
use levels::ladder::{Ladder, ProcessId};
use plant::{CellDescription, Ideal, Key, WorkstationAction, room::Room};
use rcs_core::{Plain, digest::Digest, name::Name16, tick::Tick};
use taskdata::load::Store;

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

pub fn store() -> &'static Store {
    static STORE: OnceLock<Store> = OnceLock::new();
    STORE.get_or_init(|| match Store::load(data()) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    })
}

pub fn ideal() -> Ideal {
    static IDEAL: OnceLock<Ideal> = OnceLock::new();
    let new = || {
        let cell = CellDescription::load(&data().join("cell.toml")).expect("the cell is shipped");
        Ideal::new(&Room::new(&cell), 1).expect("the cell is sound")
    };
    IDEAL.get_or_init(new).clone()
}

pub struct Rig {
    pub ladder: Ladder,
    pub before: CommonMemory,
    pub external: ExternalInputs,
    pub tick: Tick,
    cell: Ideal,
    /// Gripper that the id pins read.
    pub gripper: u8,
    pub digest: Digest,
    pub warnings: usize,
}

impl Rig {
    pub fn new() -> Self {
        let cell = ideal();
        let mut rig = Self {
            ladder: Ladder::default(),
            before: CommonMemory::default(),
            external: ExternalInputs::default(),
            tick: Tick::BEFORE_START,
            gripper: 1,
            digest: Digest::new(),
            warnings: 0,
            cell,
        };
        rig.sense(rig.cell.inputs());
        // A starting process adopts the command that it finds; the workstation sends commands once Task listens.
        rig.step(ProcessId::ALL);
        rig
    }

    /// Set the device words of the next tick, with the joystick box of the test.
    fn sense(&mut self, inputs: DeviceInputs) {
        let devices = &mut self.external.devices;
        let joystick = JoystickBox { velocity: inputs.joystick.velocity, ..devices.joystick };
        *devices = DeviceInputs { joystick, ..inputs };
        devices.quick_change.end_effector_id = self.gripper;
    }

    pub fn step(&mut self, order: &[ProcessId]) {
        self.tick = self.tick.next();
        let mut after = CommonMemory::default();
        let data = store().view();
        self.ladder.step_in_order(order, self.tick, &self.before, &self.external, &data, &mut after);
        let mut scratch = vec![0; CommonMemory::SIZE];
        self.digest.add_record(&after, &mut scratch);
        self.before = after;
        let inputs = self.cell.step(&after.device_outputs());
        self.sense(inputs);
        for _ in self.cell.warnings() {
            self.warnings += 1;
            // The operator answers every warning.
            self.cell.workstation(&WorkstationAction::T3(Key::Enter)).expect("a warning waits for ENTER");
        }
    }

    pub fn command_of_servos(&self) -> Joints {
        self.cell.t3().arm().command()
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
        let distance = self.cell.t3().arm().tool().distance(&goal);
        distance.inches < 0.02 && distance.radians < 0.002
    }
}
