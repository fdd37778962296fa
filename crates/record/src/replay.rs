//! Replay: executes the control processes again with the recorded inputs, and compares the outputs.
//!
//! The task data come from the log's attachments, the inputs from its ticks. Every output buffer of every tick is
//! compared bit for bit, and so are the states of the processes where the log has them. The first difference ends the
//! comparison, because later differences follow from it.
//!
//! Missing ticks cannot be computed; the replay continues with the states recorded with the first tick after the gap.
//! In the same way a replay can begin in the middle: states are recorded once a second. A replay with other task data
//! shows what they would have changed; it does not compare record numbers.

use std::{
    collections::BTreeMap,
    path::Path,
    sync::mpsc::sync_channel,
    thread,
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::{Ladder, LadderState};
use rcs_core::{
    Plain,
    digest::Digest,
    plain::{Writer, from_bytes},
    tick::{TICK_MS, Tick},
};
use taskdata::load::{Source, Store};

use crate::{
    channels::{HeaderPlace, headers},
    error::{ReadError, ReplayError},
    input::Attachment,
    layout::{self, Leaf},
    reader::{Log, LoggedTick},
    remarks::row_text,
};

/// Ticks that are handed over at once, and how many times as many are read ahead.
const AT_ONCE: usize = 64;
const AHEAD: usize = 4;

/// The first difference of a replay from the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The tick.
    pub tick: Tick,
    /// The process and the buffer: `prim.status`; `state.prim` for the state of a process.
    pub buffer: String,
    /// The field of the buffer.
    pub field: String,
    /// The recorded value.
    pub was: String,
    /// The computed value.
    pub is: String,
    /// The row by which the process decided in the replay.
    pub row: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { tick, buffer, field, was, is, row } = self;
        write!(f, "tick {tick}, buffer {buffer}, field {field}: was {was}, is {is}; {row}")
    }
}

/// The part of a log to replay, and the task data.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Task data instead of those in the log. Blocks that were loaded during the run are added to them.
    pub data: Option<Store>,
    /// The replay begins at the last recorded states before this tick.
    pub from: Option<Tick>,
    /// Last tick to compute.
    pub until: Option<Tick>,
}

impl Options {
    /// True if the digest of the run can be compared: the replay has all ticks and the same record numbers.
    const fn has_digest(&self) -> bool {
        self.from.is_none() && self.until.is_none() && self.data.is_none()
    }
}

/// Result of a replay.
#[derive(Clone, Debug)]
pub struct ReplayReport {
    /// Ticks that were computed again.
    pub ticks: u64,
    /// Ticks that could not be computed: those in gaps, and those at which the replay started again.
    pub skipped: u64,
    /// The first difference; `None` if there is none.
    pub first_difference: Option<Difference>,
    /// Digest of the output buffers of the computed ticks.
    pub digest: Digest,
    /// Digest at the end of the run; `None` if the log has no end.
    pub recorded_digest: Option<u64>,
    /// True if the log has its end.
    pub complete: bool,
    /// The damaged parts of the log, as text.
    pub damage: Option<String>,
    /// Time of the whole replay.
    pub elapsed: Duration,
}

impl ReplayReport {
    /// True if every computed tick was the same, and also the digest if the log has one and no tick was skipped.
    #[must_use]
    pub fn is_same(&self) -> bool {
        let digests = self.recorded_digest.is_none_or(|recorded| recorded == self.digest.value());
        self.first_difference.is_none() && (self.skipped > 0 || digests)
    }

    /// Ratio of the recorded time to the elapsed time of the replay.
    #[must_use]
    pub fn speed(&self) -> f64 {
        let simulated = Duration::from_millis(self.ticks.saturating_mul(TICK_MS));
        simulated.as_secs_f64() / self.elapsed.as_secs_f64().max(1e-9)
    }
}

/// Replay a whole log with its own task data.
///
/// # Errors
/// [`ReplayError`] if the log cannot be read, is of another layout, or its task data do not load. A difference is not
/// an error: it is in the report.
pub fn replay(path: &Path) -> Result<ReplayReport, ReplayError> {
    replay_with(path, &Options::default())
}

