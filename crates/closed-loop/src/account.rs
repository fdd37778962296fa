//! The account of a run: its first failure and the failures that followed, in one form for all programs.
//!
//! The robot collides with the tray, the part slips in the fingers, and 5,000 ticks later a process reports an empty
//! gripper: [`Account`] orders such failures. The first one is the cause in the world; the others followed.
//!
//! The run attaches its account to the log at its end. For a live view, or the log of a killed run, [`Alarms`]
//! collects the same failures from the visible events.

use std::{collections::BTreeMap, fmt, iter};

use interfaces::hws::{HwsReport, HwsStatus};
use rcs_core::tick::{TICK_S, Tick};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;

/// Code of a coupler whose outputs were made safe: the devices are stopped, which is not a failure of the job.
const TRIPPED: &str = "io.tripped";
/// Codes of a coupler that works again. The text of such an event begins with the name of the coupler.
const WORKS_AGAIN: [&str; 2] = ["io.back", "io.released"];

/// Kinds of failures. Within a tick, an earlier kind is the cause of a later one.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    EmergencyStop,
    Power,     // the robot has lost hydraulic pressure or power
    Collision, // the robot, or the part that it carries, has collided
    Lost,      // a part or a gripper was dropped, lost or torn off
    Device,
    RobotController, // the robot controller shows a warning or refuses a position
    Link,
    OffPath,
    Process,
    FalseReport, // a command was reported as finished, but its goal was not reached
    Misplaced,   // a part is not at the place where the job should have left it
    Job,         // the job could not continue: its own check failed, or the operator was missing
    Program,     // the program, a board or the clock failed
}

impl Kind {
    /// The kind as a noun with its article: `a collision`.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::EmergencyStop => "an emergency stop",
            Self::Power => "a loss of power",
            Self::Collision => "a collision",
            Self::Lost => "a lost part",
            Self::Device => "a failed device",
            Self::RobotController => "a warning of the robot controller",
            Self::Link => "a lost link",
            Self::OffPath => "a robot off its path",
            Self::Process => "a process error",
            Self::FalseReport => "a false report",
            Self::Misplaced => "a misplaced part",
            Self::Job => "a job that cannot continue",
            Self::Program => "a failure of the program",
        }
    }

    /// The operator's remedy, if the kind alone gives it; the reason of a process has its own.
    #[must_use]
    pub const fn remedy(self) -> Option<&'static str> {
        match self {
            Self::Collision | Self::Lost | Self::Misplaced | Self::FalseReport => {
                Some("put the cell in order")
            }
            Self::Device => Some("repair the device"),
            _ => None,
        }
    }

    /// The kind of the event with this code in `/log`; `None` if the event is not a failure.
    #[must_use]
    pub fn of_code(code: &str) -> Option<Self> {
        Some(match code {
            "cell.emergency" => Self::EmergencyStop,
            "cell.pressure" | "cell.power" => Self::Power,
            "cell.contact" | "contact.begins" => Self::Collision,
            "cell.dropped" | "cell.forced-out" | "cell.gripper-fell" | "cell.gripper-torn" | "cell.fell" => {
                Self::Lost
            }
            "cell.vise-stuck" | "cell.quarantined" | "io.stale" | TRIPPED => Self::Device,
            "cell.warning" | "robot.refuses" => Self::RobotController,
            "truth.false" => Self::FalseReport,
            _ => return None,
        })
    }

    /// True if it happens in the cell. The next tick shows events in the cell.
    #[must_use]
    pub const fn is_in_cell(self) -> bool {
        matches!(
            self,
            Self::EmergencyStop
                | Self::Power
                | Self::Collision
                | Self::Lost
                | Self::Device
                | Self::RobotController
                | Self::FalseReport
        )
    }

    /// True if work can continue afterwards, so that it does not explain a later failure.
    const fn passes(self) -> bool {
        !matches!(self, Self::Collision | Self::Lost | Self::FalseReport | Self::Misplaced)
    }
}

