//! The search for a run that can be shown.

use std::time::{Duration, Instant};

use executive::{boards, memory, memory::RunName};

use crate::view::Waiting;

/// Runs are looked for this often.
const SEARCH: Duration = Duration::from_secs(1);

/// Looks for runs, again and again.
pub struct Search {
    /// The only run that is wanted, if one was named.
    wanted: Option<RunName>,
    looked: Instant,
}

impl Search {
    /// Begin a search, and look for the first time.
    #[must_use]
    pub fn begin(wanted: Option<RunName>) -> (Waiting, Self) {
        let search = Self { wanted, looked: Instant::now() };
        let mut waiting = Waiting::default();
        search.look(&mut waiting);
        (waiting, search)
    }

    /// Look again, if it is time; the run to attach to, if there is no choice.
    pub fn go_on(&mut self, waiting: &mut Waiting) -> Option<RunName> {
        if self.looked.elapsed() >= SEARCH {
            self.look(waiting);
            self.looked = Instant::now();
        }
        match &waiting.runs[..] {
            [only] if waiting.refused.is_none() && waiting.boards.is_empty() => Some(only.clone()),
            _ => None,
        }
    }

    fn look(&self, waiting: &mut Waiting) {
        match memory::list() {
            Ok(runs) => {
                let alive = runs.into_iter().filter(|run| run.alive).map(|run| run.name);
                waiting.take(
                    alive.filter(|name| self.wanted.as_ref().is_none_or(|wanted| wanted == name)).collect(),
                );
                // A run that has just begun may take operators only a moment later: without a choice it is tried again.
                waiting.refused.take_if(|_| waiting.runs.len() == 1);
                waiting.boards = waiting.chosen().and_then(boards::coming_up).unwrap_or_default();
            }
            Err(error) => waiting.refused = Some(error.to_string()),
        }
    }
}
