//! Fault plans as files: TOML, one table a fault.
//!
//! ```toml
//! seed = 7                  # what the numbers depend on; 1 if it is not given
//! most_per_tick = 1         # at most so many faults in a tick and direction; no limit if it is not given
//!
//! [[fault]]
//! kind = "flip"             # drop flip duplicate delay insert truncate stall cts-low
//! direction = "to-host"     # to-host, to-controller, or both (if it is not given)
//! rate = 0.001              # chance of each byte (drop flip duplicate delay) or of each tick (the others)
//! from = 100                # first tick ...
//! until = 500               # ... and the tick behind the last; or: at = 100
//!
//! [[fault]]
//! kind = "delay"
//! at = 250
//! ticks = 3                 # delay, stall, cts-low: how late, how long; 1 if it is not given
//!
//! [[fault]]
//! kind = "insert"
//! rate = 0.01
//! byte = 0x06               # insert: this byte; any if it is not given
//! ```
//!
//! A fault needs a rate, a tick or a range of ticks. Without a rate it strikes every byte or tick of its range.
//!
//! The line is not all that can fail: the same file may hold faults of other kinds, of sensors, valves and
//! parts. Who knows them reads the file as a [`Sheet`], takes the entries that are not the line's
//! ([`Entry::is_of_line`]) for himself and leaves the others to [`Sheet::plan`]. A file for the line alone is
//! read by [`load`].

use std::{
    io,
    path::Path,
    string::{String, ToString},
    vec::Vec,
};

use os_io::files;
use serde::{Deserialize, de::DeserializeOwned};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{ALWAYS, Direction, FaultKind, MOST_TICKS, Plan, Refusal, Rule};

/// Why a file is not a fault plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanFileError {
    /// The file cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// The text is not TOML, or has other entries than a plan.
    #[error("{file}: {source}")]
    Toml {
        /// The file.
        file: String,
        /// What is wrong, with the line.
        source: toml::de::Error,
    },
    /// There is no fault in it.
    #[error("{file}: expected at least one [[fault]], found none")]
    Empty {
        /// The file.
        file: String,
    },
    /// A fault makes no sense.
    #[error("{file}, line {line}, fault {number}: {problem}")]
    Fault {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Number of the fault, from 1.
        number: usize,
        /// What is wrong.
        problem: Problem,
    },
}

/// What is wrong with a fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// No such kind on a line.
    #[error(
        "expected a kind of {}, found {found:?}; faults of sensors, valves and parts are for rcs-run",
        kinds()
    )]
    Kind {
        /// What stands there.
        found: String,
    },
    /// A fault is no table.
    #[error("expected a table [[fault]]")]
    NoTable,
    /// No kind.
    #[error("expected a kind, a text in quotes: what shall fail")]
    NoKind,
    /// No such direction.
    #[error("expected a direction of to-host, to-controller or both, found {found:?}")]
    Direction {
        /// What stands there.
        found: String,
    },
    /// Not a chance.
    #[error("expected a rate of 0.000001 to 1, found {found}")]
    Rate {
        /// What stands there.
        found: f64,
    },
    /// A tick and a range.
    #[error("expected `at` or `from` and `until`, found both")]
    AtAndRange,
    /// Not a length.
    #[error("expected 1 to {MOST_TICKS} ticks, found {found}")]
    Ticks {
        /// What stands there.
        found: i64,
    },
    /// Not a byte.
    #[error("expected a byte of 0 to 0xFF, found {found}")]
    Byte {
        /// What stands there.
        found: i64,
    },
    /// The rule is refused.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

fn kinds() -> String {
    FaultKind::ALL.iter().map(|kind| kind.text()).collect::<Vec<_>>().join(", ")
}

/// What stands before the faults.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    #[serde(default = "first_seed")]
    seed: u64,
    most_per_tick: Option<core::num::NonZeroU8>,
}

const fn first_seed() -> u64 {
    1
}

/// A fault of the line.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LineFault {
    kind: Spanned<String>,
    direction: Option<Spanned<String>>,
    rate: Option<Spanned<f64>>,
    at: Option<Spanned<u64>>,
    from: Option<u64>,
    until: Option<u64>,
    ticks: Option<Spanned<i64>>,
    byte: Option<Spanned<i64>>,
}

/// A file of faults, read so far that it is TOML with a seed and a list of tables that have a kind.
#[derive(Debug)]
pub struct Sheet<'t> {
    file: String,
    text: &'t str,
    seed: u64,
    most_per_tick: Option<core::num::NonZeroU8>,
    entries: Vec<Entry<'t>>,
}

