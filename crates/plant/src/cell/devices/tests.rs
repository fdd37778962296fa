//! The devices of the shipped cell, driven by their outputs.

use interfaces::device::DeviceOutputs;

use super::*;
use crate::Placement;

const OUTPUTS: [&str; 9] = [
    "vise.PFIXTURE.open",
    "vise.PFIXTURE.partial",
    "vise.PFIXTURE.close",
    "vise.PFIXTURE.program",
    "machine.PFIXTURE.start",
    "machine.PFIXTURE.program",
    "drum.grip",
    "drum.release",
    "drum.tool",
];
const INPUTS: [&str; 16] = [
    "vise.PFIXTURE.opened",
    "vise.PFIXTURE.partial",
    "vise.PFIXTURE.clamped",
    "vise.PFIXTURE.program",
    "machine.PFIXTURE.ready",
    "machine.PFIXTURE.busy",
    "machine.PFIXTURE.done",
    "machine.PFIXTURE.fault",
    "machine.PFIXTURE.clear",
    "drum.gripped",
    "drum.released",
    "drum.tool",
    "tray.UNIT_1.4",
    "air",
    "safety.ok",
    "grip.potentiometer",
];

fn programs() -> Programs {
    let words = |words: [&str; 3]| words.map(str::to_owned);
    Programs {
        vise: vec![(1, "LINKBAR".into()), (2, "CLEVIS".into())],
        machine: vec![(17, words(["PFIXTURE", "LINKBAR1_BH", "LINKBAR1"]))],
        drum: vec![(4, "DRILL-2".into())],
    }
}

struct Bench {
    cell: Cell,
    devices: Devices,
    outputs: [i64; 9],
}

impl Bench {
    fn new() -> Self {
        let description = CellDescription::from_toml(include_str!("../../../../../data/cell.toml")).unwrap();
        let cell = Cell::new(&description, 1).unwrap();
        let devices = Devices::new(&description, programs(), OUTPUTS, INPUTS).unwrap();
        Self { cell, devices, outputs: [0; 9] }
    }

    fn set(&mut self, name: &str, value: i64) -> &mut Self {
        let at = OUTPUTS.iter().position(|one| *one == name).unwrap();
        self.outputs[at] = value;
        self
    }

    fn run(&mut self, ticks: u64) -> &mut Self {
        for _ in 0..ticks {
            self.devices.follow(&mut self.cell, &self.outputs);
            self.cell.step(&DeviceOutputs::default());
        }
        self
    }

    fn get(&self, name: &str) -> i64 {
        let mut values = Vec::new();
        self.devices.sense(&self.cell, &mut values);
        values[INPUTS.iter().position(|one| *one == name).unwrap()]
    }

    fn vise(&self) -> [i64; 3] {
        ["opened", "partial", "clamped"].map(|name| self.get(&format!("vise.PFIXTURE.{name}")))
    }
}

#[test]
fn vise_moves_by_its_outputs_and_stays_without_them() {
    let mut bench = Bench::new();
    assert_eq!((bench.vise(), bench.get("vise.PFIXTURE.program")), ([1, 0, 0], 1));
    bench.set("vise.PFIXTURE.partial", 1).set("vise.PFIXTURE.program", 2).run(1);
    assert_eq!(bench.vise(), [0, 0, 0], "it moves");
    bench.run(100);
    assert_eq!((bench.vise(), bench.get("vise.PFIXTURE.program")), ([0, 1, 0], 2));
    bench.set("vise.PFIXTURE.partial", 0).run(50);
    assert_eq!(bench.vise(), [0, 1, 0], "bistable");
    bench.set("vise.PFIXTURE.open", 1).set("vise.PFIXTURE.close", 1).run(50);
    assert_eq!(bench.vise(), [0, 1, 0], "contradicting valves move nothing");
    bench.set("vise.PFIXTURE.open", 0).run(200);
    assert_eq!(bench.vise(), [0, 0, 1]);
}

