//! E-move and Grip, the parts gripper (VI.3.2).

use core::fmt;

use rcs_core::{Actions, Plain, handshake::Lower};

use super::words::Inches;
use crate::{Header, Reason, device::GripValves};

/// Commands of Grip (VI.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum GripVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Leave the valves as they are.
    Pause,
    /// Open or close to an opening.
    Position,
    /// Synonym of POSITION, for an opening motion.
    OpenGrip,
    /// Close with a commanded force.
    CloseGrip,
    /// Calibrate position and force sensors.
    UpInit,
}

/// Command from E-move to Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripCommand {
    /// `sincr-cmnd#`.
    pub number: u32,
    /// `scommand`.
    pub command: GripVerb,
    /// `sforce`: lb.
    pub force: i32,
    /// `sposition`: opening, 0.01 in (SPECNOTES.md, contradiction 27).
    pub position: i32,
    /// `svelocity`: 0.01 in/s; 0 means full speed.
    pub velocity: i32,
    /// `send-effector`; none if any gripper is suitable.
    pub end_effector_id: Option<u8>,
}

/// `status` of Grip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripReport {
    /// No command yet (extension).
    Idle,
    /// The command is executing.
    Executing,
    /// The desired force or position is attained.
    Done,
    /// The gripper waits for both fingers to touch.
    Paused,
    /// The command is unattainable.
    Serror,
}

impl GripReport {
    /// The report as a state variable of E-move.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Done => Lower::Done,
            Self::Executing | Self::Paused => Lower::Executing,
            Self::Serror => Lower::Error,
        }
    }
}

/// Content of a gripper by its sensors, independent of the command (docs/design/ownership.md "Felt"; extension).
///
/// A dormant process keeps the last value, and its header marks the outputs as republished. The value is valid only
/// for the attached gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Felt {
    /// The sensors are not calibrated, implausible, or have not settled; treated as held.
    NotKnown,
    /// The gripper is empty.
    Nothing,
    /// A part, or another object that keeps the fingers apart.
    Something,
}

/// Status from Grip to E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripStatus {
    /// `incr-cmnd#-echo`.
    pub echo: u32,
    /// `status`.
    pub report: GripReport,
    /// Reason of a failure (extension).
    pub reason: Reason,
    /// `initialized-?`.
    pub initialized: bool,
    /// `pos`: opening, 0.01 in.
    pub position: i32,
    /// `l-force`: lb.
    pub left_force: i32,
    /// `r-force`: lb.
    pub right_force: i32,
    /// `vel`: 0.01 in/s.
    pub velocity: i32,
    /// `finger-hgt`: 0.01 in.
    pub finger_height: i32,
    /// Content of the gripper by strain gages and potentiometer (extension).
    pub felt: Felt,
    /// `grip`: command bits to the air valves.
    pub valves: u8,
}

/// A linear sensor: `value = (counts - zero) * gain`.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Scale {
    /// Counts at value 0.
    pub zero: f64,
    /// Inches or pounds per count.
    pub gain: f64,
}

/// Scale and offset of each sensor (VI.3.1 UP-INIT).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Calibration {
    /// Potentiometer: inches.
    pub potentiometer: Scale,
    /// Left strain gage: pounds.
    pub left: Scale,
    /// Right strain gage: pounds.
    pub right: Scale,
}

/// Output buffers of Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To E-move.
    pub status: GripStatus,
    /// Result of UP-INIT. A restarted process adopts it if the sensors agree (extension).
    pub calibration: Option<Calibration>,
    /// To the valves.
    pub valves: GripValves,
}

/// `CLOSE-GRIP (opening 1.20 in, force 30 lb)`, `POSITION (opening 1.20 in)`: the verb with its fields.
impl fmt::Display for GripCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.command {
            verb @ (GripVerb::None | GripVerb::Pause | GripVerb::UpInit) => verb.fmt(f),
            verb @ (GripVerb::Position | GripVerb::OpenGrip) => {
                write!(f, "{verb} (opening {})", Inches(self.position))
            }
            verb @ GripVerb::CloseGrip => {
                write!(f, "{verb} (opening {}, force {} lb)", Inches(self.position), self.force)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jaws::{JawsCommand, JawsVerb};

    #[test]
    fn command_text_has_only_the_fields_of_its_verb() {
        let full = GripCommand { force: 30, position: 120, ..GripCommand::default() };
        for (command, text) in [
            (GripVerb::Pause, "PAUSE"),
            (GripVerb::UpInit, "UP-INIT"),
            (GripVerb::OpenGrip, "OPEN-GRIP (opening 1.20 in)"),
            (GripVerb::CloseGrip, "CLOSE-GRIP (opening 1.20 in, force 30 lb)"),
        ] {
            assert_eq!(GripCommand { command, ..full }.to_string(), text);
        }
        let full = JawsCommand { size: 120, ..JawsCommand::default() };
        for (command, text) in [(JawsVerb::Pause, "VG-PAUSE"), (JawsVerb::Pose, "VGRIP-POSE (size 1.20 in)")]
        {
            assert_eq!(JawsCommand { command, ..full }.to_string(), text);
        }
        assert_eq!(JawsCommand { command: JawsVerb::Release, size: 0, ..full }.to_string(), "VG-RELEASE");
    }
}
