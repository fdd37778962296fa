//! The seal of a frame: who knows the secret has sent it, in this connection, and as the one that comes next.
//!
//! 16 bytes behind the frame: the first half of the HMAC-SHA256, with the key of the connection and direction
//! ([`Agreement`](super::hello::Agreement)), of the frame's number (64 bits, low byte first, from 1) and its bytes. The number
//! does not travel: a frame that is left out, repeated or moved has the wrong one.

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

    fn next(&mut self, frame: &[u8]) -> Hmac<Sha256> {
        // 64 bits: a connection does not live to see the end of them.
        self.frames = self.frames.wrapping_add(1);
        let mut mac = self.key.clone();
        mac.update(&self.frames.to_le_bytes());
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
}
