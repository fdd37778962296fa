//! The session of an operator with a run: requests, answers, and the progress of commands.

use interfaces::hws::HwsReport;

use super::take_over::{TakeOver, is_due};
use crate::rcs_console::picture::Picture;

const KEPT: usize = 200;
pub const JOGS: [f64; 4] = [0.10, 0.50, 2.00, 0.02];

const STARTUP: &str = "STARTUP"; // the command that connects the Data System (V.4.1)
/// The steps of Task's table STARTUP after the first, and the texts of the original terminal (IV.4.2 step 3).
const STAGES: [(&str, &str); 4] = [
    ("aborting", "Aborting..."),
    ("initiating", "Initiating..."),
    ("connecting", "Connecting..."),
    ("settling", "Connecting..."),
];

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    pub number: u32,
    pub line: String,
    /// The answer, once it has arrived.
    pub answer: Option<Result<String, String>>,
    pub stages: Vec<String>,
}

impl Exchange {
    /// Update the progress of the requested command, in the words of the original terminal (IV.4.2 step 3).
    fn follow(&mut self, picture: &Picture) {
        let Some(Ok(answer)) = &self.answer else { return };
        let number = answer.rsplit_once("command ").and_then(|(_, number)| number.parse::<u32>().ok());
        let status = &picture.memory.task.status;
        if number != Some(status.echo) {
            return;
        }
        let stage = match status.report {
            HwsReport::Finished => format!("Finished{}", status.unconfirmed.suffix()),
            HwsReport::Executing if status.command.as_str() == STARTUP => match connecting(picture) {
                Some(stage) => stage.to_owned(),
                None => return,
            },
            report => report.to_string(),
        };
        if self.stages.last() != Some(&stage) {
            self.stages.push(stage);
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operating {
    /// The run's status line: the source of commands, whether the job waits, the velocity knob.
    pub status: String,
    /// Requests, oldest first.
    pub exchanges: Vec<Exchange>,
    count: u64,
    /// Directory of the run's task data, once the run has answered.
    pub directory: Option<String>,
    pub outbox: Vec<String>,
    pub lost: Option<String>, // why the connection was lost
    pub jog: usize,           // index in [`JOGS`]
    pub cursor: usize,        // index of the panel key
    pub is_armed: bool,       // the next F1 presses the emergency stop
    pub is_chosen: bool,      // the next Enter presses the panel key
    /// Number of requests by which the arrow keys of the prompt have gone back.
    pub back: usize,
    /// The question whether to take the command over, if it is open.
    pub take_over: Option<TakeOver>,
}

impl Operating {
    pub fn sent(&mut self, number: u32, line: String) {
        if self.exchanges.len() == KEPT {
            self.exchanges.remove(0);
        }
        self.count += 1;
        self.exchanges.push(Exchange { number, line, answer: None, stages: Vec::new() });
    }

    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The requests, numbered from 1 among all that were sent.
    pub fn numbered(&self) -> impl Iterator<Item = (u64, &Exchange)> {
        let kept = u64::try_from(self.exchanges.len()).unwrap_or(u64::MAX);
        (self.count.saturating_sub(kept) + 1..).zip(&self.exchanges)
    }

    pub fn look(&mut self, picture: &Picture) {
        self.exchanges.iter_mut().for_each(|exchange| exchange.follow(picture));
        if is_due(self.take_over, picture.tick) && self.outbox.is_empty() {
            self.take_over = Some(TakeOver::Waits { since: picture.tick });
            self.ask("stand-alone");
        }
    }

    pub fn answered(&mut self, number: u32, verdict: Result<String, String>) {
        match self.exchanges.iter_mut().rev().find(|exchange| exchange.number == number) {
            Some(exchange) => {
                self.take_over = TakeOver::after(self.take_over, &exchange.line, &verdict);
                exchange.answer = Some(verdict);
            }
            None => {
                let status = verdict.unwrap_or_else(|why| why);
                self.status = status.split_once(": ").map_or(status.as_str(), |(_, rest)| rest).to_owned();
            }
        }
    }

    #[must_use]
    pub fn job_waits(&self) -> bool {
        self.status.starts_with("the job waits")
    }

    /// The operator who commands the run, if any.
    #[must_use]
    pub fn commander(&self) -> Option<&str> {
        let who = self.status.split("; ").nth(1)?.strip_suffix(" commands")?;
        (who != "nobody").then_some(who)
    }

    /// Number of the last request; 0 before the first.
    #[must_use]
    pub fn newest(&self) -> u32 {
        self.exchanges.last().map_or(0, |exchange| exchange.number)
    }

    /// True if all requests after this one have been accepted.
    #[must_use]
    pub fn has_taken_since(&self, number: u32) -> bool {
        let mut since = self.exchanges.iter().filter(|exchange| exchange.number > number).peekable();
        let sent = self.outbox.is_empty() && since.peek().is_some();
        sent && since.all(|exchange| matches!(exchange.answer, Some(Ok(_))))
    }

    pub fn ask(&mut self, line: impl Into<String>) {
        self.outbox.push(line.into());
    }

    /// An earlier request for the prompt: the previous one if `back`, else the next.
    pub(super) fn recall(&mut self, back: bool) -> Option<String> {
        self.back = if back { self.back + 1 } else { self.back.saturating_sub(1) };
        self.back = self.back.min(self.exchanges.len());
        let at = self.exchanges.len().checked_sub(self.back)?;
        Some(self.exchanges.get(at).map_or_else(String::new, |exchange| exchange.line.clone()))
    }
}

/// The stage of STARTUP in the words of the original terminal (IV.4.2 step 3); `None` before the first.
fn connecting(picture: &Picture) -> Option<&'static str> {
    let step = picture.memory.task.header.step?;
    let (_, shown) = STAGES.iter().find(|(name, _)| *name == step.as_str())?;
    Some(shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, ExternalInputs, ProcessId, hws::HwsStatus};
    use levels::ladder::Ladder;
    use rcs_core::{
        name::{Name, Name16},
        tick::Tick,
    };

    /// The names of the stages are the step names in Task's table.
    #[test]
    fn startup_shows_the_stages_of_the_manual() {
        let tables = Ladder::processes()[ProcessId::Task.position()].tables;
        let steps = tables.iter().find(|table| table.name == STARTUP).unwrap().steps.unwrap();
        let mut exchange = Exchange {
            number: 1,
            line: "STARTUP".into(),
            answer: Some(Ok("tick 5: command 7".into())),
            stages: Vec::new(),
        };
        let mut memory = CommonMemory::default();
        let executing = HwsStatus { echo: 7, command: Name16::clipped(STARTUP), ..HwsStatus::default() };
        let mut look = |step: &str, report| {
            memory.task.status = HwsStatus { report, ..executing };
            memory.task.header.step = Some(Name::clipped(step));
            let external = ExternalInputs::default();
            exchange.follow(&Picture { tick: Tick(9), external, memory, timing: None });
        };
        for step in steps.variants {
            look(step.text, HwsReport::Executing);
        }
        look("", HwsReport::Finished);
        let shown = ["Aborting...", "Initiating...", "Connecting...", "Finished"];
        assert_eq!(exchange.stages, shown);
        assert_eq!(steps.variants.len(), STAGES.len() + 1, "a step has no stage");
    }

    #[test]
    fn recall_returns_the_last_requests() {
        let mut operating = Operating::default();
        operating.sent(1, "stop".into());
        operating.sent(2, "go".into());
        assert_eq!(operating.recall(true).as_deref(), Some("go"));
        assert_eq!(operating.recall(true).as_deref(), Some("stop"));
        assert_eq!(operating.recall(true).as_deref(), Some("stop"));
        assert_eq!(operating.recall(false).as_deref(), Some("go"));
        assert_eq!(operating.recall(false).as_deref(), Some(""));
        operating.answered(2, Err("no".into()));
        operating.answered(9, Ok("tick 7: the job waits; anna commands".into()));
        assert_eq!(operating.exchanges[1].answer, Some(Err("no".into())));
        assert!(operating.job_waits() && operating.status.ends_with("anna commands"));
    }
}
