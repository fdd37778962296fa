//! Content of a log, and its output to the file.
//!
//! | channel | message | written |
//! |---|---|---|
//! | `/replay` | `rcs.ReplayTick`: byte images of inputs, output buffers and states | every tick |
//! | `/external/...`, `/task/...`, `/prim/...` ... | the buffers, by field | on change, and every ten seconds |
//! | `/task/row`, `/prim/row` ... | `rcs.Row`: the row that fired, as text | on change, and every ten seconds |
//! | `/tf`, `/joint_states`, `/robot_description` | the moving cell | on change, and every ten seconds |
//! | `/meshes`, `/names` | shapes and names of bodies | at the start |
//! | `/trail`, `/camera` | the path of the tool point, the pictures that vision analysed | once a second, on an answer |
//! | `/ladder` | command, status and row of all processes | on change |
//! | `/instruments` | openings and forces of the grippers in SI units | on change, and every ten seconds |
//! | `/job/lines`, `/job/state`, `/operator/state`, `/cell/controller`, `/cell/parts`, `/cell/places` | the run outside the buffers ([`crate::views`]) | on change, and every ten seconds |
//! | `/contacts` | a mark at each contact of the robot or its load | on change |
//! | `/log` | `foxglove.Log` | when there is a remark |
//! | `/operator` | `rcs.OperatorLine` | on a request of an operator |
//!
//! Only `/replay` is lossless. It has differences and, once per second, the whole images and states, where a replay can
//! start. On the other channels a clock or a counter is not a change ([`crate::channels`]).
//!
//! Once per second the open chunk is written out, then a chunk with the messages of that second on `/replay`: a killed
//! run loses a second. Unchanged buffers are repeated less often, because each message costs sixteen bytes of index.

use std::{
    collections::BTreeMap,
    io::{Seek, Write},
};

use interfaces::{CommonMemory, ExternalInputs, HwsCommand};
use levels::ladder::LadderState;
use mcap::{Compression, McapResult, WriteOptions, records::Metadata};
use os_io::text::amount;
use rcs_core::{Plain, plain::Writer, tick::Tick};

use crate::{
    channels::{Buffers, HeaderPlace, Output, headers},
    input::{Attachment, CellFrame, End, Lost, Setup, Shown},
    instruments::InstrumentsChannel,
    ladder::LadderChannel,
    layout,
    lossless::{Images, Lossless},
    names::{EARLIER, END, LAYOUT, LOG_TOPIC, RESULT, RUN},
    operator::{OperatorChannel, OperatorLine},
    proto::foxglove::{self, Level},
    remarks::{Remark, remarks},
    rows::Rows,
    scene::Scene,
    tap::Tap,
    views::{View, Views},
};

/// Ticks between two sets of whole images and states: a second.
pub const FULL_SET: u64 = 25;
/// Number of full sets between two repetitions of all buffers for viewers: ten seconds.
const REPETITION: u64 = 10;
/// Uncompressed size at which a chunk is closed early, bytes: three times a second of a moving cell.
const CHUNK: u64 = 256 * 1024;
/// Level of the compression. At level 6 a log is a twenty-sixth smaller, and a run takes a seventh more processor time.
const COMPRESSION: u32 = 3;

/// Everything that the ladder read and wrote in a tick.
#[derive(Clone, Copy, Debug)]
pub struct TickRecord {
    pub tick: Tick,
    /// Number of ticks before this one that did not fit into the ring.
    pub gap: u32,
    pub external: ExternalInputs,
    pub memory: CommonMemory,
    /// Times of the tick; `None` in a run whose log must have the same bytes each time.
    pub timing: Option<Timing>,
}

/// Times of a tick. They are not part of the digest, and a replay ignores them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    pub controller_ns: u64, // nanoseconds
    pub skipped: u64,       // of the 40 ms grid, since the start
}

pub struct LogWriter<W: Write + Seek> {
    output: Output<W>,
    lossless: Lossless,
    log: u16,
    external: Buffers,
    memory: Buffers,
    rows: Rows,
    headers: Vec<HeaderPlace>,
    scene: Option<Scene>,
    ladder: LadderChannel,
    instruments: InstrumentsChannel,
    views: Views,
    action_began: u64, // begin of the last workstation action of the job on `/log`
    operator: OperatorChannel,
    last: Images,
    now: Images,
    before: CommonMemory,
    /// The last tick, the workstation's command in it, and true if all buffers were written.
    ended: Option<(Tick, HwsCommand, bool)>,
    last_full: Option<Tick>,
    full_sets: u64,
    ticks: u64,
    gaps: u64,
    /// Name of the log with the ticks before those of this one, until its first tick.
    earlier: Option<String>,
}

