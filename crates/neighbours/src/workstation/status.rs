//! The status to the workstation controller, byte by byte (V.4.2).
//!
//! ```text
//!   at  bytes  variable              holds
//!    0    4    fdbf>w                not used: blanks
//!    4   16    echo>w                not used: blanks
//!   20    2    status-length>w       bytes of the status, 236
//!   22   12    time-stamp-status>w   not used: blanks
//!   34   16    "command-echo"        the command that Task has
//!   50   16    "status"              executing, finished; extensions: idle, error, joystick-on
//!   66    2    command-#-echo        extension: the number that "status" belongs to
//!   68    2    mailgram-echo         extension: mailgram number of the command mailbox that was read last
//!   70    2    verdict               extension: 0 that mailgram was taken, else it was refused: see below
//!   72    2    status-code           extension: code of why the command failed, 0 if it did not
//!   74    2    task-state            extension: 0 Task runs, 1 its switch on the joystick box holds it, 2 it is lost
//!   76  160    reason                extension: why the mailgram was refused, or else why the command failed
//! ```
//!
//! The extensions are CHOSEN: the manual's status has neither an echo of the number nor a word for failure. A refused mailgram
//! changes nothing in the fields before it: they go on telling of the command that Task has.

use rcs_core::{
    interface::{
        Reason,
        hws::{HwsReport, HwsStatus},
    },
    name::Name16,
};

use super::Refusal;
use crate::fields::{FieldError, Packer, Unpacker, command_number};

/// Bytes of a status.
pub const STATUS: usize = 236;
/// Bytes of `reason`.
pub const REASON: usize = 160;

/// `task-state`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u16)]
pub enum TaskState {
    /// Task runs.
    #[default]
    Runs = 0,
    /// Its switch on the joystick box holds it (III.3.3): it does not read its commands.
    Held = 1,
    /// It has not run in the last tick.
    Lost = 2,
}

impl TaskState {
    const ALL: [Self; 3] = [Self::Runs, Self::Held, Self::Lost];
}

/// A status as it is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status<'a> {
    /// `"command-echo"`.
    pub command: Name16,
    /// `"status"`.
    pub report: HwsReport,
    /// `command-#-echo`.
    pub echo: u16,
    /// `mailgram-echo`.
    pub mailgram_echo: u16,
    /// `verdict`: 0 taken.
    pub verdict: u16,
    /// `status-code`.
    pub code: Reason,
    /// `task-state`.
    pub task: TaskState,
    /// `reason`.
    pub reason: &'a str,
}

/// The bytes of a status.
#[must_use]
pub fn encode(
    status: &HwsStatus,
    task: TaskState,
    mailgram_echo: u16,
    refused: Option<&Refusal>,
) -> [u8; STATUS] {
    let mut fields = Packer::<STATUS>::default();
    fields.text(4, &"");
    fields.text(16, &"");
    fields.word(u16::try_from(STATUS).unwrap_or_default());
    fields.text(12, &"");
    fields.text(16, &status.command);
    fields.text(16, &status.report.text());
    fields.word(command_number(status.echo));
    fields.word(mailgram_echo);
    fields.word(refused.map_or(0, Refusal::code));
    fields.word(u16::from(status.reason.code()));
    fields.word(task as u16);
    match refused {
        Some(refused) => fields.text(REASON, refused),
        None => fields.text(REASON, &status.reason.text()),
    }
    fields.finish()
}

/// Read the bytes of a status.
///
/// # Errors
/// [`FieldError`] for the first field that cannot be.
pub fn decode(bytes: &[u8]) -> Result<Status<'_>, FieldError> {
    let mut fields = Unpacker::new(bytes);
    fields.raw("fdbf>w, echo>w, status-length>w, time-stamp-status>w", 34)?;
    let command = fields.name("command-echo")?;
    let report = fields.name::<16>("status")?;
    let report =
        HwsReport::from_text(report.as_str()).ok_or(FieldError::Word { field: "status", found: report })?;
    let (echo, mailgram_echo) = (fields.word("command-#-echo")?, fields.word("mailgram-echo")?);
    let verdict = fields.word("verdict")?;
    let (code, task) = (fields.word("status-code")?, fields.word("task-state")?);
    Ok(Status {
        command,
        report,
        echo,
        mailgram_echo,
        verdict,
        code: u8::try_from(code)
            .ok()
            .and_then(Reason::from_code)
            .ok_or(FieldError::Code { field: "status-code", found: code })?,
        task: TaskState::ALL
            .into_iter()
            .find(|&state| state as u16 == task)
            .ok_or(FieldError::Code { field: "task-state", found: task })?,
        reason: fields.text("reason", REASON)?,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn failed() -> HwsStatus {
        HwsStatus {
            echo: 7,
            command: Name16::new("TRANSFER").unwrap(),
            report: HwsReport::Error,
            reason: Reason::GraspMissed,
        }
    }

    #[test]
    fn every_field_stands_at_its_byte() {
        let expected = [
            &[b' '; 20][..],
            b"\xEC\x00            TRANSFER        error           ",
            b"\x07\x00\x09\x00\x00\x00",
            &[Reason::GraspMissed.code(), 0, 1, 0],
            format!("{:160}", "the fingers closed on nothing").as_bytes(),
        ]
        .concat();
        let bytes = encode(&failed(), TaskState::Held, 9, None);
        assert_eq!(bytes, &expected[..]);
        let status = decode(&bytes).unwrap();
        assert_eq!((status.echo, status.report, status.code), (7, HwsReport::Error, Reason::GraspMissed));
        assert_eq!((status.mailgram_echo, status.verdict, status.task), (9, 0, TaskState::Held));
        assert_eq!(status.reason, "the fingers closed on nothing");
    }

    #[test]
    fn every_report_and_reason_comes_back_whole() {
        for &report in HwsReport::ALL {
            for &reason in Reason::ALL {
                let bytes = encode(&HwsStatus { report, reason, ..failed() }, TaskState::Lost, 0, None);
                let status = decode(&bytes).unwrap();
                assert_eq!((status.report, status.code, status.reason), (report, reason, reason.text()));
            }
        }
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = decode(&bytes);
        }
    }
}
