//! Runs the branches: one thread runs and forks the undisturbed job, the other threads run the forks.

use std::{
    panic::{self, AssertUnwindSafe},
    sync::{Arc, Mutex, PoisonError, mpsc},
    thread,
};

use super::{
    branch::{Branch, Facility},
    coverage::Coverage,
    known::Known,
    parent::{Parent, emulator},
    series::Series,
    trial::{self, Procedure},
    verdict::BranchResult,
};
use crate::rcs_run::error::Error;

#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub at: u64,
    pub series: Series,
    /// How the branch is recovered and judged.
    pub procedure: Procedure,
}

type Work<'f> = (Arc<Branch<'f>>, usize);

/// Run a branch for each plan to its end, or up to a known state. Calls `done` with each new result and its coverage.
/// The return values of `done` are in the order of the plans, for any number of `threads`.
pub fn run<T: Send>(
    facility: &Facility,
    parent: &Parent,
    plans: &[Plan],
    threads: usize,
    known: Option<&Known>,
    done: &(impl Fn(BranchResult, Coverage) -> Result<T, Error> + Sync),
) -> Result<Vec<T>, Error> {
    let collected = Mutex::new(Vec::with_capacity(plans.len()));
    // A branch takes longer than a fork, so the queue of forks is bounded.
    let (send, receive) = mpsc::sync_channel::<Work<'_>>(2 * threads);
    let receive = Mutex::new(receive);
    let outcome = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| {
                    let mut outcome = Ok(());
                    while let Some((fork, at)) = next(&receive) {
                        // After an error the workers drain the queue, so that the forking thread is not blocked.
                        if outcome.is_err() {
                            continue;
                        }
                        let Plan { series, procedure, .. } = &plans[at];
                        let mut met = Coverage::default();
                        // A panic in a branch must end the campaign, not only its thread.
                        let run = AssertUnwindSafe(|| {
                            trial::run(facility, parent, &fork, series, *procedure, known, &mut met)
                        });
                        let panicked = |_| {
                            let at = plans[at].at;
                            Err(Error::Fork(format!("the branch {series} at {at} has panicked")))
                        };
                        outcome = panic::catch_unwind(run)
                            .unwrap_or_else(panicked)
                            .and_then(|result| done(result, met))
                            .map(|done| {
                                collected.lock().unwrap_or_else(PoisonError::into_inner).push((at, done))
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
    let mut collected = collected.into_inner().unwrap_or_else(PoisonError::into_inner);
    collected.sort_by_key(|(at, _)| *at);
    Ok(collected.into_iter().map(|(_, done)| done).collect())
}

fn next<'f>(receive: &Mutex<mpsc::Receiver<Work<'f>>>) -> Option<Work<'f>> {
    receive.lock().ok()?.recv().ok()
}

fn fork_all<'f>(
    facility: &'f Facility,
    plans: &[Plan],
    send: mpsc::SyncSender<Work<'f>>,
) -> Result<(), Error> {
    let mut branch = Branch::start(facility)?;
    let mut hwsc = emulator(facility);
    let mut order: Vec<usize> = (0..plans.len()).collect();
    order.sort_by_key(|at| plans[*at].at);
    for same in order.chunk_by(|a, b| plans[*a].at == plans[*b].at) {
        while branch.at().0 < plans[same[0]].at {
            branch.step(&mut hwsc);
        }
        let fork = Arc::new(branch.clone());
        for at in same {
            // The receiver lives longer than the workers.
            let _ = send.send((Arc::clone(&fork), *at));
        }
    }
    Ok(())
}

/// The state after one tick of the undisturbed job. Fails with [`Error`] if the run cannot be forked.
pub fn fork_at(facility: &Facility, tick: u64) -> Result<Branch<'_>, Error> {
    let mut branch = Branch::start(facility)?;
    let mut hwsc = emulator(facility);
    while branch.at().0 < tick {
        branch.step(&mut hwsc);
    }
    Ok(branch)
}
