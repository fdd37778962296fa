//! Actions of a job other than commands: of the workstation, and of an operator at the joystick box.

use rcs_core::name::Name16;

use crate::files::Location;

/// Opening of a vise (VIII.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViseOpening {
    /// Wide enough to insert a blank, narrow enough to keep it upright.
    Partial,
    /// Closed on the part.
    Close,
    /// Wide enough to remove the part, or to let it drop onto the ledge.
    Open,
}

/// Position of a part in its sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    /// Distance from the centre of the sector along world X, 0.01 in.
    pub x: i32,
    /// Distance from the centre of the sector along world Y, 0.01 in.
    pub y: i32,
    /// Angle about world Z, 0.01 degree.
    pub angle: i32,
}

/// Actions of the tool drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drum {
    /// Its fingers close.
    Grip,
    /// Its fingers open.
    Release,
    /// A tool is put into it.
    Tool(Name16),
}

/// The coordinate switches of the joystick box (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JoystickFrame {
    /// Translations in world coordinates.
    World,
    /// Translations in tool coordinates.
    Tool,
    /// Pitch and yaw about the tool point.
    ToolOrigin,
    /// Pitch and yaw about the wrist point.
    WristOrigin,
    /// No switch is on: the box is not active.
    Off,
}

/// The push-buttons of the joystick box that are held down while the robot moves (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JoystickButton {
    /// Along +Z.
    Up,
    /// Along -Z.
    Down,
    /// Positive roll about the tool's X.
    RollPlus,
    /// Negative roll.
    RollMinus,
    /// Open the gripper.
    Open,
    /// Close the gripper.
    Close,
}

/// The processes that the joystick box can suspend (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Actions at the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joystick {
    /// Set the coordinate switches.
    Frame(JoystickFrame),
    /// Deflect the stick, then release it; 0 0 releases it at once.
    Stick {
        /// Deflection in X, -1000 to 1000.
        x: i16,
        /// Deflection in Y, -1000 to 1000.
        y: i16,
        /// Duration, ticks.
        ticks: u32,
    },
    /// Hold a button down.
    Press {
        /// The button.
        button: JoystickButton,
        /// Duration, ticks.
        ticks: u32,
    },
    /// Turn the velocity knob: 0 to 1000.
    Velocity(u16),
    /// Press the record button.
    Record,
    /// Enter the carriage return after a recorded pose.
    Resume,
    /// Suspend a process.
    Hold(Stepped),
    /// Let a suspended process continue.
    Free(Stepped),
    /// Step a suspended process.
    Step {
        /// The process.
        process: Stepped,
        /// Number of steps.
        count: u32,
    },
}

/// The emergency stops (III.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EStop {
    /// On the front panel of the robot controller.
    ControlPanel,
    /// On its teach pendant.
    TeachPendant,
    /// Near the terminals.
    Terminals,
    /// On the joystick box.
    JoystickBox,
    /// Near the Active Pedestal.
    Pedestal,
}

/// Actions at the panel, the keyboard and the pendant of the robot controller (IV.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// Control power on or off.
    Power(bool),
    /// FAULT RESET.
    FaultReset,
    /// The HYDRAULICS keyswitch: enable or disable.
    Hydraulics(bool),
    /// MANUAL on or off.
    Manual(bool),
    /// Align all axes to their arrows, or only the given axis, 1 to 6.
    Align(Option<u8>),
    /// AUTO.
    Auto,
    /// CYCLE START.
    CycleStart,
    /// INTERRUPT.
    Interrupt,
    /// The CANCEL key.
    Cancel,
    /// The ENTER key.
    Enter,
    /// Hold on or off.
    Hold(bool),
}

/// Actions at the panel of the rotary table's controller (IV.1 step 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TablePanel {
    /// Switch the power on or off.
    Power(bool),
    /// Set the mode switch to MANUAL (true) or to PROG.
    Manual(bool),
    /// Hold RUN+ or RUN- down.
    Run {
        /// True: toward the + limit.
        plus: bool,
        /// Duration, ticks.
        ticks: u32,
    },
    /// Press STEP+ or STEP-.
    Step {
        /// True: toward the + limit.
        plus: bool,
        /// Number of steps.
        count: u32,
    },
    /// RESET.
    Reset,
}

/// Actions at the resolver electronics (IV.3.3 step 11).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResolverPanel {
    /// Set the MANUAL/AUTO switch to MANUAL (true) or to AUTO.
    Manual(bool),
    /// Set the address switches to a joint, 0 to 5, and press its button.
    Joint(u8),
}

/// An action other than a command to the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Workstation {
    /// A part is delivered into a sector of a tray.
    Tray {
        /// The sector, resolved for the part.
        location: Location,
        /// The part.
        object: Name16,
        /// Position in the sector; `None`: random, from the seed of the run.
        offset: Option<Offset>,
    },
    /// A vise moves its jaws.
    Vise {
        /// Opening of the jaws.
        opening: ViseOpening,
        /// The vise.
        location: Location,
        /// Program of the vise from now on; `None` keeps the last one.
        program: Option<Name16>,
    },
    /// A part is machined in a vise or a nest.
    Machine {
        /// The blank.
        blank: Name16,
        /// The machined part.
        part: Name16,
        /// The vise or the nest.
        location: Location,
    },
    /// An action of the tool drum.
    Drum(Drum),
    /// An action at the joystick box.
    Joystick(Joystick),
    /// An emergency stop is pressed.
    Press(EStop),
    /// An emergency stop is pulled out again.
    Release(EStop),
    /// An action at the robot controller's panel.
    Panel(Panel),
    /// An action at the panel of the rotary table's controller.
    Table(TablePanel),
    /// An action at the resolver electronics.
    Resolvers(ResolverPanel),
    /// Blocks are loaded into the running system.
    Load {
        /// Number of the reload in the job, from 1.
        number: u32,
    },
    /// Wait.
    Wait {
        /// Duration, ticks.
        ticks: u32,
    },
    /// Hand the command over to the workstation controller until it disconnects (IV.4.1).
    HandOver,
}
