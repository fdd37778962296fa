//! What the workstation does itself, in a simulated cell (an extension: the manual's workstation has its own lines to vise, trays
//! and machine).
//!
//! ```text
//!   command   at  bytes  holds
//!              0    2    number, 1 to 65535: another one than the last is a new line
//!              2  240    the line, as in a job without its asterisks: vise close PFIXTURE
//!
//!   status     0    2    number of the line that was begun last, or refused
//!              2    2    1 while the cell is busy with a line
//!              4    2    0 all is well; 1 the line was refused; 2 the cell has a fault; 3 an emergency has stopped the robot
//!              6  240    what is wrong, in a sentence
//! ```

use rcs_core::Plain;

use crate::fields::{FieldError, Packer, Unpacker};

/// Bytes of a command.
pub const COMMAND: usize = 242;
/// Bytes of a status.
pub const STATUS: usize = 246;
/// Bytes of a text.
pub const TEXT: usize = 240;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Trouble {
    /// Nothing.
    #[text = ""]
    None,
    /// The last line was refused.
    Refused,
    /// The cell has a fault.
    Fault,
    /// An emergency has stopped the robot.
    Emergency,
}

/// The status of the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellStatus<'a> {
    /// Number of the line that was begun last, or refused.
    pub echo: u16,
    /// The cell is busy with a line.
    pub busy: bool,
    /// What is wrong.
    pub trouble: Trouble,
    /// The same in a sentence.
    pub text: &'a str,
}

/// The bytes of a line; what is longer than [`TEXT`] is cut off.
#[must_use]
pub fn encode_line(number: u16, line: &str) -> [u8; COMMAND] {
    let mut fields = Packer::<COMMAND>::default();
    fields.word(number);
    fields.text(TEXT, &line);
    fields.finish()
}

/// A line with its number, which is known even if the rest cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellLine<'a> {
    /// The number.
    pub number: u16,
    /// The line, or why it cannot be read.
    pub text: Result<&'a str, FieldError>,
}

/// Read a line.
///
/// # Errors
/// [`FieldError`] if it has no number.
pub fn decode_line(bytes: &[u8]) -> Result<CellLine<'_>, FieldError> {
    let mut fields = Unpacker::new(bytes);
    Ok(CellLine { number: fields.word("number")?, text: fields.text("line", TEXT) })
}

impl<'a> CellStatus<'a> {
    /// The bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; STATUS] {
        let mut fields = Packer::<STATUS>::default();
        fields.word(self.echo);
        fields.word(u16::from(self.busy));
        fields.word(u16::from(self.trouble.code()));
        fields.text(TEXT, &self.text);
        fields.finish()
    }

    /// Read the bytes.
    ///
    /// # Errors
    /// [`FieldError`] for the first field that cannot be.
    pub fn decode(bytes: &'a [u8]) -> Result<Self, FieldError> {
        let mut fields = Unpacker::new(bytes);
        let (echo, busy, trouble) = (fields.word("echo")?, fields.word("busy")?, fields.word("trouble")?);
        Ok(Self {
            echo,
            busy: busy != 0,
            trouble: u8::try_from(trouble)
                .ok()
                .and_then(Trouble::from_code)
                .ok_or(FieldError::Code { field: "trouble", found: trouble })?,
            text: fields.text("text", TEXT)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_statuses_come_back() {
        let bytes = encode_line(7, "vise close PFIXTURE");
        assert_eq!(&bytes[..24], b"\x07\x00vise close PFIXTURE   ");
        assert_eq!(decode_line(&bytes), Ok(CellLine { number: 7, text: Ok("vise close PFIXTURE") }));
        let short = CellLine { number: 7, text: Err(FieldError::End { field: "line" }) };
        assert_eq!(decode_line(&bytes[..100]), Ok(short));
        assert_eq!(decode_line(&bytes[..1]), Err(FieldError::End { field: "number" }));
        let status =
            CellStatus { echo: 7, busy: true, trouble: Trouble::Refused, text: "there is no vise at TABLE" };
        let bytes = status.encode();
        assert_eq!(&bytes[..18], b"\x07\x00\x01\x00\x01\x00there is no ");
        assert_eq!(CellStatus::decode(&bytes), Ok(status));
        assert_eq!(CellStatus::decode(&bytes[..245]), Err(FieldError::End { field: "text" }));
    }
}
