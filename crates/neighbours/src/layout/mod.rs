//! Layouts of mailbox data (V.4.2, VI.7.2, IX.4): one definition gives encoding, decoding and the table in
//! docs/neighbours.md.
//!
//! [`layout!`](crate::layout!) lists the fields in their order: the manual's variable, where its value is in
//! a Rust record, how it is coded, and what it holds. Offsets follow from the sizes. Integers are low byte
//! first, behind a text stand blanks. Nothing here allocates but [`Table::markdown`].
//!
//! ```
//! use neighbours::layout::{Chars, I16, Unused};
//! use rcs_core::name::Name10;
//!
//! #[derive(Debug, Default, PartialEq)]
//! pub struct Order {
//!     pub part: Name10,
//!     pub angle: i32,
//! }
//! neighbours::layout! {
//!     /// An order.
//!     OrderLayout: Order = "an order";
//!     "part"   (part)   Chars<10>,  "blank for none";
//!     "spare"  ()       Unused<2>,  "not read";
//!     "angle"  (angle)  I16,        "0.1 degree";
//! }
//! let order = Order { part: Name10::clipped("BAR"), angle: -2 };
//! let bytes = OrderLayout::encode(&order);
//! assert_eq!(&bytes, b"BAR         \xFE\xFF");
//! assert_eq!(OrderLayout::decode(&bytes), Ok(order));
//! assert_eq!(OrderLayout::decode(b"BAR").unwrap_err().to_string(), "an order of 14 bytes was expected, found 3");
//! assert!(OrderLayout::TABLE.markdown().contains("| 12 | 2 | `angle` | 0.1 degree |"));
//! ```

mod codes;

use std::fmt::Write as _;

pub use codes::{
    Chars, Coded, Flag, Given, I16, I32, Number, Sentence, Spelled, Text, U16, U32, U64, Unused,
};

use crate::fields::FieldError;

/// Why the data of a mailbox cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    /// Another number of bytes.
    #[error("{what} of {expected} bytes was expected, found {found}")]
    Size {
        /// What was expected.
        what: &'static str,
        /// Its bytes.
        expected: usize,
        /// Bytes found.
        found: usize,
    },
    /// A field with a wrong value.
    #[error(transparent)]
    Field(#[from] FieldError),
}

/// A field in a page of documentation.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The manual's name.
    pub variable: &'static str,
    /// Its bytes.
    pub bytes: usize,
    /// What it holds.
    pub text: &'static str,
}

/// A layout in a page of documentation.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// What it is a layout of.
    pub what: &'static str,
    /// The fields.
    pub rows: &'static [Row],
}

impl Table {
    /// The table: where a field stands, its bytes, its variable, what it holds.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut page = "| at | bytes | variable | |\n|---|---|---|---|\n".to_owned();
        let mut at = 0;
        for Row { variable, bytes, text } in self.rows {
            // A text takes whatever is written.
            let _ = writeln!(page, "| {at} | {bytes} | `{variable}` | {text} |");
            at += bytes;
        }
        page
    }
}

/// Which field, for errors.
#[derive(Clone, Copy, Debug)]
pub struct At {
    /// The manual's name.
    pub field: &'static str,
    /// Its first byte in the data.
    pub byte: usize,
}

/// How many bytes a code has.
pub trait Width {
    /// Bytes.
    const BYTES: usize;
}

/// How a value is coded in [`Width::BYTES`] bytes.
pub trait Codec<'a, T>: Width {
    /// The value, if the bytes cannot hold it; then they hold the nearest value that they can.
    #[must_use]
    fn misfit(_value: &T) -> Option<i32> {
        None
    }

    /// Write the value.
    fn put(value: &T, to: &mut [u8]);

    /// Read a value.
    ///
    /// # Errors
    /// [`FieldError`] if the bytes are not a value.
    fn take(at: At, from: &'a [u8]) -> Result<T, FieldError>;
}

