//! Openings and forces of the grippers in SI units: `/instruments`, because viewers cannot convert.

use std::io::{Seek, Write};

use interfaces::CommonMemory;
use mcap::McapResult;
use rcs_core::tick::Tick;

use crate::{
    channels::Output,
    contacts::INCH,
    proto::typed::{self, messages},
};

pub const INSTRUMENTS: &str = "/instruments";

const POUND: f64 = 4.448_221_615_260_5; // a pound, newtons

messages! {
    /// Statuses of the grippers.
    Instruments {
        /// Opening of the parts gripper, metres.
        parts_gripper_m: f64,
        /// Opening of the v-gripper, metres.
        v_gripper_m: f64,
        /// Opening of the tool gripper, metres.
        tool_gripper_m: f64,
        /// Opening of the pedestal's hand, metres.
        pedestal_m: f64,
        /// Force on the left finger of the parts gripper, newtons.
        left_finger_n: f64,
        /// Force on its right finger, newtons.
        right_finger_n: f64,
        /// Force on the left finger of the pedestal's hand, newtons.
        pedestal_left_n: f64,
        /// Force on its right finger, newtons.
        pedestal_right_n: f64,
    }
}

pub(crate) struct InstrumentsChannel {
    id: u16,
    last: Option<Instruments>,
}

impl InstrumentsChannel {
    pub fn open<W: Write + Seek>(output: &mut Output<W>) -> McapResult<Self> {
        let (name, descriptors) = (typed::name::<Instruments>(), typed::descriptor_set::<Instruments>());
        Ok(Self { id: output.protobuf(INSTRUMENTS, &name, &descriptors)?, last: None })
    }

    /// Write the values after a tick if they have changed or are `due`.
    pub fn write<W: Write + Seek>(
        &mut self,
        output: &mut Output<W>,
        tick: Tick,
        memory: &CommonMemory,
        due: bool,
    ) -> McapResult<()> {
        let now = Some(read(memory));
        if due || self.last != now {
            self.last = now;
            self.last.iter().try_for_each(|message| output.put(self.id, tick, &typed::encode(message)))?;
        }
        Ok(())
    }
}

fn read(memory: &CommonMemory) -> Instruments {
    let metres = |hundredths: i32| f64::from(hundredths) * INCH / 100.0;
    let newtons = |pounds: i32| f64::from(pounds) * POUND;
    let (grip, hand) = (&memory.grip.status, &memory.hand.status);
    Instruments {
        parts_gripper_m: metres(grip.position),
        v_gripper_m: metres(memory.v_grip.status.size),
        tool_gripper_m: metres(memory.tool_grip.status.size),
        pedestal_m: metres(hand.position),
        left_finger_n: newtons(grip.left_force),
        right_finger_n: newtons(grip.right_force),
        pedestal_left_n: newtons(hand.left_force),
        pedestal_right_n: newtons(hand.right_force),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inches_and_pounds_become_metres_and_newtons() {
        let mut memory = CommonMemory::default();
        (memory.grip.status.position, memory.hand.status.left_force) = (250, 10);
        let read = read(&memory);
        assert!((read.parts_gripper_m - 0.0635).abs() < 1e-12);
        assert!((read.pedestal_left_n - 44.482_216_152_605).abs() < 1e-9);
    }
}