impl Failure {
    /// The tick in which it appears in a log or a live view.
    #[must_use]
    pub const fn shown_at(&self) -> u64 {
        if self.kind.is_in_cell() { self.tick.0 + 1 } else { self.tick.0 }
    }
}

/// Key of the account in the metadata at the end of the log of an older program.
const FACT: &str = "account";

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Account {
    #[serde(flatten)]
    pub first: Failure,
    #[serde(default)]
    pub followed: Vec<Failure>,
}

impl Account {
    /// Order these failures, the first one in front; `None` without a failure.
    #[must_use]
    pub fn of(failures: impl IntoIterator<Item = Failure>) -> Option<Self> {
        let mut failures: Vec<Failure> = failures.into_iter().collect();
        failures.sort_by_key(|failure| (failure.tick, failure.kind));
        let mut ordered = Vec::with_capacity(failures.len());
        for failure in failures {
            // An observer of a failure often repeats its words: `HWSC: the jaw of the vise does not move`.
            if ordered.iter().all(|known: &Failure| !failure.text.ends_with(&known.text)) {
                ordered.push(failure);
            }
        }
        let mut failures = ordered.into_iter();
        Some(Self { first: failures.next()?, followed: failures.collect() })
    }

    #[must_use]
    pub fn with(self, more: impl IntoIterator<Item = Failure>) -> Self {
        let all: Vec<Failure> = self.failures().cloned().chain(more).collect();
        Self::of(all).unwrap_or(self)
    }

    /// The metadata at the end of a log without the account.
    pub fn without_account(facts: &BTreeMap<String, String>) -> impl Iterator<Item = (&String, &String)> {
        facts.iter().filter(|(key, _)| *key != FACT)
    }

    /// The account at the end of a log: `Some(None)` for a successful run, `None` without account and success.
    #[must_use]
    pub fn of_facts(facts: &BTreeMap<String, String>) -> Option<Option<Self>> {
        match facts.get(FACT) {
            Some(json) => serde_json::from_str(json).ok().map(Some),
            None => facts.get("result").is_some_and(|result| result == "finished").then_some(None),
        }
    }

    pub fn failures(&self) -> impl Iterator<Item = &Failure> {
        iter::once(&self.first).chain(&self.followed)
    }

    /// The first failure that a process reports, and that its rows can explain.
    #[must_use]
    pub fn of_process(&self) -> Option<&Failure> {
        self.failures().find(|failure| failure.table.is_some())
    }

    /// True if the robot or a device is lost or was stopped, which is not a failure of the job.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.failures().any(|failure| failure.stopped)
    }
}

impl Account {
    /// One sentence per failure: `First, at tick 332 (13.28 s), a collision: ...`, `Then, at tick ...`.
    pub fn sentences(&self) -> impl Iterator<Item = String> {
        let words = iter::once("First").chain(iter::repeat("Then"));
        self.failures().zip(words).map(|(Failure { tick, kind, text, .. }, word)| {
            format!("{word}, at tick {tick} ({:.2} s), {}: {text}", tick.0 as f64 * TICK_S, kind.text())
        })
    }
}

impl fmt::Display for Account {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.first.text)?;
        self.followed
            .iter()
            .try_for_each(|Failure { tick, text, .. }| write!(f, "; then, at tick {tick}, {text}"))
    }
}

/// True if a command other than PAUSE has finished between two statuses of Task.
#[must_use]
pub fn has_worked(before: &HwsStatus, now: &HwsStatus) -> bool {
    let finished = |status: &HwsStatus| status.report == HwsReport::Finished;
    finished(now) && (!finished(before) || before.echo != now.echo) && now.command.as_str() != "PAUSE"
}

/// Collects failures from the visible events of a run: lines of `/log` and reports of Task, in any order.
#[derive(Clone, Debug, Default)]
pub struct Alarms {
    failures: Vec<Failure>,
    worked: Tick, // the last tick in which a command other than PAUSE finished
}

