//! The units in which a person reads and types lengths, speeds and forces.
//!
//! Data files, logs, sockets, JSON and texts have the manual's units (docs/design/units.md). [`shown`] converts
//! quantities when a text is printed: the reader chooses the units, and no file depends on the choice.

use std::{
    borrow::Cow,
    fmt,
    str::FromStr,
    sync::atomic::{AtomicBool, Ordering},
};

const MM: f64 = 25.4; // per inch
const NEWTON: f64 = 4.448_221_615_260_5;

static MILLIMETRES: AtomicBool = AtomicBool::new(false); // true for millimetres

/// The units in which a person reads and types quantities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// Inches, inches per second, pounds, as in the manual.
    #[default]
    Inches,
    /// Millimetres, millimetres per second, newtons.
    Millimetres,
}

impl Units {
    /// The words of `--units` and `RCS_UNITS`.
    pub const WORDS: [&'static str; 2] = ["in", "mm"];

    /// The units that this process shows.
    #[must_use]
    pub fn of_process() -> Self {
        if MILLIMETRES.load(Ordering::Relaxed) { Self::Millimetres } else { Self::Inches }
    }

    /// Sets the units that this process shows; a program does this once, before it reads other options.
    pub fn show(self) {
        MILLIMETRES.store(self == Self::Millimetres, Ordering::Relaxed);
    }

    /// Parses a length in these units, or its own (`38.1mm`), and returns inches. The error states the expected form.
    pub fn length(self, text: &str) -> Result<f64, String> {
        let wrong = || {
            let [inches, millimetres] = Self::WORDS;
            format!("a length was expected, such as 1.5{inches} or 38.1{millimetres}; found {text}")
        };
        let text = text.trim();
        let (number, units) = if let Some(number) = text.strip_suffix("mm") {
            (number, Self::Millimetres)
        } else if let Some(number) = text.strip_suffix("in") {
            (number, Self::Inches)
        } else {
            (text, self)
        };
        let value: f64 = number.trim_end().parse().map_err(|_| wrong())?;
        if !value.is_finite() {
            return Err(wrong());
        }
        Ok(if units == Self::Millimetres { value / MM } else { value })
    }

    /// The text with its quantities in these units.
    #[must_use]
    pub fn convert(self, text: &str) -> Cow<'_, str> {
        match self {
            Self::Inches => Cow::Borrowed(text),
            Self::Millimetres => in_millimetres(text),
        }
    }
}

impl FromStr for Units {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "in" => Ok(Self::Inches),
            "mm" => Ok(Self::Millimetres),
            _ => Err(format!("in or mm was expected, found {text}")),
        }
    }
}

impl fmt::Display for Units {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [inches, millimetres] = Self::WORDS;
        f.write_str(if *self == Self::Inches { inches } else { millimetres })
    }
}

/// The text with its quantities in the units of this process.
#[must_use]
pub fn shown(text: &str) -> Cow<'_, str> {
    Units::of_process().convert(text)
}

/// A unit after a number and a space in a text, with the unit shown for millimetres.
struct Unit {
    text: &'static str,
    other: &'static str,
    factor: f64,
    digits: isize, // in addition to those of the number in the manual's unit
    /// True if a number without a point is a quantity, too. "2 in the log" is none, because `in` is also a preposition.
    whole: bool,
}

/// Longer units first.
const UNITS: [Unit; 4] = [
    Unit { text: "in lb", other: "N m", factor: NEWTON * MM / 1000.0, digits: 1, whole: true },
    Unit { text: "in/s", other: "mm/s", factor: MM, digits: -1, whole: true },
    Unit { text: "in", other: "mm", factor: MM, digits: -1, whole: false },
    Unit { text: "lb", other: "N", factor: NEWTON, digits: -1, whole: true },
];

/// Words between two numbers that share the last one's unit: `(1.00, 2.00, 3.00 in)`, `3.0 x 1.5 in`.
const BETWEEN: [&str; 8] = ["", ",", "x", "to", "and", "or", "Y", "Z"];

struct Number {
    start: usize,
    end: usize,
    digits: Option<usize>, // after the point; `None` without one
}

