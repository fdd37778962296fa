//! Progress on a terminal: the present line of the job, and the commands of the levels. In the background of a shell
//! only messages are printed.

use std::{
    io::{self, IsTerminal},
    time::{Duration, Instant},
};

use closed_loop::failure;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use interfaces::{CommonMemory, HwsCommand};
use levels::ladder::ProcessId;
use os_io::console::shown;
use rcs_core::tick::Tick;
use runtime::{Observer, TickReport, event::Event};
use rustix::{process::getpgrp, termios::tcgetpgrp};

const PERIOD: Duration = Duration::from_millis(100);
/// Number of levels shown: Task, Subtask, E-move, Prim, in the order of common memory.
const LEVELS: usize = 4;

/// The progress line of a run. If standard error is not a terminal, only messages are printed.
pub struct Progress {
    bar: Option<ProgressBar>,
    drawn: bool, // true while the line can be drawn: the run is in the foreground of its terminal
    shown: Instant,
}

impl Default for Progress {
    fn default() -> Self {
        let bar = io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::no_length();
            if let Ok(style) =
                ProgressStyle::with_template("{pos:>3}/{len} {elapsed:>4} {prefix}\n    {wide_msg}")
            {
                bar.set_style(style);
            }
            bar
        });
        Self { bar, drawn: true, shown: Instant::now() }
    }
}

impl Progress {
    /// The progress line, if it can be drawn now. A shell can move the run to the background and back at any time.
    fn line(&mut self) -> Option<&ProgressBar> {
        let bar = self.bar.as_ref()?;
        let drawn = is_in_foreground();
        if drawn != self.drawn {
            self.drawn = drawn;
            bar.set_draw_target(if drawn {
                ProgressDrawTarget::stderr()
            } else {
                ProgressDrawTarget::hidden()
            });
        }
        drawn.then_some(bar)
    }
}

/// True unless another process group has the terminal of standard error.
fn is_in_foreground() -> bool {
    tcgetpgrp(io::stderr()).map_or(true, |foreground| foreground == getpgrp())
}

impl Observer for Progress {
    /// Print a permanent line above the progress line.
    fn message(&mut self, text: &str) {
        match self.line() {
            Some(bar) => bar.println(shown(&format!("rcs-run: {text}"))),
            None => os_io::stderr_line!("rcs-run: {text}"),
        }
    }

    fn event(&mut self, _: Tick, event: &Event) {
        if matches!(event, Event::UserStops) {
            self.message("Ctrl-C again ends the run at once, even with the robot in motion");
        }
    }

    /// Update the progress line, at most ten times per second.
    fn tick(&mut self, report: &TickReport<'_>) {
        if self.shown.elapsed() < PERIOD {
            return;
        }
        self.shown = Instant::now();
        let Some(bar) = self.line() else { return };
        bar.set_length(report.lines as u64);
        bar.set_position(report.line as u64);
        bar.set_prefix(report.steps.last().map_or_else(String::new, |step| shown(&step.text).into_owned()));
        bar.set_message(shown(&levels(report.hws, report.memory)).into_owned());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = self.line() {
            bar.finish_and_clear();
        }
    }
}

fn levels(hws: &HwsCommand, memory: &CommonMemory) -> String {
    let doing = ProcessId::ALL.iter().take(LEVELS).filter_map(|process| {
        // The line of the job already shows Task's command.
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
    use interfaces::{emove::EmoveVerb, prim::PrimVerb};
    use rcs_core::name::{Name10, Name16};

    #[test]
    fn levels_without_a_command_are_omitted() {
        let mut memory = CommonMemory::default();
        let hws = HwsCommand { command: Name16::clipped("MOVE"), ..HwsCommand::default() };
        memory.subtask.emove.command = EmoveVerb::MovToLoc;
        memory.subtask.emove.site.location = Name10::clipped("HOME");
        memory.emove.prim.command = PrimVerb::GoThru;
        assert_eq!(levels(&hws, &memory), "Task: MOVE | E-move: MOV-TO-LOC at HOME | Prim: GO-THRU");
    }
}
