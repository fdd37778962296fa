//! How a run ended, and the reason, from which the last line on standard error and the exit status follow.

use ::neighbours::workstation::player::{JobFailure, Workstation as _};
use closed_loop::failure::{self, Failure};
use interfaces::{ExternalInputs, t3i::LinkFault};
use levels::{ladder::Ladder, prim::state::RESTART_TICKS};
use rcs_core::tick::Tick;

use crate::Run;

/// Ticks between a warning of a robot and the failure that it explains: the time in which Prim restarts the link.
const EXPLAINS_TICKS: u64 = RESTART_TICKS;

/// How a run ended.
pub enum Ending {
    /// The job has finished.
    Finished,
    /// The run has ended as configured: at `--ticks`, or, without a job of its own, by a request to stop.
    Stopped,
    /// The user has stopped the run before its job had finished.
    StoppedByUser,
    /// An error has ended the run.
    Failed(Failure),
}

impl Ending {
    /// As text, for the log.
    #[must_use]
    pub fn text(&self) -> &str {
        match self {
            Self::Finished => "finished",
            Self::Stopped => "stopped as requested",
            Self::StoppedByUser => "stopped by the user",
            Self::Failed(failure) => &failure.text,
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

    /// The ending with a verdict on the cell: a job with an error in the cell counts as failed, and a job that failed
    /// may have failed because of it.
    fn checked(self, verdict: Failure) -> Self {
        match self {
            Self::Finished | Self::Stopped | Self::StoppedByUser => Self::Failed(verdict),
            Self::Failed(failure) if failure.text == verdict.text => Self::Failed(failure),
            Self::Failed(failure) => {
                let when = if verdict.tick <= failure.tick { "before" } else { "later" };
                let text = format!("{}; {when}, {}", failure.text, verdict.text);
                Self::Failed(Failure { text, ..failure })
            }
        }
    }
}

impl Run {
    /// The ending with the verdicts on the cell: collisions of the robot, parts that are not at their
    /// places, and false confirmations.
    pub(super) fn checked(&self, ending: Ending) -> Ending {
        let parts = self.closed.workstation.cell.parts();
        let mut verdicts: Vec<Failure> = self
            .closed
            .contacts()
            .verdict()
            .into_iter()
            .chain(self.closed.placement().verdict(&parts))
            .collect();
        verdicts.extend(self.closed.truth().verdict());
        verdicts.sort_by_key(|verdict| verdict.tick);
        let simulated = |verdict: Failure| match self.robot.is_elsewhere() {
            true => Failure { text: format!("in the simulated cell, {}", verdict.text), ..verdict },
            false => verdict,
        };
        verdicts.into_iter().map(simulated).fold(ending, Ending::checked)
    }

    /// The ending of a run that another process commands: without a job that can fail, the state of the robot decides.
    pub(super) fn left(&self, ending: Ending) -> Ending {
        let commanding = self.neighbours.are_commanding();
        self.standing().filter(|_| commanding).map_or(ending, Ending::Failed)
    }

    /// The emergency or lost link that prevents the robot from moving at the end.
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
            Failure { stopped: true, ..outside(self.closed.tick(), "T3I", text) }
        })
    }

    /// The failure of a lost link, or of a robot of the caller that is elsewhere, with the warning that caused it.
    fn warned(&self, failure: Failure) -> Failure {
        let recent = |tick: Tick| tick <= failure.tick && failure.tick.since(tick) <= EXPLAINS_TICKS;
        match &self.warning {
            Some((tick, warning))
                if *tick <= failure.tick && (failure.stopped || self.robot.is_own() && recent(*tick)) =>
            {
                Failure { text: format!("{warning} at tick {tick}; {}", failure.text), ..failure }
            }
            _ => failure,
        }
    }

    /// The emergency that has stopped the robot, and the state of the arm.
    fn stopped(&self, what: &str) -> Option<Failure> {
        let emergency = self.closed.workstation.last_emergency()?;
        let text = format!("{what}; the arm {}", emergency.droop.end());
        Some(Failure { stopped: true, ..outside(emergency.tick, "T3", text) })
    }

    /// The failure of the job: the reason of the process that reports it, or the observation of the workstation
    /// controller.
    pub(super) fn explain(&self, failure: &JobFailure, external: &ExternalInputs) -> Failure {
        match failure {
            JobFailure::Emergency(what) => {
                if let Some(stopped) = self.stopped(what) {
                    return stopped;
                }
            }
            JobFailure::Commander(what) => {
                if let Some(standing) = self.standing() {
                    return Failure { text: format!("{}; {what}", standing.text), ..standing };
                }
            }
            _ => {}
        }
        let processes = Ladder::processes();
        let known = match failure {
            JobFailure::Command(_) => self.closed.course().watch().failure(processes),
            _ => None,
        };
        let trouble = self.robot.trouble();
        let known = known.map(|known| match trouble {
            Some(trouble) if known.stopped => Failure { text: format!("{trouble}; {}", known.text), ..known },
            _ => self.warned(known),
        });
        known.unwrap_or_else(|| {
            let tick = match failure {
                JobFailure::Unfinished { tick, .. } => *tick,
                _ => self.closed.tick(),
            };
            let text = match failure {
                JobFailure::TimeLimit(_) => {
                    let doing = failure::present_commands(processes, &external.hws, self.closed.memory());
                    format!("HWSC: {failure}; {doing}")
                }
                _ => format!("HWSC: {failure}"),
            };
            outside(tick, "HWSC", text)
        })
    }
}

/// A failure that no control process reports.
pub fn outside(tick: Tick, process: &str, text: String) -> Failure {
    Failure { tick, process: process.to_owned(), table: None, row: None, text, stopped: false }
}
