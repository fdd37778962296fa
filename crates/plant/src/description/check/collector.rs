//! Checks values of a description and collects the problems.

use std::collections::BTreeSet;

use diagnostics::{
    Problem,
    toml::{Defaulted, Path, element, join},
};

use crate::description::Points;

pub(super) struct Check<'s> {
    pub(super) problems: Vec<Problem>,
    /// Entries that must be more than 0: radii, lengths, weights.
    pub(super) positive: BTreeSet<Path>,
    pub(super) stand_ins: &'s Defaulted,
}

impl Check<'_> {
    pub(super) fn trusts(&self, path: &str) -> bool {
        self.stand_ins.trusts(path)
    }

    pub(super) fn that(&mut self, holds: bool, path: &str, expected: &str, found: impl FnOnce() -> String) {
        if !holds && self.trusts(path) {
            self.problems.push(Problem::unlike("cell.value", path, expected, found()));
        }
    }

    pub(super) fn within(&mut self, path: &str, value: f64, low: f64, high: f64) {
        let inside = (low..=high).contains(&value);
        self.that(inside, path, &format!("{low} to {high}"), || value.to_string());
    }

    /// Checks that a value is from 0 to the value of another entry.
    pub(super) fn up_to(&mut self, path: &str, value: f64, (other, greatest): (&str, f64)) {
        if self.trusts(other) {
            let expected = format!("0 to the {greatest} of {other}");
            self.that((0.0..=greatest).contains(&value), path, &expected, || value.to_string());
        }
    }

    /// Check that a 12-bit converter can read `counts`.
    pub(super) fn counts(&mut self, path: &str, expected: &str, counts: f64) {
        self.that((1.0..=4095.0).contains(&counts), path, expected, || format!("{counts:.0} counts"));
    }

    pub(super) fn ascending(&mut self, path: &str, [low, high]: [f64; 2]) {
        self.that(low < high, path, "two numbers, the second one greater", || format!("{low}, {high}"));
    }

    pub(super) fn frame(&mut self, path: &str, points: &Points) {
        let expected = "three points that are not on one line";
        self.that(points.frame().is_some(), path, expected, || {
            format!("{:?}, {:?}, {:?}", points.wrist, points.tool, points.finger)
        });
    }

    pub(super) fn positive(&mut self, table: &str, values: &[(&str, f64)]) {
        for (key, value) in values {
            self.above_zero(join(table, key), *value);
        }
    }

    pub(super) fn all_positive(&mut self, array: &str, values: &[f64]) {
        for (number, value) in values.iter().enumerate() {
            self.above_zero(element(array, number), *value);
        }
    }

    pub(super) fn above_zero(&mut self, path: Path, value: f64) {
        self.that(value > 0.0, &path, "more than 0", || value.to_string());
        self.positive.insert(path);
    }

    /// Check that a name is known. If a known name could not be read, the name may refer to it.
    pub(super) fn known(&mut self, path: &str, expected: &str, name: &str, known: &[&str]) {
        let names_are_read =
            !self.stand_ins.iter().any(|path| path.ends_with("name") || path.ends_with("unit"));
        if !known.contains(&name) && names_are_read && self.trusts(path) {
            self.problems.push(Problem::unlike("cell.name", path, expected, name).near(name, known));
        }
    }
}
