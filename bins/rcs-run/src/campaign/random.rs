//! Branches drawn at random, and the smallest series of interruptions with the same outcome as a drawn one.

use std::iter;

use rand::{Rng, RngExt as _, SeedableRng as _, seq::IndexedRandom as _};
use rand_chacha::ChaCha8Rng;

use super::{
    interruption::Kind,
    parent::{Parent, Ticks},
    pool::Plan,
    series::Series,
    trial::{Procedure, Until},
};

/// Upper limits of the ticks between two interruptions, one of which is drawn: at once, within a step, within a
/// command.
const BETWEEN: [u64; 3] = [3, 60, 600];

/// Parameters of the draw.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// Number of branches.
    pub branches: usize,
    /// Largest number of interruptions of a branch.
    pub longest: usize,
    /// Seed of the draw.
    pub seed: u64,
}

impl Draw {
    /// The drawn branches. Half of them begin in ticks in which something changes. A branch that is judged at rest gets
    /// a stop after its drawn interruptions.
    #[must_use]
    pub fn plans(&self, parent: &Parent, kinds: &[Kind], procedure: Procedure) -> Vec<Plan> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let changes = parent.forks(&Ticks::Changes);
        let is_same_word = |a: &Kind, b: &Kind| word(a) == word(b);
        let (rest, drawn): (bool, Vec<Kind>) = match procedure.until {
            Until::Rest => (true, kinds.iter().filter(|kind| !kind.is_for_good()).cloned().collect()),
            Until::Next | Until::Job => (false, kinds.to_vec()),
        };
        let groups: Vec<&[Kind]> = drawn.chunk_by(is_same_word).collect();
        let stops: Vec<Kind> = kinds.iter().filter(|kind| kind.is_stop()).cloned().collect();
        let stops: Vec<&[Kind]> = stops.chunk_by(is_same_word).collect();
        let mut draw = || {
            let change = changes.choose(&mut random).filter(|_| random.random());
            let at = change.copied().unwrap_or_else(|| random.random_range(1..parent.ticks));
            let mut series = Series::from(kind(&groups, &mut random)?);
            let more = random.random_range(1..=self.longest) - 1;
            for groups in iter::repeat_n(&groups, more).chain(rest.then_some(&stops)) {
                let most = BETWEEN.choose(&mut random).copied()?;
                series = series.then(random.random_range(0..=most), kind(groups, &mut random)?);
            }
            Some(Plan { at, series, procedure })
        };
        (0..self.branches).map_while(|_| draw()).collect()
    }
}

/// The command line word of a kind, without its parameter.
fn word(kind: &Kind) -> String {
    kind.to_string().split(':').next().unwrap_or_default().to_owned()
}

/// Draw a kind: each word is equally likely, whatever number of kinds it selects.
fn kind(groups: &[&[Kind]], random: &mut impl Rng) -> Option<Kind> {
    groups.choose(random)?.choose(random).cloned()
}

/// The smallest series, found by leaving out interruptions and shortening the time between them, for which `is_same`
/// holds.
///
/// # Errors
/// The errors of `is_same`.
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
