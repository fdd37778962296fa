//! States of completed branches. A branch that reaches such a state stops and is done, too.
//!
//! Two branches with the same state in the same tick, except for the values that [`past`](super::past) removes,
//! continue alike. Many interruptions leave no trace, or the same trace as at another tick.
//!
//! The judge of confirmations does not belong to the state. The truth of a confirmation depends on the command, the
//! cell, and the place where the robot has released a part. Branches in which a part has slid are not compared, and
//! states are known only if all confirmations of the branch were true. The number of confirmations from a state to the
//! end is stored with it.
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

/// Ticks between two comparisons (2 s). Each one saves the whole cell.
const EVERY: u64 = 50;

type State = (Tick, u64);

#[derive(Clone, Debug)]
pub struct End {
    pub until: Tick,
    pub state: Digest,
    /// The commands that ended, with their ticks.
    pub ended: Vec<(Tick, String)>,
}

/// A state in which a branch was compared with others.
#[derive(Clone, Copy, Debug)]
pub struct Passed {
    pub tick: Tick,
    pub state: Digest,
    /// Number of confirmations judged from the fork of the branch up to this state.
    pub judged: u64,
}

/// The remainder of a branch from a known state on.
#[derive(Clone, Debug)]
pub struct Rest {
    pub end: Arc<End>,
    /// Number of confirmations judged from the state to the end.
    pub judged: u64,
}

#[derive(Debug, Default)]
pub struct Known(Mutex<HashMap<State, Rest>>);

impl Known {
    #[must_use]
    pub const fn compares(tick: Tick) -> bool {
        tick.0.is_multiple_of(EVERY)
    }

    /// The remainder of a branch that is in this state.
    #[must_use]
    pub fn rest(&self, tick: Tick, state: Digest) -> Option<Rest> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&(tick, state.value())).cloned()
    }

    /// Store the states of a branch, its end, and the number of confirmations judged from the fork to the end.
    pub fn add(&self, path: &[Passed], end: &Arc<End>, judged: u64) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.extend(path.iter().map(|passed| {
            let rest = Rest { end: Arc::clone(end), judged: judged - passed.judged };
            ((passed.tick, passed.state.value()), rest)
        }));
    }
}
