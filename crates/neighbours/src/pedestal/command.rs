//! The command to the pedestal, byte by byte (VI.7.2).
//!
//! ```text
//!   at  bytes  variable      holds
//!    0    8    cycle-cnt     tick in which the command was written
//!    8    4    incr-cmnd#    1 to 4294967295, then 1 again; 0 for no command yet
//!   12   10    command       PRE-GRIP, GRIP, FLIP, RELEASE, PAUSE; blank for none
//!   22    4    grasp-size    0.01 in (SPECNOTES.md, contradiction 27)
//!   26    4    grasp-force   lb
//!   30    4    table-angle   0.1 degree, signed; absolute for PRE-GRIP, relative for FLIP
//! ```

use rcs_core::{
    interface::pedestal::{PedestalCommand, PedestalVerb},
    tick::Tick,
};

use super::{LayoutError, WORD, fields, word};
use crate::fields::{Packer, Unpacker};

/// Bytes of a command.
pub const COMMAND: usize = 34;

/// The bytes of a command.
#[must_use]
pub fn encode(command: &PedestalCommand) -> [u8; COMMAND] {
    let mut fields = Packer::<COMMAND>::default();
    fields.quad(command.cycle.0);
    fields.long(command.number);
    fields.text(WORD, &command.command.text());
    fields.long_integer(command.grasp_size);
    fields.long_integer(command.grasp_force);
    fields.long_integer(command.table_angle);
    fields.finish()
}

/// Read the bytes of a command. Whether it can be executed is for the pedestal process to say.
///
/// # Errors
/// [`LayoutError`] for the first thing that cannot be.
pub fn decode(data: &[u8]) -> Result<PedestalCommand, LayoutError> {
    let mut fields = fields("a command", COMMAND, data)?;
    Ok(PedestalCommand {
        cycle: Tick(fields.quad("cycle-cnt")?),
        number: fields.long("incr-cmnd#")?,
        command: word::<WORD, _>(&mut fields, "command", PedestalVerb::from_text)?,
        grasp_size: fields.long_integer("grasp-size")?,
        grasp_force: fields.long_integer("grasp-force")?,
        table_angle: fields.long_integer("table-angle")?,
    })
}

/// The number of a command that cannot be read otherwise, so that it can be refused; `None` if it is cut off before its number
/// ends.
#[must_use]
pub fn number(data: &[u8]) -> Option<u32> {
    let mut fields = Unpacker::new(data);
    fields.quad("cycle-cnt").ok()?;
    fields.long("incr-cmnd#").ok()
}
