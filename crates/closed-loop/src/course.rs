//! The ticks of a ladder, with common memory, digest and first failure.
//!
//! Common memory has two halves, selected by tick parity: processes read one and write the other, so their order has
//! no effect. After every tick the course adds the buffers to the digest and checks the statuses for a failure.
//!
//! A [`Course`] reads no clock and does not allocate after its creation. A clone continues from the same tick.
//! `executive::Runner` times and publishes a course; `rcs-run campaign` forks it.

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::ProcessId;
use rcs_core::{Plain, digest::Digest, tick::Tick};

use crate::failure::Watch;

pub trait Levels<Data: ?Sized> {
    type Error;

    /// One tick of all processes: read `before` and `external`, write all of `after`, and call `observe` after each
    /// stage like [`Ladder::step_observed`](levels::ladder::Ladder::step_observed). Fails if external processes did
    /// not take part; stop then.
    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &Data,
        after: &mut CommonMemory,
        observe: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Self::Error>;

    /// A copy for warming up a tick; `None` if a warm-up has no effect.
    fn shadow(&self) -> Option<Box<Self>>
    where
        Self: Sized,
    {
        None
    }

    /// Copy the present state to the shadow, without allocation.
    fn copy_to(&self, _shadow: &mut Self)
    where
        Self: Sized,
    {
    }

    /// Heap allocations by processes that run elsewhere.
    fn allocations(&self) -> u64 {
        0
    }
}

#[derive(Clone)]
pub struct Course<L> {
    levels: L,
    tick: Tick,
    halves: [CommonMemory; 2],
    digest: Digest,
    scratch: Box<[u8]>,
    watch: Box<Watch>,
}

impl<L> Course<L> {
    #[must_use]
    pub fn new(levels: L) -> Self {
        Self {
            levels,
            tick: Tick::BEFORE_START,
            halves: [CommonMemory::ZERO; 2],
            digest: Digest::new(),
            scratch: vec![0; CommonMemory::SIZE].into_boxed_slice(),
            watch: Box::default(),
        }
    }

    /// Continue after `tick` with these buffers, like a controller that starts with earlier knowledge.
    pub fn start_after(&mut self, tick: Tick, memory: &CommonMemory) {
        self.tick = tick;
        let (before, _) = of_tick_mut(&mut self.halves, tick.next());
        *before = *memory;
        *self.watch = Watch::default();
    }

    /// Run the next tick on its external inputs, and call `observe` after each stage. The caller must then call
    /// [`summarise`](Self::summarise).
    ///
    /// # Errors
    /// Errors of the levels. The tick is then void, and common memory is that of the previous tick.
    pub fn step<Data: ?Sized>(
        &mut self,
        external: &ExternalInputs,
        data: &Data,
        observe: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), L::Error>
    where
        L: Levels<Data>,
    {
        let tick = self.tick.next();
        let (before, after) = of_tick(&mut self.halves, tick);
        self.levels.step(tick, before, external, data, after, observe)?;
        self.tick = tick;
        Ok(())
    }

    /// Run the next tick and sum it up. Errors: those of [`step`](Self::step).
    pub fn advance<Data: ?Sized>(&mut self, external: &ExternalInputs, data: &Data) -> Result<(), L::Error>
    where
        L: Levels<Data>,
    {
        self.step(external, data, &mut |_| {})?;
        self.summarise(external);
        Ok(())
    }

    /// Add the buffers of the last tick to the digest, and check its statuses.
    pub fn summarise(&mut self, external: &ExternalInputs) {
        let (before, after) = of_tick(&mut self.halves, self.tick);
        self.watch.observe(self.tick, external, before, after);
        self.digest.add_record(after, &mut self.scratch);
    }

    /// Run the next tick on a copy of the levels and discard the result.
    pub fn warm_up<Data: ?Sized>(&mut self, shadow: &mut L, external: &ExternalInputs, data: &Data)
    where
        L: Levels<Data>,
    {
        self.levels.copy_to(shadow);
        let tick = self.tick.next();
        // The tick will overwrite this half completely.
        let (before, after) = of_tick(&mut self.halves, tick);
        // The result is discarded: the tick itself follows.
        let _ = shadow.step(tick, before, external, data, after, &mut |_| {});
    }

    #[must_use]
    pub const fn levels(&self) -> &L {
        &self.levels
    }

    pub const fn levels_mut(&mut self) -> &mut L {
        &mut self.levels
    }

    #[must_use]
    pub const fn tick(&self) -> Tick {
        self.tick
    }

    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        let [even, odd] = &self.halves;
        if self.tick.0.is_multiple_of(2) { even } else { odd }
    }

    /// The digest of all output buffers of all ticks so far.
    #[must_use]
    pub const fn digest(&self) -> Digest {
        self.digest
    }

    #[must_use]
    pub const fn watch(&self) -> &Watch {
        &self.watch
    }
}

const fn of_tick(halves: &mut [CommonMemory; 2], tick: Tick) -> (&CommonMemory, &mut CommonMemory) {
    let (before, after) = of_tick_mut(halves, tick);
    (before, after)
}

const fn of_tick_mut(halves: &mut [CommonMemory; 2], tick: Tick) -> (&mut CommonMemory, &mut CommonMemory) {
    let [even, odd] = halves;
    if tick.0.is_multiple_of(2) { (odd, even) } else { (even, odd) }
}
