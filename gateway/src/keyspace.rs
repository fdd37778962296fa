//! The keys of a cell. Everything is under `rcs/CELL`; ROLE is a role of the run, NAME the common name of a
//! certificate, and CLAIM 32 random hexadecimal digits.
//!
//! | key | contents |
//! |---|---|
//! | `open/ROLE/NAME` | queryable: asked with a CLAIM; answers the clock, or a refusal |
//! | `ROLE/NAME/CLAIM/in`, `…/out` | samples to and from the run |
//! | `ROLE/NAME/CLAIM/alive` | liveliness token of the neighbour |
//! | `alive/ZID` | liveliness token of the gateway: claims end when it does |
//! | `status/run` | JSON, five times a second, and queryable |
//! | `status/mailbox/F6200` … | image of a mailbox whenever it changes |

use std::fmt::{self, Write as _};

use neighbours::line::Role;

use crate::address::Name;

pub const ANY: &str = "*"; // stands for any cell, claim or gateway in a key of the access control

#[derive(Clone, Debug)]
pub struct CellKeys(String);

impl CellKeys {
    /// The keys of the cell with this name, or of [`ANY`].
    #[must_use]
    pub fn of(cell: &str) -> Self {
        Self(format!("rcs/{cell}"))
    }

    /// Where a certificate asks for a claim.
    #[must_use]
    pub fn open(&self, role: Role, name: &Name) -> String {
        format!("{}/open/{role}/{name}", self.0)
    }

    /// The keys of a claim, or of [`ANY`].
    #[must_use]
    pub fn claim(&self, role: Role, name: &Name, claim: &str) -> ClaimKeys {
        ClaimKeys(format!("{}/{role}/{name}/{claim}", self.0))
    }

    /// Token of a gateway, or of [`ANY`].
    #[must_use]
    pub fn alive(&self, gateway: &str) -> String {
        format!("{}/alive/{gateway}", self.0)
    }

    #[must_use]
    pub fn run(&self) -> String {
        format!("{}/status/run", self.0)
    }

    #[must_use]
    pub fn mailbox(&self, address: u32) -> String {
        format!("{}/status/mailbox/{address:05X}", self.0)
    }

    /// All that monitors read.
    #[must_use]
    pub fn status(&self) -> String {
        format!("{}/status/**", self.0)
    }
}

#[derive(Clone, Debug)]
pub struct ClaimKeys(String);

impl ClaimKeys {
    /// Samples to the run.
    #[must_use]
    pub fn inward(&self) -> String {
        format!("{}/in", self.0)
    }

    /// Samples from the run.
    #[must_use]
    pub fn outward(&self) -> String {
        format!("{}/out", self.0)
    }

    #[must_use]
    pub fn alive(&self) -> String {
        format!("{}/alive", self.0)
    }
}

const CLAIM: usize = 16; // number of random bytes in a claim

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClaimId(String);

/// 32 random hexadecimal digits: 128 bits. Fails if the system has no random bytes.
pub fn random_digits() -> Result<String, getrandom::Error> {
    let mut random = [0; CLAIM];
    getrandom::fill(&mut random)?;
    Ok(random.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

impl ClaimId {
    /// A new claim. Fails if the system has no random bytes.
    pub fn random() -> Result<Self, getrandom::Error> {
        random_digits().map(Self)
    }

    /// A received claim; `None` if it is not one. It becomes a part of keys.
    #[must_use]
    pub fn received(bytes: &[u8]) -> Option<Self> {
        let legal = |byte: &u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(byte);
        let text = std::str::from_utf8(bytes).ok()?;
        (bytes.len() == CLAIM * 2 && bytes.iter().all(legal)).then(|| Self(text.to_owned()))
    }

    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for ClaimId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_32_hexadecimal_digits_are_a_claim() {
        let claim = ClaimId::random().unwrap();
        assert_eq!(ClaimId::received(claim.as_str().as_bytes()), Some(claim.clone()));
        assert_ne!(ClaimId::random().unwrap(), claim);
        for wrong in
            ["", "**", "0123456789abcdef0123456789abcdeF", "0123456789abcdef0123456789abcde/", "0123"]
        {
            assert_eq!(ClaimId::received(wrong.as_bytes()), None, "{wrong}");
        }
    }

    #[test]
    fn keys_are_those_of_the_page() {
        let (cell, name) = (CellKeys::of("t3"), "hwsc-1".parse().unwrap());
        assert_eq!(cell.open(Role::Workstation, &name), "rcs/t3/open/workstation/hwsc-1");
        let claim = cell.claim(Role::DataSystem, &name, "c");
        assert_eq!(claim.inward(), "rcs/t3/data-system/hwsc-1/c/in");
        assert_eq!(claim.outward(), "rcs/t3/data-system/hwsc-1/c/out");
        assert_eq!(claim.alive(), "rcs/t3/data-system/hwsc-1/c/alive");
        assert_eq!(cell.mailbox(0xF6200), "rcs/t3/status/mailbox/F6200");
    }
}
