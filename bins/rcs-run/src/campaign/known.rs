//! States of branches that are done: a branch that comes to one of them is done, too.
//!
//! A tick depends on nothing but the state. Two branches that are in the same state in the same tick, but for what
//! [`past`](super::past) forgets, go on alike, and the second one need not be run to its end. Many interruptions leave
//! nothing behind, such as the fault of a sensor that is not read, or leave the same behind as at another tick, such as
//! a process that has restarted.
//!
//! The judge of confirmations is no part of the state. Whether a confirmation is true depends on the command, the cell,
//! and where the robot has released a part; a part that lies in the same place was released there, as branches in which
//! one has slid are not compared. What else the judge remembers, such as the parts that a person has changed, only tells
//! why no sensor could show an untrue confirmation. So the states of a branch are known only if all its confirmations
//! were true. How many are judged from a state to the end is known with it.
//!
//! ```text
//!   branch 1  --x----------+-----------+-----------+------- done     x  interrupted
//!   branch 2  -------x-----+-----------* done                        +  the state is compared
//!                                                                    *  the state of branch 1 in this tick
//! ```

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, PoisonError},
};

use rcs_core::{digest::Digest, tick::Tick};

/// Ticks between two comparisons (2 s): for each of them the whole cell is saved.
const EVERY: u64 = 50;

/// A state: its tick, and its digest.
type State = (Tick, u64);

/// How a branch ended that is done.
#[derive(Clone, Debug)]
pub struct End {
    /// Its last tick.
    pub until: Tick,
    /// Digest of its last state.
    pub state: Digest,
    /// The commands that ended, with their ticks.
    pub ended: Vec<(Tick, String)>,
}

/// A state in which a branch was compared with others.
#[derive(Clone, Copy, Debug)]
pub struct Passed {
    pub tick: Tick,
    pub state: Digest,
    /// Number of confirmations that were judged up to it, from the fork of the branch on.
    pub judged: u64,
}

/// How a branch ends that is in a known state.
#[derive(Clone, Debug)]
pub struct Rest {
    pub end: Arc<End>,
    /// Number of confirmations that are judged from the state to the end.
    pub judged: u64,
}

#[derive(Debug, Default)]
pub struct Known(Mutex<HashMap<State, Rest>>);

impl Known {
    /// True if the states of branches are compared after this tick.
    #[must_use]
    pub const fn compares(tick: Tick) -> bool {
        tick.0.is_multiple_of(EVERY)
    }

    /// How a branch ends that is in this state.
    #[must_use]
    pub fn rest(&self, tick: Tick, state: Digest) -> Option<Rest> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&(tick, state.value())).cloned()
    }

    /// Note the states of a branch, its end, and the number of confirmations that were judged up to it, from the fork on.
    pub fn add(&self, path: &[Passed], end: &Arc<End>, judged: u64) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.extend(path.iter().map(|passed| {
            let rest = Rest { end: Arc::clone(end), judged: judged - passed.judged };
            ((passed.tick, passed.state.value()), rest)
        }));
    }
}
