//! The screen without a run: what runs there are, or how one begins.

use executive::memory::RunName;
use ratatui::{style::Modifier, text::Line};

use super::{
    Look,
    text::{fit, rule},
};
use crate::model::Tone;

/// The runs to choose from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Waiting {
    /// Living runs of this user.
    pub runs: Vec<RunName>,
    /// The one under the cursor.
    pub cursor: usize,
    /// Why the last one could not be looked at.
    pub refused: Option<String>,
}

impl Waiting {
    /// Take in the runs that live now; the cursor stays on one of them.
    pub fn take(&mut self, runs: Vec<RunName>) {
        self.cursor = self.cursor.min(runs.len().saturating_sub(1));
        self.runs = runs;
    }

    /// The run under the cursor.
    #[must_use]
    pub fn chosen(&self) -> Option<&RunName> {
        self.runs.get(self.cursor)
    }

    pub(super) fn compose(&self, look: Look, width: usize, height: usize) -> Vec<Line<'static>> {
        let mut lines = vec![
            look.line(Tone::Plain, format!(" rcs-console{:>rest$}", "q=quit ", rest = width - 12)),
            look.line(Tone::Plain, fit(" no run", width - 10) + "LOOK ONLY"),
            look.line(Tone::Plain, rule("", width)),
            Line::default(),
        ];
        let mut say = |text: &str| lines.push(look.line(Tone::Plain, format!("   {text}")));
        if self.runs.is_empty() {
            say("Nothing runs on this machine.");
            say("");
            say("Start a run in another terminal, and it appears here by itself:");
            say("");
            say("    rcs-run linkbar --clock real");
            say("");
            say("or look at a log:");
            say("");
            say("    rcs-console --log runs/linkbar.mcap");
        } else {
            say("Several runs go on. Choose one:");
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