impl<W: Write + Seek> LogWriter<W> {
    pub fn create(sink: W, setup: Setup) -> McapResult<Self> {
        Self::create_with(sink, setup, None)
    }

    /// Like [`LogWriter::create`], with a tap for all channels and messages. Fails like `sink`.
    pub fn create_with(sink: W, setup: Setup, tap: Option<Box<dyn Tap>>) -> McapResult<Self> {
        // The log has no profile, because a profile sets rules for all channels.
        let options = WriteOptions::new()
            .profile("")
            .library(concat!("rcs-record ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_level(COMPRESSION)
            .compression_threads(0)
            .chunk_size(Some(CHUNK));
        let mut output = Output { mcap: options.create(sink)?, epoch: setup.epoch, tap };
        write_head(&mut output, &setup)?;
        output.mcap.flush()?;
        let external = Buffers::external(&mut output)?;
        let memory = Buffers::memory(&mut output)?;
        let rows = Rows::open(&mut output)?;
        let scene = setup.cell.map(|model| Scene::open(&mut output, model)).transpose()?;
        let log = output.protobuf(LOG_TOPIC, foxglove::LOG, &foxglove::log_descriptor())?;
        let lossless = Lossless::open(&mut output)?;
        let ladder = LadderChannel::open(&mut output)?;
        let instruments = InstrumentsChannel::open(&mut output)?;
        let views = Views::open(&mut output)?;
        Ok(Self {
            output,
            lossless,
            log,
            external,
            memory,
            rows,
            headers: headers(),
            scene,
            ladder,
            instruments,
            views,
            action_began: 0,
            operator: OperatorChannel::default(),
            last: Images::zeros(),
            now: Images::zeros(),
            before: CommonMemory::default(),
            ended: None,
            last_full: None,
            full_sets: 0,
            ticks: 0,
            gaps: 0,
            earlier: None,
        })
    }

    pub(crate) const fn has_ticks(&self) -> bool {
        self.ticks > 0
    }

    /// Continue the run of another log, which now has this name. The tap, which already has the channels, is passed on.
    pub(crate) fn continue_run<E: Write + Seek>(&mut self, ended: &mut LogWriter<E>, name: String) {
        self.output.tap = ended.output.tap.take();
        self.before = ended.before;
        self.views.continue_run(&mut ended.views);
        self.action_began = ended.action_began;
        self.earlier = Some(name);
    }

    /// `state` has the states after the tick. Pass it with the first tick, once per second, and after a gap.
    pub fn tick(
        &mut self,
        record: &TickRecord,
        state: Option<&LadderState>,
        cell: Option<&CellFrame>,
    ) -> McapResult<()> {
        let tick = record.tick;
        let due = self.last_full.is_none_or(|last| tick.since(last) >= FULL_SET);
        let full = due || record.gap > 0;
        let all = full && (record.gap > 0 || self.full_sets.is_multiple_of(REPETITION));
        self.full_sets += u64::from(full);
        if full {
            // The second that ends here is written before the next one begins.
            if self.last_full.is_some() {
                self.lossless.end_second(&mut self.output)?;
            }
            self.last_full = Some(tick);
        }
        record.external.encode(&mut Writer::new(&mut self.now.external));
        record.memory.encode(&mut Writer::new(&mut self.now.memory));
        let images = (&self.last, &self.now);
        let world = cell.and_then(|frame| frame.digest);
        self.lossless.note(&mut self.output, record, images, (state, world), full);
        if let Some(earlier) = self.earlier.take() {
            let text = format!("{EARLIER}{earlier}");
            self.remark(
                tick,
                &Remark { level: Level::Info, source: "log".into(), text, ..Remark::default() },
            )?;
        } else if record.gap > 0 {
            self.gaps += 1;
            let text = format!(
                "missing before this tick: {}; the log could not keep up",
                amount(record.gap, "tick")
            );
            self.remark(
                tick,
                &Remark { level: Level::Warning, source: "log".into(), text, ..Remark::default() },
            )?;
        }
        self.write_state(tick, (&record.external.hws, &record.memory), all)?;
        if let (Some(scene), Some(frame)) = (&mut self.scene, cell) {
            scene.write(&mut self.output, frame, all)?;
        }
        for remark in remarks(&self.headers, &record.external.hws, &self.before, &record.memory) {
            self.remark(tick, &remark)?;
        }
        self.before = record.memory;
        self.ended = Some((tick, record.external.hws, all));
        std::mem::swap(&mut self.last, &mut self.now);
        self.ticks += 1;
        self.output.end_tick(tick);
        Ok(())
    }

    fn write_state(
        &mut self,
        tick: Tick,
        (hws, memory): (&HwsCommand, &CommonMemory),
        all: bool,
    ) -> McapResult<()> {
        let Self { output, last, now, .. } = self;
        self.external.write(output, tick, &last.external, &now.external, all)?;
        self.memory.write(output, tick, &last.memory, &now.memory, all)?;
        self.rows.write(output, tick, &now.memory, all)?;
        self.ladder.write(output, tick, (hws, memory), all)?;
        self.instruments.write(output, tick, memory, all)?;
        if all { self.views.repeat(output, tick, self.ticks == 0) } else { Ok(()) }
    }

    /// Write the whole state once more in the last tick, so that state timelines in a viewer last to the end.
    fn write_last_state(&mut self) -> McapResult<()> {
        let Some((tick, hws, false)) = self.ended else { return Ok(()) };
        std::mem::swap(&mut self.last, &mut self.now);
        let memory = self.before;
        self.write_state(tick, (&hws, &memory), true)
    }

    pub fn remark(&mut self, tick: Tick, remark: &Remark) -> McapResult<()> {
        let Remark { level, source, text, file, line } = remark;
        let mut data = Vec::new();
        foxglove::put_log(self.output.epoch.of(tick), *level, text, source, file, *line, &mut data);
        self.output.put(self.log, tick, &data)
    }

    /// A log without a cell has no channels for pictures and contacts.
    pub fn show(&mut self, tick: Tick, shown: &Shown) -> McapResult<()> {
        match (shown, &self.scene) {
            (Shown::View(view), _) => {
                self.views.put(&mut self.output, tick, view)?;
                self.note_action(tick, view)
            }
            (Shown::Picture(png), Some(scene)) => scene.picture(&mut self.output, tick, png),
            (Shown::Touches(touches), Some(scene)) => scene.touches(&mut self.output, tick, touches),
            (Shown::Picture(_) | Shown::Touches(_), None) => Ok(()),
        }
    }

    fn note_action(&mut self, tick: Tick, view: &View) -> McapResult<()> {
        let View::JobState(job) = view else { return Ok(()) };
        if job.is_command || job.began == self.action_began || job.text.is_empty() {
            return Ok(());
        }
        self.action_began = job.began;
        let text = format!("line {} of {}: {}", job.index, job.lines, job.text);
        self.remark(tick, &Remark { source: "job".into(), text, ..Remark::default() })
    }

    pub fn operator(&mut self, line: &OperatorLine) -> McapResult<()> {
        self.operator.put(&mut self.output, line)
    }

    pub fn attach(&mut self, tick: Tick, attachment: Attachment) -> McapResult<()> {
        let time = self.output.epoch.of(tick);
        attach(&mut self.output, time, attachment)
    }

    /// End the log: metadata and summary. Fails like the sink.
    pub fn finish(mut self, end: &End, lost: Lost) -> McapResult<Written> {
        let digest = end.digest.map_or_else(String::new, |digest| format!("{digest:016x}"));
        let entries = [
            ("digest", digest),
            (RESULT, end.result.clone()),
            ("ticks", self.ticks.to_string()),
            ("gaps", self.gaps.to_string()),
            ("lost_ticks", lost.ticks.to_string()),
            ("lost_frames", lost.frames.to_string()),
            ("lost_notes", lost.notes.to_string()),
            ("lost_files", lost.files.to_string()),
            ("lost_shown", lost.shown.to_string()),
            ("lost_operators", lost.operators.to_string()),
        ];
        let mut metadata = end.facts.clone();
        metadata.extend(entries.map(|(key, value)| (key.to_owned(), value)));
        self.write_last_state()?;
        self.lossless.end_second(&mut self.output)?;
        self.output.mcap.write_metadata(&Metadata { name: END.into(), metadata })?;
        self.output.mcap.finish()?;
        let mut sink = self.output.mcap.into_inner();
        sink.flush()?;
        Ok(Written { ticks: self.ticks, bytes: sink.stream_position()? })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    pub ticks: u64,
    pub bytes: u64,
}

/// Writes metadata and attachments first, so that a failure of the run cannot lose them.
fn write_head<W: Write + Seek>(output: &mut Output<W>, setup: &Setup) -> McapResult<()> {
    let mut run: BTreeMap<String, String> = setup.run.clone();
    run.insert(LAYOUT.into(), layout::version());
    output.mcap.write_metadata(&Metadata { name: RUN.into(), metadata: run })?;
    let mut attachments = setup.attachments.clone();
    attachments.push(Attachment::text(Attachment::LAYOUT, layout::description()));
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
