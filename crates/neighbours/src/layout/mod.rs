//! Layouts of mailbox data (V.4.2, VI.7.2, IX.4): one definition for encoding, decoding and the table in
//! docs/neighbours.md. [`layout!`](crate::layout!) lists the fields in order: the manual's variable, the place of its
//! value in a Rust record, its code, and its meaning. Integers are low byte first; texts are padded with blanks. Only
//! [`Table::markdown`] allocates.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    #[error("{what} of {expected} bytes was expected, found {found}")]
    Size { what: &'static str, expected: usize, found: usize },
    #[error(transparent)]
    Field(#[from] FieldError),
}

#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub variable: &'static str, // the manual's name
    pub bytes: usize,           // bytes of the field
    pub text: &'static str,
}

#[derive(Clone, Copy, Debug)]
pub struct Table {
    pub what: &'static str,
    pub rows: &'static [Row],
}

impl Table {
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut page = "| at | bytes | variable | |\n|---|---|---|---|\n".to_owned();
        let mut at = 0;
        for Row { variable, bytes, text } in self.rows {
            // Writing to a `String` cannot fail.
            let _ = writeln!(page, "| {at} | {bytes} | `{variable}` | {text} |");
            at += bytes;
        }
        page
    }
}

#[derive(Clone, Copy, Debug)]
pub struct At {
    pub field: &'static str, // the manual's name
    pub byte: usize,         // byte in the data
}

pub trait Width {
    const BYTES: usize;
}

pub trait Codec<'a, T>: Width {
    /// A value out of range; [`Codec::put`] then writes the nearest one in range.
    #[must_use]
    fn misfit(_value: &T) -> Option<i32> {
        None
    }

    fn put(value: &T, to: &mut [u8]);

    fn take(at: At, from: &'a [u8]) -> Result<T, FieldError>;
}

/// Defines a type with `BYTES`, `TABLE`, `encode`, `decode` and `check`; see the [module](mod@crate::layout). The
/// place of a value is a path in parentheses, `()` for none, or `[get, set]`, two functions of the record.
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
            pub const BYTES: usize = 0 $( + <$codec as $crate::layout::Width>::BYTES )+; // of the data
            pub const TABLE: $crate::layout::Table = $crate::layout::Table {
                what: $what,
                rows: &[ $( $crate::layout::Row {
                    variable: $variable,
                    bytes: <$codec as $crate::layout::Width>::BYTES,
                    text: $text,
                } ),+ ],
            };

            /// A value that does not fit becomes the nearest value that fits.
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

            /// The error names the first value that does not fit its field.
            pub fn check(record: &$type) -> Result<(), $crate::fields::RangeError> {
                $(
                    let value = &$crate::layout!(@get record, $type, $place);
                    if let Some(found) = <$codec as $crate::layout::Codec<'_, _>>::misfit(value) {
                        return Err($crate::fields::RangeError { field: $variable, found });
                    }
                )+
                Ok(())
            }

            /// Fails if the size is wrong, or a field is invalid.
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

/// Checks the size. Errors: [`LayoutError::Size`].
pub const fn sized(what: &'static str, expected: usize, bytes: &[u8]) -> Result<(), LayoutError> {
    if bytes.len() == expected {
        Ok(())
    } else {
        Err(LayoutError::Size { what, expected, found: bytes.len() })
    }
}
