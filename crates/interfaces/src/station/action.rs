//! Actions at keys, switches and emergency stops.

use core::fmt;

use super::{BoxButton, EStop, Keyswitch, Switch};

/// An action at the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxAction {
    /// Set the coordinate switches: bits of [`joystick_frame`](crate::device::joystick_frame). 0 also releases stick
    /// and buttons.
    Frame(u8),
    /// Deflect the stick, -1000 to 1000, for a number of ticks; replaces the present deflection. 0 0 releases it.
    Stick {
        /// Along X, or pitch.
        x: i16,
        /// Along Y, or yaw.
        y: i16,
        /// Duration, ticks.
        ticks: u32,
    },
    /// Hold a button down for a number of ticks from now.
    Press(BoxButton, u32),
    /// Turn the velocity knob: 0 to 1000.
    Velocity(u16),
    /// Press the record button.
    Record,
    /// Press the carriage return.
    Resume,
    /// Set the switches that suspend processes: bits of [`single_step`](crate::device::single_step).
    Hold(u8),
    /// Reset the switches that suspend processes: the same bits.
    Free(u8),
    /// Press the single-step buttons of these bits a number of times.
    Step(u8, u32),
}

/// An action at the console, keyboard or teach pendant of the robot controller, or at the emergency stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Turn control power on or off (IV.3.3 step 4).
    ControlPower(bool),
    /// FAULT RESET (step 5).
    FaultReset,
    /// HYDRAULICS keyswitch (step 7).
    Hydraulics(bool),
    /// MANUAL ON/OFF (step 8).
    Manual(bool),
    /// Teach pendant: move an axis, counted from 1, to its arrow (step 9); `None` moves all of them.
    Align(Option<u8>),
    /// Teach pendant: turn an axis, counted from 1, by some degrees (IV.3.4).
    Jog {
        /// The axis.
        axis: u8,
        /// The degrees.
        degrees: i8,
    },
    /// AUTO (step 10).
    Auto,
    /// CYCLE START (step 12).
    CycleStart,
    /// INTERRUPT (step 12, A 2.3).
    Interrupt,
    /// CANCEL on the keyboard (step 12, A 2.4).
    Cancel,
    /// ENTER on the keyboard (A 2.4).
    Enter,
    /// Turn hold on or off (A 2.3).
    Hold(bool),
    /// Press an E-stop (III.6).
    Press(EStop),
    /// Pull an E-stop out.
    Release(EStop),
    /// Insert or remove the RS232 board (A 2.3, D0).
    Board(bool),
    /// Repair or break the transmitter of the RS232 board (A 2.3, D5).
    Transmitter(bool),
    /// Power of the Prim Interface Box on or off (IV.1 steps 2 and 5).
    PrimBox(bool),
}

impl fmt::Display for Key {
    /// The action in the terms of the controller's console.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let switch = |on| if on { Switch::On } else { Switch::Off };
        match *self {
            Self::ControlPower(to) => write!(f, "control power {}", switch(to)),
            Self::FaultReset => f.write_str("fault reset"),
            Self::Hydraulics(true) => write!(f, "hydraulics {}", Keyswitch::Enable),
            Self::Hydraulics(false) => write!(f, "hydraulics {}", Keyswitch::Disable),
            Self::Manual(to) => write!(f, "manual {}", switch(to)),
            Self::Align(None) => f.write_str("align"),
            Self::Align(Some(axis)) => write!(f, "align {axis}"),
            Self::Jog { axis, degrees } => write!(f, "jog {axis} {degrees}"),
            Self::Auto => f.write_str("auto"),
            Self::CycleStart => f.write_str("cycle start"),
            Self::Interrupt => f.write_str("interrupt"),
            Self::Cancel => f.write_str("cancel"),
            Self::Enter => f.write_str("enter"),
            Self::Hold(to) => write!(f, "hold {}", switch(to)),
            Self::Press(site) => write!(f, "estop {site}"),
            Self::Release(site) => write!(f, "release {site}"),
            Self::Board(to) => write!(f, "board {}", if to { "in" } else { "out" }),
            Self::PrimBox(to) => write!(f, "prim box {}", switch(to)),
            Self::Transmitter(to) => write!(f, "transmitter {}", if to { "good" } else { "broken" }),
        }
    }
}

/// An action at the panel of the rotary table's controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKey {
    /// Switch the power on or off.
    Power(bool),
    /// Set the mode switch to MANUAL (true) or to PROG.
    Manual(bool),
    /// Hold RUN+ or RUN- down for a number of ticks.
    Run {
        /// Toward the + limit.
        plus: bool,
        /// Duration, ticks.
        ticks: u32,
    },
    /// Press STEP+ or STEP- a number of times: the motor takes one step each time (ASSUMED).
    Step {
        /// Toward the + limit.
        plus: bool,
        /// Number of presses.
        count: u32,
    },
    /// RESET: set the counter to zero here.
    Reset,
}

/// An action at the resolver electronics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResolverKey {
    /// Set the MANUAL/AUTO switch to MANUAL (true) or to AUTO.
    Manual(bool),
    /// Set the address switches to a joint, 0 for the base to 5 for the roll, and press its button.
    Joint(u8),
}
