//! The keys that send an operator's requests to a run.

use interfaces::device::{KNOB_FULL, single_step};

use super::{
    Key, Model, Prompt, Screen, panels,
    session::JOGS,
    terminal::{complete::complete, known},
};

impl Model {
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
                    "the E-stops are at the robot; F1 again holds Prim, and stops board 4"
                } else {
                    "F1 again presses the E-stop: the arm sinks; Space is gentler (IV.3.1)"
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

    /// Handle a key of the panel screen. The first Enter names the key at the cursor, the second one presses it.
    fn work_a_panel(&mut self, key: Key, was_chosen: bool) -> bool {
        let (frame, velocity) = (self.joystick().frame, self.joystick().velocity);
        let knob = |velocity: u16| format!("joystick velocity {velocity}");
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
            Key::Char('-') => knob(velocity.saturating_sub(KNOB_STEP)),
            Key::Char('+' | '=') => knob(velocity.saturating_add(KNOB_STEP).min(KNOB_FULL)),
            Key::Char('s') => {
                operating.jog = (operating.jog + 1) % JOGS.len();
                return true;
            }
            Key::Char('j') => {
                operating.cursor = (operating.cursor + 1).min(panels::requests().count() - 1);
                return true;
            }
            Key::Char('k') => {
                operating.cursor = operating.cursor.saturating_sub(1);
                return true;
            }
            Key::Enter => {
                let chosen = panels::request(operating.cursor);
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
                chosen
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
                    0 => Some("no known value fits here".to_owned()),
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

const KNOB_STEP: u16 = KNOB_FULL / 10; // change of the velocity knob by a key: a tenth of its range
/// Speed with the stick at full deflection and the velocity knob at its maximum, in/s (`levels::prim::manual`).
const SPEED: f64 = 5.0;
const ACCELERATION: f64 = 10.0; // acceleration of the stick's motion, in/s²
const PLAY: f64 = 0.03; // dead zone of the stick, as a share of its range
const TICKS: f64 = 25.0; // ticks per second

/// Deflection, as a share, and ticks for a motion of this length at full knob. The ramps at both ends cancel.
fn stick(inches: f64) -> (f64, u32) {
    let ticks = (inches * TICKS).clamp(2.0, 20.0).round();
    let share = (inches * TICKS / ticks / SPEED).clamp(0.0, 1.0);
    (PLAY + share * (1.0 - PLAY), ticks as u32)
}

/// Ticks to hold a button for a motion of about this length at full knob, always at full speed.
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
}
