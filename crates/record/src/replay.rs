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
    comparison::Comparison,
    error::{ReadError, ReplayError},
    input::Attachment,
    reader::{Log, LoggedTick},
};

pub use crate::comparison::Difference;

/// Ticks that one thread hands to the next at once, and how many times as many may wait there.
const AT_ONCE: usize = 32;
const WAITING: usize = 4;

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
    let Replayer { ticks, skipped, comparison, .. } = compute_and_compare(&log, options, &generations)?;
    if ticks == 0 {
        return Err(ReplayError::Empty);
    }
    let digest = log.end.as_ref().filter(|_| options.has_digest()).and_then(|end| end.get("digest"));
    Ok(ReplayReport {
        ticks,
        skipped,
        first_difference: comparison.first_difference,
        digest: comparison.digest,
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

/// Compute the ticks of a log, and compare them up to the first difference, while another thread reads them.
fn compute_and_compare(log: &Log, options: &Options, generations: &[Store]) -> Result<Replayer, ReplayError> {
    thread::scope(|scope| {
        let (to_compute, logged) = sync_channel(WAITING);
        scope.spawn(move || {
            let mut ticks = log.ticks();
            loop {
                let some: Vec<_> = ticks.by_ref().take(AT_ONCE).collect();
                // After the first difference the receiver is gone.
                if some.is_empty() || to_compute.send(some).is_err() {
                    break;
                }
            }
        });
        let mut replayer = Replayer::new(options.data.is_some());
        replayer.compute(logged.into_iter().flatten(), options, generations)?;
        Ok(replayer)
    })
}

/// Computes recorded ticks again, and compares them.
struct Replayer {
    ladder: Ladder,
    /// Common memory after the tick before, and of the one before that, which the next tick overwrites.
    halves: [CommonMemory; 2],
    /// Byte image of common memory after the last tick.
    image: Vec<u8>,
    /// False if the replay needs recorded states to continue.
    has_states: bool,
    last: Tick,
    ticks: u64,
    skipped: u64,
    comparison: Comparison,
}

impl Replayer {
    /// `by_name`: compare records by name instead of number, for other task data than those of the log.
    fn new(by_name: bool) -> Self {
        Self {
            ladder: Ladder::default(),
            halves: [CommonMemory::ZERO; 2],
            image: vec![0; CommonMemory::SIZE],
            has_states: true,
            last: Tick::BEFORE_START,
            ticks: 0,
            skipped: 0,
            comparison: Comparison::new(by_name),
        }
    }

    /// Compute ticks up to the first that differs.
    fn compute(
        &mut self,
        ticks: impl Iterator<Item = Result<LoggedTick, ReadError>>,
        options: &Options,
        generations: &[Store],
    ) -> Result<(), ReplayError> {
        let is_early = |logged: &LoggedTick| options.from.is_some_and(|from| logged.tick < from);
        // Ticks from the last recorded states to the beginning of the replay.
        let mut run_up: Vec<LoggedTick> = Vec::new();
        for logged in ticks {
            let logged = logged?;
            if options.until.is_some_and(|until| logged.tick > until) {
                break;
            }
            let early = is_early(&logged);
            if early && logged.state.is_some() {
                run_up.clear();
            }
            run_up.push(logged);
            if early {
                continue;
            }
            for logged in run_up.drain(..) {
                let is_first = self.ticks == 0 && self.has_states;
                if is_first && is_early(&logged) && logged.state.is_some() {
                    self.take_over(&logged)?;
                    self.last = logged.tick;
                } else if self.differs(&logged, generations)? {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Compute a tick again, or take the recorded values after a gap. True if the tick differs from the log.
    fn differs(&mut self, logged: &LoggedTick, generations: &[Store]) -> Result<bool, ReplayError> {
        let tick = logged.tick;
        let follows = self.has_states && tick == self.last.next();
        self.skipped += tick.since(self.last.next());
        self.last = tick;
        if !follows {
            self.skipped += 1;
            self.take_over(logged)?;
            return Ok(false);
        }
        let bad = |source| ReplayError::Inputs { tick: tick.0, source };
        let external: ExternalInputs = from_bytes(&logged.external).map_err(bad)?;
        let missing = ReplayError::Generation { tick: tick.0, generation: external.generation };
        let store = usize::try_from(external.generation).ok().and_then(|at| generations.get(at));
        let data = store.ok_or(missing)?.view();
        let [before, after] = &mut self.halves;
        self.ladder.step(tick, before, &external, &data, after);
        self.ticks += 1;
        self.halves.swap(0, 1);
        let [after, _] = &self.halves;
        after.encode(&mut Writer::new(&mut self.image));
        let states = logged.state.is_some().then(|| image(&self.ladder.state()));
        Ok(self.comparison.differs(logged, &self.image, states.as_deref()))
    }

    /// Continue from the recorded values; without states the replay waits for the next tick that has them.
    fn take_over(&mut self, logged: &LoggedTick) -> Result<(), ReplayError> {
        let bad = |source| ReplayError::Inputs { tick: logged.tick.0, source };
        self.has_states = logged.state.is_some();
        if let Some(image) = &logged.state {
            let state: LadderState = from_bytes(image).map_err(bad)?;
            self.ladder.restore(&state);
            self.halves = [from_bytes(&logged.memory).map_err(bad)?, CommonMemory::ZERO];
        }
        Ok(())
    }
}

/// The byte image of a record.
fn image<T: Plain>(record: &T) -> Vec<u8> {
    let mut image = vec![0; T::SIZE];
    record.encode(&mut Writer::new(&mut image));
    image
}
