//! What is wrong in a file of TOML: each mistake with its entry, its place in the text, and what would be right.

use std::fmt;

/// Something that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Stable short name of its kind: `cell.syntax`, `cell.key`, `cell.missing`, `cell.value`, `cell.name`, and the same
    /// with `fault` for a file of faults.
    pub code: &'static str,
    /// The way to the entry: `gripper.parts.body[0]`; lists count from 0.
    pub entry: String,
    /// One sentence: what was expected, what was found.
    pub message: String,
    /// What was expected.
    pub expected: Option<String>,
    /// What was found.
    pub found: Option<String>,
    /// The nearest known key or name.
    pub nearest: Option<String>,
    /// Where it stands; `None` if the entries do not come from a text.
    pub place: Option<TextSpan>,
}

/// A piece of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextSpan {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// First byte.
    pub start: usize,
    /// Number of bytes.
    pub length: usize,
}

impl Mistake {
    /// One that its sentence says it all of.
    pub(crate) fn new(code: &'static str, entry: &str, message: String) -> Self {
        let entry = entry.to_owned();
        Self { code, entry, message, expected: None, found: None, nearest: None, place: None }
    }

    /// Something else was found than was expected.
    pub(crate) fn unlike(
        code: &'static str,
        entry: &str,
        expected: impl fmt::Display,
        found: impl fmt::Display,
    ) -> Self {
        let (expected, found) = (expected.to_string(), found.to_string());
        let message = format!("{entry}: expected {expected}, found {found}");
        let (expected, found) = (Some(expected), Some(found));
        Self { expected, found, ..Self::new(code, entry, message) }
    }

    /// The same with the nearest of the known names.
    pub(crate) fn near(self, wanted: &str, known: &[&str]) -> Self {
        Self { nearest: nearest(wanted, known).map(str::to_owned), ..self }
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "line {}, column {}: ", place.line, place.column)?;
        }
        f.write_str(&self.message)?;
        self.nearest.as_ref().map_or(Ok(()), |nearest| write!(f, " (the nearest is {nearest})"))
    }
}

impl TextSpan {
    /// Where some bytes of a text stand. What goes over several lines is underlined in the first.
    pub(crate) fn of(text: &str, start: usize, end: usize) -> Self {
        let start = (0..=start.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        Self {
            line: before.matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            start,
            length: end.clamp(start, line_end) - start,
        }
    }
}

/// All mistakes in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistakes(pub(crate) Vec<Mistake>);

impl Mistakes {
    /// The mistakes in the order of the text, if there is one.
    #[must_use]
    pub fn all(&self) -> &[Mistake] {
        &self.0
    }
}

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, mistake) in self.0.iter().enumerate() {
            let separator = if number == 0 { "" } else { "; " };
            write!(f, "{separator}{mistake}")?;
        }
        Ok(())
    }
}

/// The known name that differs least from `wanted`, if it is near enough to be a slip of the pen.
pub(crate) fn nearest<'a>(wanted: &str, known: &[&'a str]) -> Option<&'a str> {
    let limit = (wanted.chars().count() / 3).max(1);
    let distance = |name: &&str| strsim::osa_distance(&wanted.to_lowercase(), &name.to_lowercase());
    let near = known.iter().map(|name| (distance(name), *name)).filter(|(far, _)| *far <= limit);
    near.min_by_key(|(far, _)| *far).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_counted_in_lines_and_characters_and_ends_with_its_line() {
        let text = "a = 1\nb = \"é\" # x\nc = 3\n";
        let at = text.find('#').unwrap();
        let place = TextSpan::of(text, at, text.len());
        assert_eq!((place.line, place.column, place.start, place.length), (2, 9, at, 3));
        let end = TextSpan::of(text, 400, 500);
        assert_eq!((end.line, end.column, end.length), (4, 1, 0));
    }

    #[test]
    fn a_slip_of_the_pen_is_recognised() {
        let known = ["servo_lag_s", "stiffness", "start"];
        assert_eq!(nearest("servo_lags", &known), Some("servo_lag_s"));
        assert_eq!(nearest("Stat", &known), Some("start"));
        assert_eq!(nearest("weight", &known), None);
    }
}
