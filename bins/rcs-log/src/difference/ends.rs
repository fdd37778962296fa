//! How two runs ended: outcome, duration, closest clearance, contacts, places of the parts.

use std::{collections::BTreeMap, fmt};

use rcs_core::tick::TICK_S;
use record::Log;
use runtime::RunOutcome;
use serde::Serialize;

/// How a run ended.
#[derive(Clone, Debug, Default)]
pub struct End {
    /// In words; empty if the log has no end.
    pub outcome: String,
    /// Ticks until then.
    pub ticks: u64,
    /// What else is known of it.
    facts: BTreeMap<String, String>,
}

impl End {
    /// The end of a run.
    #[must_use]
    pub fn of_run(outcome: &RunOutcome) -> Self {
        let ticks = outcome.result.ticks + u64::from(outcome.result.ramp_ticks);
        Self { outcome: outcome.ending.text().to_owned(), ticks, facts: outcome.result.facts() }
    }

    /// The end that a log has.
    #[must_use]
    pub fn of_log(log: &Log, ticks: u64) -> Self {
        let facts = log.end.clone().unwrap_or_default();
        let outcome = facts.get("result").cloned().unwrap_or_default();
        Self { outcome, ticks, facts }
    }

    /// How long the run took.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.ticks as f64 * TICK_S
    }

    /// The closest pass of the robot by what it may not touch; "none" if there was none.
    #[must_use]
    pub fn clearance(&self) -> &str {
        self.fact("clearance")
    }

    fn fact(&self, key: &str) -> &str {
        self.facts.get(key).filter(|text| !text.is_empty()).map_or("none", String::as_str)
    }
}

/// Something that is different at the end.
#[derive(Debug, Serialize)]
struct Ended {
    what: &'static str,
    a: String,
    b: String,
}

/// How differently two runs ended.
#[derive(Debug, Default, Serialize)]
pub struct Ends(Vec<Ended>);

impl Ends {
    /// Compare two ends.
    #[must_use]
    pub fn between(a: &End, b: &End) -> Self {
        let longer = b.seconds() - a.seconds();
        let sense = if longer < 0.0 { "shorter" } else { "longer" };
        let both = [
            ("outcome", a.outcome.clone(), b.outcome.clone()),
            ("duration", format!("{:.2} s", a.seconds()), format!("{:.2} s", b.seconds())),
            ("clearance", a.clearance().to_owned(), b.clearance().to_owned()),
            ("contacts", a.fact("contacts").to_owned(), b.fact("contacts").to_owned()),
            ("parts", a.fact("parts").to_owned(), b.fact("parts").to_owned()),
        ];
        let different = both.into_iter().filter(|(_, a, b)| a != b);
        let said = different.map(|(what, a, b)| {
            let b = if what == "duration" { format!("{b}, {:.2} s {sense}", longer.abs()) } else { b };
            Ended { what, a, b }
        });
        Self(said.collect())
    }

    /// The runs ended alike.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl fmt::Display for Ends {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|Ended { what, a, b }| writeln!(f, "{what:<10} {a}\n{:<10} {b}", ""))
    }
}
