//! Branches drawn at random, and the smallest series of interruptions with the same outcome as a drawn one.
//!
//! Branches are drawn in rounds. From the second round on, about half are variations of earlier ones, preferably of
//! those with most new rows and states. A draw depends on its seed and the coverage of earlier rounds.

use std::collections::HashSet;

use rand::{RngExt as _, SeedableRng as _, seq::IndexedRandom as _};
use rand_chacha::ChaCha8Rng;

use super::{
    coverage::Coverage,
    interruption::Kind,
    parent::{Parent, Ticks},
    pool::Plan,
    series::{Interruption, Series},
    trial::{Procedure, Until},
};

/// Upper limits of the ticks between two interruptions: at once, within a step, within a command.
const BETWEEN: [u64; 3] = [3, 60, 600];
const ROUND: usize = 64;
const ROW: usize = 20; // weight of a new row, in new states
/// Greatest weight of a branch. Without it, the first branches would dominate, because they reach all rows first.
const MOST: usize = 5 * ROW;
const NEAR: u64 = 12; // a changed branch begins this many ticks sooner or later, at most
const AGAIN: usize = 8; // number of repeated draws if a branch was drawn before

#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub branches: usize,
    /// Largest number of interruptions of a branch.
    pub longest: usize,
    pub seed: u64,
}

pub struct Draw {
    settings: Settings,
    procedure: Procedure,
    random: ChaCha8Rng,
    last: u64,
    changes: Vec<u64>,
    /// The drawn kinds, grouped by word, and the stops that end branches judged at rest.
    kinds: Vec<Vec<Kind>>,
    stops: Vec<Vec<Kind>>,
    drawn: HashSet<(u64, String)>,
    met: Coverage,
    fruitful: Vec<(Plan, usize)>, // branches with new coverage, and its weight
}

impl Draw {
    /// Half of the branches begin in ticks in which a step or a command changes. A branch that is judged at rest ends
    /// with a stop.
    #[must_use]
    pub fn new(parent: &Parent, kinds: &[Kind], procedure: Procedure, settings: Settings) -> Self {
        let rest = procedure.until == Until::Rest;
        let group = |keep: &dyn Fn(&&Kind) -> bool| {
            let kinds: Vec<Kind> = kinds.iter().filter(keep).cloned().collect();
            kinds.chunk_by(|a, b| word(a) == word(b)).map(<[Kind]>::to_vec).collect::<Vec<_>>()
        };
        Self {
            settings,
            procedure,
            random: ChaCha8Rng::seed_from_u64(settings.seed),
            last: parent.ticks - 1,
            changes: parent.forks(&Ticks::Changes),
            kinds: group(&|kind| !rest || !kind.is_for_good()),
            stops: if rest { group(&|kind| kind.is_stop()) } else { Vec::new() },
            drawn: HashSet::new(),
            met: Coverage::default(),
            fruitful: Vec::new(),
        }
    }

    /// The branches of the next round; empty if all are drawn.
    pub fn round(&mut self) -> Vec<Plan> {
        let left = self.settings.branches.saturating_sub(self.drawn.len());
        (0..left.min(ROUND)).map_while(|_| self.next()).collect()
    }

    /// Add the coverage of a branch of the last round. Call it for all branches of the round, in order.
    pub fn learn(&mut self, plan: &Plan, coverage: Coverage) {
        let (rows, states) = self.met.take_in(coverage).counts();
        let weight = (ROW * rows + states).min(MOST);
        if weight > 0 {
            self.fruitful.push((plan.clone(), weight));
        }
    }

    fn next(&mut self) -> Option<Plan> {
        let mut plan = self.draw()?;
        for _ in 0..AGAIN {
            if !self.drawn.contains(&key(&plan)) {
                break;
            }
            plan = self.draw()?;
        }
        self.drawn.insert(key(&plan)).then_some(plan)
    }

    fn draw(&mut self) -> Option<Plan> {
        let known = self.fruitful.choose_weighted(&mut self.random, |(_, weight)| *weight);
        let known = known.ok().map(|(plan, _)| plan.clone());
        let (at, mut drawn) = match known.filter(|_| self.random.random()) {
            Some(plan) => self.changed(&plan)?,
            None => self.anew()?,
        };
        if !self.stops.is_empty() {
            drawn.push(Interruption { after: self.between()?, kind: kind(&self.stops, &mut self.random)? });
        }
        Some(Plan { at, series: Series::of(drawn)?, procedure: self.procedure })
    }

    /// A tick and interruptions that are independent of the earlier ones.
    fn anew(&mut self) -> Option<(u64, Vec<Interruption>)> {
        let change = self.changes.choose(&mut self.random).filter(|_| self.random.random());
        let at = change.copied().unwrap_or_else(|| self.random.random_range(1..=self.last));
        let mut drawn = Vec::new();
        for place in 0..self.random.random_range(1..=self.settings.longest) {
            let after = if place == 0 { 0 } else { self.between()? };
            drawn.push(Interruption { after, kind: kind(&self.kinds, &mut self.random)? });
        }
        Some((at, drawn))
    }

    /// Change a branch at one point: its tick, an interruption, or the ticks before one. Or add an interruption.
    fn changed(&mut self, plan: &Plan) -> Option<(u64, Vec<Interruption>)> {
        let mut drawn = plan.series.interruptions().to_vec();
        drawn.truncate(drawn.len() - usize::from(!self.stops.is_empty()));
        let place = self.random.random_range(0..drawn.len());
        let mut at = plan.at;
        match self.random.random_range(0..4) {
            0 => drawn[place].kind = kind(&self.kinds, &mut self.random)?,
            1 if place > 0 => drawn[place].after = self.between()?,
            2 if drawn.len() < self.settings.longest => {
                let after = self.between()?;
                drawn.push(Interruption { after, kind: kind(&self.kinds, &mut self.random)? });
            }
            _ => {
                let near = at.saturating_sub(NEAR).max(1)..=(at + NEAR).min(self.last);
                at = self.random.random_range(near);
            }
        }
        Some((at, drawn))
    }

    fn between(&mut self) -> Option<u64> {
        let most = BETWEEN.choose(&mut self.random).copied()?;
        Some(self.random.random_range(0..=most))
    }
}

fn key(plan: &Plan) -> (u64, String) {
    (plan.at, plan.series.to_string())
}

fn word(kind: &Kind) -> String {
    kind.to_string().split(':').next().unwrap_or_default().to_owned()
}

/// Draw a kind: each word is equally likely, regardless of the number of kinds that it selects.
fn kind(groups: &[Vec<Kind>], random: &mut ChaCha8Rng) -> Option<Kind> {
    groups.choose(random)?.choose(random).cloned()
}

/// The smallest series for which `is_same` holds, without unneeded interruptions and with shorter times between them.
pub fn smallest<E>(
    series: &Series,
    mut is_same: impl FnMut(&Series) -> Result<bool, E>,
) -> Result<Series, E> {
    let mut smallest = series.clone();
    'smaller: loop {
        let count = smallest.interruptions().len();
        let shorter = (0..count).filter_map(|at| smallest.without(at));
        let sooner = (1..count).filter_map(|at| smallest.sooner(at));
        for candidate in shorter.chain(sooner) {
            if is_same(&candidate)? {
                smallest = candidate;
                continue 'smaller;
            }
        }
        return Ok(smallest);
    }
}
