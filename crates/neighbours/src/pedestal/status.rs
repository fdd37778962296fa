//! The status of the pedestal (VI.7.2). Additional fields are CHOSEN; `status-code` is "not currently used".

use interfaces::{
    Header,
    pedestal::{PedestalReport, PedestalStatus},
};
use rcs_core::Plain;

use super::{PedestalError, STEP, WORD, row, set_row, set_table, table};
use crate::layout::{Chars, Coded, Flag, Given, I32, Spelled, Text, U16, U32, U64};

pub const REASON: usize = 160; // bytes

/// The field `verdict`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Verdict {
    /// The last mailgram was accepted.
    Taken,
    /// It is not a command.
    #[text = "no command"]
    NoCommand,
    /// The sensor words of the simulated cell cannot be read.
    #[text = "no sensor words"]
    NoSensors,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status<'a> {
    pub status: PedestalStatus, // VI.7.2
    pub header: Header,         // `table#`, `row#` and `step`; no stamp
    pub mailgram_echo: u16,
    pub verdict: Verdict,
    pub reason: &'a str,
}

crate::layout! {
    /// The status of the pedestal.
    StatusLayout: Status<'_> = "a status of the pedestal";
    "cycle-cnt-echo"   (status.cycle_echo)  U64,
        "`cycle-cnt` of the command that is echoed";
    "incr-cmnd#-echo"  (status.echo)  U32,
        "number of the command that `status` reports";
    "status"  (status.report)  Spelled<WORD>,
        "executing, done, can't-do, error; idle (CHOSEN) only with the number 0, before the first command";
    "status-code"  (status.reason)  Coded<4>,
        "CHOSEN: why it failed, 0 if it did not: [its code](reasons.md); another number makes the status \
         unreadable";
    "grip-size"   (status.grip_size)   I32, "0.01 in";
    "grip-force"  (status.grip_force)  I32, "lb";
    "table-position"  [|s| s.status.table_position.unwrap_or_default(),
                       |s, found| s.status.table_position = Some(found)]  I32, "0.1 degree";
    "table#"  [|s| table(&s.header), |s, found| set_table(&mut s.header, found)]  U16,
        "CHOSEN: decision table of the pedestal process, 0 for none";
    "row#"    [|s| row(&s.header), |s, found| set_row(&mut s.header, found)]  U16,
        "CHOSEN: its row that fired";
    "step"    (header.step)  Given<Chars<STEP>>,
        "CHOSEN: step of its command after that row, blank for none";
    "mailgram-echo"  (mailgram_echo)  U16,
        "CHOSEN: mailgram number of the command mailbox that was read last";
    "verdict"  (verdict)  Coded<2>,
        "CHOSEN: of that mailgram, independent of `status`: 0 accepted, 1 not a command, 2 the words of the sensors \
         cannot be read";
    "reason"   (reason)   Text<REASON>, "CHOSEN: the same in a sentence";
    "angle-known"  [|s| s.status.table_position.is_some(), set_known]  Flag,
        "CHOSEN: 1: `table-position` is an angle; 0: it is not known (not calibrated, or the potentiometer of \
         the table disagrees), and `table-position` is 0";
    "felt"     (status.felt)     Coded<2>,
        "CHOSEN: contents of the hand by its sensors: 0 not known, 1 empty, 2 not empty";
    "gripped"  (status.gripped)  Flag,
        "CHOSEN: 1: GRIP was ordered, and no opening since";
}

fn set_known(read: &mut Status<'_>, known: bool) {
    if !known {
        read.status.table_position = None;
    }
}

impl<'a> Status<'a> {
    /// Encodes the status. A reason beyond [`REASON`] is truncated.
    #[must_use]
    pub fn encode(&self) -> [u8; StatusLayout::BYTES] {
        StatusLayout::encode(self)
    }

    pub fn decode(data: &'a [u8]) -> Result<Self, PedestalError> {
        let read = StatusLayout::decode(data)?;
        let status = &read.status;
        if status.report == PedestalReport::Idle && status.echo != 0 {
            return Err(PedestalError::Idle(status.echo));
        }
        Ok(read)
    }
}
