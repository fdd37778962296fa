//! The records of items and clients that a server keeps, in memory or in a database.

use std::fmt::Display;

/// An item in the database.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// `ITEM_NBR`; empty for an item without a number.
    pub number: String,
    /// `ITEM_NAME`.
    pub name: String,
    /// `ITEM_TYPE`.
    pub kind: String,
    pub device: String,
    /// `STORAGE_POS`.
    pub position: String,
    /// Number of the sector at the storage position; 0 for none.
    pub sector: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Said<'a> {
    /// trans-id#: 0 for a statement without a number.
    pub number: u16,
    pub statement: &'a str,
}

/// The records that a server keeps: in a database, or in memory ([`Books`](super::Books)).
pub trait Records {
    /// Error of reading or writing the records.
    type Error: Display;

    /// State of a client's connection; 0 for an unknown client. Fails if the records cannot be read.
    fn session(&self, client: &str) -> Result<u8, Self::Error>;

    /// Set the state of a client's connection. Fails if the records cannot be written.
    fn set_session(&mut self, client: &str, session: u8) -> Result<(), Self::Error>;

    /// Store the position of an item reported by a client. Returns true if the position is new.
    ///
    /// A statement with a number other than 0 is executed once. Repeated with the same number it changes nothing, even
    /// after reports of other clients. Fails if the records cannot be written; they are then unchanged.
    fn report(&mut self, client: &str, said: Said<'_>, item: &Item) -> Result<bool, Self::Error>;

    /// All items, sorted by name and number. Fails if the records cannot be read.
    fn items(&self) -> Result<Vec<Item>, Self::Error>;
}
