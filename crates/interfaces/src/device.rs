//! Device words: the words that the boards read from and write to the hardware each tick (chapter III, VI.1 to VI.3).
//!
//! Raw words only: counts, bits and bytes. The process that owns the device scales them.

use rcs_core::{Plain, name::Name10};

pub use super::vision::{Picture, VisionRequest, VisionResponse, VisionStatus};
pub use depc::link::{LINK_BYTES, LinkBytes};

/// Resolver counts per turn: 17 bits (III.3.2).
pub const RESOLVER_COUNTS: u32 = 1 << 17;

/// The joint resolvers (III.3.2): 17-bit integers, joints 0 to 5 from the base; one turn per joint, count 0 at angle
/// 0 (ASSUMED).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Resolvers {
    /// Counts, 0 to 131071.
    pub counts: [u32; 6],
    /// The resolver box has power.
    pub valid: bool,
}

/// Air valves of the parts gripper: bits of [`GripValves::bits`] (III.3.6: eight valves; the assignment is ASSUMED).
///
/// With the supply on, the opening speed is the sum of the open flows minus the sum of the close flows. Without flow
/// the trapped air keeps finger position and force.
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
    /// Air supply; without it there is no flow.
    pub const SUPPLY: u8 = 0x80;
}

/// Command bits to the eight air valves of the parts gripper (VI.3.2 `grip`); see [`valve`].
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripValves {
    /// One bit per valve.
    pub bits: u8,
}

/// Counts of a 12-bit converter at full scale.
pub const ADC_FULL_SCALE: u16 = 4095;

/// Sensors of the attached gripper (III.3.6 to III.3.8): 12-bit converters and beam breaks.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripSensors {
    /// Finger potentiometer, 0 to 4095 counts; increases with the opening. UP-INIT finds offset and scale for the
    /// parts gripper.
    pub potentiometer: u16,
    /// Strain gage of the left finger, counts; increases with the closing force on a part.
    pub strain_left: u16,
    /// Strain gage of the right finger, counts.
    pub strain_right: u16,
    /// Eight beam breaks between the fingers, one bit each, 1 is broken.
    pub beams: u8,
}

/// Sensors of the quick change (VI.2): two reflectance sensors on the locking ring, and the id pins.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct QuickChangeSensors {
    /// A sensor sees the ring in the locked position.
    pub locked: bool,
    /// A sensor sees the ring in the unlocked position.
    pub unlocked: bool,
    /// Reading of the id pins, `endeff-id#`: 0 not mated, 1 parts, 2 v, 3 tool; other values indicate a bad contact.
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

/// Holster proximity sensors (V.1.2): right, left, centre. Bits 0 and 1: the large rear sensors detect the ears. Bits
/// 2 and 3: the small front sensors detect the ears at the seat.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct HolsterSensors {
    /// `hol-R-status`.
    pub right: u8,
    /// `hol-L-status`.
    pub left: u8,
    /// `hol-C-status`.
    pub centre: u8,
}

/// Air to a gripper that only opens and closes: v-gripper and tool gripper (VI.4, VI.5). With neither bit set the air
/// is trapped.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JawValves {
    /// Air to the side that opens.
    pub open: bool,
    /// Air to the side that closes.
    pub close: bool,
}

/// Counts of a force axis without load (ASSUMED: middle of the converter's range).
pub const FORCE_ZERO: i32 = 2048;
/// Counts per pound of force (ASSUMED).
pub const FORCE_COUNTS_PER_LB: i32 = 16;
/// Counts per inch pound of moment (ASSUMED).
pub const MOMENT_COUNTS_PER_IN_LB: i32 = 4;

/// Force sensor of the tool gripper: the four connected axes (III.3.8), in the axes of the sensor. 12-bit converters,
/// [`FORCE_ZERO`] without load; 0 and [`ADC_FULL_SCALE`] mean overload. Tool X, Y, Z are sensor Z, -Y, X.
///
/// A force that pushes the fingers along the positive sensor axis is positive.
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

/// Velocity knob at full speed, and joystick at full deflection.
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

/// The joystick box (III.3.3). Its emergency stop is in the circuit of the T3 and is not wired to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JoystickBox {
    /// Potentiometer C, the velocity knob, 0 to [`KNOB_FULL`]. It applies to every motion.
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
    /// Push-button H: close the gripper.
    pub close: bool,
    /// Coordinate switches, bits of [`joystick_frame`]; at most one may be on. The box is active while one is on.
    pub frame: u8,
    /// Push-button X: record the pose.
    pub record: bool,
    /// Carriage return at the terminal of the Prim board: continue after a recorded pose.
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
    /// Potentiometer in the base of the table, counts; increases with the angle.
    pub table_potentiometer: u16,
    /// The table is at its + limit.
    pub limit_plus: bool,
    /// The table is at its - limit.
    pub limit_minus: bool,
    /// Number of the last order that the rotary table controller has accepted.
    pub motor_echo: u32,
    /// Its motor turns.
    pub motor_moving: bool,
    /// Its step counter: steps since the counter was set.
    pub motor_counter: i32,
}

