//! Groups findings by the datum that is probably wrong.

use std::collections::BTreeMap;

use crate::{Diagnostic, Severity};

/// The findings of a datum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Name of the datum.
    pub datum: String,
    /// Positions of the findings in the grouped list, errors first.
    pub findings: Vec<usize>,
    /// Number of errors among them.
    pub errors: usize,
}

/// The data that a finding names, one of which is probably wrong, and whether it is an error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataGroup {
    /// Names of the data; not empty.
    pub data: Vec<String>,
    /// True for an error, false for a warning.
    pub error: bool,
}

/// Groups findings. The datum that most findings name gets all of these, then the next datum. The worst group is first.
#[must_use]
pub fn grouped(suspects: &[DataGroup]) -> Vec<Group> {
    let mut left: Vec<usize> = (0..suspects.len()).collect();
    let mut groups = Vec::new();
    while !left.is_empty() {
        // Among equal counts, the datum that appears first wins.
        let mut counts: BTreeMap<&str, (usize, usize, usize)> = BTreeMap::new();
        let mut order = 0;
        for suspects in left.iter().filter_map(|&at| suspects.get(at)) {
            for datum in &suspects.data {
                let count = counts.entry(datum).or_insert((0, 0, order));
                (count.0, count.1) = (count.0 + usize::from(suspects.error), count.1 + 1);
                order += 1;
            }
        }
        let worst =
            counts.into_iter().max_by_key(|(_, (errors, all, order))| (*errors, *all, usize::MAX - order));
        let Some((datum, (errors, ..))) = worst else { break };
        let is_of = |at: &usize| {
            suspects.get(*at).is_some_and(|suspects| suspects.data.iter().any(|name| name == datum))
        };
        let (mut findings, others): (Vec<_>, Vec<_>) = left.into_iter().partition(is_of);
        findings.sort_by_key(|&at| suspects.get(at).is_none_or(|suspects| !suspects.error));
        groups.push(Group { datum: datum.to_owned(), findings, errors });
        left = others;
    }
    groups
}

impl Diagnostic {
    /// The data that the finding is about, one of which is probably wrong; never empty.
    #[must_use]
    pub fn suspects(&self) -> DataGroup {
        let data = if self.problem.data.is_empty() { vec![self.named()] } else { self.problem.data.clone() };
        DataGroup { data, error: self.severity() == Severity::Error }
    }

    /// The entry of a TOML file, the name in the underlined text or after it, or else the place.
    fn named(&self) -> String {
        if let Some(entry) = self.entry() {
            return entry.to_owned();
        }
        let is_name = |word: &&str| word.bytes().any(|byte| byte.is_ascii_uppercase());
        let words = || self.text().split_whitespace().chain(self.rest().split_whitespace().rev());
        let name = self.block().and_then(|_| words().find(is_name));
        match (name, self.block(), self.line()) {
            (Some(name), ..) => name.to_owned(),
            (None, Some(block), Some(line)) => format!("{}: {block}, line {line}", self.file()),
            (None, None, Some(line)) => format!("{} line {line}", self.file()),
            _ if self.file().is_empty() => self.message().to_owned(),
            _ => self.file().to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suspects(data: &[&str], error: bool) -> DataGroup {
        DataGroup { data: data.iter().map(|name| (*name).to_owned()).collect(), error }
    }

    #[test]
    fn datum_with_the_most_findings_is_listed_first_with_all_of_them() {
        let suspects = [
            suspects(&["A/D-5", "UNIT-V1"], true),
            suspects(&["HOME"], false),
            suspects(&["UNIT-V1", "SAFE"], true),
            suspects(&["SAFE", "UNIT-V1"], true),
            suspects(&["SAFE"], true),
            suspects(&["HOME"], false),
        ];
        let groups = grouped(&suspects);
        let of = |group: &Group| (group.datum.clone(), group.findings.clone(), group.errors);
        assert_eq!(
            groups.iter().map(of).collect::<Vec<_>>(),
            [
                ("UNIT-V1".to_owned(), vec![0, 2, 3], 3),
                ("SAFE".to_owned(), vec![4], 1),
                ("HOME".to_owned(), vec![1, 5], 0),
            ]
        );
    }

    #[test]
    fn errors_of_a_datum_precede_its_warnings() {
        let groups = grouped(&[suspects(&["A"], false), suspects(&["A"], true)]);
        assert_eq!((groups[0].findings.clone(), groups[0].errors), (vec![1, 0], 1));
    }
}
