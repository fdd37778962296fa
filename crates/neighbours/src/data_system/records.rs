//! Items and clients that a server keeps.

use std::fmt::Display;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    pub number: String, // `ITEM_NBR`, or empty
    pub name: String,   // `ITEM_NAME`
    pub kind: String,
    pub device: String,
    pub position: String,
    pub sector: u8, // at the storage position; 0: none
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LastStatement<'a> {
    pub number: u16, // trans-id#; 0: none
    pub statement: &'a str,
}

/// The records of a server, in a database or in memory ([`Books`](super::Books)).
pub trait Records {
    type Error: Display; // of reading or writing

    /// 0 for an unknown client.
    fn session(&self, client: &str) -> Result<u8, Self::Error>;

    fn set_session(&mut self, client: &str, session: u8) -> Result<(), Self::Error>;

    /// Stores a position reported by a client; true if it is new. A statement with a number other than 0 is executed
    /// only once, even if other clients have reported meanwhile. After an error the records are unchanged.
    fn report(&mut self, client: &str, said: LastStatement<'_>, item: &Item) -> Result<bool, Self::Error>;

    fn items(&self) -> Result<Vec<Item>, Self::Error>; // sorted by name and number
}
