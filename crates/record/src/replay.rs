//! Replay: executes the control processes again with the recorded inputs, and compares the outputs.
//!
//! Task data and inputs are those of the log. Every output buffer of every tick is compared bit for bit, like the
//! states where the log has them, up to the first difference.
//!
//! After a gap, or from the middle, the replay continues with recorded states. All processors therefore replay
//! different stretches, which begin and end with recorded states. A replay with other task data does not compare record
//! numbers.

use std::{
    collections::BTreeMap,
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::{Ladder, LadderState};
use rcs_core::{
    Plain,
    digest::{Digest, hash},
    plain::{Writer, from_bytes},
    tick::{TICK_MS, Tick},
};
use taskdata::load::{Source, Store, parallel};

use crate::{
    comparison::Comparison,
    error::ReplayError,
    input::Attachment,
    layout,
    lossless::Codecs,
    reader::{Log, LoggedTick},
};

pub use crate::comparison::Difference;

/// Number of parts that a processor replays at once: eight seconds with two parts each.
const STRETCH: usize = 16;

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
    /// True if the digest of the run can be compared, because the replay has all ticks and the same record numbers.
    const fn has_digest(&self) -> bool {
        self.from.is_none() && self.until.is_none() && self.data.is_none()
    }
}

#[derive(Clone, Debug)]
pub struct ReplayReport {
    pub ticks: u64,
    /// Number of ticks that could not be computed: the ticks in gaps, and the ticks from which the replay continued.
    pub skipped: u64,
    pub first_difference: Option<Difference>,
    pub digest: Digest, // of the computed ticks
    /// Digest at the end of the run; `None` if the log is incomplete.
    pub recorded_digest: Option<u64>,
    pub complete: bool,
    pub damage: Option<String>,
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

/// Replay a whole log with its own task data. A difference is part of the report.
pub fn replay(path: &Path) -> Result<ReplayReport, ReplayError> {
    replay_with(path, &Options::default())
}

/// Replay a log, or a part of it. [`ReplayError::Empty`] if the part contains no tick.
pub fn replay_with(path: &Path, options: &Options) -> Result<ReplayReport, ReplayError> {
    let started = Instant::now();
    // The layout takes half as long as reading a log, so a thread makes it in parallel. Otherwise it is made later.
    let _ = thread::Builder::new().spawn(layout::description);
    let log = Log::open(path)?;
    log.check_layout()?;
    let generations = match &options.data {
        Some(data) => load_generations(data.clone(), &log.attachments)?,
        None => generations(&log)?,
    };
    // Recorded states contain record numbers, which are valid only for the log's own task data.
    let length = if options.data.is_some() { usize::MAX } else { STRETCH };
    let stretches = ReplayParts::new(&log, options, &generations, length);
    let Replayed { ticks, skipped, digest: computed, first_difference } = stretches.replay()?;
    if ticks == 0 {
        return Err(ReplayError::Empty);
    }
    let digest = log.end.as_ref().filter(|_| options.has_digest()).and_then(|end| end.get("digest"));
    Ok(ReplayReport {
        ticks,
        skipped,
        first_difference,
        digest: computed,
        recorded_digest: digest.and_then(|digest| u64::from_str_radix(digest, 16).ok()),
        complete: log.complete,
        damage: log.damage(),
        elapsed: started.elapsed(),
    })
}

/// The task data attached to a log. Fails with [`ReplayError::TaskData`] with the report of the loader.
pub fn task_data(log: &Log) -> Result<Store, ReplayError> {
    let (store, _) = Store::from_sources(log_sources(&log.attachments))
        .map_err(|report| ReplayError::TaskData(report.render(false)))?;
    Ok(store)
}

/// The task data among the attachments, in the order in which they were loaded.
#[must_use]
pub fn log_sources(attachments: &[Attachment]) -> Vec<Source> {
    let source = |attachment: &Attachment| {
        Some(attachment.source(attachment.name.strip_prefix(Attachment::TASK_DATA)?))
    };
    attachments.iter().filter_map(source).collect()
}

/// The generations of a log's task data: as loaded, and after each reload.
pub fn generations(log: &Log) -> Result<Vec<Store>, ReplayError> {
    generations_of(log_sources(&log.attachments), &log.attachments)
}

pub(crate) fn generations_of(
    sources: Vec<Source>,
    attachments: &[Attachment],
) -> Result<Vec<Store>, ReplayError> {
    let (first, _) =
        Store::from_sources(sources).map_err(|report| ReplayError::TaskData(report.render(false)))?;
    load_generations(first, attachments)
}

pub(crate) fn load_generations(first: Store, attachments: &[Attachment]) -> Result<Vec<Store>, ReplayError> {
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

#[derive(Debug, PartialEq)]
struct Replayed {
    ticks: u64,
    skipped: u64,
    digest: Digest,
    first_difference: Option<Difference>,
}

#[derive(Default)]
struct ReplayPart {
    hashes: Vec<u64>, // hashes of the output buffers of the computed ticks
    skipped: u64,
    first_difference: Option<Difference>,
}

struct ReplayParts<'a> {
    log: &'a Log,
    options: &'a Options,
    generations: &'a [Store],
    codecs: Codecs,
    comparison: Comparison,
    length: usize, // parts of the log in a stretch
}

impl<'a> ReplayParts<'a> {
    fn new(log: &'a Log, options: &'a Options, generations: &'a [Store], length: usize) -> Self {
        let comparison = Comparison::new(options.data.is_some());
        Self { log, options, generations, codecs: Codecs::new(), comparison, length }
    }

