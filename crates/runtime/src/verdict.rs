//! The ending of a run and its reason, which determine the last line on standard error and the exit status.

use std::borrow::Cow;

use ::neighbours::workstation::player::{JobFailure, Workstation as _};
use closed_loop::{
    account::{Account, Kind},
    failure::{self, Failure},
    workstation::Emergency,
};
use interfaces::{ExternalInputs, t3i::LinkFault};
use levels::{ladder::Ladder, prim::state::RESTART_TICKS};
use plant::t3::Cut;
use rcs_core::tick::Tick;

use crate::Run;

/// Ticks between a warning of a robot and the failure that it explains: the time in which Prim restarts the link.
const EXPLAINS_TICKS: u64 = RESTART_TICKS;

pub enum Ending {
    Finished,
    Stopped, // ended as configured: at `--ticks`, or, without a job of its own, by a request to stop
    StoppedByUser, // stopped by the user before the job had finished
    Failed(Account),
}

impl Ending {
    #[must_use]
    pub fn text(&self) -> Cow<'static, str> {
        match self {
            Self::Finished => "finished".into(),
            Self::Stopped => "stopped as requested".into(),
            Self::StoppedByUser => "stopped by the user".into(),
            Self::Failed(account) => account.to_string().into(),
        }
    }

    /// As one word: `finished`, `stopped` or `failed`.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Stopped | Self::StoppedByUser => "stopped",
            Self::Failed(_) => "failed",
        }
    }

    /// Adds the errors in the cell. A job with such an error has failed; if it failed anyway, the error may be
    /// the cause.
    fn checked(self, verdicts: Vec<Failure>) -> Self {
        match self {
            Self::Failed(account) => Self::Failed(account.with(verdicts)),
            other => Account::of(verdicts).map_or(other, Self::Failed),
        }
    }
}

impl From<Failure> for Ending {
    fn from(failure: Failure) -> Self {
        Self::Failed(Account { first: failure, followed: Vec::new() })
    }
}

impl Run {
    /// The ending with the verdicts on the cell: collisions of the robot, misplaced parts, and false
    /// confirmations. For a failed run also the emergencies still in force, fallen parts, and failed devices.
    pub(super) fn checked(&self, ending: Ending) -> Ending {
        let parts = self.closed.workstation.cell.parts();
        let mut verdicts: Vec<Failure> = Vec::new();
        // With real devices, the cell of this program does not show what has become of the parts.
        if !self.closed.workstation.has_real_devices() {
            verdicts.extend(self.closed.contacts().verdict());
            verdicts.extend(self.closed.placement().verdict(&parts));
            verdicts.extend(self.closed.truth().verdict());
        }
        if let Ending::Failed(account) = &ending {
            let same = |one: &Failure, other: &Failure| (one.kind, one.tick) == (other.kind, other.tick);
            let known = |alarm: &&Failure| account.failures().any(|failure| same(failure, alarm));
            verdicts.extend(self.alarms.failures().filter(|alarm| !known(alarm)).cloned());
        }
        if self.robot.is_elsewhere() {
            for verdict in &mut verdicts {
                verdict.text = format!("in the simulated cell, {}", verdict.text);
            }
        }
        ending.checked(verdicts)
    }

    /// The ending of a run that another process commands. Without a job that can fail, the state of the robot decides.
    pub(super) fn left(&self, ending: Ending) -> Ending {
        let commanding = self.neighbours.are_commanding();
        self.standing().filter(|_| commanding).map_or(ending, Ending::from)
    }

    fn standing(&self) -> Option<Failure> {
        if let Some(what) = self.closed.workstation.emergency() {
            return self.stopped(&what);
        }
        let status = &self.closed.memory().t3i.status;
        let lost = status.fault != LinkFault::None && !status.link_running;
        lost.then(|| {
            let text = match self.robot.trouble() {
                Some(trouble) => format!("T3I: {}; {trouble}", status.fault.text()),
                None => format!("T3I: the link to the robot is lost: {}", status.fault.text()),
            };
            let failure = Failure::outside(self.closed.tick(), Kind::Link, "T3I", text);
            Failure { stopped: true, ..failure }
        })
    }

    /// The warning of the robot controller, or of the robot at a port, shortly before a failure that it explains.
    fn warning_before(&self, failure: &Failure) -> Option<Failure> {
        if let Some(trouble) = self.robot.trouble().filter(|_| failure.stopped) {
            return Some(Failure::outside(failure.tick, Kind::RobotController, "robot", trouble));
        }
        let recent = |tick: Tick| failure.tick.since(tick) <= EXPLAINS_TICKS;
        let explains = |warning: &&Failure| {
            warning.tick <= failure.tick && (failure.stopped || self.robot.is_own() && recent(warning.tick))
        };
        self.warning.as_ref().filter(explains).cloned()
    }

    fn stopped(&self, what: &str) -> Option<Failure> {
        let Emergency { tick, droop } = self.closed.workstation.last_emergency()?;
        let text = format!("{what}; the arm {}", droop.end());
        let kind = if let Cut::EStop(_) = droop.cause { Kind::EmergencyStop } else { Kind::Power };
        Some(Failure { stopped: true, ..Failure::outside(*tick, kind, "T3", text) })
    }

    /// The reason of the process or workstation controller that reports a failure, and the events that explain it.
    pub(super) fn explain(&self, failure: &JobFailure, external: &ExternalInputs) -> Ending {
        let reported = || self.closed.course().watch().failure(Ladder::processes());
        let found = match failure {
            JobFailure::Emergency(what) => self.stopped(what),
            JobFailure::Commander(_) => self.standing(),
            JobFailure::Command(_) => reported(),
            _ => None,
        };
        let Some(found) = found else { return self.of_job(failure, external).into() };
        let more = match failure {
            JobFailure::Emergency(_) => reported().filter(|reported| reported.tick >= found.tick),
            JobFailure::Commander(_) => Some(self.of_job(failure, external)),
            _ => self.warning_before(&found),
        };
        Ending::Failed(Account { first: found, followed: Vec::new() }.with(more))
    }

    fn of_job(&self, failure: &JobFailure, external: &ExternalInputs) -> Failure {
        let tick = match failure {
            JobFailure::Unfinished { tick, .. } => *tick,
            _ => self.closed.tick(),
        };
        let mut text = format!("HWSC: {failure}");
        if let JobFailure::TimeLimit(_) = failure {
            text += "; ";
            text += &failure::present_commands(Ladder::processes(), &external.hws, self.closed.memory());
        }
        Failure::outside(tick, Kind::Job, "HWSC", text)
    }
}
