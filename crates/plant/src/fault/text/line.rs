//! Entries for faults of the line to the robot controller.

use depc::fault::{ALWAYS, Direction, FaultKind, MOST_TICKS, Plan, Rule};

use diagnostics::Problem;

use super::Entry;

pub(super) const KEYS: [&str; 7] = ["direction", "rate", "at", "from", "until", "ticks", "byte"];

pub(super) fn kinds() -> impl Iterator<Item = &'static str> {
    FaultKind::ALL.iter().map(|kind| kind.text())
}

pub(super) fn kind(name: &str) -> Option<FaultKind> {
    FaultKind::ALL.iter().copied().find(|kind| kind.text() == name)
}

pub(super) fn empty(seed: u64, most_per_tick: Option<u8>) -> Plan {
    let plan = Plan::new(seed);
    most_per_tick.map_or(plan, |most| plan.most_per_tick(most))
}

pub(super) fn rule(entry: &Entry<'_>, kind: FaultKind) -> Result<Rule, Box<Problem>> {
    let form = entry.form;
    let mut rule = Rule::new(kind);
    match form.direction.as_deref() {
        None | Some("both") => {}
        Some(found) => {
            let known = Direction::ALL.iter().find(|known| known.text() == found);
            let words = ["to-host", "to-controller", "both"];
            rule = rule.only(*known.ok_or_else(|| entry.unknown("direction", found, &words))?);
        }
    }
    if let Some(found) = form.rate {
        let rate = entry.within("rate", found, "a chance of 0.000001 to 1", 1e-6..=1.0)?;
        rule = rule.rate(millionths(rate));
    }
    rule = match (form.at, form.from, form.until) {
        (None, None, None) => rule,
        (Some(at), None, None) => rule.at(at),
        (Some(_), ..) => return Err(entry.says("has `at`, and `from` or `until`: one of them was expected")),
        (None, from, until) => {
            let (from, until) = (from.unwrap_or(0), until.unwrap_or(u64::MAX));
            if from >= until {
                let message =
                    format_args!("has no tick: expected `until` after `from`, found {from} to {until}");
                return Err(entry.says(message));
            }
            rule.window(from, until)
        }
    };
    if let Some(found) = form.ticks {
        let length = u16::try_from(found).ok().filter(|length| (1..=MOST_TICKS).contains(length));
        let expected = format_args!("1 to {MOST_TICKS} ticks");
        rule = rule.ticks(length.ok_or_else(|| entry.unlike("ticks", expected, found))?);
    }
    Ok(form.byte.map_or(rule, |byte| rule.byte(byte)))
}

fn millionths(rate: f64) -> u32 {
    libm::round(rate * f64::from(ALWAYS)) as u32
}
