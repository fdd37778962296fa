//! Times the ticks of a [`Course`], and can publish their buffers in shared memory.
//!
//! A tick takes ten times as long if its code and data are not in the caches, from which they are evicted within 40 ms.
//! So a tick can be *warmed up* ([`Runner::warm_up`]): a copy of the ladder runs it, and the result is discarded.

use interfaces::ExternalInputs;

use crate::{
    alloc::{self, Section},
    histogram::Histogram,
    memory::{Publisher, cell::CellView, field::FieldView, layout::Pulse},
    timing::{Stage, StageTimes},
};
use closed_loop::course::{Course, Levels};

pub struct Runner<L> {
    times: Box<Histogram>,
    stage_times: StageTimes,
    shadow: Option<Box<L>>, // the copy of the ladder for warm-ups; the first warm-up creates it
    publisher: Option<Publisher>,
    published: Box<ExternalInputs>, // the external inputs published last, for warm-ups
    allocations_at_start: u64,
    elsewhere: u64, // allocations by processes that run elsewhere
    last_ns: u64,
}

impl<L> Runner<L> {
    /// A runner before its first tick. With a publisher, it writes every tick to shared memory.
    #[must_use]
    pub fn new(publisher: Option<Publisher>) -> Self {
        Self {
            times: Box::default(),
            stage_times: StageTimes::default(),
            shadow: None,
            publisher,
            published: Box::default(),
            allocations_at_start: alloc::allocations(),
            elsewhere: 0,
            last_ns: 0,
        }
    }

    /// Run the next tick of a course on its external inputs; `skipped` is published only. Allocations are counted from
    /// here to the end of the call. The controller's time includes publishing; it excludes digest, watch for failures,
    /// and copies. After an error, common memory stays as after the previous tick.
    pub fn step<Data: ?Sized>(
        &mut self,
        course: &mut Course<L>,
        external: &ExternalInputs,
        data: &Data,
        skipped: u64,
    ) -> Result<(), L::Error>
    where
        L: Levels<Data>,
    {
        let _section = Section::enter();
        let stage_times = &mut self.stage_times;
        stage_times.mark(Stage::Inputs);
        let mut controller_ns = 0;
        course.step(external, data, &mut |process| {
            controller_ns += stage_times.mark(process.map_or(Stage::Buffers, Stage::Process));
        })?;
        self.elsewhere = course.levels().allocations();
        if let Some(publisher) = &mut self.publisher {
            let pulse = Pulse {
                tick: course.tick(),
                generation: external.generation,
                skipped,
                allocations: alloc::allocations() - self.allocations_at_start + self.elsewhere,
                controller_ns: self.last_ns,
                over: false,
            };
            publisher.publish(external, course.memory(), pulse);
        }
        self.last_ns = controller_ns + self.stage_times.mark(Stage::Buffers);
        self.times.add(self.last_ns);
        course.summarise(external);
        if let Some(publisher) = &self.publisher {
            publisher.show(external, course.memory());
            if self.shadow.is_some() {
                *self.published = *external;
            }
        }
        self.stage_times.mark(Stage::Bookkeeping);
        Ok(())
    }

    /// Run the next tick on a copy of the levels and discard the result. It publishes the last buffers once more. Call
    /// it between two ticks. Only the first warm-up allocates.
    pub fn warm_up<Data: ?Sized>(&mut self, course: &mut Course<L>, external: &ExternalInputs, data: &Data)
    where
        L: Levels<Data>,
    {
        let Some(shadow) = &mut self.shadow else {
            self.shadow = course.levels().shadow();
            return;
        };
        let _section = Section::enter();
        course.warm_up(shadow, external, data);
        if let Some(publisher) = &mut self.publisher {
            publisher.publish_again(&self.published, course.memory());
        }
    }

    /// Stopwatch of the parts of a tick, with which the caller marks the parts that [`step`](Self::step) does not run.
    pub const fn stage_times_mut(&mut self) -> &mut StageTimes {
        &mut self.stage_times
    }

    #[must_use]
    pub const fn stage_times(&self) -> &StageTimes {
        &self.stage_times
    }

    #[must_use]
    pub const fn times(&self) -> &Histogram {
        &self.times
    }

    #[must_use]
    pub const fn last_ns(&self) -> u64 {
        self.last_ns
    }

