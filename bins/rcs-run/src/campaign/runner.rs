//! Runs branches that the journal does not contain, writes them into it, and shows the progress.

use std::{
    io::{self, IsTerminal as _},
    sync::{Mutex, PoisonError},
    time::Duration,
};

use indicatif::{ProgressBar, ProgressStyle};
use os_io::console::shown;
use os_io::text::amount;

use super::{
    arguments::CampaignArguments,
    branch::Facility,
    coverage::Coverage,
    journal::{self, Journal, Judged},
    known::Known,
    parent::Parent,
    pool::{self, Plan},
    random::Draw,
    trial::Procedure,
    verdict::{BranchResult, Verdict},
};
use crate::rcs_run::error::Error;

/// The part of a branch's coverage that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoveragePart {
    /// Rows and states that no earlier branch has reached.
    New,
    /// The whole coverage, on which the next draw depends.
    All,
}

pub struct Runner<'a> {
    facility: &'a Facility,
    parent: &'a Parent,
    threads: usize,
    journal: Journal,
    bar: Option<ProgressBar>,
    met: Mutex<Coverage>,
    known: Known,
}

impl<'a> Runner<'a> {
    pub fn new(
        arguments: &CampaignArguments,
        facility: &'a Facility,
        parent: &'a Parent,
        procedure: Procedure,
        branches: usize,
    ) -> Result<Self, Error> {
        let campaign = journal::campaign(facility, parent, procedure, arguments.random.is_some());
        let journal = match &arguments.journal {
            Some(path) => Journal::open(path, &campaign)?,
            None => Journal::default(),
        };
        let threads = usize::from(arguments.threads);
        let met = Mutex::default();
        Ok(Self { facility, parent, threads, journal, bar: bar(branches), met, known: Known::default() })
    }

    /// Run the branches that the journal does not contain, and return all of them in order.
    pub fn run(&self, plans: &[Plan], keep: CoveragePart) -> Result<Vec<Judged>, Error> {
        let known: Vec<Option<Judged>> = plans.iter().map(|plan| self.journal.known(plan).cloned()).collect();
        let missing = plans.iter().zip(&known).filter(|(_, known)| known.is_none());
        let missing: Vec<Plan> = missing.map(|(plan, _)| plan.clone()).collect();
        for (_, met) in known.iter().flatten() {
            self.learn(met.clone());
        }
        let done = |result: BranchResult, met: Coverage| {
            self.warn(&result);
            let new = self.learn(met.clone());
            let kept = if keep == CoveragePart::All { met } else { new };
            self.journal.write(&result, &kept)?;
            Ok((result, kept))
        };
        // A branch reaches nothing new after a known state. But a draw needs the whole coverage of each branch, and the
        // state of couplers is not compared.
        let compares = keep == CoveragePart::New && self.facility.mapping.is_none();
        let states = compares.then_some(&self.known);
        let mut run =
            pool::run(self.facility, self.parent, &missing, self.threads, states, &done)?.into_iter();
        Ok(known.into_iter().filter_map(|known| known.or_else(|| run.next())).collect())
    }

    /// Draw and run branches, in rounds. Fails like [`Self::run`].
    pub fn draw(&self, mut draw: Draw) -> Result<(Vec<Plan>, Vec<Judged>), Error> {
        let (mut plans, mut judged) = (Vec::new(), Vec::new());
        loop {
            let round = draw.round();
            if round.is_empty() {
                return Ok((plans, judged));
            }
            let results = self.run(&round, CoveragePart::All)?;
            for (plan, (_, met)) in round.iter().zip(&results) {
                draw.learn(plan, met.clone());
            }
            plans.extend(round);
            judged.extend(results);
        }
    }

    fn learn(&self, met: Coverage) -> Coverage {
        let mut all = self.met.lock().unwrap_or_else(PoisonError::into_inner);
        let new = all.take_in(met);
        if let Some(bar) = &self.bar {
            let (rows, states) = all.counts();
            bar.set_message(format!("{}, {}", amount(rows, "row"), amount(states, "state")));
            bar.inc(1);
        }
        new
    }

    fn warn(&self, result: &BranchResult) {
        if let (Some(bar), Verdict::Hurt) = (&self.bar, result.verdict) {
            let line = format!("hurt: {} at {}: {}", result.interruption, result.at, result.detail);
            bar.println(shown(&line));
        }
    }

    pub fn finish(self) -> Coverage {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.met.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The progress bar on a terminal; `None` if standard error is not a terminal.
fn bar(branches: usize) -> Option<ProgressBar> {
    io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::new(branches as u64).with_elapsed(Duration::ZERO);
        if let Ok(style) =
            ProgressStyle::with_template("{wide_bar} {pos}/{len} branches, {per_sec}, {msg}, {eta} left")
        {
            bar.set_style(style);
        }
        bar
    })
}
