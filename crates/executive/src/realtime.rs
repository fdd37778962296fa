//! Asks the system for what real time needs, and says plainly what it did not get.
//!
//! Three things are asked for: no page of the program is ever fetched from disk (`mlockall`), the thread of
//! the ticks comes before everything that is not real time (`SCHED_FIFO`), and it stays on one core. None of
//! them is needed for right results, only for punctual ones, so a refusal is a sentence in the verdict and
//! not an error.
//!
//! Threads inherit policy and core: start log and progress threads before [`acquire`] is called.

use std::fmt;

use rustix::{
    mm::{MlockAllFlags, mlockall},
    process::{Resource, geteuid, getrlimit},
    thread::{CpuSet, sched_getaffinity, sched_setaffinity},
};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// Priority of the tick: above interrupt threads of ordinary devices, below the kernel's own watchdogs.
pub const PRIORITY: u8 = 80;

/// One of the things that were asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// What was asked for.
    pub what: String,
    /// Why it was refused; `None` if it was granted.
    pub refused: Option<String>,
}

/// What was granted and what was not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Everything that was asked for.
    pub items: Vec<Item>,
}

impl Verdict {
    /// True if nothing was refused.
    #[must_use]
    pub fn complete(&self) -> bool {
        self.items.iter().all(|item| item.refused.is_none())
    }

    fn add(&mut self, what: impl Into<String>, outcome: Result<(), String>) {
        self.items.push(Item { what: what.into(), refused: outcome.err() });
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.items.is_empty() {
            return f.write_str("real time was not asked for");
        }
        let granted: Vec<_> =
            self.items.iter().filter(|i| i.refused.is_none()).map(|i| i.what.as_str()).collect();
        if granted.is_empty() {
            f.write_str("nothing granted")?;
        } else {
            write!(f, "granted: {}", granted.join(", "))?;
        }
        for item in &self.items {
            if let Some(why) = &item.refused {
                write!(f, "; not granted: {} ({why})", item.what)?;
            }
        }
        Ok(())
    }
}

/// Ask for locked memory, SCHED_FIFO and one core, for the calling thread.
#[must_use]
pub fn acquire() -> Verdict {
    let mut verdict = Verdict::default();
    lock_memory(&mut verdict);
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let outcome =
        ThreadPriority::try_from(PRIORITY).map_err(|error| error.to_string()).and_then(|priority| {
            set_thread_priority_and_policy(thread_native_id(), priority, policy)
                .map_err(|error| error.to_string())
        });
    verdict.add(format!("SCHED_FIFO {PRIORITY}"), outcome);
    pin(&mut verdict);
    verdict
}

/// Future memory is locked only where no limit can make a later allocation fail because of it.
fn lock_memory(verdict: &mut Verdict) {
    let unlimited = geteuid().is_root() || getrlimit(Resource::Memlock).current.is_none();
    let (what, flags) = if unlimited {
        ("locked memory", MlockAllFlags::CURRENT | MlockAllFlags::FUTURE)
    } else {
        ("locked memory, what is allocated later excepted", MlockAllFlags::CURRENT)
    };
    verdict.add(what, mlockall(flags).map_err(|error| error.to_string()));
}

/// The highest core that the thread may use: interrupts and other programs prefer low ones.
fn pin(verdict: &mut Verdict) {
    let highest = sched_getaffinity(None)
        .map(|allowed| (0..CpuSet::MAX_CPU).rev().find(|&core| allowed.is_set(core)).unwrap_or(0));
    match highest {
        Ok(core) => {
            let mut only = CpuSet::new();
            only.set(core);
            verdict.add(
                format!("core {core}"),
                sched_setaffinity(None, &only).map_err(|error| error.to_string()),
            );
        }
        Err(error) => verdict.add("one core", Err(error.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_names_what_was_refused_and_why() {
        let mut verdict = Verdict::default();
        assert_eq!(verdict.to_string(), "real time was not asked for");
        verdict.add("locked memory", Ok(()));
        verdict.add("SCHED_FIFO 80", Err("operation not permitted".into()));
        assert!(!verdict.complete());
        assert_eq!(
            verdict.to_string(),
            "granted: locked memory; not granted: SCHED_FIFO 80 (operation not permitted)"
        );
    }

    #[test]
    fn every_request_has_an_outcome_and_a_thread_of_its_own_survives_it() {
        // In a thread of its own: what is granted must not last for the other tests.
        let verdict = std::thread::spawn(acquire).join().expect("no panic");
        assert_eq!(verdict.items.len(), 3);
        assert!(verdict.items.iter().all(|item| !item.what.is_empty()));
    }
}
