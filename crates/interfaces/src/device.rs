//! Device words: the words that the boards read from and write to the hardware each tick (chapter III, VI.1 to VI.3).
//!
//! Raw words only: counts, bits and bytes. The process that owns the device scales them.

use rcs_core::{Plain, name::Name10};

pub use super::vision::{Picture, VisionRequest, VisionResponse, VisionStatus};
pub use depc::link::{LINK_BYTES, LinkBytes};

/// Steps of a resolver turn: 17 bits (III.3.2).
pub const RESOLVER_COUNTS: u32 = 1 << 17;

/// The joint resolvers (III.3.2): 17-bit integers, joints 0 to 5 from the base; one turn a joint, count 0 at
/// angle 0 (ASSUMED).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Resolvers {
    /// Counts, 0 to 131071.
    pub counts: [u32; 6],
    /// The resolver box has power.
    pub valid: bool,
}

/// Air valves of the parts gripper: bits of [`GripValves::bits`] (III.3.6: eight valves; the assignment is
/// ASSUMED).
///
/// Opening speed with the supply on is the sum of the open flows less the sum of the close flows. With all
/// flows off the trapped air holds fingers and force.
pub mod valve {
    /// Open, fine: 0.25 in/s.
    pub const OPEN_FINE: u8 = 0x01;
    /// Open, medium: 1 in/s.
    pub const OPEN_MEDIUM: u8 = 0x02;
    /// Open, coarse: 4 in/s.
    pub const OPEN_COARSE: u8 = 0x04;
    /// Close, fine: 0.25 in/s.
    pub const CLOSE_FINE: u8 = 0x08;
    /// Close, medium: 1 in/s.
    pub const CLOSE_MEDIUM: u8 = 0x10;
    /// Close, coarse: 4 in/s.
    pub const CLOSE_COARSE: u8 = 0x20;
    /// Vent both sides: no force, fingers loose.
    pub const VENT: u8 = 0x40;
    /// Air supply on; without it no flow.
    pub const SUPPLY: u8 = 0x80;
}

/// Command bits to the eight air valves of the parts gripper (VI.3.2 `grip`); see [`valve`].
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripValves {
    /// One bit a valve.
    pub bits: u8,
}

/// Counts of a 12-bit converter at full scale.
pub const ADC_FULL_SCALE: u16 = 4095;

/// Sensors of the attached gripper (III.3.6 to III.3.8): 12-bit converters and beam breaks.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripSensors {
    /// Finger potentiometer, 0 to 4095 counts; grows with the opening; UP-INIT finds offset and scale of the
    /// parts gripper's.
    pub potentiometer: u16,
    /// Strain gage of the left finger, counts; grows with the force that closes on a part.
    pub strain_left: u16,
    /// Strain gage of the right finger, counts.
    pub strain_right: u16,
    /// Eight beam breaks between the fingers, one bit each, 1 is broken.
    pub beams: u8,
}

/// Sensors of the quick change (VI.2): two reflectance sensors on the locking ring, and the id pins.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct QuickChangeSensors {
    /// The ring is seen in the locked position.
    pub locked: bool,
    /// The ring is seen in the unlocked position.
    pub unlocked: bool,
    /// What the id pins read, `endeff-id#`: 0 where none is mated, 1 parts, 2 v, 3 tool, else a bad contact.
    pub end_effector_id: u8,
}

/// Valves of the quick change (VI.2.1).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct QuickChangeValves {
    /// Air to the lock side of the ring.
    pub lock: bool,
    /// Air to the unlock side of the ring.
    pub unlock: bool,
    /// The control port is enabled; with it disabled the ring cannot move.
    pub port: bool,
}

/// Holster proximity sensors (V.1.2): right, left, centre. Bits 0, 1: large rear sensors see the ears; bits
/// 2, 3: small front sensors see the ears at the seat.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct HolsterSensors {
    /// `hol-R-status`.
    pub right: u8,
    /// `hol-L-status`.
    pub left: u8,
    /// `hol-C-status`.
    pub centre: u8,
}

/// Air to a gripper that only opens and closes: v-gripper and tool gripper (VI.4, VI.5). With neither bit the
/// air is trapped.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JawValves {
    /// Air to the side that opens.
    pub open: bool,
    /// Air to the side that closes.
    pub close: bool,
}

