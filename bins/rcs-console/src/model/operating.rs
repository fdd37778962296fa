//! Requests of an operator to a run, the run's answers, and the keys that send requests.

use interfaces::device::{KNOB_FULL, single_step};

use super::{
    Key, Model, Prompt, Screen, panels,
    take_over::{TakeOver, is_due},
    terminal::{complete::complete, follow, known},
};
use crate::picture::Picture;

/// Number of requests and answers kept.
const KEPT: usize = 200;
/// Lengths of a jog, in.
pub const JOGS: [f64; 4] = [0.10, 0.50, 2.00, 0.02];
/// A request and its answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// Number of the request.
    pub number: u32,
    /// Text of the request.
    pub line: String,
    /// The answer, once it has come.
    pub answer: Option<Result<String, String>>,
    /// Progress of the command that it has sent, if any.
    pub stages: Vec<String>,
}

/// The session of an operator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operating {
    /// The status line of the run: the source of commands, whether the job waits, the velocity knob.
    pub status: String,
    /// Requests, oldest first.
    pub exchanges: Vec<Exchange>,
    /// Number of all requests sent.
    count: u64,
    /// Directory of the run's task data, once the run has answered.
    pub directory: Option<String>,
    /// Requests to be sent.
    pub outbox: Vec<String>,
    /// The reason why the connection was lost.
    pub lost: Option<String>,
    /// Index of the jog length in [`JOGS`].
    pub jog: usize,
    /// Index of the panel key under the cursor.
    pub cursor: usize,
    /// True if the next F1 presses the emergency stop.
    pub is_armed: bool,
    /// True if the next Enter presses the panel key under the cursor.
    pub is_chosen: bool,
    /// Number of requests by which the arrow keys of the prompt have gone back.
    pub back: usize,
    /// The question whether to take the command over, if it is open.
    pub take_over: Option<TakeOver>,
}

impl Operating {
    /// Note that a request was sent.
    pub fn sent(&mut self, number: u32, line: String) {
        if self.exchanges.len() == KEPT {
            self.exchanges.remove(0);
        }
        self.count += 1;
        self.exchanges.push(Exchange { number, line, answer: None, stages: Vec::new() });
    }

    /// Number of all requests sent.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The requests with their numbers among all that were sent, from 1.
    pub fn numbered(&self) -> impl Iterator<Item = (u64, &Exchange)> {
        let kept = u64::try_from(self.exchanges.len()).unwrap_or(u64::MAX);
        (self.count.saturating_sub(kept) + 1..).zip(&self.exchanges)
    }

    /// Update the progress of the commands from a picture.
    pub fn look(&mut self, picture: &Picture) {
        self.exchanges.iter_mut().for_each(|exchange| follow(exchange, picture));
        if is_due(self.take_over, picture.tick) && self.outbox.is_empty() {
            self.take_over = Some(TakeOver::Waits { since: picture.tick });
            self.ask("stand-alone");
        }
    }

    /// Note an answer to a request or to the question about the status.
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

    /// True if the job waits for an operator.
    #[must_use]
    pub fn job_waits(&self) -> bool {
        self.status.starts_with("the job waits")
    }

    /// Number of the last request; 0 before the first.
    #[must_use]
    pub fn newest(&self) -> u32 {
        self.exchanges.last().map_or(0, |exchange| exchange.number)
    }

    /// True if all requests after this one have been sent, answered and accepted.
    #[must_use]
    pub fn has_taken_since(&self, number: u32) -> bool {
        let mut since = self.exchanges.iter().filter(|exchange| exchange.number > number).peekable();
        let sent = self.outbox.is_empty() && since.peek().is_some();
        sent && since.all(|exchange| matches!(exchange.answer, Some(Ok(_))))
    }

    /// Queue a request to the run.
    pub fn ask(&mut self, line: impl Into<String>) {
        self.outbox.push(line.into());
    }

