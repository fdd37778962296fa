//! What a log holds, and how it gets into the file.
//!
//! | channel | message | written |
//! |---|---|---|
//! | `/replay` | `rcs.ReplayTick`: byte images of inputs, output buffers and states | every tick |
//! | `/external/...`, `/task/...`, `/prim/...` ... | the buffers, by field | on change, and once a second |
//! | `/task/row`, `/prim/row` ... | `rcs.Row`: the row that fired, as text | on change, and once a second |
//! | `/tf`, `/joint_states`, `/robot_description` | the moving cell | on change, and once a second |
//! | `/cell` | `rcs.CellTick`: digest of everything in the simulated cell | every tick |
//! | `/log` | `foxglove.Log` | when there is something to say |
//!
//! `/replay` alone is lossless: message *n* holds the difference of the images to those of message *n*-1, and
//! once a second the whole images and the states after that tick, where a replay can start. The other
//! channels are the same values for people.
//!
//! Once a second of simulated time the open chunk is written out, and the next one begins with everything:
//! what a killed run loses, and how far a viewer must look back, is a second.

use std::{
    collections::BTreeMap,
    io::{Seek, Write},
};

use levels::ladder::LadderState;
use mcap::{Compression, McapResult, WriteOptions, records::Metadata};
use prost_types::field_descriptor_proto::Type;
use rcs_core::{
    interface::{CommonMemory, ExternalInputs},
    record::{Field, Writer},
    tick::Tick,
};

use crate::{
    channels::{Buffers, HeaderPlace, Output, Rows, headers},
    delta,
    input::{Attachment, CellFrame, End, Setup},
    layout,
    proto::{
        descriptor::{self, encode_set, field, file},
        foxglove::{self, Level},
        wire,
    },
    recorder::Lost,
    remarks::{Remark, remarks},
    scene::Scene,
};

/// Ticks from one full set to the next: a second.
pub const FULL_SET: u64 = 25;
/// Uncompressed size at which a chunk is closed before its second is over, bytes.
const CHUNK: u64 = 64 * 1024;
/// Name of the metadata written at the start.
pub const RUN: &str = "rcs-run";
/// Name of the metadata written at the end.
pub const END: &str = "rcs-end";
/// Key of the layout version in [`RUN`].
pub const LAYOUT: &str = "layout";
/// Topic of the byte images.
pub const REPLAY: &str = "/replay";
/// Topic of the log lines.
pub const LOG_TOPIC: &str = "/log";

/// Field numbers of the message on [`REPLAY`].
pub mod replay_field {
    /// The tick.
    pub const TICK: u32 = 1;
    /// Ticks that are missing before this one.
    pub const GAP: u32 = 2;
    /// The images are differences from zeros, not from the message before.
    pub const FULL: u32 = 3;
    /// Inputs of the tick.
    pub const EXTERNAL: u32 = 4;
    /// Output buffers after the tick.
    pub const MEMORY: u32 = 5;
    /// States of the processes after the tick; the whole image, not in every message.
    pub const STATE: u32 = 6;
}

/// Everything that the ladder read and wrote in a tick.
#[derive(Clone, Copy, Debug)]
pub struct TickRecord {
    /// The tick.
    pub tick: Tick,
    /// Ticks before this one that found no room in the ring.
    pub gap: u32,
    /// What the processes read from outside.
    pub external: ExternalInputs,
    /// What they wrote.
    pub memory: CommonMemory,
}

/// A log that is being written.
pub struct LogWriter<W: Write + Seek> {
    output: Output<W>,
    replay: u16,
    log: u16,
    external: Buffers,
    memory: Buffers,
    rows: Rows,
    headers: Vec<HeaderPlace>,
    scene: Option<Scene>,
    last: Images,
    now: Images,
    before: CommonMemory,
    last_full: Option<Tick>,
    ticks: u64,
    gaps: u64,
}

/// The byte images of a tick.
struct Images {
    external: Vec<u8>,
    memory: Vec<u8>,
}

