//! Commands and quantities as one says them.

use core::fmt;

use crate::name::Name;

/// Something that may have nothing to say.
pub(super) trait Word: fmt::Display {
    /// True if it has nothing to say.
    fn is_silent(&self) -> bool;
}

impl<const N: usize> Word for Name<N> {
    fn is_silent(&self) -> bool {
        self.is_empty()
    }
}

/// A location with the word before it and its sector; a sector of 0 is not said.
pub(super) struct LocationWords<'a, const N: usize>(pub &'static str, pub &'a Name<N>, pub i32);

impl<const N: usize> fmt::Display for LocationWords<'_, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(word, name, sector) = self;
        match sector {
            0 => write!(f, "{word} {name}"),
            _ => write!(f, "{word} {name} sector {sector}"),
        }
    }
}

impl<const N: usize> Word for LocationWords<'_, N> {
    fn is_silent(&self) -> bool {
        self.1.is_empty()
    }
}

/// A verb and what goes with it, with a blank between the words that have something to say.
pub(super) fn words(f: &mut fmt::Formatter<'_>, verb: &str, rest: &[&dyn Word]) -> fmt::Result {
    f.write_str(verb)?;
    for word in rest.iter().filter(|word| !word.is_silent()) {
        write!(f, " {word}")?;
    }
    Ok(())
}

/// Hundredths of an inch as inches.
pub(super) struct Inches(pub i32);

impl fmt::Display for Inches {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.2} in", crate::units::inches(self.0))
    }
}

/// Tenths of a degree as degrees.
pub(super) struct Degrees(pub i32);

impl fmt::Display for Degrees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} degrees", f64::from(self.0) / 10.0)
    }
}