    /// An earlier request for the prompt: the previous one if `back`, else the next.
    fn recall(&mut self, back: bool) -> Option<String> {
        self.back = if back { self.back + 1 } else { self.back.saturating_sub(1) };
        self.back = self.back.min(self.exchanges.len());
        let at = self.exchanges.len().checked_sub(self.back)?;
        Some(self.exchanges.get(at).map_or_else(String::new, |exchange| exchange.line.clone()))
    }
}

impl Model {
    /// Carry out a key that sends a request. Returns false for other keys.
    pub(super) fn operate(&mut self, key: Key) -> bool {
        let on_panels = self.screen == Screen::Panels;
        let velocity = self.joystick().velocity;
        let holds_prim = self.joystick().hold & single_step::PRIM != 0;
        let Some(operating) = self.operating.as_mut().filter(|operating| operating.lost.is_none()) else {
            return false;
        };
        let was_armed = std::mem::take(&mut operating.is_armed);
        let was_chosen = std::mem::take(&mut operating.is_chosen);
        match key {
            Key::Char(' ') if velocity == 0 => operating.ask("go"),
            Key::Char(' ') => operating.ask("stop"),
            Key::Char('h') if holds_prim => operating.ask("joystick free PRIM"),
            Key::Char('h') => operating.ask("joystick hold PRIM"),
            Key::F1 | Key::Char('!') if was_armed && self.robot_elsewhere => {
                operating.ask("joystick hold PRIM");
                operating.ask("board 4 stop");
            }
            Key::F1 | Key::Char('!') if was_armed => operating.ask("estop terminals"),
            Key::F1 | Key::Char('!') => {
                operating.is_armed = true;
                let what = if self.robot_elsewhere {
                    "the E-stops are at the robot; F1 again holds Prim and stops board 4: the robot gets no further frame"
                } else {
                    "F1 again presses the E-stop near the terminals: the arm sinks; Space is gentler (IV.3.1)"
                };
                self.answer = Some(what.to_owned());
            }
            Key::Char(':') => {
                operating.back = 0;
                self.prompt = Some(Prompt::Request(String::new()));
            }
            _ => return on_panels && self.work_a_panel(key, was_chosen),
        }
        true
    }

    /// Carry out a key of the panel screen: of the joystick box, or of the key list. The first Enter names the key under
    /// the cursor, the second one presses it, so that a stray Enter starts nothing.
    fn work_a_panel(&mut self, key: Key, was_chosen: bool) -> bool {
        let frame = self.joystick().frame;
        let Some(operating) = &mut self.operating else { return false };
        let size = JOGS.get(operating.jog).copied().unwrap_or(JOGS[0]);
        let jog = |x: f64, y: f64| {
            let (share, ticks) = stick(size);
            let counts = |direction: f64| (direction * share * f64::from(KNOB_FULL)).round();
            format!("joystick stick {} {} {ticks}", counts(x), counts(y))
        };
        let press = |button: &str| format!("joystick {button} {}", button_ticks(size));
        let line = match key {
            Key::Up => jog(1.0, 0.0),
            Key::Down => jog(-1.0, 0.0),
            Key::Left => jog(0.0, 1.0),
            Key::Right => jog(0.0, -1.0),
            Key::PageUp => press("up"),
            Key::PageDown => press("down"),
            Key::Char(',') => press("roll-"),
            Key::Char('.') => press("roll+"),
            Key::Char('{') => press("open"),
            Key::Char('}') => press("close"),
            Key::Char('w') => "joystick frame WORLD".to_owned(),
            Key::Char('t') => "joystick frame TOOL".to_owned(),
            Key::Char('o') => "joystick frame TOOL-ORIGIN".to_owned(),
            Key::Char('r') => "joystick frame WRIST-ORIGIN".to_owned(),
            Key::Char('x') => "joystick frame OFF".to_owned(),
            Key::Char('z') => "joystick step PRIM".to_owned(),
            Key::Char('m') => "joystick record".to_owned(),
            Key::Char('M') => "joystick resume".to_owned(),
            Key::Char('`') => "joystick velocity 0".to_owned(),
            Key::Char(digit @ '0'..='9') => {
                let tenths = digit.to_digit(10).filter(|tenths| *tenths > 0).unwrap_or(10);
                format!("joystick velocity {}", tenths * u32::from(KNOB_FULL) / 10)
            }
            Key::Char('s') => {
                operating.jog = (operating.jog + 1) % JOGS.len();
                return true;
            }
            Key::Char('j') => {
                operating.cursor = (operating.cursor + 1).min(panels::KEYS.len() - 1);
                return true;
            }
            Key::Char('k') => {
                operating.cursor = operating.cursor.saturating_sub(1);
                return true;
            }
            Key::Enter => {
                let chosen = panels::KEYS.get(operating.cursor).copied().unwrap_or_default();
                if let Some(words) = chosen.strip_suffix(panels::TO_NAME) {
                    operating.back = 0;
                    self.prompt = Some(Prompt::Request(words.to_owned()));
                    return true;
                }
                if !was_chosen {
                    operating.is_chosen = true;
                    self.answer = Some(format!("Enter again presses: {chosen}"));
                    return true;
                }
                chosen.to_owned()
            }
            _ => return false,
        };
        let moves = matches!(key, Key::Up | Key::Down | Key::Left | Key::Right | Key::PageUp | Key::PageDown);
        if moves && frame == 0 {
            self.answer = Some("no frame is on: w t o r switch one on, then arrows move the hand".to_owned());
        } else {
            operating.ask(line);
        }
        true
    }

