//! How a connection begins: who is there, and does he know the secret?
//!
//! ```text
//!   controller -> neighbour   52 43 53 32  "RCS2"      neighbour -> controller   52 43 53 32  "RCS2"
//!                             01 00        version                              rr 00        who: 1 workstation, 2 Data System
//!                             cc 00        clock: 0 the 40 ms grid, 1 fast      00 00
//!                             32 bytes     random                               32 bytes     proof
//! ```
//!
//! The proof is the HMAC-SHA256, with the secret as its key, of all 40 bytes of the controller and the first 8 of the neighbour; zeros
//! where no secret was agreed upon. The secret does not travel, and an answer that was overheard opens nothing: the random
//! bytes are new each time. What follows is not encrypted; on a network that others can listen to TLS has to do that.
//!
//! The controller answers by its first mailgrams, or by last words.

use std::{
    fs, io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
};

use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::Sha256;

use super::Role;

/// Bytes of either side.
pub const HELLO: usize = 40;
/// Bytes in front of random bytes or proof.
const FRONT: usize = 8;
/// What both begin with.
const MARK: &[u8; 4] = b"RCS2";
/// Of the line.
pub const VERSION: u16 = 1;
/// Bytes that a secret must have.
const MIN_SECRET: usize = 16;

/// What controller and neighbours know and nobody else.
#[derive(Clone)]
pub struct Secret(Vec<u8>);

/// Why a secret cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SecretError {
    /// It cannot be read.
    #[error("the secret {} cannot be read: {source}", .file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is guessed too easily.
    #[error("a secret of at least {MIN_SECRET} bytes was expected in {}, found {found}", .file.display())]
    Short {
        /// The file.
        file: PathBuf,
        /// Its bytes.
        found: usize,
    },
    /// It is none.
    #[error("the secret {} can be read by others than its owner: chmod 600", .file.display())]
    Public {
        /// The file.
        file: PathBuf,
    },
}

impl Secret {
    /// The secret in a file, without the blanks and ends of lines at its end.
    ///
    /// # Errors
    /// [`SecretError`].
    pub fn load(file: &Path) -> Result<Self, SecretError> {
        let failed = |source| SecretError::Read { file: file.to_owned(), source };
        let bytes = fs::read(file).map_err(failed)?;
        if fs::metadata(file).map_err(failed)?.mode() & 0o077 != 0 {
            return Err(SecretError::Public { file: file.to_owned() });
        }
        let secret = bytes.trim_ascii_end();
        if secret.len() < MIN_SECRET {
            return Err(SecretError::Short { file: file.to_owned(), found: secret.len() });
        }
        Ok(Self(secret.to_vec()))
    }
}

/// Which clock the controller has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum ClockKind {
    /// A tick every 40 ms: nobody is waited for.
    Real = 0,
    /// Ticks at once: every neighbour is waited for.
    Fast = 1,
}

/// The controller's hello.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Challenge([u8; HELLO]);

/// Why a hello is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HelloError {
    /// It is no hello.
    #[error("a hello was expected, found {0:02X?}")]
    Mark([u8; 4]),
    /// Another version of the line.
    #[error("version {VERSION} of the line was expected, found {0}")]
    Version(u16),
    /// Nobody.
    #[error("the number of a neighbour was expected, found {0}")]
    Role(u16),
    /// He does not know the secret.
    #[error("the proof of the secret is wrong")]
    Proof,
}

impl Challenge {
    /// A new one.
    ///
    /// # Errors
    /// If the system has no random bytes.
    pub fn new(clock: ClockKind) -> io::Result<Self> {
        let mut bytes = front(VERSION, clock as u16);
        getrandom::fill(&mut bytes[FRONT..]).map_err(io::Error::other)?;
        Ok(Self(bytes))
    }

    /// Its bytes.
    #[must_use]
    pub const fn bytes(&self) -> &[u8; HELLO] {
        &self.0
    }

    /// As the neighbour reads it.
    ///
    /// # Errors
    /// [`HelloError`] if it is none, or not for us.
    pub fn from_bytes(bytes: [u8; HELLO]) -> Result<Self, HelloError> {
        let (version, _) = words(&bytes)?;
        if version == VERSION { Ok(Self(bytes)) } else { Err(HelloError::Version(version)) }
    }

    /// The clock of the controller.
    #[must_use]
    pub const fn clock(&self) -> ClockKind {
        if self.0[6] == 0 { ClockKind::Real } else { ClockKind::Fast }
    }

    /// The answer of a neighbour.
    #[must_use]
    pub fn answer(&self, role: Role, secret: Option<&Secret>) -> [u8; HELLO] {
        let mut bytes = front(role as u16, 0);
        if let Some(mac) = self.proof(&bytes, secret) {
            bytes[FRONT..].copy_from_slice(&mac.finalize().into_bytes());
        }
        bytes
    }

