//! The status of the pedestal, byte by byte (VI.7.2).
//!
//! ```text
//!   at  bytes  variable          holds
//!    0    8    cycle-cnt-echo    cycle-cnt of the command that is echoed
//!    8    4    incr-cmnd#-echo   the number that `status` belongs to
//!   12   10    status            executing, done, can't-do, error; extension: idle, for the number 0 alone
//!   22    4    status-code       extension: code of why the command failed, 0 if it did not
//!   26    4    grip-size         0.01 in
//!   30    4    grip-force        lb
//!   34    4    table-position    0.1 degree, signed
//!   38    2    table#            extension: decision table of the pedestal process that was used last, 0 for none
//!   40    2    row#              extension: its row that fired
//!   42   16    step              extension: step of its command after that row, blank for none
//!   58    2    mailgram-echo     extension: mailgram number of the command mailbox that was read last
//!   60    2    verdict           extension: 0 that mailgram was taken, 1 it is no command, 2 the sensor words cannot be read
//!   62  160    reason            extension: the same in a sentence
//!  222    2    angle-known       extension: 1 if `table-position` is an angle; 0 if it is not known, and 0
//!  224    2    felt              extension: what is in the hand: 0 not known, 1 nothing, 2 something
//!  226    2    gripped           extension: 1 if GRIP was ordered, and no opening since
//! ```
//!
//! The extensions are CHOSEN. `status-code` is "not currently used" by the manual; here it is the code of [`Reason`].
//!
//! [`Reason`]: rcs_core::interface::Reason

use rcs_core::{
    Plain,
    interface::{
        Header,
        pedestal::{PedestalReport, PedestalStatus},
    },
    tick::Tick,
};

use super::{LayoutError, WORD, felt, fields, put_row, reason, take_row, word};
use crate::fields::{FieldError, Packer};

/// Bytes of a status.
pub const STATUS: usize = 228;
/// Bytes of `reason`.
pub const REASON: usize = 160;

/// `verdict`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Verdict {
    /// What was read last was taken.
    Taken,
    /// It is no command.
    #[text = "no command"]
    NoCommand,
    /// The sensor words of the simulated cell cannot be read.
    #[text = "no sensor words"]
    NoSensors,
}

/// A status as it is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status<'a> {
    /// The variables of VI.7.2.
    pub status: PedestalStatus,
    /// `table#`, `row#` and `step`; no stamp.
    pub header: Header,
    /// `mailgram-echo`.
    pub mailgram_echo: u16,
    /// `verdict`.
    pub verdict: Verdict,
    /// `reason`.
    pub reason: &'a str,
}

impl<'a> Status<'a> {
    /// The bytes; what is longer than [`REASON`] is cut off.
    #[must_use]
    pub fn encode(&self) -> [u8; STATUS] {
        let status = &self.status;
        let mut fields = Packer::<STATUS>::default();
        fields.quad(status.cycle_echo.0);
        fields.long(status.echo);
        fields.text(WORD, &status.report.text());
        fields.long(status.reason.code().into());
        fields.long_integer(status.grip_size);
        fields.long_integer(status.grip_force);
        fields.long_integer(status.table_position.unwrap_or_default());
        put_row(&mut fields, &self.header);
        fields.word(self.mailgram_echo);
        fields.word(self.verdict.code().into());
        fields.text(REASON, &self.reason);
        fields.flag(status.table_position.is_some());
        fields.word(status.felt.code().into());
        fields.flag(status.gripped);
        fields.finish()
    }

    /// Read the bytes.
    ///
    /// # Errors
    /// [`LayoutError`] for the first thing that cannot be.
    pub fn decode(data: &'a [u8]) -> Result<Self, LayoutError> {
        let mut fields = fields("a status of the pedestal", STATUS, data)?;
        let mut status = PedestalStatus {
            cycle_echo: Tick(fields.quad("cycle-cnt-echo")?),
            echo: fields.long("incr-cmnd#-echo")?,
            report: word::<WORD, _>(&mut fields, "status", PedestalReport::from_text)?,
            reason: reason(&mut fields, "status-code")?,
            grip_size: fields.long_integer("grip-size")?,
            grip_force: fields.long_integer("grip-force")?,
            table_position: Some(fields.long_integer("table-position")?),
            ..PedestalStatus::default()
        };
        if status.report == PedestalReport::Idle && status.echo != 0 {
            return Err(LayoutError::Idle(status.echo));
        }
        let header = take_row(&mut fields)?;
        let (mailgram_echo, verdict) = (fields.word("mailgram-echo")?, fields.byte("verdict")?);
        let verdict = Verdict::from_code(verdict)
            .ok_or(FieldError::Code { field: "verdict", found: verdict.into() })?;
        let reason = fields.text("reason", REASON)?;
        if !fields.flag("angle-known")? {
            status.table_position = None;
        }
        (status.felt, status.gripped) = (felt(&mut fields)?, fields.flag("gripped")?);
        Ok(Self { status, header, mailgram_echo, verdict, reason })
    }
}
