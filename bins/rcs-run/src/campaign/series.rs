//! A series of interruptions: `hold+35:pause` means a hold, and a PAUSE 35 ticks after the hold has ended.

use std::{fmt, path::Path};

use plant::CellDescription;

use super::interruption::Kind;
use crate::rcs_run::error::Error;

#[derive(Clone, Debug, PartialEq)]
pub struct Interruption {
    /// Ticks since the end of the previous interruption; 0 for the first.
    pub after: u64,
    pub kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Series(Vec<Interruption>);

impl From<Kind> for Series {
    fn from(kind: Kind) -> Self {
        Self(vec![Interruption { after: 0, kind }])
    }
}

impl fmt::Display for Series {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, Interruption { after, kind }) in self.0.iter().enumerate() {
            if at == 0 {
                write!(f, "{kind}")?;
            } else {
                write!(f, "+{after}:{kind}")?;
            }
        }
        Ok(())
    }
}

impl Series {
    #[must_use]
    pub fn of(mut interruptions: Vec<Interruption>) -> Option<Self> {
        interruptions.first_mut()?.after = 0;
        Some(Self(interruptions))
    }

    /// The series with another interruption at its end.
    #[must_use]
    pub fn then(mut self, after: u64, kind: Kind) -> Self {
        self.0.push(Interruption { after, kind });
        self
    }

    #[must_use]
    pub fn interruptions(&self) -> &[Interruption] {
        &self.0
    }

    /// The series without one interruption; `None` if it is the only one.
    #[must_use]
    pub fn without(&self, at: usize) -> Option<Self> {
        let mut others = self.0.clone();
        others.remove(at);
        Self::of(others)
    }

    /// The series with half the ticks before one interruption; `None` if there are no ticks before it.
    #[must_use]
    pub fn sooner(&self, at: usize) -> Option<Self> {
        let mut sooner = self.clone();
        let after = &mut sooner.0[at].after;
        (*after > 0).then(|| *after /= 2)?;
        Some(sooner)
    }

    /// The series that a word of the command line selects: one per combination of the kinds of its parts.
    pub fn named(text: &str, data: &Path, cell: &CellDescription) -> Result<Vec<Self>, Error> {
        let mut parts = text.split('+');
        let first = parts.next().unwrap_or_default();
        let mut all: Vec<Self> = Kind::named(first, data, cell)?.into_iter().map(Self::from).collect();
        for part in parts {
            let (after, word) = part
                .split_once(':')
                .and_then(|(ticks, word)| Some((ticks.parse::<u64>().ok()?, word)))
                .ok_or_else(|| {
                    Error::Campaign(format!(
                        "{text}: expected +TICKS:KIND after the first interruption, as in hold+35:pause, found \
                         +{part}"
                    ))
                })?;
            let kinds = Kind::named(word, data, cell)?;
            let longer =
                all.iter().flat_map(|one| kinds.iter().map(|kind| one.clone().then(after, kind.clone())));
            all = longer.collect();
        }
        Ok(all)
    }
}
