//! Generations of the task data: blocks that are loaded while the robot runs (docs/design/ownership.md "Reload").
//!
//! A reload is built and checked outside the tick. It takes effect as a whole between two ticks and between commands,
//! so a command keeps its records. Existing names keep their record numbers, so the states that processes keep between
//! commands (the robot's position, the held object) remain valid.

use std::{collections::VecDeque, sync::Arc};

use interfaces::{CommonMemory, StatusReport, hws::HwsReport};
use taskdata::load::{Store, job::Reload};

/// The task data in use, the task data of each reload, and the queue of reloads. A copy shares the data.
#[derive(Clone)]
pub struct Generations {
    first: Arc<Store>,
    reloads: Arc<Vec<Reload>>, // generation 1 and later ones, each based on its predecessor
    number: u32,
    inserted: u32,          // number of generations that do not originate in a line of the job
    waiting: VecDeque<u32>, // generations that wait for the end of a command
}

impl Generations {
    /// The task data before the first tick, and the reloads of the job in the order of its lines.
    #[must_use]
    pub const fn new(first: Arc<Store>, reloads: Arc<Vec<Reload>>) -> Self {
        Self { first, reloads, number: 0, inserted: 0, waiting: VecDeque::new() }
    }

    fn store(&self, number: u32) -> &Store {
        self.reload(number).map_or(&self.first, |reload| &reload.store)
    }

    #[must_use]
    pub fn reload(&self, number: u32) -> Option<&Reload> {
        self.reloads.get(usize::try_from(number).ok()?.checked_sub(1)?)
    }

    #[must_use]
    pub fn current(&self) -> &Store {
        self.store(self.number)
    }

    /// The task data of the next tick if the job requests only the reload `load` before it. [`Generations::advance`]
    /// puts them into effect after the tick with the buffers `memory`.
    #[must_use]
    pub fn next(&self, memory: &CommonMemory, load: Option<u32>) -> &Store {
        if is_busy(memory) {
            return self.current();
        }
        let load = load.map(|number| number.saturating_add(self.inserted));
        let next = self.waiting.front().copied().or_else(|| load.filter(|load| self.reload(*load).is_some()));
        next.map_or_else(|| self.current(), |number| self.store(number))
    }

    #[must_use]
    pub const fn number(&self) -> u32 {
        self.number
    }

    /// All reloads of the run: the reloads in effect, and the reloads of later lines of the job.
    #[must_use]
    pub fn reloads(&self) -> &[Reload] {
        &self.reloads
    }

    #[must_use]
    pub fn done(&self) -> usize {
        usize::try_from(self.number).unwrap_or(usize::MAX)
    }

    #[must_use]
    pub const fn state(&self) -> (u32, u32, &VecDeque<u32>) {
        (self.number, self.inserted, &self.waiting)
    }

    /// Queue a reload of the job, by its number from 1, until the present command has ended. Several queued reloads
    /// take effect one per tick. An unknown number has no effect.
    pub fn propose(&mut self, load: u32) {
        let number = load.saturating_add(self.inserted);
        if self.reload(number).is_some() {
            self.waiting.push_back(number);
        }
    }

    /// Use the task data of a generation of an earlier run with the same job. An unknown number has no effect.
    pub fn resume(&mut self, number: u32) {
        if self.reload(number).is_some() {
            self.number = number;
        }
        self.waiting.clear();
    }

    /// Use other task data from the next tick on, even during a command. `reloads` are all reloads of the run, with
    /// the new one after those in effect; the records of the present command must still exist. Returns false, without
    /// a change, if there is no new reload or one of the job is queued.
    pub fn insert(&mut self, reloads: Vec<Reload>) -> bool {
        if !self.waiting.is_empty() || reloads.len() <= self.done() {
            return false;
        }
        self.reloads = Arc::new(reloads);
        self.number = self.number.saturating_add(1);
        self.inserted = self.inserted.saturating_add(1);
        true
    }

    /// Between two ticks: put queued task data into effect if no command is being executed according to `memory`.
    /// Returns true if the generation has changed.
    pub fn advance(&mut self, memory: &CommonMemory) -> bool {
        if is_busy(memory) {
            return false;
        }
        let Some(number) = self.waiting.pop_front() else { return false };
        self.number = number;
        true
    }
}

#[must_use]
pub fn is_busy(memory: &CommonMemory) -> bool {
    memory.task.status.report == HwsReport::Executing
        || memory.subtask.status.report == StatusReport::Executing
        || memory.emove.status.report == StatusReport::Executing
}

#[cfg(test)]
mod tests {
    use taskdata::load::Source;

    use super::*;

    fn new_generations(reloads: usize) -> Generations {
        Generations::new(Arc::default(), Arc::new(empty(reloads)))
    }

    fn empty(reloads: usize) -> Vec<Reload> {
        let source = Source { name: "try.blk".into(), text: "".into() };
        vec![Reload { source, store: Store::default() }; reloads]
    }

    #[test]
    fn a_command_in_progress_keeps_its_records() {
        let mut generations = new_generations(1);
        let mut memory = CommonMemory::default();
        assert!(!generations.advance(&memory), "nothing waits");

        memory.task.status.report = HwsReport::Executing;
        generations.propose(1);
        assert!(!generations.advance(&memory), "Task executes a command");
        memory.task.status.report = HwsReport::Finished;
        memory.emove.status.report = StatusReport::Executing;
        assert!(!generations.advance(&memory), "the robot still moves");

        memory.emove.status.report = StatusReport::Done;
        assert!(generations.advance(&memory));
        assert_eq!(generations.number(), 1);
        assert!(!generations.advance(&memory), "nothing waits any more");
    }

    #[test]
    fn next_equals_the_data_after_advance() {
        let mut generations = new_generations(2);
        let mut memory = CommonMemory::default();
        let is = |found: &Store, expected: &Store| std::ptr::eq(found, expected);
        let store = |generations: &Generations, number: u32| std::ptr::from_ref(generations.store(number));
        assert!(is(generations.next(&memory, None), generations.current()));
        assert_eq!(std::ptr::from_ref(generations.next(&memory, Some(2))), store(&generations, 2));
        assert!(is(generations.next(&memory, Some(3)), generations.current()), "there is no such reload");
        generations.propose(1);
        assert_eq!(std::ptr::from_ref(generations.next(&memory, Some(2))), store(&generations, 1));
        memory.task.status.report = HwsReport::Executing;
        assert!(is(generations.next(&memory, Some(2)), generations.current()));
    }

    #[test]
    fn inserted_reload_waits_only_for_a_queued_reload() {
        let mut generations = new_generations(1);
        assert!(!generations.insert(Vec::new()), "there is no new one");
        assert!(generations.insert(empty(2)));
        assert_eq!(generations.number(), 1);
        generations.propose(1);
        assert!(!generations.insert(empty(3)), "a reload of the job waits");
        assert!(generations.advance(&CommonMemory::default()));
        assert_eq!(generations.number(), 2, "the first reload of the job is now the second of the run");
    }
}
