//! A rig that moves the arm without a controller: straight lines of the tool frame, and the gripper's valves.
#![allow(dead_code)]

pub mod scenes;
pub mod tape;

use geometry::{
    frame::{Frame, INCHES_PER_RADIAN, Vector, rotation_by, rotation_vector},
    kinematics::T3,
    movetable::{Movetable, MovetableLine, System},
    pose::Pose,
};
use interfaces::device::{DeviceInputs, DeviceOutputs, MotorCommand, MotorOrder, valve};
use plant::{Cell, CellDescription, CellEvent, PartState, Placement, WorkstationAction, fault::FaultPlan};
use tape::{Beat, Tape};

pub const CELL: &str = include_str!("../../../../data/cell.toml");

pub const UT_1: Pose =
    Pose { wrist: [-6650, -550, 1600], tool: [-6650, -550, -1400], finger: [-6650, -3550, -1400] };
pub const PFIX: Pose =
    Pose { wrist: [3800, -4400, -400], tool: [6800, -4400, -400], finger: [6800, -1400, -400] };
pub const PED: Pose =
    Pose { wrist: [1972, -3708, -1000], tool: [3380, -6357, -1000], finger: [6029, -4949, -1000] };
pub const UNIT_V1: Pose =
    Pose { wrist: [-4040, -1471, 3398], tool: [-5450, -1984, 800], finger: [-4424, -4803, 800] };
pub const HOM_SAF_3: Pose =
    Pose { wrist: [-2454, -3505, 2521], tool: [-3671, -5243, 400], finger: [-1214, -6964, 400] };
pub const HOM_SAF_1: Pose =
    Pose { wrist: [0, -4279, 2521], tool: [0, -6400, 400], finger: [3000, -6400, 400] };
pub const FIX_V1: Pose =
    Pose { wrist: [1473, -3098, 1426], tool: [3285, -5258, 400], finger: [5583, -3330, 400] };

pub struct Rig {
    pub cell: Cell,
    pub outputs: DeviceOutputs,
    pub inputs: DeviceInputs,
    pub log: Vec<CellEvent>,
    pub count: u64,
    pub description: CellDescription,
    pub tape: Option<Tape>,
    beat: Beat, // inputs of the next tick
    at: Frame,
}

pub fn description() -> CellDescription {
    CellDescription::from_toml(CELL).unwrap()
}

pub fn table(lines: &[(System, [i32; 3])]) -> Movetable {
    let lines: Vec<MovetableLine> =
        lines.iter().map(|&(system, values)| MovetableLine { system, values }).collect();
    Movetable::from_lines(&lines).unwrap()
}

impl Rig {
    pub fn new(description: &CellDescription, seed: u64) -> Self {
        Self::with_faults(description, seed, &FaultPlan::default())
    }

    pub fn with_faults(description: &CellDescription, seed: u64, faults: &FaultPlan) -> Self {
        let cell = Cell::with_faults(description, seed, faults).unwrap();
        let (inputs, at) = (cell.inputs(), T3.forward(&cell.joints()));
        let (outputs, beat, description) = (DeviceOutputs::default(), Beat::default(), description.clone());
        Self { cell, outputs, inputs, log: Vec::new(), count: 0, description, tape: None, beat, at }
    }

    pub fn taped(description: &CellDescription, seed: u64) -> Self {
        Self { tape: Some(Tape::default()), ..Self::new(description, seed) }
    }

    pub fn work(&mut self, action: WorkstationAction) {
        self.cell.workstation(&action).unwrap();
        self.beat.actions.push(action);
    }

    pub fn place(&mut self, part: &str, sector: u16, x: f64, y: f64, angle: f64) {
        let placement = Placement::At { x, y, angle };
        let action = WorkstationAction::Place { part: part.into(), unit: "UNIT_1".into(), sector, placement };
        self.work(action);
    }

