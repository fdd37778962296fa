//! Progress on a terminal: the line of the job that is being executed, and what each level does.

use std::{
    io::{self, IsTerminal},
    time::{Duration, Instant},
};

use executive::failure;
use indicatif::{ProgressBar, ProgressStyle};
use levels::ladder::ProcessId;
use neighbours::workstation::player::BegunStep;
use rcs_core::interface::{CommonMemory, HwsCommand};

/// Time between two pictures.
const PERIOD: Duration = Duration::from_millis(100);
/// Levels that are shown: Task, Subtask, E-move, Prim, in the order of common memory.
const LEVELS: usize = 4;

/// The progress line; nothing if standard error is no terminal.
pub struct Progress {
    bar: Option<ProgressBar>,
    shown: Instant,
}

impl Progress {
    /// A line for a job of so many steps.
    #[must_use]
    pub fn new(steps: usize) -> Self {
        let bar = io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(steps as u64);
            if let Ok(style) =
                ProgressStyle::with_template("{pos:>3}/{len} {elapsed:>4} {prefix}\n    {wide_msg}")
            {
                bar.set_style(style);
            }
            bar
        });
        Self { bar, shown: Instant::now() }
    }

    /// Show where the run is, at most ten times a second.
    pub fn show(&mut self, steps: &[BegunStep], hws: &HwsCommand, memory: &CommonMemory) {
        let Some(bar) = &self.bar else { return };
        if self.shown.elapsed() < PERIOD {
            return;
        }
        self.shown = Instant::now();
        bar.set_position(steps.len() as u64);
        let line = steps.last().map_or("", |step| step.text.as_str());
        bar.set_prefix(line.to_owned());
        bar.set_message(levels(hws, memory));
    }

    /// A line that stays, above the progress line.
    pub fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(text),
            None => os_io::stderr_line!("{text}"),
        }
    }

    /// Take the line away.
    pub fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// What Task, Subtask, E-move and Prim do.
fn levels(hws: &HwsCommand, memory: &CommonMemory) -> String {
    let doing = ProcessId::ALL.iter().take(LEVELS).filter_map(|process| {
        // All of Task's command stands in the line of the job already.
        let command = match process {
            ProcessId::Task => hws.command.to_string(),
            _ => failure::command(*process, hws, memory),
        };
        (!command.is_empty()).then(|| format!("{process}: {command}"))
    });
    doing.collect::<Vec<_>>().join(" | ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::{
        interface::{emove::EmoveVerb, prim::PrimVerb},
        name::{Name10, Name16},
    };

    #[test]
    fn levels_without_a_command_are_left_out() {
        let mut memory = CommonMemory::default();
        let hws = HwsCommand { command: Name16::clipped("MOVE"), ..HwsCommand::default() };
        memory.subtask.emove.command = EmoveVerb::MovToLoc;
        memory.subtask.emove.location = Name10::clipped("HOME");
        memory.emove.prim.command = PrimVerb::GoThru;
        assert_eq!(levels(&hws, &memory), "Task: MOVE | E-move: MOV-TO-LOC at HOME | Prim: GO-THRU");
    }
}
