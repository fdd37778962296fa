//! The lossless channel, `/replay`: byte images of inputs and outputs of every tick, as differences.
//!
//! The messages are buffered until the end of their second.

use std::io::{Seek, Write};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::LadderState;
use mcap::McapResult;
use prost_types::field_descriptor_proto::Type;
use rcs_core::{Plain, plain::Writer, tick::Tick};

use crate::{
    channels::Output,
    delta::Codec,
    names::REPLAY,
    proto::{
        descriptor::{self, encode_set, field, file},
        wire,
    },
    writer::{TickRecord, Timing},
};

/// Field numbers of the message on [`REPLAY`].
pub mod replay_field {
    pub const TICK: u32 = 1;
    pub const GAP: u32 = 2; // missing ticks before this one
    pub const FULL: u32 = 3; // differences from zeros, not from the previous message
    pub const EXTERNAL: u32 = 4;
    pub const MEMORY: u32 = 5; // after the tick
    /// States of the processes after the tick, as a difference from zeros; not in every message.
    pub const STATE: u32 = 6;
    pub const WORLD: u32 = 7; // of the simulated cell, before the tick
    pub const CONTROLLER_NS: u32 = 8;
    pub const SKIPPED: u32 = 9;
}

pub(crate) struct Codecs {
    pub(crate) external: Codec,
    pub(crate) memory: Codec,
    pub(crate) state: Codec,
}

impl Codecs {
    pub(crate) fn new() -> Self {
        Self {
            external: Codec::new(ExternalInputs::STRUCT),
            memory: Codec::new(CommonMemory::STRUCT),
            state: Codec::new(LadderState::STRUCT),
        }
    }
}

pub(crate) struct Images {
    pub(crate) external: Vec<u8>,
    pub(crate) memory: Vec<u8>,
}

impl Images {
    pub(crate) fn zeros() -> Self {
        Self { external: vec![0; ExternalInputs::SIZE], memory: vec![0; CommonMemory::SIZE] }
    }
}

pub(crate) struct Lossless {
    channel: u16,
    second: Vec<(Tick, Vec<u8>)>, // messages of the present second
    codecs: Codecs,
    zeros: Images,
}

impl Lossless {
    pub fn open<W: Write + Seek>(output: &mut Output<W>) -> McapResult<Self> {
        let channel = output.protobuf(REPLAY, "rcs.ReplayTick", &replay_descriptor())?;
        Ok(Self { channel, second: Vec::new(), codecs: Codecs::new(), zeros: Images::zeros() })
    }

    /// Store a tick as a difference from the previous tick, or from zeros if it is `full`.
    pub fn note<W: Write + Seek>(
        &mut self,
        output: &mut Output<W>,
        record: &TickRecord,
        (last, now): (&Images, &Images),
        (state, world): (Option<&LadderState>, Option<u64>),
        full: bool,
    ) {
        let mut data = Vec::new();
        wire::unsigned(replay_field::TICK, record.tick.0, &mut data);
        wire::unsigned(replay_field::GAP, record.gap.into(), &mut data);
        wire::unsigned(replay_field::FULL, full.into(), &mut data);
        let last = if full { &self.zeros } else { last };
        wire::nested(replay_field::EXTERNAL, &mut data, |out| {
            self.codecs.external.encode(&last.external, &now.external, out);
        });
        wire::nested(replay_field::MEMORY, &mut data, |out| {
            self.codecs.memory.encode(&last.memory, &now.memory, out);
        });
        if let Some(state) = state {
            let mut image = vec![0; LadderState::SIZE];
            state.encode(&mut Writer::new(&mut image));
            let zeros = vec![0; LadderState::SIZE];
            wire::nested(replay_field::STATE, &mut data, |out| self.codecs.state.encode(&zeros, &image, out));
        }
        if let Some(world) = world {
            wire::fixed64(replay_field::WORLD, world, &mut data);
        }
        if let Some(Timing { controller_ns, skipped }) = record.timing {
            wire::unsigned(replay_field::CONTROLLER_NS, controller_ns, &mut data);
            wire::unsigned(replay_field::SKIPPED, skipped, &mut data);
        }
        output.pass(self.channel, record.tick, &data);
        self.second.push((record.tick, data));
    }

    /// Write the messages of a second into a separate chunk, so that a replay decompresses only a seventh of a log.
    pub fn end_second<W: Write + Seek>(&mut self, output: &mut Output<W>) -> McapResult<()> {
        output.mcap.flush()?;
        for (tick, data) in self.second.drain(..) {
            output.write(self.channel, tick, &data)?;
        }
        output.mcap.flush()
    }
}

fn replay_descriptor() -> Vec<u8> {
    let number = |field: u32| i32::try_from(field).unwrap_or(i32::MAX);
    let fields = vec![
        field("tick", number(replay_field::TICK), Type::Uint64),
        field("gap", number(replay_field::GAP), Type::Uint32),
        field("full", number(replay_field::FULL), Type::Bool),
        field("external", number(replay_field::EXTERNAL), Type::Bytes),
        field("memory", number(replay_field::MEMORY), Type::Bytes),
        field("state", number(replay_field::STATE), Type::Bytes),
        field("world", number(replay_field::WORLD), Type::Fixed64),
        field("controller_ns", number(replay_field::CONTROLLER_NS), Type::Uint64),
        field("skipped", number(replay_field::SKIPPED), Type::Uint64),
    ];
    let message = descriptor::message("ReplayTick", fields);
    encode_set(vec![file("rcs.proto", descriptor::PACKAGE, &[], vec![message])])
}
