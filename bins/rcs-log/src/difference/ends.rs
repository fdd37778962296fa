//! Compares the ends of two runs: outcome, duration, closest clearance, contacts, positions of the parts.

use std::{collections::BTreeMap, fmt};

use rcs_core::tick::TICK_S;
use record::Log;
use runtime::RunOutcome;
use serde::Serialize;

#[derive(Clone, Debug, Default)]
pub struct End {
    /// Outcome as text; empty if the log is incomplete.
    pub outcome: String,
    /// Number of ticks of the run.
    pub ticks: u64,
    facts: BTreeMap<String, String>, // other facts about the end, by name
}

impl End {
    #[must_use]
    pub fn of_run(outcome: &RunOutcome) -> Self {
        let ticks = outcome.result.ticks + u64::from(outcome.result.ramp_ticks);
        Self { outcome: outcome.ending.text().into_owned(), ticks, facts: outcome.result.facts() }
    }

    /// The end recorded in a log of `ticks` ticks.
    #[must_use]
    pub fn of_log(log: &Log, ticks: u64) -> Self {
        let facts = log.end.clone().unwrap_or_default();
        let outcome = facts.get("result").cloned().unwrap_or_default();
        Self { outcome, ticks, facts }
    }

    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.ticks as f64 * TICK_S
    }

    /// Least distance between the robot and an obstacle, as text; "none" if the run has no distance.
    #[must_use]
    pub fn clearance(&self) -> &str {
        self.fact("clearance")
    }

    fn fact(&self, key: &str) -> &str {
        self.facts.get(key).filter(|text| !text.is_empty()).map_or("none", String::as_str)
    }
}

#[derive(Debug, Serialize)]
struct Ended {
    what: &'static str,
    a: String,
    b: String,
}

#[derive(Debug, Default, Serialize)]
pub struct Ends(Vec<Ended>);

impl Ends {
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
