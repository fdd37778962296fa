//! Searches for runs to show.

use std::time::{Duration, Instant};

use executive::{boards, memory, memory::RunName};

use crate::rcs_console::view::Waiting;

const SEARCH: Duration = Duration::from_secs(1);

pub struct Search {
    wanted: Option<RunName>,
    looked: Instant,
}

impl Search {
    #[must_use]
    pub fn begin(wanted: Option<RunName>) -> (Waiting, Self) {
        let search = Self { wanted, looked: Instant::now() };
        let mut waiting = Waiting::default();
        search.look(&mut waiting);
        (waiting, search)
    }

    /// Search again when it is time. Returns the run to attach to, if there is only one.
    pub fn go_on(&mut self, waiting: &mut Waiting) -> Option<RunName> {
        if self.looked.elapsed() >= SEARCH {
            self.look(waiting);
            self.looked = Instant::now();
        }
        match &waiting.runs[..] {
            [only] if waiting.refused.is_none() && waiting.boards.is_empty() && waiting.phase.is_none() => {
                Some(only.clone())
            }
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
                // A new run accepts operators only a moment after its start, so the console tries an only run again.
                waiting.refused.take_if(|_| waiting.runs.len() == 1);
                waiting.phase = waiting.chosen().and_then(memory::starting);
                waiting.boards = waiting.chosen().and_then(boards::coming_up).unwrap_or_default();
            }
            Err(error) => waiting.refused = Some(error.to_string()),
        }
    }
}
