//! The status of the pedestal's gripper for Diagnostics (IX.3), byte by byte. CHOSEN: the manual gives no layout. The gripper is
//! nearly identical to the parts gripper (III.9.2), so the variables are those of Grip (VI.3.2), the status first and behind it the
//! command that it belongs to.
//!
//! ```text
//!   at  bytes  variable           holds
//!    0    4    incr-cmnd#-echo    the number that `status` belongs to
//!    4   10    status             executing, done, paused, serror; extension: idle
//!   14    4    status-code        extension: code of why the command failed, 0 if it did not
//!   18    2    initialized-?      1 if the sensors are calibrated
//!   20    4    pos                0.01 in
//!   24    4    l-force            lb
//!   28    4    r-force            lb
//!   32    4    vel                0.01 in/s
//!   36    4    finger-hgt         0.01 in
//!   40    2    grip               command bits to the eight air valves
//!   42    2    table#             extension: decision table of the hand process that was used last, 0 for none
//!   44    2    row#               extension: its row that fired
//!   46   16    step               extension: step of its command after that row, blank for none
//!   62    4    incr-cmnd#         number of the command from the pedestal process, 0 for none
//!   66   10    command            PAUSE, OPEN-GRIP, CLOSE-GRIP, POSITION, UP-INIT; blank for none
//!   76    4    force              lb
//!   80    4    position           0.01 in
//!   84    4    velocity           0.01 in/s; 0 is full speed
//!   88    2    end-effector       0: it is on no quick change
//!   90    2    felt               extension: what is between the fingers: 0 not known, 1 nothing, 2 something
//!   92    2    scales-known       extension: 1 if the scales are those of a calibration
//!   94    8    zero of pos        extension: counts at opening 0, as the bits of a 64-bit floating-point number
//!  102    8    gain of pos        extension: inches a count
//!  110   16    left strain gage   extension: the same, pounds
//!  126   16    right strain gage  extension: the same, pounds
//! ```

use rcs_core::interface::{
    GripOutputs,
    device::GripValves,
    grip::{Calibration, Felt, GripCommand, GripReport, GripStatus, GripVerb, Scale},
};

use super::{LayoutError, WORD, felt, fields, put_row, reason, take_row, word};
use crate::fields::Packer;

/// Bytes of a status.
pub const STATUS: usize = 142;

/// The bytes of the hand's status and command.
#[must_use]
pub fn encode(hand: &GripOutputs, command: &GripCommand) -> [u8; STATUS] {
    let status = &hand.status;
    let mut fields = Packer::<STATUS>::default();
    fields.long(status.echo);
    fields.text(WORD, &status.report.text());
    fields.long(status.reason.code().into());
    fields.flag(status.initialized);
    for value in
        [status.position, status.left_force, status.right_force, status.velocity, status.finger_height]
    {
        fields.long_integer(value);
    }
    fields.word(status.valves.into());
    put_row(&mut fields, &hand.header);
    fields.long(command.number);
    fields.text(WORD, &command.command.text());
    fields.long_integer(command.force);
    fields.long_integer(command.position);
    fields.long_integer(command.velocity);
    fields.word(command.end_effector_id.unwrap_or(0).into());
    fields.word(status.felt.code().into());
    fields.flag(hand.calibration.is_some());
    let Calibration { potentiometer, left, right } = hand.calibration.unwrap_or_default();
    for scale in [potentiometer, left, right] {
        fields.quad(scale.zero.to_bits());
        fields.quad(scale.gain.to_bits());
    }
    fields.finish()
}

/// Read the bytes: what the hand process has written, without an order to its valves, and its command.
///
/// # Errors
/// [`LayoutError`] for the first thing that cannot be.
pub fn decode(data: &[u8]) -> Result<(GripOutputs, GripCommand), LayoutError> {
    let mut fields = fields("a status of the gripper", STATUS, data)?;
    let mut status = GripStatus {
        echo: fields.long("incr-cmnd#-echo")?,
        report: word::<WORD, _>(&mut fields, "status", GripReport::from_text)?,
        reason: reason(&mut fields, "status-code")?,
        initialized: fields.flag("initialized-?")?,
        position: fields.long_integer("pos")?,
        left_force: fields.long_integer("l-force")?,
        right_force: fields.long_integer("r-force")?,
        velocity: fields.long_integer("vel")?,
        finger_height: fields.long_integer("finger-hgt")?,
        valves: fields.byte("grip")?,
        felt: Felt::NotKnown,
    };
    let header = take_row(&mut fields)?;
    let command = GripCommand {
        number: fields.long("incr-cmnd#")?,
        command: word::<WORD, _>(&mut fields, "command", GripVerb::from_text)?,
        force: fields.long_integer("force")?,
        position: fields.long_integer("position")?,
        velocity: fields.long_integer("velocity")?,
        end_effector_id: Some(fields.byte("end-effector")?).filter(|id| *id != 0),
    };
    status.felt = felt(&mut fields)?;
    let known = fields.flag("scales-known")?;
    let mut scale = |zero, gain| -> Result<Scale, LayoutError> {
        Ok(Scale { zero: f64::from_bits(fields.quad(zero)?), gain: f64::from_bits(fields.quad(gain)?) })
    };
    let calibration = Calibration {
        potentiometer: scale("zero of pos", "gain of pos")?,
        left: scale("zero of the left strain gage", "gain of the left strain gage")?,
        right: scale("zero of the right strain gage", "gain of the right strain gage")?,
    };
    let calibration = known.then_some(calibration);
    let hand = GripOutputs { header, status, calibration, valves: GripValves::default() };
    Ok((hand, command))
}
