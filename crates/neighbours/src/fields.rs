//! Errors of fields of mailbox data, and command numbers.

use std::fmt;

use rcs_core::name::Name16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldError {
    End {
        field: &'static str, // in the manual's words
    },
    Character {
        field: &'static str, // in the manual's words
        at: usize,           // byte in the data
        found: u8,
    },
    Word {
        field: &'static str, // in the manual's words
        found: Name16,
    },
    Expected {
        field: &'static str, // in the manual's words
        expected: &'static str,
        found: u16,
    },
    Infinite {
        field: &'static str, // in the manual's words
    },
    Code {
        field: &'static str, // in the manual's words
        found: u16,
    },
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::End { field } => write!(f, "the data end before {field} does"),
            Self::Character { field, at, found } => {
                write!(
                    f,
                    "printable characters and blanks after them were expected for {field}, found {found:02X} at byte {at}"
                )
            }
            Self::Word { field, found } => write!(f, "{found} is not a word of {field}"),
            Self::Expected { field, expected, found } => {
                write!(f, "{expected} was expected for {field}, found {found}")
            }
            Self::Infinite { field } => write!(f, "a finite number was expected for {field}"),
            Self::Code { field, found } => write!(f, "{found} is not a code of {field}"),
        }
    }
}

impl std::error::Error for FieldError {}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("an integer of two bytes was expected for {field}, found {found}")]
pub struct RangeError {
    pub field: &'static str, // in the manual's words
    pub found: i32,
}

/// Reduces the controller's four bytes to the manual's two. 1 follows 65535, because 0 means no command.
#[must_use]
pub fn command_number(number: u32) -> u16 {
    let wrapped = number.checked_sub(1).map_or(0, |before| before % u32::from(u16::MAX) + 1);
    u16::try_from(wrapped).unwrap_or_default()
}

#[must_use]
pub fn successor(number: u16) -> u16 {
    number.checked_add(1).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_numbers_wrap_around_without_zero() {
        let numbers = [0, 1, 65_535, 65_536, 131_070, 131_071].map(command_number);
        assert_eq!(numbers, [0, 1, 65_535, 1, 65_535, 1]);
        assert_eq!([1, 65_535].map(successor), [2, 1]);
    }
}