/// Replay a log, or a part of it.
///
/// # Errors
/// As [`replay`]; [`ReplayError::Empty`] if the part contains no tick.
pub fn replay_with(path: &Path, options: &Options) -> Result<ReplayReport, ReplayError> {
    let started = Instant::now();
    let log = Log::open(path)?;
    log.check_layout()?;
    let generations = match &options.data {
        Some(data) => grown(data.clone(), &log.attachments)?,
        None => generations(&log)?,
    };
    let mut replayer = Replayer::new(options.data.is_some());
    let first_difference = replayer.run(&log, options, &generations)?;
    if replayer.ticks == 0 {
        return Err(ReplayError::Empty);
    }
    let digest = log.end.as_ref().filter(|_| options.has_digest()).and_then(|end| end.get("digest"));
    Ok(ReplayReport {
        ticks: replayer.ticks,
        skipped: replayer.skipped,
        first_difference,
        digest: replayer.digest,
        recorded_digest: digest.and_then(|digest| u64::from_str_radix(digest, 16).ok()),
        complete: log.complete,
        damage: log.damage(),
        elapsed: started.elapsed(),
    })
}

/// The task data attached to a log.
///
/// # Errors
/// [`ReplayError::TaskData`] with the report of the loader.
pub fn task_data(log: &Log) -> Result<Store, ReplayError> {
    let (store, _) = Store::from_sources(log_sources(&log.attachments))
        .map_err(|report| ReplayError::TaskData(report.render(false)))?;
    Ok(store)
}

/// The task data among the attachments, in the order in which they were loaded.
pub(crate) fn log_sources(attachments: &[Attachment]) -> Vec<Source> {
    let source = |attachment: &Attachment| {
        Some(attachment.source(attachment.name.strip_prefix(Attachment::TASK_DATA)?))
    };
    attachments.iter().filter_map(source).collect()
}

/// The generations of a log's task data: as loaded, and after each reload.
///
/// # Errors
/// [`ReplayError::TaskData`] with the report of the loader.
pub fn generations(log: &Log) -> Result<Vec<Store>, ReplayError> {
    generations_of(log_sources(&log.attachments), &log.attachments)
}

/// The generations of task data after each reload among the attachments.
pub(crate) fn generations_of(
    sources: Vec<Source>,
    attachments: &[Attachment],
) -> Result<Vec<Store>, ReplayError> {
    let (first, _) =
        Store::from_sources(sources).map_err(|report| ReplayError::TaskData(report.render(false)))?;
    grown(first, attachments)
}

/// A store, and the stores after each reload among the attachments.
pub(crate) fn grown(first: Store, attachments: &[Attachment]) -> Result<Vec<Store>, ReplayError> {
    let mut generations = vec![first];
    let mut reloads: BTreeMap<u32, Vec<Source>> = BTreeMap::new();
    for (generation, source) in attachments.iter().filter_map(Attachment::as_reload) {
        reloads.entry(generation).or_default().push(source);
    }
    for sources in reloads.into_values() {
        let newest = generations.last().cloned().unwrap_or_default();
        let (store, _) =
            newest.with_blocks(sources).map_err(|report| ReplayError::TaskData(report.render(false)))?;
        generations.push(store);
    }
    Ok(generations)
}

struct Replayer {
    ladder: Ladder,
    /// Common memory after the tick before; `None` if the replay needs recorded states to continue.
    before: Option<CommonMemory>,
    last: Tick,
    image: Vec<u8>,
    state: Vec<u8>,
    memory_leaves: Vec<Leaf>,
    state_leaves: Vec<Leaf>,
    headers: Vec<HeaderPlace>,
    digest: Digest,
    ticks: u64,
    skipped: u64,
}

impl Replayer {
    /// `by_name`: compare records by name instead of number, for other task data than those of the log.
    fn new(by_name: bool) -> Self {
        let leaves = |record| {
            let mut leaves = layout::leaves(record);
            leaves.retain(|leaf| !by_name || !leaf.is_record_number());
            leaves
        };
        Self {
            ladder: Ladder::default(),
            before: Some(CommonMemory::default()),
            last: Tick::BEFORE_START,
            image: vec![0; CommonMemory::SIZE],
            state: vec![0; LadderState::SIZE],
            memory_leaves: leaves(CommonMemory::STRUCT),
            state_leaves: leaves(LadderState::STRUCT),
            headers: headers(),
            digest: Digest::new(),
            ticks: 0,
            skipped: 0,
        }
    }

    /// Compute the ticks of a log up to the first difference. Another thread reads ahead.
    fn run(
        &mut self,
        log: &Log,
        options: &Options,
        generations: &[Store],
    ) -> Result<Option<Difference>, ReplayError> {
        thread::scope(|scope| {
            let (sender, receiver) = sync_channel(AHEAD);
            scope.spawn(move || {
                let mut ticks = log.ticks();
                loop {
                    let some: Vec<_> = ticks.by_ref().take(AT_ONCE).collect();
                    // The replay may have ended before the log.
                    if some.is_empty() || sender.send(some).is_err() {
                        break;
                    }
                }
            });
            self.compute(receiver.into_iter().flatten(), options, generations)
        })
    }

