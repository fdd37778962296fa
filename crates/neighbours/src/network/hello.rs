//! How a connection begins: who is there, and do both know the secret?
//!
//! ```text
//!   controller -> neighbour   52 43 53 32  "RCS2"
//!                             02 00        version
//!                             cc 00        clock: 0 the 40 ms grid, 1 fast
//!                             32 bytes     random
//!   neighbour -> controller   52 43 53 32  "RCS2"
//!                             rr 00        who: the number of a [`Role`]
//!                             00 00
//!                             32 bytes     random
//!                             32 bytes     proof
//!   controller -> neighbour   a frame with the address [`WELCOME`](super::frame::WELCOME): 32 bytes, proof
//! ```
//!
//! Both proofs are HMAC-SHA256 with the secret as key: of a word, `neighbour` or `controller`, and the 80 bytes in front of the
//! first proof. Neither side gets anything from a stranger that it would take: the secret does not travel, the random bytes of
//! both are new each time, and the words tell the sides apart. The keys by which the frames that follow are sealed
//! ([`Seal`]) come from the same 80 bytes with the words `down` (from the controller) and `up`. Where no secret was agreed upon,
//! proofs are zeros and frames have no seal. Nothing is encrypted.
//!
//! Who is refused hears why by last words in the place of the welcome.

use std::{
    fs, io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
};

use hmac::{Hmac, KeyInit as _, Mac as _};
use os_io::files;
use sha2::Sha256;

use super::{Role, seal::Seal};

/// Bytes of the controller's hello.
pub const HELLO: usize = 40;
/// Bytes of the neighbour's.
pub const ANSWER: usize = HELLO + PROOF;
/// Bytes of a proof.
pub const PROOF: usize = 32;
/// Bytes in front of random bytes.
const FRONT: usize = 8;
/// What both begin with.
const MARK: &[u8; 4] = b"RCS2";
/// Of the line.
pub const VERSION: u16 = 2;
/// Bytes that a secret must have.
const MIN_SECRET: usize = 16;
/// Bytes that its file may have.
const LARGEST_SECRET: u64 = 4096;

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
        let bytes = files::read(file, LARGEST_SECRET).map_err(failed)?;
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
    /// The controller does not know it.
    #[error("the controller does not know the secret: somebody else answers in its place")]
    Impostor,
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

    /// The answer of a neighbour, and what follows from it.
    ///
    /// # Errors
    /// If the system has no random bytes.
    pub fn answer(
        &self,
        role: Role,
        secret: Option<&Secret>,
    ) -> io::Result<([u8; ANSWER], Option<Agreement>)> {
        let mut hello = front(role as u16, 0);
        getrandom::fill(&mut hello[FRONT..]).map_err(io::Error::other)?;
        let agreement = secret.map(|secret| Agreement::new(secret, &self.0, &hello));
        let mut bytes = [0; ANSWER];
        bytes[..HELLO].copy_from_slice(&hello);
        if let Some(agreement) = &agreement {
            bytes[HELLO..].copy_from_slice(&agreement.mac(b"neighbour").finalize().into_bytes());
        }
        Ok((bytes, agreement))
    }

    /// Who answers, and what follows from it.
    ///
    /// # Errors
    /// [`HelloError`] if it is nobody who may.
    pub fn judge(
        &self,
        answer: &[u8; ANSWER],
        secret: Option<&Secret>,
    ) -> Result<(Role, Option<Agreement>), HelloError> {
        let (hello, proof) = answer.split_first_chunk().expect("an answer is longer than a hello");
        let (number, _) = words(hello)?;
        let agreement = secret.map(|secret| Agreement::new(secret, &self.0, hello));
        if !is_proven(agreement.as_ref(), b"neighbour", proof) {
            return Err(HelloError::Proof);
        }
        let role = Role::from_number(number).ok_or(HelloError::Role(number))?;
        Ok((role, agreement))
    }
}

/// What two who know the secret have in common in one connection.
pub struct Agreement {
    /// The secret and what both have said.
    base: Hmac<Sha256>,
}

impl Agreement {
    fn new(secret: &Secret, controller: &[u8; HELLO], neighbour: &[u8; HELLO]) -> Self {
        let mut base = Hmac::<Sha256>::new_from_slice(&secret.0).expect("any length will do");
        base.update(controller);
        base.update(neighbour);
        Self { base }
    }

    fn mac(&self, word: &[u8]) -> Hmac<Sha256> {
        let mut mac = self.base.clone();
        mac.update(word);
        mac
    }

    fn seal(&self, word: &[u8]) -> Seal {
        Seal::new(self.mac(word).finalize().into_bytes().into())
    }

    /// Of frames from the controller.
    #[must_use]
    pub fn down(&self) -> Seal {
        self.seal(b"down")
    }

    /// Of frames to the controller.
    #[must_use]
    pub fn up(&self) -> Seal {
        self.seal(b"up")
    }
}

/// The controller's proof.
#[must_use]
pub fn welcome(agreement: Option<&Agreement>) -> [u8; PROOF] {
    agreement.map_or([0; PROOF], |agreement| agreement.mac(b"controller").finalize().into_bytes().into())
}