/// The numbers that are separate words.
fn numbers(text: &str) -> Vec<Number> {
    let (bytes, mut found, mut at) = (text.as_bytes(), Vec::new(), 0);
    let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let word =
        |at: usize| bytes.get(at).is_some_and(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'.'));
    while at < bytes.len() {
        if !digit(at) {
            at += 1;
            continue;
        }
        let first = at;
        while digit(at) {
            at += 1;
        }
        let mut digits = None;
        if bytes.get(at) == Some(&b'.') && digit(at + 1) {
            let point = at;
            at += 1;
            while digit(at) {
                at += 1;
            }
            digits = Some(at - point - 1);
        }
        let before = |at: usize| at.checked_sub(1);
        // A sign belongs to the number, except where it joins number and word, as in UNIT-1.
        let sign = before(first).filter(|at| matches!(bytes[*at], b'-' | b'+'));
        let is_joined = |at: usize| before(at).is_some_and(|at| word(at) || bytes[at] == b'-');
        let start = sign.unwrap_or(first);
        let is_followed = word(at) && (bytes[at] != b'.' || digit(at + 1));
        if !is_joined(start) && !is_followed {
            found.push(Number { start, end: at, digits });
        }
        while word(at) {
            at += 1;
        }
    }
    found
}

fn unit_at(text: &str, at: usize) -> Option<&'static Unit> {
    let rest = text.get(at..)?.strip_prefix(' ')?;
    let is_end = |rest: &str| {
        !rest.starts_with(|next: char| next.is_alphanumeric() || matches!(next, '/' | '_' | '-'))
    };
    UNITS.iter().find(|unit| rest.strip_prefix(unit.text).is_some_and(is_end))
}

