//! The console: keys, switches and queries, one command per line.

use std::str::FromStr;

use plant::{EStop, Key};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConsoleCommand {
    /// Press a key or turn a switch of the controller.
    Key(Key),
    /// Show the state of the controller and of the line.
    Status,
    Help,
    /// Wait this long before the next line, ms.
    Wait(u64),
    Quit,
}

const LONGEST_WAIT_S: f64 = 3600.0; // seconds

/// Help text with all commands, in the order of the start-up.
pub const HELP: &str = "\
control power on|off        power of the controller
fault reset                 the red FAULT RESET button
hydraulics enable|disable   the keyswitch
manual on|off               the MANUAL ON/OFF button: the robot's hydraulics
align [AXIS]                teach pendant: move all axes, or one of 1 to 6, to its arrow
jog AXIS DEGREES            teach pendant: turn one of the axes 1 to 6 by up to 20 degrees, in manual mode
auto                        the AUTO button: the robot moves to HOME
cycle start                 two short vertical motions, then the DEPC function
interrupt, cancel, enter    INTERRUPT button; CANCEL and ENTER keys
hold on|off                 the Hold button
estop [SITE]                E-stop: the robot sinks; control-panel (if none is named), teach-pendant,
                            terminals, joystick-box, pedestal
release [SITE]              pull an E-stop out again, before fault reset
board in|out                put the RS232 board in, take it out: control power off first
transmitter good|broken     the transmitter of the RS232 board
prim box on|off             power of the Prim Interface Box: FAULT RESET needs it
status                      everything at a glance
wait SECONDS                wait before the next line (for scripts)
help, quit";

impl FromStr for ConsoleCommand {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let lower = text.to_ascii_lowercase();
        let words: Vec<&str> = lower.split_whitespace().collect();
        let key = match words.as_slice() {
            ["control", "power", switch] => Key::ControlPower(on(switch)?),
            ["fault", "reset"] => Key::FaultReset,
            ["hydraulics", "enable"] => Key::Hydraulics(true),
            ["hydraulics", "disable"] => Key::Hydraulics(false),
            ["hydraulics", ..] => return Err("hydraulics enable or hydraulics disable was expected".into()),
            ["manual", switch] => Key::Manual(on(switch)?),
            ["align"] => Key::Align(None),
            ["align", axis] => match axis.parse() {
                Ok(axis @ 1..=6) => Key::Align(Some(axis)),
                _ => return Err(format!("an axis from 1 to 6 was expected, found {axis}")),
            },
            ["jog", axis, degrees] => jog(axis, degrees)?,
            ["jog", ..] => return Err("jog AXIS DEGREES was expected, such as jog 1 -5".into()),
            ["prim", "box", switch] => Key::PrimBox(on(switch)?),
            ["auto"] => Key::Auto,
            ["cycle", "start"] => Key::CycleStart,
            ["interrupt"] => Key::Interrupt,
            ["cancel"] => Key::Cancel,
            ["enter"] => Key::Enter,
            ["hold", switch] => Key::Hold(on(switch)?),
            ["estop" | "e-stop"] => Key::Press(EStop::ControlPanel),
            ["estop" | "e-stop", site] => Key::Press(estop(site)?),
            ["release"] => Key::Release(EStop::ControlPanel),
            ["release", site] => Key::Release(estop(site)?),
            ["board", place] => Key::Board(one_of(place, "in", "out")?),
            ["transmitter", state] => Key::Transmitter(one_of(state, "good", "broken")?),
            ["status"] => return Ok(Self::Status),
            ["help" | "?"] => return Ok(Self::Help),
            ["wait", seconds] => return wait(seconds),
            ["quit" | "exit"] => return Ok(Self::Quit),
            _ => return Err(format!("there is no command \"{}\"; help lists them", text.trim())),
        };
        Ok(Self::Key(key))
    }
}

const LONGEST_JOG: i8 = 20; // largest jog of one axis from the pendant, degrees

fn jog(axis: &str, degrees: &str) -> Result<Key, String> {
    let axis = axis.parse().ok().filter(|axis| (1..=6).contains(axis));
    let degrees = degrees.parse().ok().filter(|degrees| (-LONGEST_JOG..=LONGEST_JOG).contains(degrees));
    let key = axis.zip(degrees).map(|(axis, degrees)| Key::Jog { axis, degrees });
    key.ok_or_else(|| {
        format!("an axis from 1 to 6 and -{LONGEST_JOG} to {LONGEST_JOG} degrees were expected")
    })
}