/// Define a layout: a type with `BYTES`, `TABLE`, `encode`, `decode` and `check`. See the
/// [module](mod@crate::layout).
///
/// A place is a path in parentheses; `()` for a field without a value; or `[get, set]`, two functions of the
/// record.
#[macro_export]
macro_rules! layout {
    (
        $(#[$meta:meta])*
        $name:ident: $type:ty = $what:literal;
        $( $variable:literal $place:tt $codec:ty, $text:expr; )+
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl $name {
            /// Bytes of the data.
            pub const BYTES: usize = 0 $( + <$codec as $crate::layout::Width>::BYTES )+;
            /// The layout as a table.
            pub const TABLE: $crate::layout::Table = $crate::layout::Table {
                what: $what,
                rows: &[ $( $crate::layout::Row {
                    variable: $variable,
                    bytes: <$codec as $crate::layout::Width>::BYTES,
                    text: $text,
                } ),+ ],
            };

            /// The bytes. A value that its field cannot hold becomes the nearest that it can.
            #[must_use]
            pub fn encode(record: &$type) -> [u8; Self::BYTES] {
                let mut bytes = [0; Self::BYTES];
                let rest = &mut bytes[..];
                $(
                    let (field, rest) = rest.split_at_mut(<$codec as $crate::layout::Width>::BYTES);
                    <$codec as $crate::layout::Codec<'_, _>>::put(&$crate::layout!(@get record, $type, $place), field);
                )+
                assert!(rest.is_empty(), "the fields fill the data");
                bytes
            }

            /// Refuse a value that its field cannot hold.
            ///
            /// # Errors
            /// [`RangeError`]($crate::fields::RangeError) for the first one.
            pub fn check(record: &$type) -> Result<(), $crate::fields::RangeError> {
                $(
                    let value = &$crate::layout!(@get record, $type, $place);
                    if let Some(found) = <$codec as $crate::layout::Codec<'_, _>>::misfit(value) {
                        return Err($crate::fields::RangeError { field: $variable, found });
                    }
                )+
                Ok(())
            }

            /// Read the bytes.
            ///
            /// # Errors
            /// [`LayoutError`]($crate::layout::LayoutError) for the size, or the first wrong field.
            pub fn decode(bytes: &[u8]) -> Result<$type, $crate::layout::LayoutError> {
                let mut record = <$type>::default();
                $crate::layout::sized($what, Self::BYTES, bytes)?;
                let (rest, at) = (bytes, 0);
                $(
                    let (field, rest) = rest.split_at(<$codec as $crate::layout::Width>::BYTES);
                    let value = <$codec as $crate::layout::Codec<'_, _>>::take(
                        $crate::layout::At { field: $variable, byte: at }, field)?;
                    $crate::layout!(@set record, $type, $place, value);
                    let at = at + field.len();
                )+
                assert!(rest.is_empty() && at == Self::BYTES, "the fields fill the data");
                Ok(record)
            }
        }
    };
    (@get $record:ident, $type:ty, ()) => { () };
    (@get $record:ident, $type:ty, ($($path:tt)+)) => { $record.$($path)+ };
    (@get $record:ident, $type:ty, [$get:expr, $set:expr]) => {{
        let get: fn(&$type) -> _ = $get;
        get($record)
    }};
    (@set $record:ident, $type:ty, (), $value:ident) => { let () = $value; };
    (@set $record:ident, $type:ty, ($($path:tt)+), $value:ident) => { $record.$($path)+ = $value; };
    (@set $record:ident, $type:ty, [$get:expr, $set:expr], $value:ident) => {{
        let set: fn(&mut $type, _) = $set;
        set(&mut $record, $value);
    }};
}

/// Refuse data of another size.
///
/// # Errors
/// [`LayoutError::Size`].
pub const fn sized(what: &'static str, expected: usize, bytes: &[u8]) -> Result<(), LayoutError> {
    if bytes.len() == expected {
        Ok(())
    } else {
        Err(LayoutError::Size { what, expected, found: bytes.len() })
    }
}
