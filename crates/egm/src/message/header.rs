//! `EgmHeader`: sequence number, time stamp and type of a message.

use crate::{
    Error,
    wire::{Reader, Writer},
};

/// `EgmHeader`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Header {
    /// Sequence number. Senders count in steps of 1 or 2, from 0 or 1.
    pub seqno: Option<u32>,
    /// Time stamp of the sender, ms.
    pub tm: Option<u32>,
    /// Type of the message.
    pub mtype: Option<MessageType>,
}

/// `EgmHeader.MessageType`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MessageType {
    /// Undefined, or not in the schema.
    #[default]
    Undefined,
    /// For future use.
    Command,
    /// From the robot controller.
    Data,
    /// From the sensor: the host.
    Correction,
    /// A path correction from the sensor.
    PathCorrection,
}

impl MessageType {
    /// Number of the type in the schema.
    #[must_use]
    pub const fn code(self) -> u32 {
        match self {
            Self::Undefined => 0,
            Self::Command => 1,
            Self::Data => 2,
            Self::Correction => 3,
            Self::PathCorrection => 4,
        }
    }

    const fn from_code(code: u32) -> Self {
        match code {
            1 => Self::Command,
            2 => Self::Data,
            3 => Self::Correction,
            4 => Self::PathCorrection,
            _ => Self::Undefined,
        }
    }
}

impl Header {
    /// A header with all fields.
    #[must_use]
    pub const fn new(seqno: u32, tm: u32, mtype: MessageType) -> Self {
        Self { seqno: Some(seqno), tm: Some(tm), mtype: Some(mtype) }
    }

    pub(super) fn merge(&mut self, mut fields: Reader<'_>) -> Result<(), Error> {
        while let Some(field) = fields.next_field()? {
            match field.number {
                1 => self.seqno = Some(field.uint32()?),
                2 => self.tm = Some(field.uint32()?),
                3 => self.mtype = Some(MessageType::from_code(field.uint32()?)),
                _ => {}
            }
        }
        Ok(())
    }

    pub(super) fn write(&self, writer: &mut Writer<'_>) -> Result<(), Error> {
        if let Some(mtype) = self.mtype {
            writer.uint(3, mtype.code().into())?;
        }
        if let Some(tm) = self.tm {
            writer.uint(2, tm.into())?;
        }
        self.seqno.map_or(Ok(()), |seqno| writer.uint(1, seqno.into()))
    }
}