fn estop(word: &str) -> Result<EStop, String> {
    EStop::from_text(word).ok_or_else(|| {
        let known: Vec<&str> = EStop::ALL.iter().map(|site| site.text()).collect();
        format!("one of the E-stops {} was expected, found {word}", known.join(", "))
    })
}

fn on(switch: &str) -> Result<bool, String> {
    one_of(switch, "on", "off")
}

/// Returns true for the word `yes` and false for the word `no`.
fn one_of(word: &str, yes: &str, no: &str) -> Result<bool, String> {
    if word == yes {
        Ok(true)
    } else if word == no {
        Ok(false)
    } else {
        Err(format!("{yes} or {no} was expected, found {word}"))
    }
}

fn wait(seconds: &str) -> Result<ConsoleCommand, String> {
    match seconds.parse::<f64>() {
        Ok(seconds) if (0.0..=LONGEST_WAIT_S).contains(&seconds) => {
            Ok(ConsoleCommand::Wait((seconds * 1000.0).round() as u64))
        }
        _ => Err(format!("seconds from 0 to {LONGEST_WAIT_S} were expected, found {seconds}")),
    }
}

/// Splits the bytes of standard input into lines. A line that is too long is truncated.
#[derive(Debug, Default)]
pub struct Lines {
    bytes: Vec<u8>,
}

const LONGEST_LINE: usize = 256; // bytes

impl Lines {
    /// Takes `bytes` and returns the lines that they complete, without empty lines and `#` comments.
    pub fn accept(&mut self, bytes: &[u8]) -> Vec<String> {
        let mut lines = Vec::new();
        for byte in bytes {
            match byte {
                b'\n' | b'\r' => {
                    let line = String::from_utf8_lossy(&self.bytes).trim().to_owned();
                    self.bytes.clear();
                    if !line.is_empty() && !line.starts_with('#') {
                        lines.push(line);
                    }
                }
                _ if self.bytes.len() < LONGEST_LINE => self.bytes.push(*byte),
                _ => {}
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_of_the_help_is_understood() {
        for line in HELP.lines().filter(|line| !line.starts_with(' ')) {
            let synopsis = line.split("  ").next().unwrap_or_default();
            for one in synopsis.split(", ") {
                let one = one.split(['|', '[']).next().unwrap_or_default();
                let one = one.replace("SECONDS", "1.5").replace("AXIS", "1").replace("DEGREES", "5");
                assert!(one.parse::<ConsoleCommand>().is_ok(), "{one}");
            }
        }
    }

    #[test]
    fn abbreviations_resolve_and_mistakes_are_reported() {
        assert_eq!("  Control POWER on ".parse(), Ok(ConsoleCommand::Key(Key::ControlPower(true))));
        assert_eq!("align 3".parse(), Ok(ConsoleCommand::Key(Key::Align(Some(3)))));
        for key in [
            Key::ControlPower(false),
            Key::Hydraulics(false),
            Key::Align(Some(6)),
            Key::Hold(true),
            Key::Press(EStop::JoystickBox),
            Key::Release(EStop::TeachPendant),
            Key::Board(false),
            Key::Transmitter(true),
            Key::PrimBox(false),
            Key::Jog { axis: 1, degrees: -5 },
        ] {
            assert_eq!(key.to_string().parse(), Ok(ConsoleCommand::Key(key)));
        }
        assert_eq!("wait 0.25".parse(), Ok(ConsoleCommand::Wait(250)));
        for (wrong, says) in [
            ("align 7", "1 to 6"),
            ("jog 1 90", "-20 to 20 degrees"),
            ("jog 1", "such as jog 1 -5"),
            ("prim box maybe", "on or off"),
            ("hold maybe", "on or off"),
            ("board off", "in or out"),
            ("transmitter", "no command"),
            ("wait nan", "seconds"),
            ("wait -1", "seconds"),
            ("hydraulics on", "enable"),
            ("start", "no command"),
            ("estop door", "pedestal"),
        ] {
            let error = wrong.parse::<ConsoleCommand>().expect_err(wrong);
            assert!(error.contains(says), "{wrong}: {error}");
        }
    }

    #[test]
    fn lines_are_assembled_from_any_pieces() {
        let mut lines = Lines::default();
        assert!(lines.accept(b"sta").is_empty());
        assert_eq!(lines.accept(b"tus\r\n\n# no\nquit\nhe"), ["status", "quit"]);
        assert_eq!(lines.accept(&[b'x'; 5000]).len(), 0);
        assert_eq!(lines.accept(b"\n")[0].len(), LONGEST_LINE);
    }
}
