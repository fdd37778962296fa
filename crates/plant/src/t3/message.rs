//! Messages of the controller, and visible events of the robot. Texts of the screen are those of the manual (IV.3.3, A
//! 2.3, A 2.4).

use std::fmt;

use depc::{Plate, controller::Warning};
use geometry::pose::WireFrame;
use serde::{Deserialize, Serialize};

use super::Cut;

/// HOME as the manual prints it (IV.3.3 step 11).
pub const HOME: WireFrame =
    WireFrame { tool: [0, -7145, -1483], wrist_to_tool: [0, -2123, -2119], tool_to_finger: [3000, 0, 0] };
/// Greatest deviation of a value from HOME (IV.3.3 step 11).
pub const HOME_TOLERANCE: i32 = 4;

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum Message {
    Aligned([bool; 6]),
    Warning(#[serde(with = "crate::image::record")] Warning),
    Lamps(Lamps),
    Robot(RobotEvent),
    /// The position, and its greatest deviation from HOME.
    Position(#[serde(with = "crate::image::record")] WireFrame),
    /// The DEPC function has begun and reported the position.
    Reported(#[serde(with = "crate::image::record")] Plate),
    Ended,
    /// The controller runs a function on arrival (A 2.3).
    Function([u8; 2]),
}

/// A change of the lamps (III.6, IV.3.3).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub enum Lamps {
    PowerOn,
    PowerOff,
    Fault,
    FaultReset,
    HydraulicsEnabled,
    HydraulicsDisabled,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub enum RobotEvent {
    Sinks(Cut),
    WillJump,
    /// The arm has jumped to the command of the servos.
    Jumped {
        inches: f64, // distance that the hand has moved, in
    },
    /// The robot makes the vertical motions of its program (IV.3.3 step 12).
    VerticalMotions,
    Interrupted,
    GoesHome,
    PreManual,
}

impl fmt::Display for Lamps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PowerOn => "control power on, FAULT RESET on",
            Self::PowerOff => "control power off",
            Self::Fault => "FAULT RESET on, HYD ENABLED off",
            Self::FaultReset => "FAULT RESET off",
            Self::HydraulicsEnabled => "HYD ENABLED on, red warning lights on the robot on",
            Self::HydraulicsDisabled => "HYD ENABLED off, red warning lights on the robot off",
        })
    }
}

impl fmt::Display for RobotEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sinks(cause) => write!(f, "{cause}: hydraulics off, the arm sinks"),
            Self::WillJump => f.write_str("hydraulics on: the arm will jump"),
            Self::Jumped { inches } => write!(f, "the hand has jumped by {inches:.1} in and is at rest"),
            Self::VerticalMotions => f.write_str("two short vertical motions"),
            Self::Interrupted => f.write_str("interrupted"),
            Self::GoesHome => f.write_str("moves directly to HOME"),
            Self::PreManual => f.write_str("pre-manual mode"),
        }
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Aligned(axes) => {
                f.write_str("* = ALIGNED   1 2 3 4 5 6\n             ")?;
                for star in axes {
                    f.write_str(if *star { " *" } else { "  " })?;
                }
                Ok(())
            }
            Self::Warning(warning) => {
                let (code, problem) = screen(*warning);
                write!(f, "{code}  {problem}")
            }
            Self::Lamps(lamps) => write!(f, "[lamp] {lamps}"),
            Self::Robot(event) => write!(f, "[robot] {event}"),
            Self::Position(frame) => {
                for (row, [x, y, z]) in
                    [frame.tool, frame.wrist_to_tool, frame.tool_to_finger].iter().enumerate()
                {
                    let head = if row == 0 { "[position]" } else { "\n          " };
                    write!(f, "{head} {x:6} {y:6} {z:6}")?;
                }
                match off_home(frame) {
                    off if off <= HOME_TOLERANCE => write!(f, "   HOME, to within {off}"),
                    _ => Ok(()),
                }
            }
            Self::Reported(plate) => {
                let [x, y, z, d, e, r] = plate.words;
                write!(f, "[link] DEPC runs, reported X {x} Y {y} Z {z} D {d} E {e} R {r}")
            }
            Self::Ended => f.write_str("[link] DEPC cancelled by the host"),
            Self::Function([code, operand]) => write!(f, "[link] function {code:02X} {operand:02X}"),
        }
    }
}