    /// Carry out a key of the request prompt.
    pub(super) fn type_request(&mut self, mut text: String, key: Key) {
        let mut recall = |back| self.operating.as_mut().and_then(|operating| operating.recall(back));
        match key {
            Key::Char(typed) => text.push(typed),
            Key::Backspace => drop(text.pop()),
            Key::Up => text = recall(true).unwrap_or(text),
            Key::Down => text = recall(false).unwrap_or(text),
            Key::Tab => {
                let words = known(self.terminal.board.number);
                let (completed, fitting) = complete(&text, self.terminal.library.names(), &words);
                self.answer = match fitting.len() {
                    0 => Some("no known value can stand here".to_owned()),
                    1 => None,
                    _ => Some(fitting.join(" ")),
                };
                text = completed;
            }
            Key::Enter if text.trim().is_empty() => return,
            Key::Enter => return self.enter(text.trim()),
            Key::Esc | Key::Interrupt => return,
            _ => {}
        }
        self.prompt = Some(Prompt::Request(text));
    }
}

/// Speed with the stick at full deflection and the velocity knob at its maximum, in/s (`levels::prim::manual`).
const SPEED: f64 = 5.0;
/// Acceleration of the stick's motion, in/s².
const ACCELERATION: f64 = 10.0;
/// Dead zone of the stick, as a share of its range.
const PLAY: f64 = 0.03;
/// Ticks per second.
const TICKS: f64 = 25.0;

/// Deflection, as a share, and ticks for a motion of this length at full knob: the ramps at both ends cancel each
/// other.
fn stick(inches: f64) -> (f64, u32) {
    let ticks = (inches * TICKS).clamp(2.0, 20.0).round();
    let share = (inches * TICKS / ticks / SPEED).clamp(0.0, 1.0);
    (PLAY + share * (1.0 - PLAY), ticks as u32)
}

/// Ticks to hold a button for a motion of about this length at full knob; its speed is always the full one.
fn button_ticks(inches: f64) -> u32 {
    let ramp = SPEED / ACCELERATION;
    let seconds = if inches < SPEED * ramp { (inches / ACCELERATION).sqrt() } else { inches / SPEED };
    (seconds * TICKS).round().max(1.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jog_has_its_length() {
        for inches in JOGS {
            let (deflection, ticks) = stick(inches);
            let share = (deflection - PLAY) / (1.0 - PLAY);
            let moved = share * SPEED * f64::from(ticks) / TICKS;
            assert!((moved - inches).abs() < 0.01 * inches, "{inches}: {moved}");
            assert!(button_ticks(inches) >= 1);
        }
    }

    #[test]
    fn the_last_requests_come_back() {
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
