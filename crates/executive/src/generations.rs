//! Generations of the task data: blocks that are loaded while the robot runs
//! (docs/design/ownership.md "Reload").
//!
//! A reload is built and checked outside the tick. It becomes visible as a whole between two ticks, and only while no
//! command is being executed: a command in progress keeps the records with which it began. Names that existed keep
//! their record numbers from one generation to the next, so that the states that processes keep between commands (the
//! position of the robot, the object that it holds) stay valid.

use std::collections::VecDeque;

use interfaces::{CommonMemory, StatusReport, hws::HwsReport};
use taskdata::load::Store;

/// The task data in use, and the queued ones.
pub struct Generations {
    current: Store,
    number: u32,
    waiting: VecDeque<Store>,
}

impl Generations {
    /// Generation 0: the task data loaded before the first tick.
    #[must_use]
    pub const fn new(store: Store) -> Self {
        Self { current: store, number: 0, waiting: VecDeque::new() }
    }

    /// The task data of the next tick.
    #[must_use]
    pub const fn current(&self) -> &Store {
        &self.current
    }

    /// The task data of the next tick, if only `proposed` is still queued before it: what [`Generations::advance`] makes
    /// current after the tick whose buffers are `memory`.
    #[must_use]
    pub fn next<'a>(&'a self, memory: &CommonMemory, proposed: Option<&'a Store>) -> &'a Store {
        if is_busy(memory) {
            return &self.current;
        }
        self.waiting.front().or(proposed).unwrap_or(&self.current)
    }

    /// Number of the generation in use.
    #[must_use]
    pub const fn number(&self) -> u32 {
        self.number
    }

    /// Queue task data until the command in progress has ended. Several queued ones become visible one after the other,
    /// one a tick.
    pub fn propose(&mut self, store: Store) {
        self.waiting.push_back(store);
    }

    /// Use other task data from the next tick on, even while a command is executed: for experiments with a run. The
    /// records of the command in progress must still exist. Returns false, without a change, if other task data are
    /// queued.
    pub fn supersede(&mut self, store: Store) -> bool {
        if !self.waiting.is_empty() {
            return false;
        }
        self.current = store;
        self.number = self.number.saturating_add(1);
        true
    }

    /// Between two ticks: use the queued task data if no command is being executed according to `memory`. Returns true
    /// if the generation has changed.
    pub fn advance(&mut self, memory: &CommonMemory) -> bool {
        if is_busy(memory) {
            return false;
        }
        let Some(store) = self.waiting.pop_front() else { return false };
        self.current = store;
        self.number = self.number.saturating_add(1);
        true
    }
}

/// True if a command is being executed.
#[must_use]
pub fn is_busy(memory: &CommonMemory) -> bool {
    memory.task.status.report == HwsReport::Executing
        || memory.subtask.status.report == StatusReport::Executing
        || memory.emove.status.report == StatusReport::Executing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_in_progress_keeps_its_records() {
        let mut generations = Generations::new(Store::default());
        let mut memory = CommonMemory::default();
        assert!(!generations.advance(&memory), "nothing waits");

        memory.task.status.report = HwsReport::Executing;
        generations.propose(Store::default());
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
    fn next_data_are_those_that_advance_makes_current() {
        let mut generations = Generations::new(Store::default());
        let mut memory = CommonMemory::default();
        let proposed = Store::default();
        let is = |found: &Store, expected: &Store| std::ptr::eq(found, expected);
        assert!(is(generations.next(&memory, None), generations.current()));
        assert!(is(generations.next(&memory, Some(&proposed)), &proposed));
        generations.propose(Store::default());
        assert!(is(generations.next(&memory, Some(&proposed)), &generations.waiting[0]));
        memory.task.status.report = HwsReport::Executing;
        assert!(is(generations.next(&memory, Some(&proposed)), generations.current()));
    }

    #[test]
    fn an_experiment_does_not_wait_for_a_command_but_for_a_reload() {
        let mut generations = Generations::new(Store::default());
        assert!(generations.supersede(Store::default()));
        assert_eq!(generations.number(), 1);
        generations.propose(Store::default());
        assert!(!generations.supersede(Store::default()), "a reload waits");
        assert_eq!(generations.number(), 1);
    }
}