/// A `[[fault]]`.
#[derive(Clone, Debug)]
pub struct Entry<'t> {
    /// Which one, from 1.
    pub number: usize,
    /// Its kind, and where that stands in the text.
    pub kind: Spanned<String>,
    table: Spanned<DeTable<'t>>,
}

impl Entry<'_> {
    /// True if a fault plan of the line has this kind.
    #[must_use]
    pub fn is_of_line(&self) -> bool {
        FaultKind::ALL.iter().any(|kind| kind.text() == self.kind.get_ref())
    }

    /// Where it begins in the text.
    #[must_use]
    pub fn place(&self) -> usize {
        self.table.span().start
    }

    /// The keys that stand in it, and where.
    pub fn keys(&self) -> impl Iterator<Item = (&str, usize)> {
        self.table.get_ref().keys().map(|key| (key.get_ref().as_ref(), key.span().start))
    }

    /// Read it as a structure; `kind` is one of its fields.
    ///
    /// # Errors
    /// What the structure does not have, does not find, or finds of another type.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, toml::de::Error> {
        T::deserialize(toml::de::Deserializer::from(self.table.clone()))
    }
}

impl<'t> Sheet<'t> {
    /// Read `text`; `file` names it in errors.
    ///
    /// # Errors
    /// [`PlanFileError`] if it is not TOML, has other entries than a fault file, or no fault.
    pub fn read(file: &str, text: &'t str) -> Result<Self, PlanFileError> {
        let toml = |mut source: toml::de::Error| {
            source.set_input(Some(text));
            PlanFileError::Toml { file: file.to_string(), source }
        };
        let mut root = DeTable::parse(text).map_err(toml)?;
        let faults = root.get_mut().remove("fault");
        let head = Head::deserialize(toml::de::Deserializer::from(root)).map_err(toml)?;
        let empty = || PlanFileError::Empty { file: file.to_string() };
        let faults = faults.ok_or_else(empty)?;
        let place = faults.span().start;
        let DeValue::Array(tables) = faults.into_inner() else { return Err(empty()) };
        let entries = (1..).zip(tables).map(|(number, table)| {
            entry(number, table).map_err(|(problem, at)| PlanFileError::Fault {
                file: file.to_string(),
                line: line(text, at.unwrap_or(place)),
                number,
                problem,
            })
        });
        let entries = entries.collect::<Result<Vec<_>, _>>()?;
        if entries.is_empty() {
            return Err(empty());
        }
        Ok(Self { file: file.to_string(), text, seed: head.seed, most_per_tick: head.most_per_tick, entries })
    }

    /// What the numbers of all faults in the file depend on.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// All faults in their order.
    #[must_use]
    pub fn entries(&self) -> &[Entry<'t>] {
        &self.entries
    }

    /// Line of a place in the text, from 1.
    #[must_use]
    pub fn line(&self, place: usize) -> usize {
        line(self.text, place)
    }