impl Alarms {
    /// Note a line of `/log` with its tick and code. A line without a failure is ignored.
    pub fn line(&mut self, tick: Tick, source: &str, code: &str, text: &str) {
        if WORKS_AGAIN.contains(&code) {
            let coupler = |text: &str| text.split(' ').next().map(str::to_owned);
            let works = coupler(text);
            self.failures.retain(|failure| failure.process != source || coupler(&failure.text) != works);
        }
        if let Some(kind) = Kind::of_code(code) {
            let tick = Tick(tick.0.saturating_sub(u64::from(kind.is_in_cell())));
            let failure = Failure::outside(tick, kind, source, text.to_owned());
            self.failures.push(Failure { stopped: code == TRIPPED, ..failure });
        }
    }

    pub fn failed(&mut self, failure: Failure) {
        self.failures.push(failure);
    }

    /// Note the tick in which a command other than PAUSE finished. Earlier stops no longer explain a failure.
    pub fn worked(&mut self, tick: Tick) {
        self.worked = self.worked.max(tick);
    }

    /// The noted failures in order, without stops that preceded a finished command.
    pub fn failures(&self) -> impl Iterator<Item = &Failure> {
        self.failures.iter().filter(|failure| failure.tick > self.worked || !failure.kind.passes())
    }

    #[must_use]
    pub fn account(&self) -> Option<Account> {
        Account::of(self.failures().cloned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(tick: u64, kind: Kind, text: &str) -> Failure {
        Failure::outside(Tick(tick), kind, "E-move", text.to_owned())
    }

    #[test]
    fn earliest_failure_is_first() {
        let account = Account::of([
            failure(9, Kind::Process, "nothing is held"),
            failure(3, Kind::Collision, "the robot ran into the tray"),
            failure(9, Kind::Lost, "the part is lost"),
            failure(9, Kind::Lost, "the part is lost"),
        ]);
        let account = account.expect("there are failures");
        assert_eq!(
            account.to_string(),
            "the robot ran into the tray; then, at tick 9, the part is lost; then, at tick 9, nothing is held"
        );
        assert_eq!(Account::of([]), None);
    }

    #[test]
    fn emergency_stop_explains_the_link_of_the_same_tick() {
        let account = Account::of([
            failure(5, Kind::Link, "not responding"),
            failure(5, Kind::EmergencyStop, "the E-stop was pressed"),
        ]);
        assert_eq!(account.expect("there are failures").first.kind, Kind::EmergencyStop);
    }

    #[test]
    fn coupler_that_works_again_explains_no_failure() {
        let mut alarms = Alarms::default();
        alarms.line(Tick(4), "field", "io.stale", "arm has not answered for 120 ms");
        alarms.line(Tick(5), "field", "io.stale", "fixture has not answered for 120 ms");
        alarms.line(Tick(6), "field", "io.back", "arm answers again after 160 ms");
        let account = alarms.account().expect("the fixture is still away");
        assert!(account.to_string().starts_with("fixture") && !account.is_stopped(), "{account}");
        alarms.line(Tick(9), "field", "io.tripped", "fixture was not written for 600 ms");
        assert!(alarms.account().is_some_and(|account| account.is_stopped()));
        alarms.line(Tick(30), "field", "io.released", "fixture is released");
        assert_eq!(alarms.account(), None);
    }

    #[test]
    fn collision_explains_a_later_failure_and_a_reset_stop_does_not() {
        let mut alarms = Alarms::default();
        alarms.line(Tick(4), "cell", "cell.emergency", "the E-stop was pressed");
        alarms.line(Tick(5), "cell", "fault.begins", "no failure");
        assert_eq!(alarms.account().map(|account| account.first.tick), Some(Tick(3)), "shown a tick later");
        alarms.worked(Tick(20));
        assert_eq!(alarms.account(), None);
        alarms.line(Tick(31), "cell", "contact.begins", "the robot runs into the tray");
        alarms.worked(Tick(40));
        alarms.failed(failure(50, Kind::Process, "nothing is held"));
        let kinds = |account: Account| account.failures().map(|failure| failure.kind).collect::<Vec<_>>();
        assert_eq!(alarms.account().map(kinds), Some(vec![Kind::Collision, Kind::Process]));
    }
}
