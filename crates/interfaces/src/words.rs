//! Commands and quantities as text.

use core::fmt;

use geometry::units::Length;
use rcs_core::name::Name;

pub(super) fn name<const N: usize>(f: &mut fmt::Formatter<'_>, name: Option<&Name<N>>) -> fmt::Result {
    name.map_or(Ok(()), |name| write!(f, " {name}"))
}

/// A location of a command with its preposition and sector, if it has them.
pub(super) fn location<const N: usize>(
    f: &mut fmt::Formatter<'_>,
    word: &str,
    name: Option<&Name<N>>,
    sector: Option<i32>,
) -> fmt::Result {
    match (name, sector) {
        (None, _) => Ok(()),
        (Some(name), None) => write!(f, " {word} {name}"),
        (Some(name), Some(sector)) => write!(f, " {word} {name} sector {sector}"),
    }
}

/// Hundredths of an inch as inches.
pub(super) struct Inches(pub i32);

impl fmt::Display for Inches {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Length(geometry::units::inches(self.0)).fmt(f)
    }
}

/// Tenths of a degree as degrees.
pub(super) struct Degrees(pub i32);

impl fmt::Display for Degrees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} degrees", f64::from(self.0) / 10.0)
    }
}