#[test]
fn machine_runs_for_its_time_and_reports_what_is_wrong() {
    let machine = |bench: &Bench| {
        ["ready", "busy", "done", "fault", "clear"].map(|name| bench.get(&format!("machine.PFIXTURE.{name}")))
    };
    let mut bench = Bench::new();
    assert_eq!(machine(&bench), [1, 0, 0, 0, 1]);
    bench.set("machine.PFIXTURE.start", 1).run(1);
    assert_eq!(machine(&bench), [0, 0, 0, 1, 1], "no program 0");
    bench.set("machine.PFIXTURE.start", 0).run(FAULT_TICKS);
    assert_eq!(machine(&bench), [1, 0, 0, 0, 1]);
    bench.set("machine.PFIXTURE.program", 17).set("machine.PFIXTURE.start", 1).run(MACHINING_TICKS - 1);
    assert_eq!(machine(&bench), [0, 1, 0, 0, 1]);
    bench.run(1);
    assert_eq!(machine(&bench), [0, 0, 0, 1, 1], "nothing is clamped");
    assert_eq!(
        bench.devices.messages(),
        [
            "the machine at PFIXTURE does not start: it has no program 0",
            "the machine at PFIXTURE stops: LINKBAR1_BH is to be machined, but nothing is clamped in the vise"
        ]
    );
}

#[test]
fn drum_brings_a_tool_once() {
    let mut bench = Bench::new();
    let drum = |bench: &Bench| ["drum.gripped", "drum.released", "drum.tool"].map(|name| bench.get(name));
    assert_eq!(drum(&bench), [0, 1, 0]);
    bench.set("drum.tool", 4).run(2);
    assert_eq!(drum(&bench), [1, 0, 4]);
    bench.set("drum.release", 1).run(1);
    assert_eq!(drum(&bench), [0, 1, 4]);
    bench.set("drum.tool", 0).run(1).set("drum.tool", 4).run(1);
    assert_eq!(bench.cell.parts().len(), 1, "a lost output brings no second tool");
    assert!(bench.devices.messages().is_empty());
}

#[test]
fn trays_and_supply_have_sensors() {
    let mut bench = Bench::new();
    assert_eq!((bench.get("tray.UNIT_1.4"), bench.get("air"), bench.get("safety.ok")), (0, 1, 1));
    let (part, unit) = ("LINKBAR1_BH".to_owned(), "UNIT_1".to_owned());
    let place = WorkstationAction::Place { part, unit, sector: 4, placement: Placement::Random };
    bench.cell.workstation(&place).unwrap();
    bench.cell.press(interfaces::station::Key::Press(EStop::Pedestal)).unwrap();
    assert_eq!((bench.get("tray.UNIT_1.4"), bench.get("safety.ok")), (1, 0));
}

#[test]
fn points_and_programs_of_other_cells_are_refused() {
    let cell = CellDescription::from_toml(include_str!("../../../../../data/cell.toml")).unwrap();
    let refused = |programs: Programs, outputs: &[&'static str], inputs: &[&'static str]| {
        Devices::new(&cell, programs, outputs.iter().copied(), inputs.iter().copied())
            .unwrap_err()
            .to_string()
    };
    let none = Programs::default;
    let said = refused(none(), &["vise.TABLE.open"], &[]);
    assert_eq!(said, "vise.TABLE.open: the cell description has its vise at PFIXTURE");
    assert!(refused(none(), &[], &["tray.UNIT_1.9"]).contains("UNIT_1 with 4 sectors"));
    assert!(refused(none(), &[], &["machine.TABLE.busy"]).contains("machines at PFIXTURE"));
    let wrong = Programs { vise: vec![(1, "CLEVISS".into())], ..none() };
    assert!(refused(wrong, &[], &[]).starts_with("program 1: the vise has no program CLEVISS"));
}
