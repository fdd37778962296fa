//! The operator's words for keys, switches and emergency stops of the station.
//!
//! Jobs, operator requests and completion read the same words ([`following`]). All words are extensions. The manual
//! describes the controls (III.3.3, III.6, IV.1, IV.3.3) but has no lines for them.

mod action;

use rcs_core::{Plain, plain::EnumSchema};

pub use action::{BoxAction, Key, ResolverKey, TableKey};

use crate::{
    device::{joystick_frame, single_step},
    processes::ProcessId,
};

/// The first word of a station line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LineVerb {
    /// A part is delivered into a sector of a tray.
    Tray,
    /// The jaws of a vise move.
    Vise,
    /// A blank becomes a part.
    Machine,
    /// An action at the tool drum.
    Drum,
    /// An action at the joystick box.
    Joystick,
    /// An emergency stop is pressed.
    #[text = "estop"]
    EStop,
    /// An emergency stop is pulled out.
    Release,
    /// An action at the panel of the robot controller.
    Panel,
    /// An action at the panel of the rotary table's controller.
    Table,
    /// An action at the resolver electronics.
    Resolvers,
    /// The job waits.
    Wait,
    /// Blocks are loaded.
    Load,
    /// Another line is executed some ticks after the next command.
    After,
    /// The job passes the command to the workstation controller.
    #[text = "workstation"]
    HandOver,
}

impl LineVerb {
    /// True if the line uses the job's ticks, files or next command.
    #[must_use]
    pub const fn is_of_job(self) -> bool {
        matches!(self, Self::Wait | Self::Load | Self::After | Self::HandOver)
    }
}

/// Opening of a vise (VIII.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ViseOpening {
    /// Wide enough to insert a blank, narrow enough to keep it upright.
    Partial,
    /// Closed on the part.
    Close,
    /// Wide enough to remove the part, or to let it drop onto the ledge.
    Open,
}

/// Actions of the tool drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum DrumVerb {
    /// The drum's fingers close.
    Grip,
    /// The drum's fingers open.
    Release,
    /// A tool is put into the drum.
    Tool,
}

/// The emergency stops (III.6): one circuit with five buttons. A pressed button stays in until it is pulled out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EStop {
    /// On the front panel of the robot controller.
    ControlPanel,
    /// On the teach pendant.
    TeachPendant,
    /// Near the terminals of RCS-II/T3.
    Terminals,
    /// On the joystick box.
    JoystickBox,
    /// Near the Active Pedestal.
    Pedestal,
}

impl EStop {
    /// Its place as a clause: *on the control panel*.
    #[must_use]
    pub const fn place(self) -> &'static str {
        match self {
            Self::ControlPanel => "on the control panel",
            Self::TeachPendant => "on the teach pendant",
            Self::Terminals => "near the terminals",
            Self::JoystickBox => "on the joystick box",
            Self::Pedestal => "near the pedestal",
        }
    }
}

/// The controls of the joystick box except [`BoxButton`] (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum BoxControl {
    /// The coordinate switches.
    Frame,
    /// The stick.
    Stick,
    /// The velocity knob.
    Velocity,
    /// Switch on the suspension of a process.
    Hold,
    /// Switch off the suspension of a process.
    Free,
    /// A single-step button.
    Step,
    /// The record button.
    Record,
    /// The carriage return after a recorded pose.
    Resume,
}

/// The push-buttons of the joystick box that an operator holds down to move the robot (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum BoxButton {
    /// D: along +Z.
    Up,
    /// E: along -Z.
    Down,
    /// Z: positive roll about the tool's X.
    #[text = "roll+"]
    RollPlus,
    /// a: negative roll.
    #[text = "roll-"]
    RollMinus,
    /// F: open the gripper.
    Open,
    /// H: close the gripper.
    Close,
}