/// Counts of a force axis without load (ASSUMED: middle of the converter's range).
pub const FORCE_ZERO: i32 = 2048;
/// Counts for a pound of force (ASSUMED).
pub const FORCE_COUNTS_PER_LB: i32 = 16;
/// Counts for an inch pound of moment (ASSUMED).
pub const MOMENT_COUNTS_PER_IN_LB: i32 = 4;

/// Force sensor of the tool gripper, the four axes that are connected (III.3.8), in the axes of the sensor:
/// 12-bit converters, [`FORCE_ZERO`] without load. Tool X, Y, Z are sensor Z, -Y, X. 0 and [`ADC_FULL_SCALE`]
/// mean overload.
///
/// Positive is what pushes the fingers along the positive sensor axis.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ForceSensor {
    /// Force along sensor X.
    pub x: u16,
    /// Force along sensor Y.
    pub y: u16,
    /// Force along sensor Z.
    pub z: u16,
    /// Moment about the tool's Y, right-hand.
    pub moment: u16,
    /// The sensor is connected and its conditioners have power.
    pub valid: bool,
}

/// Full speed of the velocity knob, and full deflection of the joystick.
pub const KNOB_FULL: u16 = 1000;

/// Bits of [`JoystickBox::frame`]: the four coordinate switches.
pub mod joystick_frame {
    /// Switch f: translations in world coordinates.
    pub const WORLD: u8 = 0x01;
    /// Switch h: translations in tool coordinates.
    pub const TOOL: u8 = 0x02;
    /// Switch j: pitch and yaw about the tool point.
    pub const TOOL_ORIGIN: u8 = 0x04;
    /// Switch k: pitch and yaw about the wrist point.
    pub const WRIST_ORIGIN: u8 = 0x08;
}

/// Bits of [`JoystickBox::hold`] and [`JoystickBox::single_step`], in the order of the box.
pub mod single_step {
    /// Switch N, button T.
    pub const TASK: u8 = 0x01;
    /// Switch P, button U.
    pub const SUBTASK: u8 = 0x02;
    /// Switch R, button V.
    pub const EMOVE: u8 = 0x04;
    /// Switch S, button W.
    pub const PRIM: u8 = 0x08;
}

/// The joystick box (III.3.3). Its emergency stop is in the T3's circuit and does not come to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JoystickBox {
    /// Potentiometer C, the velocity knob, 0 to [`KNOB_FULL`]: whatever commands the motion.
    pub velocity: u16,
    /// Stick L: X, or pitch; -1000 to 1000.
    pub x: i16,
    /// Stick M: Y, or yaw; -1000 to 1000.
    pub y: i16,
    /// Push-button D: along +Z.
    pub up: bool,
    /// Push-button E: along -Z.
    pub down: bool,
    /// Push-button Z: positive roll about the tool's X.
    pub roll_plus: bool,
    /// Push-button a: negative roll.
    pub roll_minus: bool,
    /// Push-button F: open the gripper.
    pub open: bool,
    /// Push-button H: close it.
    pub close: bool,
    /// Coordinate switches, bits of [`joystick_frame`]; one at most may be on. The box is active while one
    /// is.
    pub frame: u8,
    /// Push-button X: record the pose.
    pub record: bool,
    /// Carriage return at the terminal of the Prim board: go on after a recorded pose.
    pub resume: bool,
    /// Switches N, P, R, S: processes that are suspended, bits of [`single_step`].
    pub hold: u8,
    /// Push-buttons T, U, V, W: step a suspended process once, bits of [`single_step`].
    pub single_step: u8,
}

/// Hand and rotary table of the Active Pedestal (III.9, III.10).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PedestalSensors {
    /// Finger potentiometer, counts.
    pub potentiometer: u16,
    /// Strain gage of the left finger, counts.
    pub strain_left: u16,
    /// Strain gage of the right finger, counts.
    pub strain_right: u16,
    /// Potentiometer in the base of the table, counts: grows with the angle.
    pub table_potentiometer: u16,
    /// The table is at its + limit.
    pub limit_plus: bool,
    /// The table is at its - limit.
    pub limit_minus: bool,
    /// Number of the last order that the rotary table controller has taken.
    pub motor_echo: u32,
    /// Its motor turns.
    pub motor_moving: bool,
    /// Its step counter: steps from where it was set to a value.
    pub motor_counter: i32,
}

/// Steps of the rotary table's motor for a tenth of a degree (ASSUMED).
pub const TABLE_STEPS_PER_TENTH: i32 = 10;

