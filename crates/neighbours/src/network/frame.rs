//! A mailgram on the line.
//!
//! ```text
//!   byte  0           4        6            8           10           12 ...
//!         address     length   mailgram #   read lock   write lock   data
//!         32 bits     `----------- the mailbox, head and data ----------------'
//! ```
//!
//! All low byte first. The address is that of Table IX.1; `length` is that of the mailbox, from its own first byte to the last of
//! its data: a frame has 4 bytes more, and 16 of a [seal](super::seal) behind it where a secret was agreed upon. Three addresses
//! are no mailboxes:
//!
//! * 0, the **pulse**: its data are the number of a tick, 64 bits. The controller sends it behind the mailgrams of every tick, the
//!   neighbour sends it back behind his own.
//! * 1, **last words**: its data are a text; the controller closes the connection after it, and the text says why;
//! * 2, the **welcome**: its data are the controller's proof ([`hello`](super::hello)). It is the first frame, and has no seal.

use std::io::{self, Read};

use super::seal::{BrokenSeal, SealError};
use crate::mailbox::{HEAD, MAX_SIZE, Mailbox, Place};

/// Bytes in front of a mailbox.
pub const ADDRESS: usize = 4;
/// The address of a pulse.
pub const PULSE: u32 = 0;
/// The address of last words.
pub const LAST_WORDS: u32 = 1;
/// The address of a welcome.
pub const WELCOME: u32 = 2;
/// Bytes of a frame at most.
pub const MAX_FRAME: usize = ADDRESS + MAX_SIZE;

/// A frame, as bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    bytes: [u8; MAX_FRAME],
    length: usize,
}

impl Frame {
    fn new(address: u32, mailbox: &[u8]) -> Self {
        let mut frame = Self { bytes: [0; MAX_FRAME], length: ADDRESS + mailbox.len() };
        frame.bytes[..ADDRESS].copy_from_slice(&address.to_le_bytes());
        frame.bytes[ADDRESS..frame.length].copy_from_slice(mailbox);
        frame
    }

    /// What stands in a mailbox.
    #[must_use]
    pub fn of(mailbox: &Mailbox) -> Self {
        Self::new(mailbox.place().address, mailbox.used())
    }

    /// A frame that is no mailbox's.
    fn other(address: u32, data: &[u8]) -> Self {
        let data = &data[..data.len().min(MAX_SIZE - HEAD)];
        let mut used = [0; MAX_SIZE];
        let length = HEAD + data.len();
        used[..2].copy_from_slice(&u16::try_from(length).unwrap_or(u16::MAX).to_le_bytes());
        used[HEAD..length].copy_from_slice(data);
        Self::new(address, &used[..length])
    }

    /// The pulse of a tick.
    #[must_use]
    pub fn pulse(tick: u64) -> Self {
        Self::other(PULSE, &tick.to_le_bytes())
    }

    /// Why the connection ends.
    #[must_use]
    pub fn last_words(text: &str) -> Self {
        Self::other(LAST_WORDS, text.as_bytes())
    }

    /// The neighbour is let in, by whoever can prove that he may.
    #[must_use]
    pub fn welcome(proof: &[u8]) -> Self {
        Self::other(WELCOME, proof)
    }

    /// All bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }

    /// Whose it is.
    #[must_use]
    pub fn address(&self) -> u32 {
        u32::from_le_bytes([self.bytes[0], self.bytes[1], self.bytes[2], self.bytes[3]])
    }

    /// The mailbox, head and data.
    #[must_use]
    pub fn mailbox(&self) -> &[u8] {
        &self.bytes[ADDRESS..self.length]
    }