    /// The plan of the faults for which `of_line` holds.
    ///
    /// # Errors
    /// [`PlanFileError`] with the file, the line, what was expected and what was found.
    pub fn plan(&self, of_line: impl Fn(&Entry<'_>) -> bool) -> Result<Plan, PlanFileError> {
        let mut plan = Plan::new(self.seed);
        if let Some(most) = self.most_per_tick {
            plan = plan.most_per_tick(most.get());
        }
        for entry in self.entries.iter().filter(|entry| of_line(entry)) {
            let number = entry.number;
            let fault = |problem, place: Option<usize>| PlanFileError::Fault {
                file: self.file.clone(),
                line: self.line(place.unwrap_or_else(|| entry.place())),
                number,
                problem,
            };
            if !entry.is_of_line() {
                let found = entry.kind.get_ref().clone();
                return Err(fault(Problem::Kind { found }, Some(entry.kind.span().start)));
            }
            let read: LineFault = entry.read().map_err(|mut source| {
                source.set_input(Some(self.text));
                PlanFileError::Toml { file: self.file.clone(), source }
            })?;
            rule(&read)
                .and_then(|rule| plan.add(rule).map_err(|refusal| (Problem::from(refusal), None)))
                .map_err(|(problem, place)| fault(problem, place))?;
        }
        Ok(plan)
    }
}

/// A table that has a kind; or what is wrong, and where.
fn entry(number: usize, found: Spanned<DeValue<'_>>) -> Result<Entry<'_>, (Problem, Option<usize>)> {
    let span = found.span();
    let DeValue::Table(table) = found.into_inner() else {
        return Err((Problem::NoTable, Some(span.start)));
    };
    let kind = match table.get("kind").map(|kind| (kind.span(), kind.get_ref())) {
        Some((place, DeValue::String(kind))) => Spanned::new(place, kind.to_string()),
        Some((place, _)) => return Err((Problem::NoKind, Some(place.start))),
        None => return Err((Problem::NoKind, Some(span.start))),
    };
    Ok(Entry { number, kind, table: Spanned::new(span, table) })
}

/// Read a plan from a file that has faults of the line only.
///
/// # Errors
/// [`PlanFileError`] with the file, the line, what was expected and what was found.
pub fn load(path: &Path) -> Result<Plan, PlanFileError> {
    let file = path.display().to_string();
    match files::read_text(path) {
        Ok(text) => parse(&file, &text),
        Err(source) => Err(PlanFileError::Read { file, source }),
    }
}

/// The plan in `text`, which has faults of the line only; `file` names it in errors.
///
/// # Errors
/// [`PlanFileError`] with the file, the line, what was expected and what was found.
pub fn parse(file: &str, text: &str) -> Result<Plan, PlanFileError> {
    Sheet::read(file, text)?.plan(|_| true)
}

/// Line of a place in the text, from 1.
fn line(text: &str, place: usize) -> usize {
    let before = text.as_bytes().get(..place).unwrap_or(text.as_bytes());
    before.iter().filter(|byte| **byte == b'\n').count().saturating_add(1)
}

/// The rule of an entry; or what is wrong, and where if that is not the whole of it.
fn rule(entry: &LineFault) -> Result<Rule, (Problem, Option<usize>)> {
    let kind = FaultKind::ALL.iter().copied().find(|kind| kind.text() == entry.kind.get_ref());
    let kind = kind.ok_or_else(|| {
        (Problem::Kind { found: entry.kind.get_ref().clone() }, Some(entry.kind.span().start))
    })?;
    let mut rule = Rule::new(kind);
    if let Some(direction) = &entry.direction {
        let found = direction.get_ref();
        rule = match Direction::ALL.iter().find(|known| known.text() == found) {
            Some(known) => rule.only(*known),
            None if found == "both" => rule,
            None => {
                let problem = Problem::Direction { found: found.clone() };
                return Err((problem, Some(direction.span().start)));
            }
        };
    }
    if let Some(rate) = &entry.rate {
        let found = *rate.get_ref();
        let millionths = millionths(found).ok_or((Problem::Rate { found }, Some(rate.span().start)))?;
        rule = rule.rate(millionths);
    }
    rule = match (&entry.at, entry.from, entry.until) {
        (None, None, None) => rule,
        (Some(at), None, None) => rule.at(*at.get_ref()),
        (Some(at), _, _) => return Err((Problem::AtAndRange, Some(at.span().start))),
        (None, from, until) => {
            let (from, until) = (from.unwrap_or(0), until.unwrap_or(u64::MAX));
            if from >= until {
                return Err((Refusal::EmptyWindow { from, until }.into(), None));
            }
            rule.window(from, until)
        }
    };
    if let Some(ticks) = &entry.ticks {
        let found = *ticks.get_ref();
        let length = u16::try_from(found).ok().filter(|length| (1..=MOST_TICKS).contains(length));
        rule = rule.ticks(length.ok_or((Problem::Ticks { found }, Some(ticks.span().start)))?);
    }
    if let Some(byte) = &entry.byte {
        let found = *byte.get_ref();
        let value = u8::try_from(found).map_err(|_| (Problem::Byte { found }, Some(byte.span().start)))?;
        rule = rule.byte(value);
    }
    Ok(rule)
}

/// A chance in millionths, if it is one that is not zero.
#[expect(clippy::as_conversions, reason = "the number is within 1 to 1,000,000")]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
fn millionths(rate: f64) -> Option<u32> {
    let scaled = libm::round(rate * f64::from(ALWAYS));
    (1.0..=f64::from(ALWAYS)).contains(&scaled).then_some(scaled as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(text: &str) -> Plan {
        parse("plan.toml", text).unwrap()
    }

    fn complaint(text: &str) -> String {
        parse("plan.toml", text).unwrap_err().to_string()
    }

    #[test]
    fn every_entry_is_read() {
        let read = plan(
            "seed = 7\nmost_per_tick = 2\n\
             [[fault]]\nkind = \"flip\"\ndirection = \"to-host\"\nrate = 0.001\nfrom = 100\nuntil = 500\n\
             [[fault]]\nkind = \"delay\"\nat = 250\nticks = 3\ndirection = \"both\"\n\
             [[fault]]\nkind = \"insert\"\nrate = 1\nbyte = 0x06\ndirection = \"to-controller\"\n\
             [[fault]]\nkind = \"stall\"\nfrom = 600\n",
        );
        let mut expected = Plan::new(7).most_per_tick(2);
        for rule in [
            Rule::new(FaultKind::Flip).only(Direction::ToHost).rate(1000).window(100, 500),
            Rule::new(FaultKind::Delay).at(250).ticks(3),
            Rule::new(FaultKind::Insert).only(Direction::ToController).rate(ALWAYS).byte(6),
            Rule::new(FaultKind::Stall).window(600, u64::MAX),
        ] {
            expected.add(rule).unwrap();
        }
        assert_eq!(read, expected);
        assert_eq!(plan("[[fault]]\nkind = \"drop\"\nat = 1\n").seed(), 1);
    }

    #[test]
    fn errors_say_where_what_was_expected_and_what_was_found() {
        for (entries, expected) in [
            (
                "kind = \"burn\"\nat = 1",
                "plan.toml, line 5, fault 2: expected a kind of drop, flip, duplicate, delay, insert, truncate, \
                 stall, cts-low, found \"burn\"; faults of sensors, valves and parts are for rcs-run",
            ),
            (
                "kind = \"flip\"\ndirection = \"up\"",
                "plan.toml, line 6, fault 2: expected a direction of to-host, to-controller or both, found \"up\"",
            ),
            (
                "kind = \"flip\"\nrate = 1.5",
                "plan.toml, line 6, fault 2: expected a rate of 0.000001 to 1, found 1.5",
            ),
            (
                "kind = \"flip\"\nrate = nan",
                "plan.toml, line 6, fault 2: expected a rate of 0.000001 to 1, found NaN",
            ),
            (
                "kind = \"flip\"\nat = 3\nuntil = 4",
                "plan.toml, line 6, fault 2: expected `at` or `from` and `until`, found both",
            ),
            (
                "kind = \"stall\"\nat = 3\nticks = 0",
                "plan.toml, line 7, fault 2: expected 1 to 1000 ticks, found 0",
            ),
            (
                "kind = \"insert\"\nat = 3\nbyte = 256",
                "plan.toml, line 7, fault 2: expected a byte of 0 to 0xFF, found 256",
            ),
            (
                "kind = \"drop\"\nat = 1\nticks = 2",
                "plan.toml, line 4, fault 2: `ticks` says how long a delay, a stall or cts-low takes; drop takes no time",
            ),
            (
                "kind = \"drop\"\nuntil = 0",
                "plan.toml, line 4, fault 2: expected `until` behind `from`, found 0 to 0: there is no tick in it",
            ),
        ] {
            let text = std::format!("[[fault]]\nkind = \"flip\"\nrate = 0.1\n[[fault]]\n{entries}\n");
            assert_eq!(complaint(&text), expected);
        }
    }

    #[test]
    fn what_is_no_plan_is_refused() {
        assert_eq!(complaint("seed = 3\n"), "plan.toml: expected at least one [[fault]], found none");
        for (text, words) in [
            ("seed = \n", "line 1"),
            ("[[fault]]\nkind = \"drop\"\nat = 1\ncolour = 3\n", "unknown field `colour`"),
            ("[[fault]]\nat = 1\n", "line 1, fault 1: expected a kind, a text in quotes: what shall fail"),
            ("fault = [3]\n", "expected a table [[fault]]"),
            ("fault = 3\n", "expected at least one [[fault]]"),
            ("colour = 3\n[[fault]]\nkind = \"drop\"\nat = 1\n", "unknown field `colour`"),
            ("most_per_tick = 0\n", "nonzero"),
        ] {
            let found = complaint(text);
            assert!(found.starts_with("plan.toml") && found.contains(words), "{found}");
        }
        let found = load(Path::new("no/such/plan.toml")).unwrap_err().to_string();
        assert!(found.starts_with("no/such/plan.toml: cannot be read: "), "{found}");
    }
}