    fn compute(
        &mut self,
        ticks: impl Iterator<Item = Result<LoggedTick, ReadError>>,
        options: &Options,
        generations: &[Store],
    ) -> Result<Option<Difference>, ReplayError> {
        // Ticks from the last recorded states to the beginning of the replay.
        let mut run_up: Vec<LoggedTick> = Vec::new();
        for logged in ticks {
            let logged = logged?;
            if options.until.is_some_and(|until| logged.tick > until) {
                break;
            }
            if options.from.is_some_and(|from| logged.tick < from) {
                if logged.state.is_some() {
                    run_up.clear();
                }
                run_up.push(logged);
                continue;
            }
            for earlier in run_up.drain(..) {
                if self.ticks == 0 && self.before.is_some() && earlier.state.is_some() {
                    self.take_over(&earlier)?;
                    self.last = earlier.tick;
                } else if let Some(difference) = self.tick(&earlier, generations)? {
                    return Ok(Some(difference));
                }
            }
            if let Some(difference) = self.tick(&logged, generations)? {
                return Ok(Some(difference));
            }
        }
        Ok(None)
    }

    /// Compute a tick again, or take the recorded values after a gap.
    fn tick(
        &mut self,
        logged: &LoggedTick,
        generations: &[Store],
    ) -> Result<Option<Difference>, ReplayError> {
        let tick = logged.tick;
        let before = self.before.filter(|_| tick == self.last.next());
        self.skipped += tick.since(self.last.next());
        self.last = tick;
        let Some(before) = before else {
            self.skipped += 1;
            self.take_over(logged)?;
            return Ok(None);
        };
        let bad = |source| ReplayError::Inputs { tick: tick.0, source };
        let external: ExternalInputs = from_bytes(&logged.external).map_err(bad)?;
        let missing = ReplayError::Generation { tick: tick.0, generation: external.generation };
        let store = usize::try_from(external.generation).ok().and_then(|at| generations.get(at));
        let data = store.ok_or(missing)?.view();
        let mut after = before;
        self.ladder.step(tick, &before, &external, &data, &mut after);
        self.ticks += 1;
        after.encode(&mut Writer::new(&mut self.image));
        self.digest.add(&self.image);
        self.before = Some(after);
        Ok(self.compare(logged))
    }

    /// Continue from the recorded values; without states the replay waits for the next tick that has them.
    fn take_over(&mut self, logged: &LoggedTick) -> Result<(), ReplayError> {
        let bad = |source| ReplayError::Inputs { tick: logged.tick.0, source };
        self.before = None;
        if let Some(image) = &logged.state {
            let state: LadderState = from_bytes(image).map_err(bad)?;
            self.ladder.restore(&state);
            self.before = Some(from_bytes(&logged.memory).map_err(bad)?);
        }
        Ok(())
    }

    fn compare(&mut self, logged: &LoggedTick) -> Option<Difference> {
        let tick = logged.tick;
        if let Some(leaf) = layout::first_difference(&self.memory_leaves, &logged.memory, &self.image) {
            let (buffer, field) = split(&leaf.path);
            return Some(self.difference(tick, leaf, buffer, field, &logged.memory, &self.image));
        }
        let recorded = logged.state.as_ref()?;
        self.ladder.state().encode(&mut Writer::new(&mut self.state));
        let leaf = layout::first_difference(&self.state_leaves, recorded, &self.state)?;
        let (process, field) = leaf.path.split_once('.').unwrap_or((&leaf.path, ""));
        Some(self.difference(tick, leaf, format!("state.{process}"), field.to_owned(), recorded, &self.state))
    }

    fn difference(
        &self,
        tick: Tick,
        leaf: &Leaf,
        buffer: String,
        field: String,
        was: &[u8],
        is: &[u8],
    ) -> Difference {
        let process = leaf.path.split('.').next().unwrap_or_default();
        let row =
            self.headers.iter().find(|place| place.field == process).map_or_else(String::new, |place| {
                match place.row(&place.read(&self.image)) {
                    Some((table, row)) => {
                        format!("{} decided by {}", place.process.name, row_text(table, row))
                    }
                    None => format!("{} decided by no row", place.process.name),
                }
            });
        Difference { tick, buffer, field, was: leaf.text(was), is: leaf.text(is), row }
    }
}

/// The first two names of a path, and the rest: `prim.status`, `distance`.
fn split(path: &str) -> (String, String) {
    let mut parts = path.splitn(3, '.');
    let buffer: Vec<&str> = parts.by_ref().take(2).collect();
    (buffer.join("."), parts.next().unwrap_or_default().to_owned())
}