fn in_millimetres(text: &str) -> Cow<'_, str> {
    let numbers = numbers(text);
    let mut units: Vec<Option<&Unit>> = numbers.iter().map(|number| unit_at(text, number.end)).collect();
    for at in (0..numbers.len()).rev() {
        let Some(unit) = units[at] else { continue };
        // `0.01 in` is the unit of a number in the data, such as `250 in 0.01 in`.
        let is_scale = &text[numbers[at].start..numbers[at].end] == "0.01";
        if is_scale || (numbers[at].digits.is_none() && !unit.whole) {
            units[at] = None;
            continue;
        }
        // The preceding numbers that share its unit get as many digits.
        let Some(before) = at.checked_sub(1) else { continue };
        let between = text.get(numbers[before].end..numbers[at].start).unwrap_or_default();
        let is_listed = BETWEEN.contains(&between.trim_matches(' '));
        if units[before].is_none() && numbers[before].digits == numbers[at].digits && is_listed {
            units[before] = Some(unit);
        }
    }
    if units.iter().all(Option::is_none) {
        return Cow::Borrowed(text);
    }
    let (mut out, mut done) = (String::with_capacity(text.len() + 16), 0);
    for (number, unit) in numbers.iter().zip(units) {
        let Some(unit) = unit else { continue };
        let written = &text[number.start..number.end];
        let Ok(value) = written.parse::<f64>() else { continue };
        out.push_str(&text[done..number.start]);
        let digits = number.digits.unwrap_or(0).saturating_add_signed(unit.digits);
        let sign = if written.starts_with('+') { "+" } else { "" };
        let converted = format!("{sign}{:.digits$}", value * unit.factor + 0.0);
        // Columns keep their positions: a longer number replaces blanks before it, a shorter one adds blanks.
        for _ in written.len()..converted.len() {
            if out.ends_with("  ") {
                out.pop();
            }
        }
        if out.ends_with("  ") {
            out.extend(std::iter::repeat_n(' ', written.len().saturating_sub(converted.len())));
        }
        out.push_str(&converted);
        done = number.end;
        if unit_at(text, done).is_some() {
            out.push(' ');
            out.push_str(unit.other);
            done += 1 + unit.text.len();
        }
    }
    out.push_str(&text[done..]);
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mm(text: &str) -> String {
        Units::Millimetres.convert(text).into_owned()
    }

    #[test]
    fn quantities_are_converted_with_fitting_digits() {
        for (inches, millimetres) in [
            ("HOME is 2.50 in and 0.0 degrees away", "HOME is 63.5 mm and 0.0 degrees away"),
            ("1.23 in (-X 1.20, +Z 0.30 in)", "31.2 mm (-X 1.20, +Z 7.6 mm)"),
            ("passes pot_2 by 0.120 in at tick 3367", "passes pot_2 by 3.05 mm at tick 3367"),
            ("at (68.40, -43.51, -3.10 in)", "at (1737.4, -1105.2, -78.7 mm)"),
            ("(  32.85, -52.58,   4.00 in)", "(  834.4, -1335.5,  101.6 mm)"),
            ("3.0 x 1.5 x 1.0 in", "76 x 38 x 25 mm"),
            ("0.50 to 3.53 in wide", "12.7 to 89.7 mm wide"),
            ("14.0 in/s, limit 14 in/s", "356 mm/s, limit 356 mm/s"),
            ("opening 0.60 in, force 30 lb", "opening 15.2 mm, force 133 N"),
            ("20 and 22 lb", "89 and 98 N"),
            ("a moment of 12.0 in lb", "a moment of 1.36 N m"),
            ("X 0.00 Y -62.96 Z -6.35 in, D -90.00", "X 0.0 Y -1599.2 Z -161.3 mm, D -90.00"),
            ("a key moves +0.25 in.", "a key moves +6.3 mm."),
        ] {
            assert_eq!(mm(inches), millimetres);
            assert_eq!(Units::Inches.convert(inches), inches);
        }
    }

    #[test]
    fn other_numbers_and_the_preposition_remain() {
        for text in [
            "2 in the log",
            "238.9 s simulated in 0.4 s",
            "VII.7.2 in the manual",
            "version 1.2.3 in use",
            "UNIT-1 in tray 4",
            "robot-2.5 in the cell",
            "0.5 inside",
            "in 0.01 in",
            "0.01 in-process",
            "12 lbs",
            "4e2.5 in",
            "",
        ] {
            assert_eq!(mm(text), text);
        }
    }

    #[test]
    fn right_aligned_columns_keep_their_places() {
        assert_eq!(
            mm(" T1     12.50    -3.30     0.80 in  tray"),
            " T1     317.5    -83.8     20.3 mm  tray"
        );
        assert_eq!(mm(" 1  50.00 in"), " 1 1270.0 mm");
    }

    #[test]
    fn texts_in_both_units_agree_to_half_a_digit() {
        for hundredths in (-40_000..40_000).step_by(37) {
            let inches = f64::from(hundredths) / 100.0;
            for (text, unit, factor) in [
                (format!("{inches:.2} in"), " mm", MM),
                (format!("{inches:.3} in/s"), " mm/s", MM),
                (format!("{inches:.1} lb"), " N", NEWTON),
            ] {
                let written: f64 = text.split(' ').next().and_then(|number| number.parse().ok()).unwrap();
                let shown = mm(&text);
                let number = shown.strip_suffix(unit).unwrap_or_else(|| panic!("{text}: {shown}"));
                let digits = number.split_once('.').map_or(0, |(_, digits)| digits.len());
                let half = 0.5 / 10_f64.powi(i32::try_from(digits).unwrap());
                let off = (number.parse::<f64>().unwrap() - written * factor).abs();
                assert!(off <= half + 1e-9, "{text}: {shown}");
            }
        }
    }

    #[test]
    fn a_typed_length_has_the_units_of_the_person_or_its_own() {
        let (inches, millimetres) = (Units::Inches, Units::Millimetres);
        for (units, text, expected) in [
            (inches, "1.5", 1.5),
            (millimetres, "38.1", 1.5),
            (inches, "38.1mm", 1.5),
            (millimetres, "1.5in", 1.5),
            (millimetres, " -25.4 mm", -1.0),
        ] {
            let length = units.length(text).unwrap();
            assert!((length - expected).abs() < 1e-12, "{text}: {length}");
        }
        for wrong in ["", "mm", "1.5 cm", "NaN", "infinity", "one"] {
            assert!(inches.length(wrong).unwrap_err().starts_with("a length was expected"), "{wrong}");
        }
    }
}