/// The coordinate switches of the joystick box (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum BoxFrame {
    /// Translations in world coordinates.
    World,
    /// Translations in tool coordinates.
    Tool,
    /// Pitch and yaw about the tool point.
    ToolOrigin,
    /// Pitch and yaw about the wrist point.
    WristOrigin,
    /// All switches are off: the box is not active.
    Off,
}

impl BoxFrame {
    /// Its bits of [`joystick_frame`].
    #[must_use]
    pub const fn bits(self) -> u8 {
        match self {
            Self::World => joystick_frame::WORLD,
            Self::Tool => joystick_frame::TOOL,
            Self::ToolOrigin => joystick_frame::TOOL_ORIGIN,
            Self::WristOrigin => joystick_frame::WRIST_ORIGIN,
            Self::Off => 0,
        }
    }

    /// The switch that is on; `None` if several are.
    #[must_use]
    pub fn from_bits(bits: u8) -> Option<Self> {
        Self::ALL.iter().copied().find(|frame| frame.bits() == bits)
    }
}

/// The processes that the joystick box can suspend (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum Stepped {
    /// Task.
    Task,
    /// Subtask.
    Subtask,
    /// E-move.
    Emove,
    /// Prim.
    Prim,
}

impl Stepped {
    /// The process.
    #[must_use]
    pub const fn process(self) -> ProcessId {
        match self {
            Self::Task => ProcessId::Task,
            Self::Subtask => ProcessId::Subtask,
            Self::Emove => ProcessId::Emove,
            Self::Prim => ProcessId::Prim,
        }
    }

    /// Its bit of [`single_step`].
    #[must_use]
    pub const fn bit(self) -> u8 {
        match self {
            Self::Task => single_step::TASK,
            Self::Subtask => single_step::SUBTASK,
            Self::Emove => single_step::EMOVE,
            Self::Prim => single_step::PRIM,
        }
    }
}

/// Keys and switches at the panel, the keyboard and the pendant of the robot controller (IV.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PanelControl {
    /// The power switch.
    Power,
    /// FAULT RESET.
    FaultReset,
    /// The HYDRAULICS keyswitch.
    Hydraulics,
    /// MANUAL ON/OFF.
    Manual,
    /// Align all axes, or one, to their arrows.
    Align,
    /// AUTO.
    Auto,
    /// CYCLE START.
    CycleStart,
    /// INTERRUPT.
    Interrupt,
    /// CANCEL.
    Cancel,
    /// ENTER.
    Enter,
    /// Hold.
    Hold,
}

/// Keys and switches at the panel of the rotary table's controller (IV.1 step 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableControl {
    /// The power switch.
    Power,
    /// The mode switch.
    Mode,
    /// RUN+.
    #[text = "run+"]
    RunPlus,
    /// RUN-.
    #[text = "run-"]
    RunMinus,
    /// STEP+.
    #[text = "step+"]
    StepPlus,
    /// STEP-.
    #[text = "step-"]
    StepMinus,
    /// RESET.
    Reset,
}

/// Switch and buttons of the resolver electronics (IV.3.3 step 11).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ResolverControl {
    /// The MANUAL/AUTO switch to MANUAL.
    Manual,
    /// The MANUAL/AUTO switch to AUTO.
    Auto,
    /// The button of a joint.
    Joint,
}

/// Numbers of the joints at the resolver electronics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ResolverJoint {
    /// The base.
    #[text = "0"]
    Base,
    /// The shoulder.
    #[text = "1"]
    Shoulder,
    /// The elbow.
    #[text = "2"]
    Elbow,
    /// The pitch.
    #[text = "3"]
    Pitch,
    /// The yaw.
    #[text = "4"]
    Yaw,
    /// The roll.
    #[text = "5"]
    Roll,
}

/// Positions of a switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Switch {
    /// On.
    On,
    /// Off.
    Off,
}

/// Positions of the keyswitch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Keyswitch {
    /// The hydraulics may start.
    Enable,
    /// The hydraulics may not start.
    Disable,
}

/// Positions of the mode switch of the rotary table's controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableMode {
    /// The keys are effective.
    Manual,
    /// The serial line is effective.
    Prog,
}