    /// Who answers.
    ///
    /// # Errors
    /// [`HelloError`] if it is nobody who may.
    pub fn judge(&self, answer: &[u8; HELLO], secret: Option<&Secret>) -> Result<Role, HelloError> {
        let (number, _) = words(answer)?;
        // Compared in a time that does not depend on the bytes.
        let proven = match self.proof(answer, secret) {
            Some(mac) => mac.verify_slice(&answer[FRONT..]).is_ok(),
            None => answer[FRONT..] == [0; HELLO - FRONT],
        };
        if !proven {
            return Err(HelloError::Proof);
        }
        Role::from_number(number).ok_or(HelloError::Role(number))
    }

    fn proof(&self, answer: &[u8; HELLO], secret: Option<&Secret>) -> Option<Hmac<Sha256>> {
        let mut mac = Hmac::<Sha256>::new_from_slice(&secret?.0).ok()?;
        mac.update(&self.0);
        mac.update(&answer[..FRONT]);
        Some(mac)
    }
}

fn front(first: u16, second: u16) -> [u8; HELLO] {
    let mut bytes = [0; HELLO];
    bytes[..4].copy_from_slice(MARK);
    bytes[4..6].copy_from_slice(&first.to_le_bytes());
    bytes[6..8].copy_from_slice(&second.to_le_bytes());
    bytes
}

fn words(bytes: &[u8; HELLO]) -> Result<(u16, u16), HelloError> {
    let [a, b, c, d, e, f, g, h, ..] = *bytes;
    if [a, b, c, d] != *MARK {
        return Err(HelloError::Mark([a, b, c, d]));
    }
    Ok((u16::from_le_bytes([e, f]), u16::from_le_bytes([g, h])))
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    fn secret(text: &str) -> Secret {
        Secret(text.as_bytes().to_vec())
    }

    #[test]
    fn only_who_knows_the_secret_is_let_in() {
        let challenge = Challenge::new(ClockKind::Real).unwrap();
        let (ours, other) = (secret("correct horse battery"), secret("incorrect horse battery"));
        let answer = challenge.answer(Role::Workstation, Some(&ours));
        assert_eq!(challenge.judge(&answer, Some(&ours)), Ok(Role::Workstation));
        assert_eq!(challenge.judge(&answer, Some(&other)), Err(HelloError::Proof));
        assert_eq!(challenge.judge(&answer, None), Err(HelloError::Proof));
        let bare = challenge.answer(Role::Workstation, None);
        assert_eq!(challenge.judge(&bare, Some(&ours)), Err(HelloError::Proof));
        assert_eq!(challenge.judge(&bare, None), Ok(Role::Workstation));
        let later = Challenge::new(ClockKind::Real).unwrap();
        assert_eq!(
            later.judge(&answer, Some(&ours)),
            Err(HelloError::Proof),
            "an overheard answer is worth nothing"
        );
        let mut posing = answer;
        posing[4] = 2;
        assert_eq!(challenge.judge(&posing, Some(&ours)), Err(HelloError::Proof), "who is proven too");
    }

    /// The same with the tools of another language: `hmac.new(key, challenge + front, "sha256")` of Python.
    #[test]
    fn the_proof_is_hmac_sha256() {
        let challenge = Challenge(*b"RCS2\x01\x00\x00\x000123456789abcdef0123456789abcdef");
        let answer = challenge.answer(Role::Workstation, Some(&secret("correct horse battery")));
        let hex: String = answer[FRONT..].iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hex, "4274f0fbe94181232c8d897b4735c999b02d9e02e0c9ada7bd4667393aa931c9");
    }

    #[test]
    fn what_is_no_hello_is_said() {
        let challenge = Challenge::new(ClockKind::Fast).unwrap();
        assert_eq!(challenge.clock(), ClockKind::Fast);
        let mut bytes = *challenge.bytes();
        bytes[4] = 9;
        assert_eq!(Challenge::from_bytes(bytes), Err(HelloError::Version(9)));
        assert_eq!(
            challenge.judge(b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n         ", None),
            Err(HelloError::Mark(*b"GET "))
        );
        let mut nobody = challenge.answer(Role::Workstation, None);
        nobody[4] = 77;
        assert_eq!(challenge.judge(&nobody, None), Err(HelloError::Role(77)));
    }

    #[test]
    fn a_secret_is_long_enough_and_the_owners_alone() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("secret");
        fs::write(&file, "correct horse battery\n").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o644)).unwrap();
        assert!(matches!(Secret::load(&file), Err(SecretError::Public { .. })));
        fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
        assert_eq!(Secret::load(&file).unwrap().0, b"correct horse battery");
        fs::write(&file, "short\n").unwrap();
        assert!(matches!(Secret::load(&file), Err(SecretError::Short { found: 5, .. })));
        assert!(matches!(Secret::load(place.path()), Err(SecretError::Read { .. })));
    }
}
