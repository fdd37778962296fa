//! A mailgram on the line.
//!
//! ```text
//!   byte  0           4        6            8           10           12 ...
//!         address     length   mailgram #   read lock   write lock   data
//!         32 bits     `----------- the mailbox, head and data ----------------'
//! ```
//!
//! Numbers are low byte first. The address is that of Table IX.1; `length` counts from its own first byte to the last
//! of the data. Three addresses do not belong to mailboxes:
//!
//! * 0, the **pulse**: a tick, 64 bits, after the controller's mailgrams. The neighbour sends it back after its own;
//! * 1, the **disconnect reason**: a text, after which the controller closes the connection;
//! * 2, the **welcome**, without data: the neighbour is admitted.

use crate::mailbox::{HEAD, MAX_SIZE, Mailbox, Place};

pub const ADDRESS: usize = 4; // bytes before the mailbox
pub const PULSE: u32 = 0;
pub const DISCONNECT: u32 = 1; // a disconnect reason
pub const WELCOME: u32 = 2;
pub const MAX_FRAME: usize = ADDRESS + MAX_SIZE; // bytes

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    bytes: &'a [u8],
}

impl<'a> Frame<'a> {
    /// `None` while incomplete. After [`FrameError::Length`] no further frame can be found.
    pub fn first(bytes: &'a [u8]) -> Result<Option<Self>, FrameError> {
        let Some(&[a, b, c, d, low, high]) = bytes.first_chunk() else { return Ok(None) };
        let (address, found) = (u32::from_le_bytes([a, b, c, d]), u16::from_le_bytes([low, high]));
        let length = usize::from(found);
        if !(HEAD..=MAX_SIZE).contains(&length) {
            return Err(FrameError::Length { address, found });
        }
        Ok(bytes.get(..ADDRESS + length).map(|bytes| Self { bytes }))
    }

    #[must_use]
    pub const fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    #[must_use]
    pub fn address(&self) -> u32 {
        u32::from_le_bytes([self.bytes[0], self.bytes[1], self.bytes[2], self.bytes[3]])
    }

    #[must_use]
    pub fn mailbox(&self) -> &'a [u8] {
        &self.bytes[ADDRESS..]
    }

    #[must_use]
    pub fn data(&self) -> &'a [u8] {
        &self.bytes[ADDRESS + HEAD..]
    }

    /// `None` if the frame is not a pulse. Fails with [`FrameError::Pulse`].
    pub fn as_pulse(&self) -> Result<Option<u64>, FrameError> {
        if self.address() != PULSE {
            return Ok(None);
        }
        let number = self.data().try_into().map_err(|_| FrameError::Pulse(self.data().len()))?;
        Ok(Some(u64::from_le_bytes(number)))
    }
}

pub fn put_mailbox(out: &mut Vec<u8>, mailbox: &Mailbox) {
    out.extend_from_slice(&mailbox.place().address.to_le_bytes());
    out.extend_from_slice(mailbox.used());
}

/// Appends a frame that is not a mailbox. Data beyond the size of a frame are truncated.
pub fn put(out: &mut Vec<u8>, address: u32, data: &[u8]) {
    let data = &data[..data.len().min(MAX_SIZE - HEAD)];
    let length = u16::try_from(HEAD + data.len()).unwrap_or(u16::MAX);
    out.extend_from_slice(&address.to_le_bytes());
    out.extend_from_slice(&length.to_le_bytes());
    out.extend_from_slice(&[0; HEAD - 2]);
    out.extend_from_slice(data);
}

pub fn put_pulse(out: &mut Vec<u8>, tick: u64) {
    put(out, PULSE, &tick.to_le_bytes());
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    #[error("a length of {HEAD} to {MAX_SIZE} was expected after the address {address:05X}, found {found}")]
    Length { address: u32, found: u16 },
    #[error("the number of a tick was expected in a pulse, 8 bytes, found {0}")]
    Pulse(usize),
    #[error("the address of {} was expected, found {found:05X}", names(.expected))]
    Address { expected: &'static [Place], found: u32 },
}

fn names(places: &[Place]) -> String {
    places.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mailbox::HWSC_COMMAND;

    fn pulse(tick: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        put_pulse(&mut bytes, tick);
        bytes
    }

    #[test]
    fn mailgram_follows_its_address() {
        let mut mailbox = Mailbox::initialized(HWSC_COMMAND);
        mailbox.write(&[7, 8, 9]).unwrap();
        let mut bytes = Vec::new();
        put_mailbox(&mut bytes, &mailbox);
        assert_eq!(bytes, [0x00, 0x60, 0x0F, 0, 11, 0, 1, 0, 0, 0, 0, 0, 7, 8, 9]);
        let mut again = Mailbox::initialized(HWSC_COMMAND);
        again.receive(Frame::first(&bytes).unwrap().unwrap().mailbox()).unwrap();
        assert_eq!(again, mailbox);
        for end in 0..bytes.len() {
            assert_eq!(Frame::first(&bytes[..end]), Ok(None), "{end} bytes");
        }
        bytes.push(0xA5);
        assert_eq!(Frame::first(&bytes).unwrap().unwrap().bytes().len(), bytes.len() - 1);
    }

    #[test]
    fn pulse_has_the_number_of_its_tick() {
        let bytes = pulse(0x0102);
        assert_eq!(bytes, [0, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0]);
        assert_eq!(Frame::first(&bytes).unwrap().unwrap().as_pulse(), Ok(Some(0x0102)));
        let mut other = Vec::new();
        put(&mut other, DISCONNECT, b"12345678");
        assert_eq!(Frame::first(&other).unwrap().unwrap().as_pulse(), Ok(None));
        let mut short = Vec::new();
        put(&mut short, PULSE, &[1; 5]);
        let error = Frame::first(&short).unwrap().unwrap().as_pulse().unwrap_err();
        assert_eq!(error.to_string(), "the number of a tick was expected in a pulse, 8 bytes, found 5");
    }

    #[test]
    fn data_are_truncated_to_the_size_of_a_frame() {
        let mut bytes = Vec::new();
        put(&mut bytes, DISCONNECT, &[b'x'; MAX_SIZE]);
        let frame = Frame::first(&bytes).unwrap().unwrap();
        assert_eq!(
            (bytes.len(), frame.bytes().len(), frame.data().len()),
            (MAX_FRAME, MAX_FRAME, MAX_SIZE - HEAD)
        );
    }

    #[test]
    fn impossible_length_is_refused_at_once() {
        for (low, high, found) in [(7, 0, 7), (1, 16, 4097)] {
            let error = Frame::first(&[0, 0x60, 0x0F, 0, low, high]).unwrap_err();
            let text = format!("a length of 8 to 4096 was expected after the address F6000, found {found}");
            assert_eq!(error.to_string(), text);
        }
    }
}