/// Whether it is the controller that welcomes.
///
/// # Errors
/// [`HelloError::Impostor`].
pub fn check_welcome(proof: &[u8], agreement: Option<&Agreement>) -> Result<(), HelloError> {
    if is_proven(agreement, b"controller", proof) { Ok(()) } else { Err(HelloError::Impostor) }
}

/// Compared in a time that does not depend on the bytes.
fn is_proven(agreement: Option<&Agreement>, word: &[u8], proof: &[u8]) -> bool {
    agreement.map_or_else(|| proof == [0; PROOF], |agreement| agreement.mac(word).verify_slice(proof).is_ok())
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

    fn judged(
        challenge: &Challenge,
        answer: &[u8; ANSWER],
        secret: Option<&Secret>,
    ) -> Result<Role, HelloError> {
        challenge.judge(answer, secret).map(|(role, _)| role)
    }

    #[test]
    fn only_who_knows_the_secret_is_let_in() {
        let challenge = Challenge::new(ClockKind::Real).unwrap();
        let (ours, other) = (secret("correct horse battery"), secret("incorrect horse battery"));
        let (answer, _) = challenge.answer(Role::Workstation, Some(&ours)).unwrap();
        assert_eq!(judged(&challenge, &answer, Some(&ours)), Ok(Role::Workstation));
        assert_eq!(judged(&challenge, &answer, Some(&other)), Err(HelloError::Proof));
        assert_eq!(judged(&challenge, &answer, None), Err(HelloError::Proof));
        let (bare, _) = challenge.answer(Role::Workstation, None).unwrap();
        assert_eq!(judged(&challenge, &bare, Some(&ours)), Err(HelloError::Proof));
        assert_eq!(judged(&challenge, &bare, None), Ok(Role::Workstation));
        let later = Challenge::new(ClockKind::Real).unwrap();
        let overheard = judged(&later, &answer, Some(&ours));
        assert_eq!(overheard, Err(HelloError::Proof), "an overheard answer is worth nothing");
        let mut posing = answer;
        posing[4] = 2;
        let posing = judged(&challenge, &posing, Some(&ours));
        assert_eq!(posing, Err(HelloError::Proof), "who is proven too");
    }

    #[test]
    fn only_the_controller_is_believed() {
        let challenge = Challenge::new(ClockKind::Real).unwrap();
        let (ours, other) = (secret("correct horse battery"), secret("incorrect horse battery"));
        let (answer, theirs) = challenge.answer(Role::Workstation, Some(&ours)).unwrap();
        let (_, agreement) = challenge.judge(&answer, Some(&ours)).unwrap();
        let welcome = welcome(agreement.as_ref());
        assert_eq!(check_welcome(&welcome, theirs.as_ref()), Ok(()));
        assert_eq!(check_welcome(&[0; PROOF], theirs.as_ref()), Err(HelloError::Impostor));
        assert_eq!(check_welcome(&answer[HELLO..], theirs.as_ref()), Err(HelloError::Impostor), "echoed");
        let (_, guessed) = challenge.answer(Role::Workstation, Some(&other)).unwrap();
        assert_eq!(check_welcome(&welcome, guessed.as_ref()), Err(HelloError::Impostor));
        assert_eq!(check_welcome(&welcome, None), Err(HelloError::Impostor));
        assert_eq!(check_welcome(&[0; PROOF], None), Ok(()));
    }

    /// The same with the tools of another language: `hmac.new(key, hellos + word, "sha256")` of Python.
    #[test]
    fn proofs_are_hmac_sha256() {
        let agreement = Agreement::new(
            &secret("correct horse battery"),
            b"RCS2\x02\x00\x00\x000123456789abcdef0123456789abcdef",
            b"RCS2\x01\x00\x00\x00fedcba9876543210fedcba9876543210",
        );
        let hex = |word: &[u8]| -> String {
            agreement.mac(word).finalize().into_bytes().iter().map(|byte| format!("{byte:02x}")).collect()
        };
        assert_eq!(hex(b"neighbour"), "9bc62a856b40a30e3fe988c93876d8aca34a9d59f1ebf94469fcaa0d604b8b93");
        assert_eq!(hex(b"controller"), "6db0330c0c926ed383dc8d8af4ca9e46e50d7d2f6c813c0917e1cfb3a68b8e81");
    }

    #[test]
    fn what_is_no_hello_is_said() {
        let challenge = Challenge::new(ClockKind::Fast).unwrap();
        assert_eq!(challenge.clock(), ClockKind::Fast);
        let mut bytes = *challenge.bytes();
        bytes[4] = 9;
        assert_eq!(Challenge::from_bytes(bytes), Err(HelloError::Version(9)));
        let mut browser = [b' '; ANSWER];
        browser[..16].copy_from_slice(b"GET / HTTP/1.1\r\n");
        assert_eq!(judged(&challenge, &browser, None), Err(HelloError::Mark(*b"GET ")));
        let (mut nobody, _) = challenge.answer(Role::Workstation, None).unwrap();
        nobody[4] = 77;
        assert_eq!(judged(&challenge, &nobody, None), Err(HelloError::Role(77)));
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