/// What the rotary table controller is told over its serial link (III.10; the words are ASSUMED).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum MotorOrder {
    /// Nothing.
    #[text = ""]
    None,
    /// Turn by a number of steps; a limit switch stops it.
    Turn,
    /// Give the step counter a value.
    SetCounter,
    /// Stop.
    Stop,
}

/// Order to the rotary table controller.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct MotorCommand {
    /// Changes with each order; 0 means none.
    pub number: u32,
    /// What to do.
    pub order: MotorOrder,
    /// Steps to turn, or value of the counter.
    pub steps: i32,
}

/// How the controller is connected with devices behind field I/O, from best to worst (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Plain)]
pub enum Connection {
    /// Their words are new, or they are not behind field I/O.
    Fresh,
    /// Their words are new. Their outputs are safe until an operator releases them.
    Tripped,
    /// Their words are old, and keep their values.
    Stale,
    /// Their words are older than a second.
    Lost,
}

impl Connection {
    /// The words are older than they may be.
    #[must_use]
    pub const fn is_old(self) -> bool {
        matches!(self, Self::Stale | Self::Lost)
    }
}

/// How old the words of the devices are, by groups (extension, docs/design/field.md "Stale").
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct FieldHealth {
    /// Parts gripper, and the potentiometer of all grippers.
    pub grip: Connection,
    /// Quick change.
    pub quick_change: Connection,
    /// Holsters.
    pub holsters: Connection,
    /// Force sensor.
    pub force: Connection,
    /// Hand of the pedestal.
    pub hand: Connection,
    /// Rotary table.
    pub table: Connection,
    /// Joystick box.
    pub joystick: Connection,
    /// Resolvers.
    pub resolvers: Connection,
    /// The worst of all devices.
    pub any: Connection,
}

/// Everything that the controller reads from its devices in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DeviceInputs {
    /// From the DEPC line.
    pub link_rx: LinkBytes,
    /// The line's clear-to-send (the robot's DTR, A.2).
    pub link_ready: bool,
    /// The port has not taken all bytes of the last tick: they are not on the line.
    pub link_unsent: bool,
    /// Ticks that the host waits for an answer while the robot's DTR is on; the 60 s of `depc::host` if
    /// nothing is set (`--robot`).
    pub link_patience: Option<u16>,
    /// Time by which the robot is expected to lag behind the positions sent, ms; 200 ms if nothing is set
    /// (`--robot`, docs/design/link.md "Following").
    pub robot_lag: Option<u16>,
    /// Joint resolvers.
    pub resolvers: Resolvers,
    /// The attached gripper. All three have their potentiometer on the same connections (III.3.7, III.3.8);
    /// strain gages and beam breaks are the parts gripper's, zeros with another one.
    pub grip: GripSensors,
    /// Force sensor of the tool gripper; invalid with another one.
    pub force: ForceSensor,
    /// Quick change.
    pub quick_change: QuickChangeSensors,
    /// Holsters.
    pub holsters: HolsterSensors,
    /// Joystick box.
    pub joystick: JoystickBox,
    /// Vision system.
    pub vision: VisionResponse,
    /// Active Pedestal.
    pub pedestal: PedestalSensors,
    /// Location of the vise whose jaws have closed on a part, as the vise reports it (extension); none if it reports
    /// nothing.
    pub clamping: Option<Name10>,
    /// Age of the words from devices behind field I/O.
    pub field: FieldHealth,
}

/// Everything that the controller writes to its devices in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DeviceOutputs {
    /// To the DEPC line.
    pub link_tx: LinkBytes,
    /// The robot is to stop by its own means, and to stay where it is: T3I has found it off its path. The T3 has no
    /// such input; a robot with EGM and one of the caller of the library have (extension).
    pub robot_stop: bool,
    /// Parts gripper.
    pub grip: GripValves,
    /// Quick change.
    pub quick_change: QuickChangeValves,
    /// Vision system.
    pub vision: VisionRequest,
    /// v-gripper.
    pub v_grip: JawValves,
    /// Tool gripper.
    pub tool_grip: JawValves,
    /// LEDs b, c, d, e of the joystick box, bits of [`joystick_frame`].
    pub joystick_leds: u8,
    /// Fingers of the pedestal's hand: eight valves as those of the parts gripper (III.9.2).
    pub pedestal_hand: GripValves,
    /// Rotary table of the pedestal.
    pub pedestal_table: MotorCommand,
}
