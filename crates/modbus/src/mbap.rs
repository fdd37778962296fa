//! The header of a frame, and the length of a frame in a stream (MG 3.1.3).
//!
//! ```text
//!  0 1          2 3       4 5                6     7
//!  transaction  protocol  length from here:  unit  function and its data
//!               0                2 to 254    1     1 to 253 bytes
//! ```

use crate::{
    Error,
    bytes::{Reader, Writer},
};

/// Number of bytes of the header, with the unit (MG 3.1.3).
pub const HEADER_BYTES: usize = 7;
/// Greatest number of bytes of a frame: the header and 253 bytes (AP 4.1).
pub const MOST_FRAME_BYTES: usize = 260;
/// Protocol identifier of Modbus (MG 3.1.3).
pub const PROTOCOL: u16 = 0;
/// Least length in a header: unit and function.
pub const LEAST_LENGTH: u16 = 2;
/// Greatest length in a header: unit and 253 bytes (AP 4.1).
pub const MOST_LENGTH: u16 = 254;
const BEFORE_UNIT: usize = 6; // not counted by the length

/// Header of a frame, without the length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Number of the request; the answer repeats it.
    pub transaction: u16,
    /// The device; behind a gateway it selects the serial device.
    pub unit: u8,
}

impl Header {
    /// Splits one frame into header and body. Errors: [`Error::BadProtocol`], [`Error::BadLength`], [`Error::BadSize`].
    pub fn split(frame: &[u8]) -> Result<(Self, &[u8]), Error> {
        let expected = needed(frame)?;
        if frame.len() != expected {
            return Err(Error::BadSize { expected, found: frame.len() });
        }
        let mut reader = Reader::new(frame);
        let transaction = reader.word()?;
        let _protocol_and_length = reader.take(4)?;
        let unit = reader.byte()?;
        let (_, body) = frame.split_at_checked(HEADER_BYTES).unwrap_or_default();
        Ok((Self { transaction, unit }, body))
    }

    /// Writes the header and what `body` writes. Returns the length of the frame.
    pub(crate) fn emit(
        self,
        buffer: &mut [u8],
        body: impl FnOnce(&mut Writer<'_>) -> Result<(), Error>,
    ) -> Result<usize, Error> {
        let (head, rest) =
            buffer.split_first_chunk_mut::<HEADER_BYTES>().ok_or(Error::NoRoom { needed: HEADER_BYTES })?;
        let mut data = Writer::new(rest);
        body(&mut data)?;
        let body_bytes = data.written();
        let length = u16::try_from(body_bytes.saturating_add(1)).unwrap_or(u16::MAX);
        let mut header = Writer::new(head);
        header.word(self.transaction)?;
        header.word(PROTOCOL)?;
        header.word(length)?;
        header.byte(self.unit)?;
        Ok(HEADER_BYTES.saturating_add(body_bytes))
    }
}

/// The number of bytes needed in `stream`: a whole frame, or up to the end of the length field while that is
/// incomplete. After [`Error::BadProtocol`] or [`Error::BadLength`] close the connection, because the next frame's
/// beginning is unknown.
pub fn needed(stream: &[u8]) -> Result<usize, Error> {
    let Some((head, _)) = stream.split_first_chunk::<BEFORE_UNIT>() else { return Ok(BEFORE_UNIT) };
    let [_, _, protocol @ .., high, low] = head;
    let (protocol, length) = (u16::from_be_bytes(*protocol), u16::from_be_bytes([*high, *low]));
    if protocol != PROTOCOL {
        return Err(Error::BadProtocol { found: protocol });
    }
    if !(LEAST_LENGTH..=MOST_LENGTH).contains(&length) {
        return Err(Error::BadLength { found: length });
    }
    Ok(BEFORE_UNIT.saturating_add(usize::from(length)))
}

/// The first complete frame in `stream`; `None` if it is incomplete. Errors: those of [`needed`].
pub fn first_frame(stream: &[u8]) -> Result<Option<&[u8]>, Error> {
    // While the length field is incomplete, `needed` returns `BEFORE_UNIT`.
    needed(stream).map(|length| if length > BEFORE_UNIT { stream.get(..length) } else { None })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [u8; 12] = [0x15, 0x01, 0, 0, 0, 6, 0xFF, 0x03, 0x00, 0x04, 0x00, 0x01];

    #[test]
    fn header_is_split_from_a_frame() {
        let header = Header { transaction: 0x1501, unit: 0xFF };
        assert_eq!(Header::split(&FRAME), Ok((header, &FRAME[7..])));
        let mut buffer = [0xA5; 12];
        let length = header.emit(&mut buffer, |data| data.bytes(&FRAME[7..]));
        assert_eq!((length, buffer), (Ok(12), FRAME));
    }

    #[test]
    fn stream_is_divided_into_frames() {
        for length in 0..6 {
            assert_eq!(needed(&FRAME[..length]), Ok(6));
            assert_eq!(first_frame(&FRAME[..length]), Ok(None));
        }
        for length in 6..12 {
            assert_eq!(needed(&FRAME[..length]), Ok(12));
            assert_eq!(first_frame(&FRAME[..length]), Ok(None));
            assert_eq!(Header::split(&FRAME[..length]), Err(Error::BadSize { expected: 12, found: length }));
        }
        let two = [FRAME, FRAME].concat();
        assert_eq!(first_frame(&two), Ok(Some(&FRAME[..])));
        assert_eq!(Header::split(&two), Err(Error::BadSize { expected: 12, found: 24 }));
    }

    #[test]
    fn impossible_headers_are_refused() {
        let mut frame = FRAME;
        frame[3] = 1;
        assert_eq!(needed(&frame), Err(Error::BadProtocol { found: 1 }));
        for length in [0_u16, 1, 255, 0xFFFF] {
            frame = FRAME;
            frame[4..6].copy_from_slice(&length.to_be_bytes());
            assert_eq!(needed(&frame), Err(Error::BadLength { found: length }));
        }
        for length in [2_u16, 254] {
            frame[4..6].copy_from_slice(&length.to_be_bytes());
            assert_eq!(needed(&frame), Ok(6 + usize::from(length)));
        }
    }

    #[test]
    fn frame_without_room_is_refused() {
        let header = Header { transaction: 1, unit: 1 };
        for length in 0..7 {
            let emitted = header.emit(&mut [0; 7][..length], |_| Ok(()));
            assert_eq!(emitted, Err(Error::NoRoom { needed: 7 }));
        }
        assert_eq!(header.emit(&mut [0; 9], |data| data.bytes(&[1, 2, 3])), Err(Error::NoRoom { needed: 3 }));
    }
}
