//! The only conversions between the manual's integers, inches and radians (docs/design/units.md "Manual").

use core::{f64::consts::PI, fmt};

const PER_INCH: f64 = 100.0;
const PER_HALF_TURN: f64 = 18_000.0;

/// Inches from hundredths of an inch.
#[must_use]
#[inline]
pub fn inches(hundredths: i32) -> f64 {
    f64::from(hundredths) / PER_INCH
}

/// Hundredths of an inch from inches, rounded to the nearest (halves away from zero), saturating.
#[must_use]
#[inline]
pub fn hundredths(inches: f64) -> i32 {
    rounded(inches * PER_INCH)
}

/// Radians from hundredths of a degree.
#[must_use]
#[inline]
pub fn radians(hundredths_of_degree: i32) -> f64 {
    f64::from(hundredths_of_degree) * (PI / PER_HALF_TURN)
}

/// Hundredths of a degree from radians, rounded to the nearest, saturating.
#[must_use]
#[inline]
pub fn hundredths_of_degree(radians: f64) -> i32 {
    rounded(radians * (PER_HALF_TURN / PI))
}

/// A length as text with its unit, `2.50 in`: two digits, or the format's precision. The decimal point marks lengths
/// for conversion (docs/design/units.md "Text").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length(
    /// Inches.
    pub f64,
);

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2).max(1);
        write!(f, "{:.digits$} in", self.0)
    }
}

/// A point as text: `(1.00, 2.00, 3.00 in)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point(
    /// X, Y, Z, inches.
    pub [f64; 3],
);

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "({x:.2}, {y:.2}, {z:.2} in)")
    }
}

/// The nearest integer (halves away from zero); saturates, and NaN gives 0.
#[must_use]
#[expect(
    clippy::as_conversions,
    reason = "a float-to-integer cast saturates and takes NaN to 0, which is what is wanted"
)]
#[inline]
pub fn rounded(value: f64) -> i32 {
    libm::round(value) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_in_texts_have_a_decimal_point_and_their_unit() {
        let texts = std::format!(
            "{} {:.3} {:.0} {}",
            Length(2.0),
            Length(-0.5),
            Length(7.0),
            Point([1.0, -2.5, 0.0])
        );
        assert_eq!(texts, "2.00 in -0.500 in 7.0 in (1.00, -2.50, 0.00 in)");
    }

    #[test]
    fn rounds_to_the_nearest_and_saturates() {
        assert_eq!(hundredths(-14.835), -1484);
        assert_eq!(hundredths(0.625), 63);
        assert_eq!(hundredths(1e12), i32::MAX);
        assert_eq!(hundredths(f64::NAN), 0);
        assert_eq!(hundredths_of_degree(PI), 18_000);
        assert!((radians(-300) + 0.052_359_877).abs() < 1e-8);
    }
}