/// Motor steps of the rotary table per tenth of a degree (ASSUMED).
pub const TABLE_STEPS_PER_TENTH: i32 = 10;

/// Orders to the rotary table controller over its serial link (III.10; the words are ASSUMED).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum MotorOrder {
    /// No order.
    #[text = ""]
    None,
    /// Turn by a number of steps; a limit switch stops the table.
    Turn,
    /// Set the step counter to a value.
    SetCounter,
    /// Stop.
    Stop,
}

/// Order to the rotary table controller.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct MotorCommand {
    /// Changes with each order; 0 means none.
    pub number: u32,
    /// The order.
    pub order: MotorOrder,
    /// Steps to turn, or the new value of the counter.
    pub steps: i32,
}

/// Health of a group of devices behind field I/O, in order from best to worst (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Plain)]
pub enum GroupHealth {
    /// Current words, or no field I/O.
    Fresh,
    /// Current words; the outputs are safe until an operator releases them.
    Tripped,
    /// Old words, held at their last values.
    Stale,
    /// Words older than a second.
    Lost,
}

impl GroupHealth {
    /// True if the words are older than permitted.
    #[must_use]
    pub const fn is_old(self) -> bool {
        matches!(self, Self::Stale | Self::Lost)
    }
}

/// Age of the device words, by group (extension, docs/design/field.md "Stale").
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct FieldHealth {
    /// Parts gripper, and the potentiometer of all grippers.
    pub grip: GroupHealth,
    /// Quick change.
    pub quick_change: GroupHealth,
    /// Holsters.
    pub holsters: GroupHealth,
    /// Force sensor.
    pub force: GroupHealth,
    /// Hand of the pedestal.
    pub hand: GroupHealth,
    /// Rotary table.
    pub table: GroupHealth,
    /// Joystick box.
    pub joystick: GroupHealth,
    /// Resolvers.
    pub resolvers: GroupHealth,
    /// The worst of all devices.
    pub any: GroupHealth,
}

impl FieldHealth {
    /// The groups that are not fresh, by name.
    pub fn late(&self) -> impl Iterator<Item = (&'static str, GroupHealth)> {
        let groups = [
            ("grip", self.grip),
            ("quick-change", self.quick_change),
            ("holsters", self.holsters),
            ("tool", self.force),
            ("pedestal", self.hand),
            ("table", self.table),
            ("joystick", self.joystick),
            ("resolvers", self.resolvers),
        ];
        groups.into_iter().filter(|(_, health)| *health != GroupHealth::Fresh)
    }
}

/// All words that the controller reads from its devices in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DeviceInputs {
    /// Bytes from the DEPC line.
    pub link_rx: LinkBytes,
    /// The line's clear-to-send (the robot's DTR, A.2).
    pub link_ready: bool,
    /// The port has not accepted all bytes of the last tick, so some are not on the line.
    pub link_unsent: bool,
    /// Answer timeout of the host while the robot's DTR is on, ticks. None means the 60 s of `depc::host`
    /// (`--robot`).
    pub link_patience: Option<u16>,
    /// Expected lag of the robot behind the commanded positions, ms. None means 200 ms (`--robot`,
    /// docs/design/link.md "Following").
    pub robot_lag: Option<u16>,
    /// Joint resolvers.
    pub resolvers: Resolvers,
    /// The attached gripper. The three grippers share the connections of the potentiometer (III.3.7, III.3.8). Strain
    /// gages and beam breaks belong to the parts gripper and read zero with another one.
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
    /// Location of the vise that reports its jaws closed on a part (extension). None without such a report.
    pub clamping: Option<Name10>,
    /// Age of the words from devices behind field I/O.
    pub field: FieldHealth,
}

/// All words that the controller writes to its devices in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DeviceOutputs {
    /// Bytes to the DEPC line.
    pub link_tx: LinkBytes,
    /// The robot must stop by its own means and stay: T3I found it off its path. The T3 has no such input; a robot
    /// with EGM and a caller of the library have one (extension).
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
    /// Fingers of the pedestal's hand: eight valves like those of the parts gripper (III.9.2).
    pub pedestal_hand: GripValves,
    /// Rotary table of the pedestal.
    pub pedestal_table: MotorCommand,
}