impl Images {
    fn zeros() -> Self {
        Self { external: vec![0; ExternalInputs::SIZE], memory: vec![0; CommonMemory::SIZE] }
    }
}

impl<W: Write + Seek> LogWriter<W> {
    /// Begin a log: metadata, attachments, channels.
    ///
    /// # Errors
    /// What `sink` says.
    pub fn create(sink: W, setup: Setup) -> McapResult<Self> {
        // A profile would promise a viewer that all channels follow its rules.
        let options = WriteOptions::new()
            .profile("")
            .library(concat!("rcs-record ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Lz4))
            .compression_level(6)
            .chunk_size(Some(CHUNK));
        let mut output = Output { mcap: options.create(sink)?, epoch: setup.epoch };
        write_head(&mut output, &setup)?;
        output.mcap.flush()?;
        let external = Buffers::external(&mut output)?;
        let memory = Buffers::memory(&mut output)?;
        let rows = Rows::open(&mut output)?;
        let scene = setup.cell.map(|model| Scene::open(&mut output, model)).transpose()?;
        let log = output.protobuf(LOG_TOPIC, foxglove::LOG, &foxglove::log_descriptor())?;
        let replay = output.protobuf(REPLAY, "rcs.ReplayTick", &replay_descriptor())?;
        Ok(Self {
            output,
            replay,
            log,
            external,
            memory,
            rows,
            headers: headers(),
            scene,
            last: Images::zeros(),
            now: Images::zeros(),
            before: CommonMemory::default(),
            last_full: None,
            ticks: 0,
            gaps: 0,
        })
    }

    /// Write a tick. `state` holds the states after it, and is best given with the first tick, once a second,
    /// and after a gap.
    ///
    /// # Errors
    /// What the sink says.
    pub fn tick(
        &mut self,
        record: &TickRecord,
        state: Option<&LadderState>,
        cell: Option<&CellFrame>,
    ) -> McapResult<()> {
        let tick = record.tick;
        let due = self.last_full.is_none_or(|last| tick.since(last) >= FULL_SET);
        let full = due || record.gap > 0;
        if full {
            // The second that ends here is safe before the next one begins.
            if self.last_full.is_some() {
                self.output.mcap.flush()?;
            }
            self.last_full = Some(tick);
        }
        record.external.encode(&mut Writer::new(&mut self.now.external));
        record.memory.encode(&mut Writer::new(&mut self.now.memory));
        self.put_replay(record, state, full)?;
        if record.gap > 0 {
            self.gaps += 1;
            let text = format!("{} ticks are missing before this one: the log could not keep up", record.gap);
            self.remark(
                tick,
                &Remark { level: Level::Warning, source: "log".into(), text, ..Remark::default() },
            )?;
        }
        self.external.write(&mut self.output, tick, &self.last.external, &self.now.external, full)?;
        self.memory.write(&mut self.output, tick, &self.last.memory, &self.now.memory, full)?;
        self.rows.write(&mut self.output, tick, &self.now.memory, full)?;
        if let (Some(scene), Some(frame)) = (&mut self.scene, cell) {
            scene.write(&mut self.output, frame, full)?;
        }
        for remark in remarks(&self.headers, &record.external.hws, &self.before, &record.memory) {
            self.remark(tick, &remark)?;
        }
        self.before = record.memory;
        std::mem::swap(&mut self.last, &mut self.now);
        self.ticks += 1;
        Ok(())
    }

    /// Write a line on `/log`.
    ///
    /// # Errors
    /// What the sink says.
    pub fn remark(&mut self, tick: Tick, remark: &Remark) -> McapResult<()> {
        let Remark { level, source, text, file, line } = remark;
        let mut data = Vec::new();
        foxglove::put_log(self.output.epoch.of(tick), *level, text, source, file, *line, &mut data);
        self.output.put(self.log, tick, &data)
    }

    /// Write a file that came up during the run.
    ///
    /// # Errors
    /// What the sink says.
    pub fn attach(&mut self, tick: Tick, attachment: Attachment) -> McapResult<()> {
        let time = self.output.epoch.of(tick);
        attach(&mut self.output, time, attachment)
    }

    /// End the log: metadata and summary.
    ///
    /// # Errors
    /// What the sink says.
    pub fn finish(mut self, end: &End, lost: Lost) -> McapResult<Written> {
        let digest = end.digest.map_or_else(String::new, |digest| format!("{digest:016x}"));
        let entries = [
            ("digest", digest),
            ("result", end.result.clone()),
            ("ticks", self.ticks.to_string()),
            ("gaps", self.gaps.to_string()),
            ("lost_ticks", lost.ticks.to_string()),
            ("lost_frames", lost.frames.to_string()),
            ("lost_notes", lost.notes.to_string()),
            ("lost_files", lost.files.to_string()),
        ];
        let metadata = entries.map(|(key, value)| (key.to_owned(), value));
        self.output.mcap.write_metadata(&Metadata { name: END.into(), metadata: metadata.into() })?;
        self.output.mcap.finish()?;
        let mut sink = self.output.mcap.into_inner();
        sink.flush()?;
        Ok(Written { ticks: self.ticks, bytes: sink.stream_position()? })
    }

    fn put_replay(&mut self, record: &TickRecord, state: Option<&LadderState>, full: bool) -> McapResult<()> {
        if full {
            self.last = Images::zeros();
        }
        let mut data = Vec::new();
        wire::unsigned(replay_field::TICK, record.tick.0, &mut data);
        wire::unsigned(replay_field::GAP, record.gap.into(), &mut data);
        wire::unsigned(replay_field::FULL, full.into(), &mut data);
        let (last, now) = (&self.last, &self.now);
        wire::nested(replay_field::EXTERNAL, &mut data, |out| {
            delta::encode(&last.external, &now.external, out)
        });
        wire::nested(replay_field::MEMORY, &mut data, |out| delta::encode(&last.memory, &now.memory, out));
        if let Some(state) = state {
            let mut image = vec![0; LadderState::SIZE];
            state.encode(&mut Writer::new(&mut image));
            let zeros = vec![0; LadderState::SIZE];
            wire::nested(replay_field::STATE, &mut data, |out| delta::encode(&zeros, &image, out));
        }
        self.output.put(self.replay, record.tick, &data)
    }
}

/// What became of a log that was finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Ticks in it.
    pub ticks: u64,
    /// Bytes of the file.
    pub bytes: u64,
}

/// Metadata and attachments: written first, so that they survive whatever happens to the run.
fn write_head<W: Write + Seek>(output: &mut Output<W>, setup: &Setup) -> McapResult<()> {
    let mut run: BTreeMap<String, String> = setup.run.clone();
    run.insert(LAYOUT.into(), layout::version());
    output.mcap.write_metadata(&Metadata { name: RUN.into(), metadata: run })?;
    let mut attachments = setup.attachments.clone();
    attachments.push(Attachment::text(Attachment::LAYOUT, &layout::description()));
    if let Some(cell) = &setup.cell {
        let urdf = Attachment::text(Attachment::URDF, &cell.urdf);
        attachments.push(Attachment { media_type: "application/xml".into(), ..urdf });
    }
    let time = setup.epoch.of(Tick::BEFORE_START);
    attachments.into_iter().try_for_each(|attachment| attach(output, time, attachment))
}

fn attach<W: Write + Seek>(output: &mut Output<W>, time: u64, attachment: Attachment) -> McapResult<()> {
    let Attachment { name, media_type, data } = attachment;
    let data = data.into();
    output.mcap.attach(&mcap::Attachment { log_time: time, create_time: time, name, media_type, data })
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
    ];
    let message = descriptor::message("ReplayTick", fields);
    encode_set(vec![file("rcs.proto", descriptor::PACKAGE, &[], vec![message])])
}
