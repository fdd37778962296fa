//! The status of the pedestal's rotary table for Diagnostics (IX.3), byte by byte. CHOSEN: the manual gives no layout, and nothing of
//! the table process but that it is there.
//!
//! ```text
//!   at  bytes  variable           holds
//!    0    4    incr-cmnd#-echo    the number that `status` belongs to
//!    4   10    status             executing, done, can't-do, error; idle
//!   14    4    status-code        code of why the command failed, 0 if it did not
//!   18    2    calibrated         1 if the counter was set at the + limit
//!   20    4    table-position     0.1 degree, signed; 0 if it is not known
//!   24    2    table#             decision table of the table process that was used last, 0 for none
//!   26    2    row#               its row that fired
//!   28   16    step               step of its command after that row, blank for none
//!   44    4    incr-cmnd#         number of the command from the pedestal process, 0 for none
//!   48   10    command            PAUSE, CALIBRATE, TURN; blank for none
//!   58    4    table-angle        0.1 degree, absolute, signed
//!   62    2    angle-known        1 if `table-position` is an angle
//!   64    2    limit-known        1 if `at-limit` is a reading
//!   66    2    at-limit           potentiometer at the + limit, counts; 0 if it is not known
//! ```

use rcs_core::interface::{
    TableOutputs,
    device::MotorCommand,
    pedestal::{PedestalReport, TableCommand, TableStatus, TableVerb},
};

use super::{LayoutError, WORD, fields, put_row, reason, take_row, word};
use crate::fields::Packer;

/// Bytes of a status.
pub const STATUS: usize = 68;

/// The bytes of the table's status and command.
#[must_use]
pub fn encode(table: &TableOutputs, command: &TableCommand) -> [u8; STATUS] {
    let status = &table.status;
    let mut fields = Packer::<STATUS>::default();
    fields.long(status.echo);
    fields.text(WORD, &status.report.text());
    fields.long(status.reason.code().into());
    fields.flag(status.calibrated);
    fields.long_integer(status.position.unwrap_or_default());
    put_row(&mut fields, &table.header);
    fields.long(command.number);
    fields.text(WORD, &command.command.text());
    fields.long_integer(command.angle);
    fields.flag(status.position.is_some());
    fields.flag(table.at_limit.is_some());
    fields.word(table.at_limit.unwrap_or_default());
    fields.finish()
}

/// Read the bytes: what the table process has written, without an order to its motor, and its command.
///
/// # Errors
/// [`LayoutError`] for the first thing that cannot be.
pub fn decode(data: &[u8]) -> Result<(TableOutputs, TableCommand), LayoutError> {
    let mut fields = fields("a status of the table", STATUS, data)?;
    let mut status = TableStatus {
        echo: fields.long("incr-cmnd#-echo")?,
        report: word::<WORD, _>(&mut fields, "status", PedestalReport::from_text)?,
        reason: reason(&mut fields, "status-code")?,
        calibrated: fields.flag("calibrated")?,
        position: Some(fields.long_integer("table-position")?),
    };
    let header = take_row(&mut fields)?;
    let command = TableCommand {
        number: fields.long("incr-cmnd#")?,
        command: word::<WORD, _>(&mut fields, "command", TableVerb::from_text)?,
        angle: fields.long_integer("table-angle")?,
    };
    if !fields.flag("angle-known")? {
        status.position = None;
    }
    let (known, counts) = (fields.flag("limit-known")?, fields.word("at-limit")?);
    let at_limit = known.then_some(counts);
    Ok((TableOutputs { header, status, at_limit, motor: MotorCommand::default() }, command))
}
