//! The place of a log in a run that wrote several logs, one after the other ([`crate::rotation`]).

use std::path::PathBuf;

use rcs_core::tick::Tick;

use crate::{
    names::{CONTINUES, EARLIER, REPLAY, RESULT},
    reader::Log,
};

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Part {
    #[error("the log begins at tick {begin}, not at the start of its run; {before}")]
    Later {
        begin: Tick,    // the first tick of the log
        before: Before, // the earlier logs of the run, as far as known
    },
    /// The log has the first ticks, and the run continues in another log.
    #[error("the log ends at tick {end}, and its run continues in another log")]
    First {
        end: Tick, // the last tick of the log
    },
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Before {
    #[error("the first log of the run is {}", .0.display())]
    First(PathBuf),
    #[error("the log before it, {}, is missing", .0.display())]
    Missing(PathBuf),
    #[error("its begin is damaged")]
    Damaged,
}

impl Log {
    /// The place of this log in a run that wrote several logs; `None` if the log has all ticks from the first one on.
    #[must_use]
    pub fn part(&self) -> Option<Part> {
        let begin = self.first_tick()?;
        if begin > Tick::BEFORE_START.next() {
            return Some(Part::Later { begin, before: self.before(begin) });
        }
        let continues = |result: &String| result.starts_with(CONTINUES);
        let is_continued = self.end.as_ref().and_then(|end| end.get(RESULT)).is_some_and(continues);
        is_continued.then(|| Part::First { end: self.last_tick().unwrap_or(begin) })
    }

    fn first_tick(&self) -> Option<Tick> {
        self.messages(REPLAY).next().map(|(tick, _)| tick)
    }

    fn earlier(&self) -> Option<PathBuf> {
        let name = self.lines().find_map(|line| line.text.strip_prefix(EARLIER).map(str::to_owned))?;
        // A name in a log must not point outside the directory.
        let is_name = !name.is_empty() && name != ".." && !name.contains('/');
        is_name.then(|| self.path().with_file_name(name))
    }

    /// Follow the earlier logs to the first one. Each must begin earlier, so that the search ends.
    fn before(&self, mut begin: Tick) -> Before {
        let Some(mut path) = self.earlier() else { return Before::Damaged };
        loop {
            let Ok(log) = Self::open(&path) else { return Before::Missing(path) };
            match log.first_tick() {
                Some(first) if first == Tick::BEFORE_START.next() => return Before::First(path),
                Some(first) if first < begin => begin = first,
                _ => return Before::Damaged,
            }
            let Some(earlier) = log.earlier() else { return Before::Damaged };
            path = earlier;
        }
    }
}
