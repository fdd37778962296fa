//! The seal of a frame: who knows the secret has sent it, in this connection, and as the one that comes next.
//!
//! 16 bytes behind the frame: the first half of the HMAC-SHA256, with the key of the connection and direction
//! ([`Agreement`](super::hello::Agreement)), of the frame's number (64 bits, low byte first, from 1) and its bytes. The number
//! does not travel: a frame that is left out, repeated or moved has the wrong one.
//!
//! Where anybody can put in a frame of his own (publish and subscribe) the number does travel: otherwise nobody could tell a
//! stranger's frame, which changes nothing, from one of the other side behind a gap.

use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::Sha256;

/// Bytes behind a frame.
pub const SEAL: usize = 16;

/// Seals, or breaks the seals of, one direction of a connection.
#[derive(Clone)]
pub struct Seal {
    key: Hmac<Sha256>,
    /// Frames so far.
    frames: u64,
}

/// A frame that is not from the other side, or not the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the seal of frame {0} is wrong: it was forged, damaged, or is not the next")]
pub struct BrokenSeal(pub u64);

/// What is wrong with a frame that carries its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SealError {
    /// Somebody else has sent it.
    #[error("its seal is wrong")]
    Forged,
    /// It is one that has come already.
    #[error("it repeats frame {0}")]
    Repeated(u64),
    /// Those in front of it are lost.
    #[error("frame {expected} was expected, found {found}: some were lost")]
    Gap {
        /// The next.
        expected: u64,
        /// Its number.
        found: u64,
    },
}

impl Seal {
    /// With a key of its own.
    ///
    /// # Panics
    /// Never: a key of any length will do.
    #[must_use]
    pub fn new(key: [u8; 32]) -> Self {
        let key = Hmac::<Sha256>::new_from_slice(&key).expect("any length will do");
        Self { key, frames: 0 }
    }

    /// The seal of the next frame.
    #[must_use]
    pub fn close(&mut self, frame: &[u8]) -> [u8; SEAL] {
        let mac = self.next(frame).finalize().into_bytes();
        *mac.first_chunk().expect("it is longer")
    }

    /// Look at the seal of the next frame.
    ///
    /// # Errors
    /// [`BrokenSeal`].
    pub fn open(&mut self, frame: &[u8], seal: &[u8; SEAL]) -> Result<(), BrokenSeal> {
        let mac = self.next(frame);
        mac.verify_truncated_left(seal).map_err(|_| BrokenSeal(self.frames))
    }

    /// Number and seal of the next frame.
    #[must_use]
    pub fn close_numbered(&mut self, frame: &[u8]) -> (u64, [u8; SEAL]) {
        let seal = self.close(frame);
        (self.frames, seal)
    }

    /// Look at the seal of a frame with a number. One that is not taken leaves everything as it was.
    ///
    /// # Errors
    /// [`SealError`].
    pub fn open_numbered(&mut self, number: u64, frame: &[u8], seal: &[u8; SEAL]) -> Result<(), SealError> {
        // Only whom the seal proves is asked for the order: a stranger must not make a gap.
        self.mac(number, frame).verify_truncated_left(seal).map_err(|_| SealError::Forged)?;
        if number <= self.frames {
            return Err(SealError::Repeated(number));
        }
        let expected = self.frames.wrapping_add(1);
        if number != expected {
            return Err(SealError::Gap { expected, found: number });
        }
        self.frames = number;
        Ok(())
    }

    fn next(&mut self, frame: &[u8]) -> Hmac<Sha256> {
        // 64 bits: a connection does not live to see the end of them.
        self.frames = self.frames.wrapping_add(1);
        self.mac(self.frames, frame)
    }

    fn mac(&self, number: u64, frame: &[u8]) -> Hmac<Sha256> {
        let mut mac = self.key.clone();
        mac.update(&number.to_le_bytes());
        mac.update(frame);
        mac
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::frame::Frame;

    const KEY: [u8; 32] = [
        0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27,
        28, 29, 30, 31,
    ];

    /// The same with the tools of another language: `hmac.new(key, number + frame, "sha256")` of Python.
    #[test]
    fn a_seal_is_hmac_sha256() {
        let seal = Seal::new(KEY).close(Frame::pulse(0x0102).bytes());
        let hex: String = seal.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hex, "c16c8dc4af28af6c592cfc9573a054e4");
    }

    #[test]
    fn only_the_next_frame_of_the_other_side_is_taken() {
        let (mut theirs, mut other) = (Seal::new(KEY), Seal::new([7; 32]));
        let (first, second) = (Frame::pulse(1), Frame::pulse(2));
        let seals = [theirs.close(first.bytes()), theirs.close(second.bytes())];
        let ours = Seal::new(KEY);
        assert_eq!(ours.clone().open(first.bytes(), &seals[0]), Ok(()));
        assert_eq!(ours.clone().open(second.bytes(), &seals[1]), Err(BrokenSeal(1)), "one is left out");
        assert_eq!(ours.clone().open(second.bytes(), &seals[0]), Err(BrokenSeal(1)), "another frame");
        assert_eq!(ours.clone().open(first.bytes(), &other.close(first.bytes())), Err(BrokenSeal(1)));
        let mut reader = ours;
        reader.open(first.bytes(), &seals[0]).unwrap();
        assert_eq!(reader.clone().open(first.bytes(), &seals[0]), Err(BrokenSeal(2)), "it comes twice");
        reader.open(second.bytes(), &seals[1]).unwrap();
    }
    #[test]
    fn a_frame_that_carries_its_number_tells_a_gap_from_a_stranger() {
        let (mut theirs, mut ours) = (Seal::new(KEY), Seal::new(KEY));
        let frames: Vec<_> = (1..=3).map(Frame::pulse).collect();
        let sealed: Vec<_> = frames.iter().map(|frame| theirs.close_numbered(frame.bytes())).collect();
        let mut open =
            |at: usize, number, frame: &Frame| ours.open_numbered(number, frame.bytes(), &sealed[at].1);
        assert_eq!(open(0, 9, &frames[0]), Err(SealError::Forged), "a number is sealed too");
        assert_eq!(open(0, 1, &frames[1]), Err(SealError::Forged));
        assert_eq!(open(0, 1, &frames[0]), Ok(()));
        assert_eq!(open(0, 1, &frames[0]), Err(SealError::Repeated(1)));
        assert_eq!(open(2, 3, &frames[2]), Err(SealError::Gap { expected: 2, found: 3 }));
        assert_eq!(open(1, 2, &frames[1]), Ok(()), "what was refused has changed nothing");
    }
}