    pub fn tick(&mut self) {
        self.inputs = self.cell.step(&self.outputs);
        let beat = Beat { outputs: self.outputs, ..std::mem::take(&mut self.beat) };
        if let Some(tape) = &mut self.tape {
            tape.note(beat, &self.cell);
        }
        self.log.extend(self.cell.events());
        self.count += 1;
    }

    pub fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            self.tick();
        }
    }

    /// Move the tool to a frame in a straight line at `speed` in/s; a radian is treated as 14 in.
    pub fn go(&mut self, to: Frame, speed: f64) {
        let from = self.at;
        let turn = rotation_vector(&(from.rotation.inverse() * to.rotation));
        let way = (to.position - from.position).norm().max(turn.norm() * INCHES_PER_RADIAN);
        let steps = (way / (speed * 0.04)).ceil().max(1.0);
        for step in 1..=steps as u32 {
            let share = f64::from(step) / steps;
            let frame = Frame {
                position: from.position + (to.position - from.position) * share,
                rotation: from.rotation * rotation_by(&(turn * share)),
            };
            self.lead(&frame);
            self.tick();
        }
        self.at = to;
    }

    fn lead(&mut self, tool: &Frame) {
        let plate = tool.shifted(Vector::new(-T3.plate_to_tool, 0.0, 0.0));
        if let Err(error) = self.cell.drive(&plate) {
            panic!("{error} at {tool:?}");
        }
        self.beat.plate = Some(plate);
    }

    pub fn go_and_stop(&mut self, to: Frame, speed: f64) {
        self.go(to, speed);
        self.ticks(30);
    }

    /// Close until the force of the fingers is at least `force` lb; then trap the air.
    pub fn close(&mut self, force: f64) {
        self.outputs.grip.bits = valve::SUPPLY | valve::CLOSE_MEDIUM;
        for _ in 0..1000 {
            self.tick();
            if self.cell.fingers().1 >= force {
                self.outputs.grip.bits = valve::SUPPLY;
                self.tick();
                return;
            }
        }
        panic!("the fingers find nothing to press on: {:?}", self.cell.fingers());
    }

    pub fn open(&mut self, opening: f64) {
        self.outputs.grip.bits = valve::SUPPLY | valve::OPEN_MEDIUM;
        for _ in 0..1000 {
            self.tick();
            if self.cell.fingers().0 >= opening {
                self.outputs.grip.bits = valve::SUPPLY;
                self.tick();
                return;
            }
        }
        panic!("the fingers do not open: {:?}", self.cell.fingers());
    }

    /// Close the pedestal's hand until the force of its fingers is at least `force` lb; then trap the air.
    pub fn pedestal_close(&mut self, force: f64) {
        self.outputs.pedestal_hand.bits = valve::SUPPLY | valve::CLOSE_MEDIUM;
        for _ in 0..1000 {
            self.tick();
            if self.cell.pedestal_fingers().1 >= force {
                self.outputs.pedestal_hand.bits = valve::SUPPLY;
                self.tick();
                return;
            }
        }
        panic!("the pedestal's hand finds nothing to press on: {:?}", self.cell.pedestal_fingers());
    }

    pub fn pedestal_open(&mut self, opening: f64) {
        self.outputs.pedestal_hand.bits = valve::SUPPLY | valve::OPEN_MEDIUM;
        for _ in 0..1000 {
            self.tick();
            if self.cell.pedestal_fingers().0 >= opening {
                self.outputs.pedestal_hand.bits = valve::SUPPLY;
                self.tick();
                return;
            }
        }
        panic!("the pedestal's hand does not open: {:?}", self.cell.pedestal_fingers());
    }

    /// Give the rotary table an order and wait until its motor stops.
    pub fn table(&mut self, order: MotorOrder, steps: i32) {
        let number = self.outputs.pedestal_table.number + 1;
        self.outputs.pedestal_table = MotorCommand { number, order, steps };
        for _ in 0..1000 {
            self.tick();
            if !self.inputs.pedestal.motor_moving {
                assert_eq!(self.inputs.pedestal.motor_echo, number);
                return;
            }
        }
        panic!("the table turns on: {:?}", self.inputs.pedestal);
    }

    /// Like the pedestal's controller: find the + limit, set the counter, turn across the radial line.
    pub fn table_square(&mut self) {
        self.table(MotorOrder::Turn, 100_000);
        self.table(MotorOrder::SetCounter, 0);
        self.table(MotorOrder::Turn, -21_350);
    }

    pub fn vise(&mut self, action: WorkstationAction) {
        self.work(action);
        while self.cell.workstation_busy() {
            self.tick();
        }
        self.ticks(20);
    }

    pub fn part(&self) -> PartState {
        self.cell.parts().pop().unwrap()
    }

    pub fn part_frame(&self) -> Frame {
        self.cell.part_frame(self.part().id).unwrap()
    }

    pub fn in_fixture(&self) -> Frame {
        PFIX.to_frame().unwrap().inverse().compose(&self.part_frame())
    }

    /// The grip frame over a part in a tray: LK-GRP-1 on the part's place, backed off by `up` in.
    pub fn grip_frame(&self, sector: u16, x: f64, y: f64, angle: f64, up: f64) -> Frame {
        let sector = description().tray("UNIT_1").unwrap().sector(sector).unwrap();
        let place = Frame {
            position: sector.position + Vector::new(x, y, 0.0),
            rotation: sector.rotation * rotation_by(&Vector::new(angle.to_radians(), 0.0, 0.0)),
        };
        let grip = table(&[(System::Tool, [-20, 0, 210]), (System::ToolOrigin, [-300, 0, 0])]).apply(&place);
        grip.shifted(Vector::new(-up, 0.0, 0.0))
    }

    pub fn pick(&mut self, x: f64, y: f64, angle: f64, force: f64) {
        self.go(UNIT_V1.to_frame().unwrap(), 10.0);
        self.open(3.0);
        self.go(self.grip_frame(4, x, y, angle, 8.0), 10.0);
        self.go_and_stop(self.grip_frame(4, x, y, angle, 0.0), 4.0);
        self.close(force);
        self.go(self.grip_frame(4, x, y, angle, 8.0), 4.0);
    }

    pub fn carry(&mut self) {
        for via in [UNIT_V1, HOM_SAF_3, HOM_SAF_1, FIX_V1] {
            self.go(via.to_frame().unwrap(), 10.0);
        }
    }

    /// A grip frame at the fixture, backed off by `back` in and lifted by `up` in.
    pub fn fixture(lines: &[(System, [i32; 3])], back: f64, up: f64) -> Frame {
        let frame = table(lines).apply(&PFIX.to_frame().unwrap()).shifted(Vector::new(-back, 0.0, 0.0));
        Frame { position: frame.position + Vector::new(0.0, 0.0, up), ..frame }
    }

    /// Insert into the vise like LK-GRP-FX1.
    pub fn insert(&mut self) {
        self.go(Self::fixture(&FX1, 10.0, 0.0), 10.0);
        self.go(Self::fixture(&FX1, 5.0, 0.0), 4.0);
        self.go(Self::fixture(&FX1, 0.0, 0.25), 1.0);
        self.go_and_stop(Self::fixture(&FX1, 0.0, 0.0), 0.5);
    }
}

pub const FX1: [(System, [i32; 3]); 2] = [(System::Tool, [15, 19, 100]), (System::ToolOrigin, [-300, 0, 0])];
pub const FX2: [(System, [i32; 3]); 2] = [(System::Tool, [25, 15, 100]), (System::ToolOrigin, [-300, 0, 0])];
pub const HOLD: [(System, [i32; 3]); 2] = [(System::Tool, [-35, 5, -90]), (System::Roll, [9000, 0, 0])];
pub const SEAT: [(System, [i32; 3]); 2] = [(System::Tool, [-20, 5, -90]), (System::Roll, [9000, 0, 0])];
