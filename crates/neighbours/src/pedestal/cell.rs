//! The devices of the pedestal in the simulated cell (CHOSEN: a real pedestal has devices of its own, and neither reads nor writes
//! these mailboxes).
//!
//! ```text
//!   sensors   at  bytes  holds
//!              0    2    finger potentiometer, counts
//!              2    2    strain gage of the left finger, counts
//!              4    2    strain gage of the right finger, counts
//!              6    2    potentiometer of the table, counts
//!              8    2    1 at the + limit of the table
//!             10    2    1 at its - limit
//!             12    4    number of the last order that the rotary table controller has taken
//!             16    2    1 while its motor turns
//!             18    4    its step counter, signed
//!
//!   orders     0    2    command bits to the eight air valves of the hand
//!              2    4    number of the order to the rotary table controller, 0 for none
//!              6   12    turn, set-counter, stop; blank for none
//!             18    4    steps, signed
//! ```

use rcs_core::interface::device::{GripValves, MotorCommand, MotorOrder, PedestalSensors};

use super::{LayoutError, fields, word};
use crate::fields::Packer;

/// Bytes of the sensor words.
pub const SENSORS: usize = 22;
/// Bytes of the orders.
pub const ORDERS: usize = 22;
/// Characters of an order.
const ORDER: usize = 12;

/// The bytes of the sensor words.
#[must_use]
pub fn encode_sensors(sensors: &PedestalSensors) -> [u8; SENSORS] {
    let mut fields = Packer::<SENSORS>::default();
    for counts in
        [sensors.potentiometer, sensors.strain_left, sensors.strain_right, sensors.table_potentiometer]
    {
        fields.word(counts);
    }
    fields.flag(sensors.limit_plus);
    fields.flag(sensors.limit_minus);
    fields.long(sensors.motor_echo);
    fields.flag(sensors.motor_moving);
    fields.long_integer(sensors.motor_counter);
    fields.finish()
}

/// Read the sensor words.
///
/// # Errors
/// [`LayoutError`] for the first thing that cannot be.
pub fn decode_sensors(data: &[u8]) -> Result<PedestalSensors, LayoutError> {
    let mut fields = fields("a set of sensor words", SENSORS, data)?;
    Ok(PedestalSensors {
        potentiometer: fields.word("the finger potentiometer")?,
        strain_left: fields.word("the left strain gage")?,
        strain_right: fields.word("the right strain gage")?,
        table_potentiometer: fields.word("the potentiometer of the table")?,
        limit_plus: fields.flag("the + limit")?,
        limit_minus: fields.flag("the - limit")?,
        motor_echo: fields.long("the echo of the motor")?,
        motor_moving: fields.flag("motor turns")?,
        motor_counter: fields.long_integer("the step counter")?,
    })
}

/// The bytes of the orders to valves and motor.
#[must_use]
pub fn encode_orders(valves: GripValves, motor: &MotorCommand) -> [u8; ORDERS] {
    let mut fields = Packer::<ORDERS>::default();
    fields.word(valves.bits.into());
    fields.long(motor.number);
    fields.text(ORDER, &motor.order.text());
    fields.long_integer(motor.steps);
    fields.finish()
}

/// Read the orders to valves and motor.
///
/// # Errors
/// [`LayoutError`] for the first thing that cannot be.
pub fn decode_orders(data: &[u8]) -> Result<(GripValves, MotorCommand), LayoutError> {
    let mut fields = fields("a set of orders", ORDERS, data)?;
    let valves = GripValves { bits: fields.byte("the valves")? };
    let motor = MotorCommand {
        number: fields.long("the number of the order")?,
        order: word::<ORDER, _>(&mut fields, "the order to the motor", MotorOrder::from_text)?,
        steps: fields.long_integer("steps")?,
    };
    Ok((valves, motor))
}
