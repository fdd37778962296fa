//! A frame among publishers.
//!
//! ```text
//!   byte 0         8 ...
//!        number    frame, as on a socket   seal, 16 bytes
//!        64 bits
//! ```
//!
//! The number counts the frames of a connection and direction from 1, low byte first.

use super::super::{
    frame::{Frame, FrameError},
    seal::{SEAL, Seal, SealError},
};

/// Bytes of the number.
const NUMBER: usize = 8;

/// What is wrong with an envelope.
#[derive(Debug, thiserror::Error)]
pub enum EnvelopeError {
    /// A stranger has sent it: it is too short for number and seal.
    #[error("{least} bytes or more were expected, found {0}", least = NUMBER + SEAL)]
    Short(usize),
    /// A stranger has sent it, or somebody repeats what was sent.
    #[error(transparent)]
    Strange(SealError),
    /// The other side has sent it: the connection is not whole any more.
    #[error(transparent)]
    Broken(#[from] FrameError),
}

/// Put the next frame into an envelope.
#[must_use]
pub fn close(seal: &mut Seal, frame: &Frame) -> Vec<u8> {
    let (number, end) = seal.close_numbered(frame.bytes());
    [number.to_le_bytes().as_slice(), frame.bytes(), &end].concat()
}

/// Take a frame out of the envelope that was under the key of an address.
///
/// # Errors
/// [`EnvelopeError`].
pub fn open(seal: &mut Seal, address: u32, bytes: &[u8]) -> Result<Frame, EnvelopeError> {
    let short = EnvelopeError::Short(bytes.len());
    let Some((number, rest)) = bytes.split_first_chunk::<NUMBER>() else { return Err(short) };
    let Some((frame, end)) = rest.split_last_chunk::<SEAL>() else { return Err(short) };
    seal.open_numbered(u64::from_le_bytes(*number), frame, end).map_err(|error| match error {
        SealError::Gap { .. } => EnvelopeError::Broken(error.into()),
        strange => EnvelopeError::Strange(strange),
    })?;
    let frame = Frame::from_bytes(frame)?;
    if frame.address() == address {
        Ok(frame)
    } else {
        // Who may write there need not be allowed to write here.
        Err(FrameError::Key { expected: address, found: frame.address() }.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::frame::PULSE;

    const KEY: [u8; 32] = [7; 32];

    const fn is_broken(error: &EnvelopeError) -> bool {
        matches!(error, EnvelopeError::Broken(_))
    }

    #[test]
    fn a_frame_comes_out_of_its_envelope_once() {
        let (mut theirs, mut ours) = (Seal::new(KEY), Seal::new(KEY));
        let frame = Frame::pulse(0x0102);
        let bytes = close(&mut theirs, &frame);
        assert_eq!(bytes[..NUMBER], [1, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(bytes[NUMBER..bytes.len() - SEAL], *frame.bytes());
        assert_eq!(open(&mut ours, PULSE, &bytes).unwrap(), frame);
        let again = open(&mut ours, PULSE, &bytes).unwrap_err();
        assert_eq!((again.to_string().as_str(), is_broken(&again)), ("it repeats frame 1", false));
    }

    #[test]
    fn every_byte_is_sealed() {
        let mut theirs = Seal::new(KEY);
        let bytes = close(&mut theirs, &Frame::last_words("the run is over"));
        for at in 0..bytes.len() {
            let mut other = bytes.clone();
            other[at] ^= 1;
            let error = open(&mut Seal::new(KEY), 1, &other).unwrap_err();
            assert!(matches!(error, EnvelopeError::Strange(SealError::Forged)), "byte {at}");
        }
        for length in 0..bytes.len() {
            assert!(!is_broken(&open(&mut Seal::new(KEY), 1, &bytes[..length]).unwrap_err()), "{length}");
        }
    }

    #[test]
    fn a_frame_stands_under_its_own_key() {
        let bytes = close(&mut Seal::new(KEY), &Frame::pulse(1));
        let error = open(&mut Seal::new(KEY), 0xF6000, &bytes).unwrap_err();
        assert_eq!(error.to_string(), "a frame of F6000 was expected under this key, found one of 00000");
        assert!(is_broken(&error));
    }

    #[test]
    fn a_lost_frame_is_noticed() {
        let mut theirs = Seal::new(KEY);
        let [_lost, second] = [1, 2].map(|tick| close(&mut theirs, &Frame::pulse(tick)));
        let gap = open(&mut Seal::new(KEY), PULSE, &second).unwrap_err();
        assert_eq!(gap.to_string(), "frame 1 was expected, found 2: some were lost");
        assert!(is_broken(&gap));
    }
}
