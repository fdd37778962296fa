//! Requests real-time operation from the system, and reports what the system refused.
//!
//! The requests: no page faults in a tick (`mlockall`, a touched stack), priority of the tick thread (`SCHED_FIFO`),
//! one fixed core, and no deep idle states (`/dev/cpu_dma_latency`). Only ticks on time need them, not correct
//! results, so a refusal is a note in the verdict and not an error.
//!
//! Threads inherit policy and core: start log and progress threads before calling [`acquire`].

use std::{
    fmt,
    fs::File,
    hint::black_box,
    io::{self, Write},
};

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
pub const FIELD_PRIORITY: u8 = PRIORITY - 1; // priority of the threads of couplers: below the tick
/// Priority of a simulated cell in real time. Its physics takes milliseconds, so everything that must be punctual in
/// both programs is above it.
pub const CELL_PRIORITY: u8 = FIELD_PRIORITY - 1;

/// Size of the stack that is touched beforehand; a tick needs a fraction of it.
const STACK_BYTES: usize = 512 * 1024;
/// While this file is open, the cores use no idle state with a longer wake-up time than the written one, us.
const IDLE_STATES: &str = "/dev/cpu_dma_latency";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    pub what: String,
    pub refused: Option<String>, // reason of the refusal; `None` if it was granted
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
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

/// The granted requests. Idle states are limited until this is dropped.
pub struct RealTime {
    pub verdict: Verdict,
    _idle_states: Option<File>,
}

/// Make all requests for the calling thread. `core` is the core to run on; `None` chooses the highest number that the
/// process may use, because interrupts and other programs prefer low ones.
#[must_use]
pub fn acquire(core: Option<usize>) -> RealTime {
    let mut verdict = Verdict::default();
    lock_memory(&mut verdict);
    touch_stack();
    verdict.add("stack touched", Ok(()));
    verdict.add(format!("SCHED_FIFO {PRIORITY}"), raise_priority(PRIORITY));
    pin(&mut verdict, core);
    let idle_states = limit_idle_states();
    let outcome = idle_states.as_ref().map(|_| ()).map_err(ToString::to_string);
    verdict.add("no deep idle states", outcome);
    RealTime { verdict, _idle_states: idle_states.ok() }
}

/// Request only the priority, for the calling thread: for a thread that serves a link in parallel with the ticks.
pub fn raise_priority(priority: u8) -> Result<(), String> {
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    ThreadPriority::try_from(priority).map_err(|error| error.to_string()).and_then(|priority| {
        set_thread_priority_and_policy(thread_native_id(), priority, policy).map_err(in_words)
    })
}

fn in_words(error: thread_priority::Error) -> String {
    match error {
        thread_priority::Error::OS(number) => io::Error::from_raw_os_error(number).to_string(),
        other => other.to_string(),
    }
}

/// Allocate the pages of the stack before the first tick needs them.
#[inline(never)]
fn touch_stack() {
    let mut stack = [0_u8; STACK_BYTES];
    black_box(&mut stack);
}

fn limit_idle_states() -> io::Result<File> {
    let mut file = File::options().write(true).open(IDLE_STATES)?;
    file.write_all(&0_i32.to_ne_bytes())?;
    Ok(file)
}

/// Lock memory. Future memory is locked only if no limit can then make a later allocation fail.
fn lock_memory(verdict: &mut Verdict) {
    let unlimited = geteuid().is_root() || getrlimit(Resource::Memlock).current.is_none();
    let (what, flags) = if unlimited {
        ("locked memory", MlockAllFlags::CURRENT | MlockAllFlags::FUTURE)
    } else {
        ("locked memory, what is allocated later excepted", MlockAllFlags::CURRENT)
    };
    verdict.add(what, mlockall(flags).map_err(|error| error.to_string()));
}

fn pin(verdict: &mut Verdict, core: Option<usize>) {
    let chosen = match core {
        Some(core) if core < CpuSet::MAX_CPU => Ok(core),
        Some(core) => Err(format!("there is no core {core}")),
        None => sched_getaffinity(None)
            .map(|allowed| (0..CpuSet::MAX_CPU).rev().find(|&core| allowed.is_set(core)).unwrap_or(0))
            .map_err(|error| error.to_string()),
    };
    match chosen {
        Ok(core) => {
            let mut only = CpuSet::new();
            only.set(core);
            verdict.add(
                format!("core {core}"),
                sched_setaffinity(None, &only).map_err(|error| error.to_string()),
            );
        }
        Err(error) => verdict.add("one core", Err(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_names_the_refused_command_and_the_reason() {
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
        // In a separate thread, so that granted requests do not affect the other tests.
        let verdict = std::thread::spawn(|| acquire(None).verdict).join().expect("no panic");
        assert_eq!(verdict.items.len(), 5);
        assert!(verdict.items.iter().all(|item| !item.what.is_empty()));
    }

    #[test]
    fn a_core_that_is_not_there_is_refused() {
        let refused = |core| {
            let mut verdict = Verdict::default();
            std::thread::spawn(move || {
                pin(&mut verdict, Some(core));
                verdict.items[0].refused.clone()
            })
            .join()
            .expect("no panic")
        };
        assert_eq!(refused(100_000), Some("there is no core 100000".to_owned()));
        assert!(refused(CpuSet::MAX_CPU - 1).is_some(), "no machine has so many");
    }
}
