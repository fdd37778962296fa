//! The screen without a run: the choice of runs, or how to start one.

use executive::{boards::Board, memory::RunName};
use ratatui::{style::Modifier, text::Line};

use super::{
    Look,
    text::{fit, rule},
};
use crate::rcs_console::model::Tone;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Waiting {
    pub runs: Vec<RunName>, // of this user, in progress
    pub cursor: usize,      // index of a run
    /// The boards of the selected run while it waits for boards, with true for those that have joined (IV.2.1, IV.2.8).
    pub boards: Vec<(Board, bool)>,
    pub phase: Option<String>,   // before its first tick, as a phrase after its name
    pub refused: Option<String>, // why the last run could not be shown
}

impl Waiting {
    /// Update the list of runs. The cursor stays on its run.
    pub fn take(&mut self, runs: Vec<RunName>) {
        self.cursor = self.cursor.min(runs.len().saturating_sub(1));
        self.runs = runs;
    }

    #[must_use]
    pub fn chosen(&self) -> Option<&RunName> {
        self.runs.get(self.cursor)
    }

    pub(super) fn compose(&self, look: Look, width: usize, height: usize) -> Vec<Line<'static>> {
        let mut lines = vec![
            look.line(Tone::Plain, format!(" rcs-console{:>rest$}", "q=quit ", rest = width - 12)),
            look.line(Tone::Plain, fit(" ?? NO RUN", width)),
            look.line(Tone::Plain, rule("", width)),
            Line::default(),
        ];
        let mut say = |text: &str| lines.push(look.line(Tone::Plain, format!("   {text}")));
        if let (Some(run), false) = (self.chosen(), self.boards.is_empty()) {
            say(&format!("The boards of {run} come up:"));
            say("");
            say("    board 0   is there   the pulse, the log, the cell or the robot's port");
            for (board, is_there) in &self.boards {
                let state = if *is_there { "is there" } else { "MISSING " };
                let processes: Vec<_> = board.processes().map(|process| process.text()).collect();
                let processes = fit(&processes.join(", "), width.saturating_sub(28));
                say(&format!("    board {}   {state}   {}", board.number(), processes.trim_end()));
            }
            say("");
            if let Some((missing, _)) = self.boards.iter().find(|(_, is_there)| !is_there) {
                say("With --boards manual each is started with the data and the job of the run:");
                say("");
                say(&format!("    rcs-run board {} --run {run} JOB", missing.number()));
            } else {
                say("All are there: the first tick comes.");
            }
        } else if let ([run], Some(phase)) = (&self.runs[..], &self.phase) {
            say(&format!("{run} {phase}."));
            say("");
            say("It appears here with its first tick.");
        } else if self.runs.is_empty() {
            say("There is no run on this machine.");
            say("");
            say("Start a run in another terminal, and it appears here by itself:");
            say("");
            say("    rcs-run linkbar --clock real");
            say("");
            say("or look at a log:");
            say("");
            say("    rcs-console --log runs/linkbar.mcap");
        } else {
            say("There are several runs. Choose one:");
            say("");
            for (at, run) in self.runs.iter().enumerate() {
                let mark = if at == self.cursor { '>' } else { ' ' };
                let line = look.line(Tone::Plain, format!("   {mark} {run}"));
                lines.push(if at == self.cursor { line.patch_style(Modifier::REVERSED) } else { line });
            }
        }
        if let Some(refused) = &self.refused {
            lines.push(Line::default());
            let told = super::text::wrap(&format!("!! {refused}"), width);
            lines.extend(told.into_iter().map(|text| look.line(Tone::Trouble, text)));
        }
        lines.truncate(height - 2);
        lines.resize(height - 2, Line::default());
        lines.push(look.line(Tone::Plain, " Looking for runs of this user every second."));
        lines.push(look.line(Tone::Plain, " j k=choose  Enter=look at it  q=quit"));
        lines
    }
}
