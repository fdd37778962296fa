//! Recorded scenes with many contacts, for the determinism tests and the speed measurements.

use geometry::{
    frame::{Frame, Vector},
    pose::Pose,
};
use interfaces::device::JawValves;
use plant::{
    CellDescription, Placement,
    WorkstationAction::{self, DrumGrip, DrumRelease, DrumTool, ViseClose, ViseOpen, VisePartial},
};

use super::{CELL, FIX_V1, FX1, HOLD, Rig, SEAT, description};

pub const TOOL_V1: Pose =
    Pose { wrist: [2757, -2683, 2321], tool: [5597, -3497, 1800], finger: [5987, -1052, 105] };
pub const TOOL_SAFE: Pose =
    Pose { wrist: [5298, -2322, 1559], tool: [8296, -2431, 1585], finger: [8357, -1417, -1238] };

pub fn with_tool_gripper() -> CellDescription {
    CellDescription::from_toml(&CELL.replace("mounted = \"parts\"", "mounted = \"tool\"")).unwrap()
}

/// Four blanks in a tray; the fourth is picked, dropped into the vise, gripped while it closes, and pushed to the back.
pub fn clamping(seed: u64) -> Rig {
    let mut rig = Rig::taped(&description(), seed);
    for sector in 1..=3 {
        let (part, unit, placement) = ("LINKBAR1_BH".into(), "UNIT_1".into(), Placement::Random);
        rig.work(WorkstationAction::Place { part, unit, sector, placement });
    }
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 20.0);
    rig.vise(VisePartial);
    rig.pick(0.0, 0.0, 20.0, 30.0);
    rig.carry();
    rig.insert();
    rig.open(0.9);
    rig.ticks(10);
    rig.close(30.0);
    rig.vise(ViseClose);
    rig.open(3.5);
    rig.go(Rig::fixture(&FX1, 8.0, 0.0), 4.0);
    rig.go(Rig::fixture(&HOLD, 5.0, 0.0), 4.0);
    rig.close(40.0);
    rig.go_and_stop(Rig::fixture(&HOLD, 0.0, 0.0), 0.5);
    rig.vise(ViseOpen);
    rig.go_and_stop(Rig::fixture(&SEAT, 0.0, 0.0), 0.5);
    rig.ticks(25);
    rig
}

fn at_drum(rig: &Rig, x: f64) -> Frame {
    rig.description.drum.pose.frame().unwrap().shifted(Vector::new(x, 0.0, 0.0))
}

fn gripped_in_drum(seed: u64) -> Rig {
    let mut rig = Rig::taped(&with_tool_gripper(), seed);
    rig.work(DrumTool { part: "ENDMILL-1".into() });
    for via in [FIX_V1, TOOL_V1, TOOL_SAFE] {
        rig.go(via.to_frame().unwrap(), 10.0);
    }
    jaws(&mut rig, true);
    rig.go(at_drum(&rig, -3.0), 4.0);
    rig.go_and_stop(at_drum(&rig, 0.0), 1.0);
    jaws(&mut rig, false);
    rig.work(DrumRelease);
    rig
}

/// A tool is gripped in the drum, pulled half out against the detents, pushed back, and gripped by the drum.
pub fn drumming(seed: u64) -> Rig {
    let mut rig = gripped_in_drum(seed);
    rig.go_and_stop(at_drum(&rig, -0.2), 0.1);
    rig.go_and_stop(at_drum(&rig, 0.0), 0.1);
    rig.work(DrumGrip);
    jaws(&mut rig, true);
    rig.go_and_stop(at_drum(&rig, -3.0), 2.0);
    rig
}

pub fn with_tool_in_hand(seed: u64) -> Rig {
    let mut rig = gripped_in_drum(seed);
    rig.go_and_stop(at_drum(&rig, -6.0), 0.5);
    rig
}

fn jaws(rig: &mut Rig, open: bool) {
    rig.outputs.tool_grip = JawValves { open, close: !open };
    rig.ticks(60);
    rig.outputs.tool_grip = JawValves::default();
    rig.ticks(5);
}