    fn replay(&self) -> Result<Replayed, ReplayError> {
        let mut all = Replayed { ticks: 0, skipped: 0, digest: Digest::new(), first_difference: None };
        for stretch in self.in_all_processors() {
            let ReplayPart { hashes, skipped, first_difference } = stretch?;
            all.ticks += hashes.len() as u64;
            all.skipped += skipped;
            hashes.iter().for_each(|hash| all.digest.add_hash(*hash));
            all.first_difference = first_difference;
            if all.first_difference.is_some() {
                break;
            }
        }
        Ok(all)
    }

    /// The stretches in order, up to the first difference, or the first tick that cannot be computed.
    fn in_all_processors(&self) -> impl Iterator<Item = Result<ReplayPart, ReplayError>> {
        let last = AtomicUsize::new(usize::MAX);
        let stretches = parallel::map(self.log.parts().div_ceil(self.length), |number| {
            if number > last.load(Ordering::Relaxed) {
                return None;
            }
            let stretch = self.stretch(number);
            if !stretch.as_ref().is_ok_and(|stretch| stretch.first_difference.is_none()) {
                last.fetch_min(number, Ordering::Relaxed);
            }
            Some(stretch)
        });
        stretches.into_iter().map_while(|stretch| stretch)
    }

    /// Compute a stretch up to the first difference: from the first recorded states in its parts to the first ones
    /// after.
    fn stretch(&self, number: usize) -> Result<ReplayPart, ReplayError> {
        let first = number.saturating_mul(self.length);
        let end = first.saturating_add(self.length);
        let mut ticks = self.log.ticks_from(first, &self.codecs);
        let (mut replayer, mut has_begun) = (Replayer::new(), number == 0);
        // Ticks from the last recorded states to the start of the replay.
        let mut run_up: Vec<LoggedTick> = Vec::new();
        while let Some(read) = ticks.advance() {
            let (part, logged) = read?;
            let is_over = self.options.until.is_some_and(|until| logged.tick > until);
            if is_over || (part >= end && !has_begun) {
                break;
            }
            let is_early = self.options.from.is_some_and(|from| logged.tick < from);
            if logged.state.is_some() && (is_early || !has_begun) {
                replayer.take_over(logged)?;
                run_up.clear();
                has_begun = true;
            } else if is_early && has_begun {
                run_up.push(logged.clone());
            } else if has_begun {
                for logged in run_up.iter().chain([logged]) {
                    replayer.step(logged, self)?;
                    if replayer.stretch.first_difference.is_some() {
                        return Ok(replayer.stretch);
                    }
                }
                run_up.clear();
            }
            if part >= end && logged.state.is_some() {
                break;
            }
        }
        Ok(replayer.stretch)
    }
}

struct Replayer {
    ladder: Ladder,
    /// Common memory after the last two ticks. The next tick overwrites the older one.
    halves: [CommonMemory; 2],
    in_second: bool,  // true if the last tick is in the second half
    image: Vec<u8>,   // byte image of common memory after the last tick
    has_states: bool, // false if the replay needs recorded states to continue
    last: Tick,
    stretch: ReplayPart,
}

impl Replayer {
    fn new() -> Self {
        Self {
            ladder: Ladder::default(),
            halves: [CommonMemory::ZERO; 2],
            in_second: false,
            image: vec![0; CommonMemory::SIZE],
            has_states: true,
            last: Tick::BEFORE_START,
            stretch: ReplayPart::default(),
        }
    }

    /// Compute a tick again and compare it, or copy the recorded values after a gap.
    fn step(&mut self, logged: &LoggedTick, stretches: &ReplayParts<'_>) -> Result<(), ReplayError> {
        let tick = logged.tick;
        self.stretch.skipped += tick.since(self.last.next());
        if !self.has_states || tick != self.last.next() {
            self.stretch.skipped += 1;
            return self.take_over(logged);
        }
        self.last = tick;
        let bad = |source| ReplayError::Inputs { tick: tick.0, source };
        let external: ExternalInputs = from_bytes(&logged.external).map_err(bad)?;
        let missing = ReplayError::Generation { tick: tick.0, generation: external.generation };
        let store = usize::try_from(external.generation).ok().and_then(|at| stretches.generations.get(at));
        let data = store.ok_or(missing)?.view();
        let [first, second] = &mut self.halves;
        let (before, after) = if self.in_second { (second, first) } else { (first, second) };
        self.in_second = !self.in_second;
        self.ladder.step(tick, before, &external, &data, after);
        after.encode(&mut Writer::new(&mut self.image));
        self.stretch.hashes.push(hash(&self.image));
        let states = logged.state.is_some().then(|| image(&self.ladder.state()));
        self.stretch.first_difference =
            stretches.comparison.difference(logged, &self.image, states.as_deref());
        Ok(())
    }

    /// Continue with the recorded values. Without states the replay waits for the next tick that has them.
    fn take_over(&mut self, logged: &LoggedTick) -> Result<(), ReplayError> {
        let bad = |source| ReplayError::Inputs { tick: logged.tick.0, source };
        (self.last, self.has_states) = (logged.tick, logged.state.is_some());
        if let Some(image) = &logged.state {
            let state: LadderState = from_bytes(image).map_err(bad)?;
            self.ladder.restore(&state);
            (self.halves, self.in_second) =
                ([from_bytes(&logged.memory).map_err(bad)?, CommonMemory::ZERO], false);
        }
        Ok(())
    }
}

fn image<T: Plain>(record: &T) -> Vec<u8> {
    let mut image = vec![0; T::SIZE];
    record.encode(&mut Writer::new(&mut image));
    image
}

#[cfg(test)]
mod tests;
