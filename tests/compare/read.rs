use std::{
    fmt,
    io::{self, BufRead},
};

use super::CompareError;
use crate::trace::{END, TICKS};

/// A tick, or the end, which follows all ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Moment {
    Tick(u64),
    End,
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tick(tick) => f.pad(&format!("tick {tick}")),
            Self::End => f.pad(END),
        }
    }
}

pub(super) struct Lines<R> {
    which: &'static str,
    lines: io::Lines<R>,
    number: usize,
    next: Option<(Moment, String, String)>,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(which: &'static str, input: R) -> Result<Self, CompareError> {
        let mut lines = Self { which, lines: input.lines(), number: 0, next: None };
        lines.advance()?;
        lines.next.is_some().then_some(lines).ok_or(CompareError::NoEnd(which))
    }

    pub(super) fn moment(&self) -> Option<Moment> {
        self.next.as_ref().map(|(moment, ..)| *moment)
    }

    pub(super) fn last_tick(&self) -> Option<u64> {
        match &self.next {
            Some((Moment::End, path, value)) if path == TICKS => value.parse().ok(),
            _ => None,
        }
    }

    pub(super) fn take(&mut self, moment: Moment) -> Result<Option<(String, String)>, CompareError> {
        let Some((_, path, value)) = self.next.as_mut().filter(|(next, ..)| *next == moment) else {
            return Ok(None);
        };
        // `advance` needs the moment to check the order of the lines.
        let taken = (std::mem::take(path), std::mem::take(value));
        self.advance()?;
        Ok(Some(taken))
    }

    pub(super) fn skip_to_end(&mut self) -> Result<(), CompareError> {
        while self.moment().is_some_and(|moment| moment < Moment::End) {
            self.advance()?;
        }
        Ok(())
    }

    fn advance(&mut self) -> Result<(), CompareError> {
        let (which, before) = (self.which, self.moment());
        self.next = match self.lines.next() {
            Some(line) => {
                let line = line.map_err(|error| CompareError::Unreadable(which, error))?;
                self.number += 1;
                let next = parse(&line).filter(|(moment, ..)| before.is_none_or(|before| before <= *moment));
                Some(next.ok_or(CompareError::Line { which, line: self.number, found: line })?)
            }
            None if before.is_some_and(|before| before < Moment::End) => {
                return Err(CompareError::NoEnd(which));
            }
            None => None,
        };
        Ok(())
    }
}

fn parse(line: &str) -> Option<(Moment, String, String)> {
    let mut columns = line.splitn(3, '\t');
    let moment = match columns.next()? {
        END => Moment::End,
        tick => Moment::Tick(tick.parse().ok()?),
    };
    Some((moment, columns.next()?.to_owned(), columns.next()?.to_owned()))
}
