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

use std::{
    fs, io,
    path::Path,
    string::{String, ToString},
    vec::Vec,
};

use serde::Deserialize;
use toml::Spanned;

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
    /// No such kind.
    #[error("expected a kind of {}, found {found:?}", kinds())]
    Kind {
        /// What stands there.
        found: String,
    },
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default = "first_seed")]
    seed: u64,
    most_per_tick: Option<core::num::NonZeroU8>,
    #[serde(default, rename = "fault")]
    faults: Vec<Spanned<Entry>>,
}

const fn first_seed() -> u64 {
    1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    kind: Spanned<String>,
    direction: Option<Spanned<String>>,
    rate: Option<Spanned<f64>>,
    at: Option<Spanned<u64>>,
    from: Option<u64>,
    until: Option<u64>,
    ticks: Option<Spanned<i64>>,
    byte: Option<Spanned<i64>>,
}

/// Read a plan from a file.
///
/// # Errors
/// [`PlanFileError`] with the file, the line, what was expected and what was found.
pub fn load(path: &Path) -> Result<Plan, PlanFileError> {
    let file = path.display().to_string();
    match fs::read_to_string(path) {
        Ok(text) => parse(&file, &text),
        Err(source) => Err(PlanFileError::Read { file, source }),
    }
}

/// The plan in `text`; `file` names it in errors.
///
/// # Errors
/// [`PlanFileError`] with the file, the line, what was expected and what was found.
pub fn parse(file: &str, text: &str) -> Result<Plan, PlanFileError> {
    let read: File =
        toml::from_str(text).map_err(|source| PlanFileError::Toml { file: file.to_string(), source })?;
    if read.faults.is_empty() {
        return Err(PlanFileError::Empty { file: file.to_string() });
    }
    let mut plan = Plan::new(read.seed);
    if let Some(most) = read.most_per_tick {
        plan = plan.most_per_tick(most.get());
    }
    for (number, entry) in (1..).zip(&read.faults) {
        rule(entry.get_ref())
            .and_then(|rule| plan.add(rule).map_err(|refusal| (Problem::from(refusal), None)))
            .map_err(|(problem, place)| PlanFileError::Fault {
                file: file.to_string(),
                line: line(text, place.unwrap_or_else(|| entry.span().start)),
                number,
                problem,
            })?;
    }
    Ok(plan)
}

/// Line of a place in the text, from 1.
fn line(text: &str, place: usize) -> usize {
    let before = text.as_bytes().get(..place).unwrap_or(text.as_bytes());
    before.iter().filter(|byte| **byte == b'\n').count().saturating_add(1)
}

/// The rule of an entry; or what is wrong, and where if that is not the whole of it.
fn rule(entry: &Entry) -> Result<Rule, (Problem, Option<usize>)> {
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
                 stall, cts-low, found \"burn\"",
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
            ("[[fault]]\nat = 1\n", "missing field `kind`"),
            ("most_per_tick = 0\n", "nonzero"),
        ] {
            let found = complaint(text);
            assert!(found.starts_with("plan.toml: ") && found.contains(words), "{found}");
        }
        let found = load(Path::new("no/such/plan.toml")).unwrap_err().to_string();
        assert!(found.starts_with("no/such/plan.toml: cannot be read: "), "{found}");
    }
}
