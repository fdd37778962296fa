//! States of branches that are done: a branch that comes to one of them is done, too.
//!
//! A tick depends on nothing but the state. Two branches that are in the same state in the same tick, but for what
//! [`past`](super::past) forgets, go on alike, and the second one need not be run to its end. Many interruptions leave
//! nothing behind, such as the fault of a sensor that is not read, or leave the same behind as at another tick, such as
//! a process that has restarted.
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

/// The known states.
#[derive(Debug, Default)]
pub struct Known(Mutex<HashMap<State, Arc<End>>>);

impl Known {
    /// True if the states of branches are compared after this tick.
    #[must_use]
    pub const fn compares(tick: Tick) -> bool {
        tick.0.is_multiple_of(EVERY)
    }

    /// How a branch ends that is in this state.
    #[must_use]
    pub fn end(&self, tick: Tick, state: Digest) -> Option<Arc<End>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&(tick, state.value())).cloned()
    }

    /// Note the states of a branch, with their ticks, and its end.
    pub fn add(&self, path: &[(Tick, Digest)], end: &Arc<End>) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.extend(path.iter().map(|(tick, state)| ((*tick, state.value()), Arc::clone(end))));
    }
}
