//! A sample: all mailboxes of one direction, the last pulse, and at the end of a claim its reason. The bytes are the
//! frames of docs/neighbours.md "On the line".
//!
//! A sample is a state, not a change, so the next sample replaces a lost one.

use neighbours::{
    line::frame::{self, DISCONNECT, Frame, FrameError},
    mailbox::{Mailbox, MailboxError, Place},
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    places: &'static [Place], // their places, in the order of their role
    mailboxes: Vec<Mailbox>,
    pub pulse: Option<u64>, // number of the last pulse; `None` before the first
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SampleError {
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error(transparent)]
    Mailbox(#[from] MailboxError),
    #[error("expected a whole frame, found {0} bytes of one")]
    Rest(usize),
}

impl State {
    /// Initialized mailboxes.
    #[must_use]
    pub fn initialized(places: &'static [Place]) -> Self {
        Self {
            places,
            mailboxes: places.iter().map(|&place| Mailbox::initialized(place)).collect(),
            pulse: None,
        }
    }

    #[must_use]
    pub fn mailboxes(&self) -> &[Mailbox] {
        &self.mailboxes
    }

    /// Store a mailbox. Fails if its bytes do not fit the mailbox, or the mailbox has the other direction.
    pub fn receive(&mut self, address: u32, used: &[u8]) -> Result<(), SampleError> {
        let mailbox = self.mailboxes.iter_mut().find(|mailbox| mailbox.place().address == address);
        let mailbox = mailbox.ok_or(FrameError::Address { expected: self.places, found: address })?;
        Ok(mailbox.receive(used)?)
    }

    #[must_use]
    pub fn encode(&self, end: Option<&str>) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.mailboxes.iter().for_each(|mailbox| frame::put_mailbox(&mut bytes, mailbox));
        if let Some(pulse) = self.pulse {
            frame::put_pulse(&mut bytes, pulse);
        }
        if let Some(reason) = end {
            frame::put(&mut bytes, DISCONNECT, reason.as_bytes());
        }
        bytes
    }

    /// Returns the reason of the end, if the claim ends. After an error the state may have changed in part.
    pub fn decode(&mut self, mut bytes: &[u8]) -> Result<Option<String>, SampleError> {
        let mut end = None;
        while !bytes.is_empty() {
            let frame = Frame::first(bytes)?.ok_or(SampleError::Rest(bytes.len()))?;
            if let Some(pulse) = frame.as_pulse()? {
                self.pulse = Some(pulse);
            } else if frame.address() == DISCONNECT {
                end = Some(plain(frame.data()));
            } else {
                self.receive(frame.address(), frame.mailbox())?;
            }
            bytes = &bytes[frame.bytes().len()..];
        }
        Ok(end)
    }
}

/// A received text without control characters, which a terminal would execute.
#[must_use]
pub fn plain(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace(char::is_control, "?")
}

#[cfg(test)]
mod tests {
    use super::*;
    use neighbours::{line::Role, mailbox::HWSC_COMMAND};

    fn example() -> State {
        let mut state = State::initialized(Role::Workstation.to_controller());
        state.mailboxes[0].write(b"PAUSE").unwrap();
        state.pulse = Some(7);
        state
    }

    #[test]
    fn sample_restores_all_mailboxes_the_pulse_and_the_end() {
        let sent = example();
        let mut found = State::initialized(Role::Workstation.to_controller());
        assert_eq!(found.decode(&sent.encode(None)), Ok(None));
        assert_eq!(found, sent);
        assert_eq!(found.decode(&sent.encode(Some("over\n"))), Ok(Some("over?".to_owned())));
        assert_eq!(found, sent);
    }

    #[test]
    fn mailboxes_of_the_other_direction_are_refused() {
        let mut state = State::initialized(Role::Workstation.from_controller());
        let error = state.decode(&example().encode(None)).unwrap_err();
        let expected = FrameError::Address {
            expected: Role::Workstation.from_controller(),
            found: HWSC_COMMAND.address,
        };
        assert_eq!(error, SampleError::Frame(expected));
    }

    #[test]
    fn damaged_samples_are_errors() {
        let bytes = example().encode(None);
        let mut state = State::initialized(Role::Workstation.to_controller());
        let whole = [0, 17, 29, 49];
        for end in 0..bytes.len() {
            let result = state.decode(&bytes[..end]);
            assert!(whole.contains(&end) == result.is_ok(), "{end} bytes: {result:?}");
        }
        for at in 0..bytes.len() {
            let mut wrong = bytes.clone();
            wrong[at] ^= 0xFF;
            // Decoding must not panic. A sample with a changed byte in its data is still valid.
            let _ = state.decode(&wrong);
        }
    }
}
