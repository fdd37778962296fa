//! Actions of the workstation in a simulated cell: an extension. The manual's workstation has its own connections to
//! vise, trays and machine.

use rcs_core::Plain;

use crate::{
    fields::FieldError,
    layout::{At, Codec as _, Coded, Flag, LayoutError, Text, U16, Width as _},
};

pub const TEXT: usize = 240; // bytes of a line or status

/// Kind of trouble in the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Trouble {
    /// No trouble.
    #[text = ""]
    None,
    /// The last line was refused.
    Refused,
    /// The cell has a fault.
    Fault,
    /// An emergency has stopped the robot.
    Emergency,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellStatus<'a> {
    pub echo: u16, // last line begun or refused
    pub busy: bool,
    pub trouble: Trouble,
    pub text: &'a str,
}

pub type NumberedLine<'a> = (u16, &'a str);

crate::layout! {
    /// A line for the cell.
    LineLayout: NumberedLine<'_> = "a line";
    "number"  (0)  U16,
        "1 to 65535: a different number is a new line, a repeated number has no effect. 0 is refused";
    "line"    (1)  Text<TEXT>, "as in a job without its asterisks: `vise close PFIXTURE`";
}

crate::layout! {
    /// The status of the cell.
    CellStatusLayout: CellStatus<'_> = "a status of the cell";
    "echo"     (echo)     U16,
        "number of the last line that was started or refused; a mailgram of less than 2 bytes is refused without a \
         number";
    "busy"     (busy)     Flag,        "1 while the cell is busy with a line";
    "trouble"  (trouble)  Coded<2>,
        "0 none; 1 the line was refused; 2 the cell has a fault; 3 an emergency has stopped the robot";
    "text"     (text)     Text<TEXT>,  "the trouble, as a sentence";
}

/// Encodes a line. A text beyond [`TEXT`] is truncated.
#[must_use]
pub fn encode_line(number: u16, line: &str) -> [u8; LineLayout::BYTES] {
    LineLayout::encode(&(number, line))
}

/// The number is known even if the rest cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellLine<'a> {
    pub number: u16,
    pub text: Result<&'a str, LayoutError>,
}

pub fn decode_line(bytes: &[u8]) -> Result<CellLine<'_>, FieldError> {
    let number = bytes.get(..U16::BYTES).ok_or(FieldError::End { field: "number" })?;
    let number = U16::take(At { field: "number", byte: 0 }, number)?;
    Ok(CellLine { number, text: LineLayout::decode(bytes).map(|(_, line)| line) })
}

impl<'a> CellStatus<'a> {
    #[must_use]
    pub fn encode(&self) -> [u8; CellStatusLayout::BYTES] {
        CellStatusLayout::encode(self)
    }

    pub fn decode(bytes: &'a [u8]) -> Result<Self, LayoutError> {
        CellStatusLayout::decode(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cell_lines_and_statuses_round_trip() {
        let bytes = encode_line(7, "vise close PFIXTURE");
        assert_eq!(&bytes[..24], b"\x07\x00vise close PFIXTURE   ");
        assert_eq!(decode_line(&bytes), Ok(CellLine { number: 7, text: Ok("vise close PFIXTURE") }));
        let size = LayoutError::Size { what: "a line", expected: 242, found: 100 };
        let short = CellLine { number: 7, text: Err(size) };
        assert_eq!(decode_line(&bytes[..100]), Ok(short));
        assert_eq!(decode_line(&bytes[..1]), Err(FieldError::End { field: "number" }));
        let status =
            CellStatus { echo: 7, busy: true, trouble: Trouble::Refused, text: "there is no vise at TABLE" };
        let bytes = status.encode();
        assert_eq!(&bytes[..18], b"\x07\x00\x01\x00\x01\x00there is no ");
        assert_eq!(CellStatus::decode(&bytes), Ok(status));
        let size = LayoutError::Size { what: "a status of the cell", expected: 246, found: 245 };
        assert_eq!(CellStatus::decode(&bytes[..245]), Err(size));
    }
}
