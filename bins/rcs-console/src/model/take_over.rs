//! Takes the command over from the workstation controller of another process, and returns it (IV.4.1).

use rcs_core::tick::Tick;

use super::{Key, Model, Section, Text, Tone};
use crate::rcs_console::picture::Picture;

const OFFER: &str = "`stand-alone` takes over"; // part of a refusal that offers to take the command over
const AGAIN: u64 = 25;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TakeOver {
    /// The console asks the operator whether and how to take over.
    Asks,
    /// The console waits for the end of the command in progress.
    Waits {
        since: Tick, // tick of the last request
    },
}

impl TakeOver {
    /// The state after an answer of the run. A refusal that offers a take-over begins it; an accepted request ends it.
    #[must_use]
    pub fn after(self_: Option<Self>, line: &str, verdict: &Result<String, String>) -> Option<Self> {
        match verdict {
            Err(why) if why.contains(OFFER) => self_.or(Some(Self::Asks)),
            Ok(_) if line.starts_with("stand-alone") => None,
            Ok(_) | Err(_) => self_,
        }
    }
}

#[must_use]
pub fn sections(state: TakeOver, picture: &Picture) -> Vec<Section> {
    let command = &picture.external.hws;
    let report = picture.memory.task.status.report;
    let plain = |text: &str| Text::plain(format!("   {text}"));
    let mut lines = vec![
        Text::default(),
        plain("Take over?"),
        Text::default(),
        plain(&format!(
            "The workstation controller commands: {}, number {}, {report}.",
            command.command, command.number
        )),
        Text::default(),
    ];
    match state {
        TakeOver::Asks => lines.extend([
            plain("  Enter   wait until it is finished, then this console commands"),
            plain("  P       PAUSE now, then this console commands; the command ends as replaced"),
            plain("  Esc     keep watching"),
        ]),
        TakeOver::Waits { .. } => lines.extend([
            Text::new(Tone::Marked, "   The end of the command is waited for.".to_owned()),
            plain("  P       do not wait: PAUSE now"),
            plain("  Esc     give it up"),
        ]),
    }
    lines.extend([
        Text::default(),
        plain("While this console commands, nothing that the workstation controller sends"),
        plain("is executed. `:workstation` gives the command back, with the robot at HOME"),
        plain("and PAUSE as the last command (IV.4.1); numbers continue from the last one."),
        Text::default(),
        plain("At any time: Space sets the knob to 0, h holds Prim, F1 is the E-stop."),
    ]);
    vec![Section::new("who commands", lines)]
}

impl Model {
    /// Carry out a key while the question is open. Returns false for other keys.
    pub(super) fn take_over(&mut self, key: Key) -> bool {
        let tick = Tick(self.tick());
        let Some(operating) = &mut self.operating else { return false };
        let Some(state) = operating.take_over else { return false };
        match (state, key) {
            (TakeOver::Asks, Key::Enter) => {
                operating.take_over = Some(TakeOver::Waits { since: tick });
                operating.ask("stand-alone");
            }
            (_, Key::Char('P')) => operating.ask("stand-alone now"),
            (_, Key::Esc) => operating.take_over = None,
            _ => return false,
        }
        true
    }
}

/// Repeat the request while the command in progress continues.
#[must_use]
pub fn is_due(state: Option<TakeOver>, tick: Tick) -> bool {
    matches!(state, Some(TakeOver::Waits { since }) if tick.since(since) >= AGAIN)
}