/// The largest deviation of a value from HOME.
#[must_use]
pub fn off_home(frame: &WireFrame) -> i32 {
    let values = |frame: &WireFrame| [frame.tool, frame.wrist_to_tool, frame.tool_to_finger].concat();
    values(frame).iter().zip(values(&HOME)).map(|(a, b)| (a - b).abs()).max().unwrap_or_default()
}

/// A warning with its meaning: `WD6 (joint 6 is at its limit)`.
#[must_use]
pub fn explained(warning: Warning) -> String {
    let meaning = match warning {
        Warning::None => "none",
        Warning::BoardMissing => "its RS232 board is missing",
        Warning::CtsLow => "the host's line CTS is off",
        Warning::Interrupt => "the Interrupt button was pressed",
        Warning::Translation => "a step in X, Y, Z is too long",
        Warning::Orientation => "a step in D, E, R is too large",
        Warning::Transmitter => "its transmitter has failed",
        Warning::JointLimit => "joint 6 is at its limit",
        Warning::ShoulderUp => "joint 2, the shoulder, is at its upper limit",
        Warning::OtherJoint => "a joint is at its limit",
        Warning::Wrist => "the wrist is in a singular position",
        Warning::Terminated => "the DEPC function has ended and must be started again",
        Warning::OffPath => "the robot has left its path and comes to rest",
    };
    format!("{} ({meaning})", screen(warning).0)
}

fn screen(warning: Warning) -> (&'static str, &'static str) {
    match warning {
        Warning::None => ("", ""),
        Warning::BoardMissing => ("WD0", "RS232 board missing"),
        Warning::CtsLow => ("WD1", "CTS low"),
        Warning::Interrupt => ("WD2", "Interrupt Button"),
        Warning::Translation => ("WD3", "Translation"),
        Warning::Orientation => ("WD4", "Orientation"),
        Warning::Transmitter => ("WD5", "Trans hardware"),
        Warning::JointLimit => ("WD6", "Joint limit reached (Joint 6)"),
        Warning::ShoulderUp => ("P05", "Joint 2 reached upward DEPC limit"),
        Warning::OtherJoint => ("P0B", "Joint limit reached"),
        Warning::Wrist => ("P9P", "Wrist singularity problem"),
        Warning::Terminated => ("P-IG", "DEPC link terminated (unrecoverable)"),
        Warning::OffPath => ("OFF-PATH", "Path interrupted"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warning_is_explained_with_its_code() {
        assert_eq!(explained(Warning::JointLimit), "WD6 (joint 6 is at its limit)");
        assert_eq!(explained(Warning::ShoulderUp), "P05 (joint 2, the shoulder, is at its upper limit)");
        let ended = "P-IG (the DEPC function has ended and must be started again)";
        assert_eq!(explained(Warning::Terminated), ended);
    }

    #[test]
    fn screen_text_equals_that_of_the_manual() {
        assert_eq!(
            Message::Aligned([true, false, false, false, true, true]).to_string(),
            "* = ALIGNED   1 2 3 4 5 6\n              *       * *"
        );
        assert_eq!(Message::Warning(Warning::CtsLow).to_string(), "WD1  CTS low");
        assert!(Message::Warning(Warning::Terminated).to_string().starts_with("P-IG"));
    }

    #[test]
    fn home_is_recognised_within_four_counts() {
        let mut frame = HOME;
        frame.wrist_to_tool[1] += 4;
        assert!(Message::Position(frame).to_string().ends_with("HOME, to within 4"));
        frame.wrist_to_tool[1] += 1;
        assert!(!Message::Position(frame).to_string().contains("HOME"));
    }
}
