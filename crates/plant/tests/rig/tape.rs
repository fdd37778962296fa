//! Inputs of a cell in each tick and its digests, so that a restored cell can be given the same inputs.

use geometry::frame::Frame;
use interfaces::device::DeviceOutputs;
use plant::{Cell, WorkstationAction};

#[derive(Clone, Debug, Default)]
pub struct Beat {
    pub actions: Vec<WorkstationAction>,
    pub plate: Option<Frame>,
    pub outputs: DeviceOutputs,
}

impl Beat {
    pub fn play(&self, cell: &mut Cell) {
        if let Some(plate) = &self.plate {
            cell.drive(plate).unwrap();
        }
        for action in &self.actions {
            cell.workstation(action).unwrap();
        }
        cell.step(&self.outputs);
        cell.events();
    }
}

#[derive(Debug, Default)]
pub struct Tape {
    pub beats: Vec<Beat>,
    pub digests: Vec<u64>,
}

impl Tape {
    pub fn note(&mut self, beat: Beat, cell: &Cell) {
        self.beats.push(beat);
        self.digests.push(cell.digest());
    }

    pub fn chain(&self) -> u64 {
        let mut chain = rcs_core::digest::Digest::new();
        self.digests.iter().for_each(|digest| chain.add(&digest.to_le_bytes()));
        chain.value()
    }
}