    /// Heap allocations of the controller since the creation of the runner; `None` if the program does not count them.
    #[must_use]
    pub fn allocations(&self) -> Option<u64> {
        alloc::is_installed().then(|| alloc::allocations() - self.allocations_at_start + self.elsewhere)
    }

    #[must_use]
    pub const fn publisher(&self) -> Option<&Publisher> {
        self.publisher.as_ref()
    }

    /// Publish the simulated cell after a tick; `view` is called if the run is published. Does not allocate.
    pub fn show_cell<'a>(&mut self, view: impl FnOnce() -> &'a CellView) {
        if let Some(publisher) = &mut self.publisher {
            publisher.show_cell(view());
        }
    }

    /// Publish the couplers after a tick; `view` is called if the run is published. Does not allocate.
    pub fn show_field(&mut self, view: impl FnOnce() -> FieldView) {
        if let Some(publisher) = &mut self.publisher {
            publisher.show_field(&view());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use interfaces::CommonMemory;
    use levels::ladder::ProcessId;
    use rcs_core::{Plain as _, digest::Digest, tick::Tick};

    use super::*;

    /// Adds one to the echo of Task and copies it one process further down per tick; counts its steps.
    #[derive(Clone, Default)]
    struct Chain {
        steps: u32,
    }

    impl Levels<u32> for Chain {
        type Error = Infallible;

        fn step(
            &mut self,
            tick: Tick,
            before: &CommonMemory,
            _: &ExternalInputs,
            data: &u32,
            after: &mut CommonMemory,
            _: &mut dyn FnMut(Option<ProcessId>),
        ) -> Result<(), Infallible> {
            self.steps += 1;
            *after = *before;
            after.task.header.stamp = tick;
            after.task.status.echo = before.task.status.echo + *data;
            after.subtask.status.echo = before.task.status.echo;
            after.emove.status.echo = before.subtask.status.echo;
            Ok(())
        }

        fn shadow(&self) -> Option<Box<Self>> {
            Some(Box::new(self.clone()))
        }

        fn copy_to(&self, shadow: &mut Self) {
            shadow.clone_from(self);
        }
    }

    #[test]
    fn each_hop_takes_a_tick() {
        let (mut course, mut runner) = (Course::new(Chain::default()), Runner::new(None));
        let external = ExternalInputs::default();
        for tick in 1..=10_u32 {
            let Ok(()) = runner.step(&mut course, &external, &3, 0);
            let memory = course.memory();
            let echoes = (memory.task.status.echo, memory.subtask.status.echo, memory.emove.status.echo);
            assert_eq!(echoes, (3 * tick, 3 * (tick - 1), 3 * tick.saturating_sub(2)));
        }
        assert_eq!((course.tick(), runner.times().count()), (Tick(10), 10));
    }

    #[test]
    fn a_warm_up_leaves_the_state_unchanged() {
        let (mut one, mut other) = (Course::new(Chain::default()), Course::new(Chain::default()));
        let (mut runner, mut warmed) = (Runner::new(None), Runner::new(None));
        let external = ExternalInputs::default();
        for data in 1..=10 {
            let Ok(()) = runner.step(&mut one, &external, &data, 0);
            // Warm-ups have no effect, even with other data than the tick.
            (0..3).for_each(|_| warmed.warm_up(&mut other, &external, &77));
            let Ok(()) = warmed.step(&mut other, &external, &data, 0);
            assert_eq!(other.memory(), one.memory());
        }
        assert_eq!((other.digest(), other.tick(), other.levels().steps), (one.digest(), one.tick(), 10));
        assert_eq!(warmed.times().count(), 10);
    }

    #[test]
    fn the_digest_is_that_of_all_buffers_of_all_ticks() {
        let (mut one, mut other) = (Course::new(Chain::default()), Course::new(Chain::default()));
        let mut runner = Runner::new(None);
        let external = ExternalInputs::default();
        let mut expected = Digest::new();
        let mut scratch = vec![0; CommonMemory::SIZE];
        for _ in 0..5 {
            let Ok(()) = runner.step(&mut one, &external, &1, 0);
            expected.add_record(one.memory(), &mut scratch);
            let Ok(()) = runner.step(&mut other, &external, &2, 0);
        }
        assert_eq!(one.digest(), expected);
        assert_ne!(one.digest(), other.digest());
    }
}
