//! Runs the branches: one thread runs the undisturbed job and forks it, others run what it forks.

use std::sync::{Arc, Mutex, mpsc};
use std::thread;

use super::{
    branch::{Branch, Facility, Fork},
    interruption::Kind,
    parent::{Parent, emulator},
    trial::{self, BranchResult, NoObserver, Procedure},
};
use crate::error::Error;

/// A state, and what interrupts it.
type Work = (Arc<Fork>, usize);

/// Fork the job after each of `forks`, and run a branch for each kind of interruption. `done` is told of each result as it comes.
///
/// # Errors
/// [`Error`] if the run cannot be forked.
pub fn run(
    facility: &Facility,
    parent: &Parent,
    forks: &[u64],
    kinds: &[Kind],
    procedure: Procedure,
    threads: usize,
    done: &(impl Fn(&BranchResult) + Sync),
) -> Result<Vec<BranchResult>, Error> {
    let results = Mutex::new(Vec::with_capacity(forks.len() * kinds.len()));
    // A branch takes longer than a fork: what waits is bounded.
    let (send, receive) = mpsc::sync_channel::<Work>(2 * threads);
    let receive = Mutex::new(receive);
    let outcome = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| {
                    let mut outcome = Ok(());
                    while let Some((fork, kind)) = next(&receive) {
                        // After an error what waits is taken and left, so that the thread that forks is not kept waiting.
                        if outcome.is_err() {
                            continue;
                        }
                        match trial::run(facility, parent, &fork, &kinds[kind], procedure, &mut NoObserver) {
                            Err(error) => outcome = Err(error),
                            Ok(result) => {
                                done(&result);
                                if let Ok(mut results) = results.lock() {
                                    results.push((fork_order(&result, kind), result));
                                }
                            }
                        }
                    }
                    outcome
                })
            })
            .collect();
        let forked = fork_all(facility, forks, kinds.len(), send);
        let worked: Result<Vec<()>, Error> = workers
            .into_iter()
            .map(|worker| {
                worker.join().unwrap_or_else(|_| Err(Error::Fork("a branch has panicked".to_owned())))
            })
            .collect();
        worked.and(forked)
    });
    outcome?;
    let mut results = results.into_inner().unwrap_or_default();
    results.sort_by_key(|(order, _)| *order);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

/// The next state to interrupt; none if there will be none.
fn next(receive: &Mutex<mpsc::Receiver<Work>>) -> Option<Work> {
    receive.lock().ok()?.recv().ok()
}

/// Judgements stand in the order of their ticks, whichever thread was first.
const fn fork_order(result: &BranchResult, kind: usize) -> (usize, u64) {
    (kind, result.at)
}

fn fork_all(
    facility: &Facility,
    forks: &[u64],
    kinds: usize,
    send: mpsc::SyncSender<Work>,
) -> Result<(), Error> {
    let mut branch = Branch::start(facility)?;
    let mut hwsc = emulator(facility);
    for tick in forks {
        while branch.at().0 < *tick {
            branch.tick(&mut hwsc);
        }
        let fork = Arc::new(branch.fork()?);
        for kind in 0..kinds {
            // The receiver outlives the workers.
            let _ = send.send((Arc::clone(&fork), kind));
        }
    }
    Ok(())
}

/// The state after one tick of the undisturbed job.
///
/// # Errors
/// [`Error`] if the run cannot be forked.
pub fn fork_at(facility: &Facility, tick: u64) -> Result<Fork, Error> {
    let mut branch = Branch::start(facility)?;
    let mut hwsc = emulator(facility);
    while branch.at().0 < tick {
        branch.tick(&mut hwsc);
    }
    branch.fork()
}
