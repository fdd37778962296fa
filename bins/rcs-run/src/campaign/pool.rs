//! Runs the branches: one thread runs the undisturbed job and forks it, others run what it forks.

use std::sync::{Arc, Mutex, mpsc};
use std::thread;

use super::{
    branch::{Branch, Facility, Fork},
    parent::{Parent, emulator},
    rows::RowsFired,
    series::Series,
    trial::{self, BranchResult, Procedure},
};
use crate::error::Error;

/// A branch that is to be run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The tick after which the job is forked.
    pub at: u64,
    /// What interrupts it.
    pub series: Series,
    /// How it is recovered and judged.
    pub procedure: Procedure,
}

/// A state, and which plan begins with it.
type Work = (Arc<Fork>, usize);

/// What came of branches.
#[derive(Debug, Default)]
pub struct Outcome {
    /// In the order of the plans.
    pub results: Vec<BranchResult>,
    /// The rows that have fired in them.
    pub rows: RowsFired,
}

/// Run a branch for each plan. `done` gets each result as it comes, and the rows that no branch before has fired. The
/// outcome does not depend on `threads`.
///
/// # Errors
/// [`Error`] if the run cannot be forked, and those of `done`.
pub fn run(
    facility: &Facility,
    parent: &Parent,
    plans: &[Plan],
    threads: usize,
    done: &(impl Fn(&BranchResult, &RowsFired) -> Result<(), Error> + Sync),
) -> Result<Outcome, Error> {
    let collected = Mutex::new((Vec::with_capacity(plans.len()), RowsFired::default()));
    // A branch takes longer than a fork: what waits is bounded.
    let (send, receive) = mpsc::sync_channel::<Work>(2 * threads);
    let receive = Mutex::new(receive);
    let outcome = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| {
                    let mut outcome = Ok(());
                    while let Some((fork, at)) = next(&receive) {
                        // After an error what waits is taken and left, so that the thread that forks is not kept waiting.
                        if outcome.is_err() {
                            continue;
                        }
                        let Plan { series, procedure, .. } = &plans[at];
                        let mut rows = RowsFired::default();
                        outcome = trial::run(facility, parent, &fork, series, *procedure, &mut rows)
                            .and_then(|result| {
                                let Ok(mut collected) = collected.lock() else { return Ok(()) };
                                let fresh = collected.1.take_in(rows);
                                done(&result, &fresh)?;
                                collected.0.push((at, result));
                                Ok(())
                            });
                    }
                    outcome
                })
            })
            .collect();
        let forked = fork_all(facility, plans, send);
        let worked: Result<Vec<()>, Error> = workers
            .into_iter()
            .map(|worker| {
                worker.join().unwrap_or_else(|_| Err(Error::Fork("a branch has panicked".to_owned())))
            })
            .collect();
        worked.and(forked)
    });
    outcome?;
    let (mut results, rows) = collected.into_inner().unwrap_or_default();
    results.sort_by_key(|(at, _)| *at);
    Ok(Outcome { results: results.into_iter().map(|(_, result)| result).collect(), rows })
}

/// The next state to interrupt; none if there will be none.
fn next(receive: &Mutex<mpsc::Receiver<Work>>) -> Option<Work> {
    receive.lock().ok()?.recv().ok()
}

fn fork_all(facility: &Facility, plans: &[Plan], send: mpsc::SyncSender<Work>) -> Result<(), Error> {
    let mut branch = Branch::start(facility)?;
    let mut hwsc = emulator(facility);
    let mut order: Vec<usize> = (0..plans.len()).collect();
    order.sort_by_key(|at| plans[*at].at);
    for same in order.chunk_by(|a, b| plans[*a].at == plans[*b].at) {
        while branch.at().0 < plans[same[0]].at {
            branch.tick(&mut hwsc);
        }
        let fork = Arc::new(branch.fork()?);
        for at in same {
            // The receiver outlives the workers.
            let _ = send.send((Arc::clone(&fork), *at));
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
