//! The keys of a station.
//!
//! | key | what is under it | from |
//! |---|---|---|
//! | `rcs2/t3/F6000` | a mailbox, by its address in Table IX.1 | whoever writes it |
//! | `rcs2/t3/workstation/pulse` | pulses | controller |
//! | `rcs2/t3/workstation/answer` | pulses that come back | neighbour |
//! | `rcs2/t3/workstation/last-words` | why the connection ends | controller |
//! | `rcs2/t3/workstation/hello` | the queryable at which a connection begins | controller |
//! | `rcs2/t3/workstation/here/ID` | liveliness token of a connection | neighbour |
//! | `rcs2/t3/controller/here/ID` | the same | controller |
//! | `rcs2/t3/controller/run` | liveliness token of the run | controller |
//!
//! `t3` is the name of the station, `workstation` that of a [`Role`].

use std::fmt::Write as _;

use super::super::{
    Role,
    frame::{LAST_WORDS, PULSE},
    hello::ANSWER,
    station::Station,
};

/// Bytes of the neighbour's hello that name a connection: random ones.
const ID: std::ops::Range<usize> = 8..16;

/// The keys of a station.
#[derive(Clone, Debug)]
pub struct Keys(String);

impl Keys {
    /// Of a station.
    #[must_use]
    pub fn new(station: &Station) -> Self {
        Self(format!("rcs2/{}", station.name()))
    }

    /// Where a frame with an address is published: by the controller (`down`), or by the neighbour.
    #[must_use]
    pub fn of(&self, role: Role, down: bool, address: u32) -> String {
        match (address, down) {
            (PULSE, true) => format!("{}/{role}/pulse", self.0),
            (PULSE, false) => format!("{}/{role}/answer", self.0),
            (LAST_WORDS, _) => format!("{}/{role}/last-words", self.0),
            (address, _) => format!("{}/{address:05X}", self.0),
        }
    }

    /// Where a connection begins.
    #[must_use]
    pub fn hello(&self, role: Role) -> String {
        format!("{}/{role}/hello", self.0)
    }

    /// The neighbour is there, in a connection; `*` for any.
    #[must_use]
    pub fn neighbour_here(&self, role: Role, id: &str) -> String {
        format!("{}/{role}/here/{id}", self.0)
    }

    /// The controller is there, in a connection.
    #[must_use]
    pub fn controller_here(&self, id: &str) -> String {
        format!("{}/controller/here/{id}", self.0)
    }

    /// A run is there.
    #[must_use]
    pub fn run(&self) -> String {
        format!("{}/controller/run", self.0)
    }
}

/// The name of a connection, from the hello of the neighbour.
#[must_use]
pub fn id(answer: &[u8; ANSWER]) -> String {
    answer[ID].iter().fold(String::new(), |mut id, byte| {
        // A text takes whatever is written.
        let _ = write!(id, "{byte:02x}");
        id
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mailbox::HWSC_COMMAND;

    #[test]
    fn a_mailbox_has_the_key_of_its_address() {
        let keys = Keys::new(&"t3".parse().unwrap());
        assert_eq!(keys.of(Role::Workstation, false, HWSC_COMMAND.address), "rcs2/t3/F6000");
        assert_eq!(keys.of(Role::DataSystem, true, PULSE), "rcs2/t3/data-system/pulse");
        assert_eq!(keys.of(Role::DataSystem, false, PULSE), "rcs2/t3/data-system/answer");
    }

    #[test]
    fn a_connection_has_a_name_of_random_bytes() {
        let mut answer = [0; ANSWER];
        answer[8..16].copy_from_slice(&[0xA5, 1, 2, 3, 4, 5, 6, 0xFF]);
        assert_eq!(id(&answer), "a5010203040506ff");
    }
}