    /// The data.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        &self.bytes[ADDRESS + HEAD..self.length]
    }

    /// The tick of a pulse; `None` if it is none.
    ///
    /// # Errors
    /// [`FrameError::Pulse`] if its data are no number of a tick.
    pub fn as_pulse(&self) -> Result<Option<u64>, FrameError> {
        if self.address() != PULSE {
            return Ok(None);
        }
        let number = self.data().try_into().map_err(|_| FrameError::Pulse(self.data().len()))?;
        Ok(Some(u64::from_le_bytes(number)))
    }

    /// Read a frame from bytes that hold one and nothing else.
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn from_bytes(mut bytes: &[u8]) -> Result<Self, FrameError> {
        let frame = Self::read(&mut bytes)?;
        if bytes.is_empty() { Ok(frame) } else { Err(FrameError::Rest(bytes.len())) }
    }

    /// Read the next frame of a stream.
    ///
    /// # Errors
    /// [`FrameError`]. After one no frame can be found any more.
    pub fn read(stream: &mut impl Read) -> Result<Self, FrameError> {
        let mut head = [0; ADDRESS + 2];
        stream.read_exact(&mut head)?;
        let [a, b, c, d, low, high] = head;
        let (address, found) = (u32::from_le_bytes([a, b, c, d]), u16::from_le_bytes([low, high]));
        let length = usize::from(found);
        if !(HEAD..=MAX_SIZE).contains(&length) {
            return Err(FrameError::Length { address, found });
        }
        let mut frame = Self { bytes: [0; MAX_FRAME], length: ADDRESS + length };
        frame.bytes[..head.len()].copy_from_slice(&head);
        stream.read_exact(&mut frame.bytes[head.len()..ADDRESS + length])?;
        Ok(frame)
    }
}

/// Why bytes are no frame.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The stream ends, or fails.
    #[error(transparent)]
    Stream(#[from] io::Error),
    /// A length that no mailbox has.
    #[error("a length of {HEAD} to {MAX_SIZE} was expected behind the address {address:05X}, found {found}")]
    Length {
        /// In front of it.
        address: u32,
        /// The length.
        found: u16,
    },
    /// A pulse without the number of a tick.
    #[error("the number of a tick was expected in a pulse, 8 bytes, found {0}")]
    Pulse(usize),
    /// An address that is none of the sender's mailboxes.
    #[error("the address of {} was expected, found {found:05X}", names(.expected))]
    Address {
        /// The sender's mailboxes.
        expected: &'static [Place],
        /// The address.
        found: u32,
    },
    /// It does not come from whom it should.
    #[error(transparent)]
    Seal(#[from] BrokenSeal),
    /// Frames in front of it are lost.
    #[error(transparent)]
    Number(#[from] SealError),
    /// It was published under the key of another address.
    #[error("a frame of {expected:05X} was expected under this key, found one of {found:05X}")]
    Key {
        /// The address that has the key.
        expected: u32,
        /// That of the frame.
        found: u32,
    },
    /// Bytes behind the frame.
    #[error("nothing was expected behind the frame, found {0} bytes")]
    Rest(usize),
}

fn names(places: &[Place]) -> String {
    places.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mailbox::HWSC_COMMAND;

    #[test]
    fn a_mailgram_stands_behind_its_address() {
        let mut mailbox = Mailbox::initialized(HWSC_COMMAND);
        mailbox.write(&[7, 8, 9]).unwrap();
        let frame = Frame::of(&mailbox);
        assert_eq!(frame.bytes(), [0x00, 0x60, 0x0F, 0, 11, 0, 1, 0, 0, 0, 0, 0, 7, 8, 9]);
        let mut again = Mailbox::initialized(HWSC_COMMAND);
        again.receive(Frame::from_bytes(frame.bytes()).unwrap().mailbox()).unwrap();
        assert_eq!(again, mailbox);
    }

    #[test]
    fn a_pulse_has_the_number_of_its_tick() {
        let frame = Frame::pulse(0x0102);
        assert_eq!(frame.bytes(), [0, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0]);
        assert_eq!(frame.as_pulse().unwrap(), Some(0x0102));
        assert_eq!(Frame::last_words("12345678").as_pulse().unwrap(), None);
        let short = Frame::other(PULSE, &[1; 5]).as_pulse().unwrap_err();
        assert_eq!(short.to_string(), "the number of a tick was expected in a pulse, 8 bytes, found 5");
    }

    #[test]
    fn last_words_are_cut_to_what_a_frame_holds() {
        let frame = Frame::last_words(&"x".repeat(MAX_SIZE));
        assert_eq!((frame.bytes().len(), frame.data().len()), (MAX_FRAME, MAX_SIZE - HEAD));
    }

    #[test]
    fn what_is_no_frame_is_said() {
        let said = |bytes: &[u8]| Frame::from_bytes(bytes).unwrap_err().to_string();
        assert!(said(&[0, 0x60]).contains("fill"), "{}", said(&[0, 0x60]));
        let length = said(&[0, 0x60, 0x0F, 0, 7, 0]);
        assert_eq!(length, "a length of 8 to 4096 was expected behind the address F6000, found 7");
        assert_eq!(
            said(&[Frame::pulse(1).bytes(), &[0]].concat()),
            "nothing was expected behind the frame, found 1 bytes"
        );
    }
}