/// The words that can follow the first words of a line; `None` if a name, a number or nothing follows.
#[must_use]
pub fn following(words: &[&str]) -> Option<&'static [&'static EnumSchema]> {
    let [verb, rest @ ..] = words else { return Some(&[LineVerb::ENUM]) };
    let control = match rest {
        [] => None,
        [control] => Some(*control),
        _ => return None,
    };
    match (LineVerb::from_text(verb)?, control) {
        (LineVerb::Vise, None) => Some(&[ViseOpening::ENUM]),
        (LineVerb::Drum, None) => Some(&[DrumVerb::ENUM]),
        (LineVerb::EStop | LineVerb::Release, None) => Some(&[EStop::ENUM]),
        (LineVerb::Joystick, None) => Some(&[BoxControl::ENUM, BoxButton::ENUM]),
        (LineVerb::Joystick, Some(control)) => match BoxControl::from_text(control)? {
            BoxControl::Frame => Some(&[BoxFrame::ENUM]),
            BoxControl::Hold | BoxControl::Free | BoxControl::Step => Some(&[Stepped::ENUM]),
            BoxControl::Stick | BoxControl::Velocity | BoxControl::Record | BoxControl::Resume => None,
        },
        (LineVerb::Panel, None) => Some(&[PanelControl::ENUM]),
        (LineVerb::Panel, Some(control)) => match PanelControl::from_text(control)? {
            PanelControl::Power | PanelControl::Manual | PanelControl::Hold => Some(&[Switch::ENUM]),
            PanelControl::Hydraulics => Some(&[Keyswitch::ENUM]),
            _ => None,
        },
        (LineVerb::Table, None) => Some(&[TableControl::ENUM]),
        (LineVerb::Table, Some(control)) => match TableControl::from_text(control)? {
            TableControl::Power => Some(&[Switch::ENUM]),
            TableControl::Mode => Some(&[TableMode::ENUM]),
            _ => None,
        },
        (LineVerb::Resolvers, None) => Some(&[ResolverControl::ENUM]),
        (LineVerb::Resolvers, Some(control)) => {
            let joint = ResolverControl::from_text(control)? == ResolverControl::Joint;
            joint.then_some(&[ResolverJoint::ENUM])
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grammar_leads_from_each_control_to_its_positions() {
        let words = |line: &str| -> Vec<&str> {
            let words: Vec<&str> = line.split_whitespace().collect();
            let lists = following(&words).unwrap_or_default();
            lists.iter().flat_map(|list| list.variants).map(|variant| variant.text).collect()
        };
        for (line, expected) in [
            ("panel hydraulics", "enable disable"),
            ("panel hold", "on off"),
            ("panel auto", ""),
            ("table mode", "manual prog"),
            ("release", "control-panel teach-pendant terminals joystick-box pedestal"),
            ("joystick frame", "WORLD TOOL TOOL-ORIGIN WRIST-ORIGIN OFF"),
            ("joystick step", "TASK SUBTASK EMOVE PRIM"),
            ("joystick step PRIM", ""),
            ("joystick up", ""),
            ("resolvers joint", "0 1 2 3 4 5"),
            ("nonsense", ""),
        ] {
            assert_eq!(words(line).join(" "), expected, "{line}");
        }
        assert_eq!(words("joystick").len(), BoxControl::ALL.len() + BoxButton::ALL.len());
    }

    #[test]
    fn switches_have_one_bit_each() {
        let frames: Vec<u8> = BoxFrame::ALL.iter().map(|frame| frame.bits()).collect();
        assert_eq!(frames, [1, 2, 4, 8, 0]);
        assert_eq!(BoxFrame::from_bits(4), Some(BoxFrame::ToolOrigin));
        assert_eq!(BoxFrame::from_bits(5), None);
        let processes: Vec<u8> = Stepped::ALL.iter().map(|process| process.bit()).collect();
        assert_eq!(processes, [1, 2, 4, 8]);
    }
}
