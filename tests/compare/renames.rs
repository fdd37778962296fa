//! Intended changes: paths, and texts of values.

use std::collections::BTreeSet;

use serde::Deserialize;

use super::CompareError;
use crate::trace::ABSENT;

/// The intended changes as TOML. In a path `*` matches any part of one segment, and at the end all that follows:
/// `emove.poses[*].pose.*`. In a value it matches any text. The first `*` of `new` is replaced by the match of the
/// first `*` of `old`, and so on.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Renames {
    pub renamed: Vec<Renamed>, // the first match applies
    pub dropped: Vec<Only>,    // in the old version
    /// Fields of the new version only. A field of both versions is still compared.
    pub added: Vec<Only>,
    pub value: Vec<NewText>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Renamed {
    pub old: String,
    pub new: String,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Only {
    pub path: String,   // in the version that has it
    pub reason: String, // for not comparing it
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NewText {
    pub path: String,
    pub old: String,
    pub new: String, // or `ABSENT` if the field does not exist
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rule {
    Renamed(usize),
    Dropped(usize),
    Added(usize),
    Value(usize),
}

impl Renames {
    pub fn parse(text: &str) -> Result<Self, CompareError> {
        let renames: Self = toml::from_str(text)?;
        let paths = renames.renamed.iter().map(|rule| (&rule.old, &rule.new));
        let values = renames.value.iter().map(|rule| (&rule.old, &rule.new));
        for (old, new) in paths.chain(values) {
            if new.matches('*').count() > old.matches('*').count() {
                return Err(CompareError::Stars { old: old.clone(), new: new.clone() });
            }
        }
        Ok(renames)
    }

    /// `None`: the field is dropped.
    pub(super) fn new_path(&self, old: &str, used: &mut BTreeSet<Rule>) -> Option<String> {
        if let Some(at) = self.dropped.iter().position(|rule| path_matches(&rule.path, old)) {
            used.insert(Rule::Dropped(at));
            return None;
        }
        let rules = self.renamed.iter().enumerate();
        let mut fitting =
            rules.filter_map(|(at, rule)| Some((at, translate(&rule.old, &rule.new, old, '.')?)));
        let Some((at, new)) = fitting.next() else { return Some(old.to_owned()) };
        used.insert(Rule::Renamed(at));
        Some(new)
    }

    pub(super) fn is_added(&self, path: &str, used: &mut BTreeSet<Rule>) -> bool {
        let rule = self.added.iter().position(|rule| path_matches(&rule.path, path));
        used.extend(rule.map(Rule::Added));
        rule.is_some()
    }

    pub(super) fn values_of(&self, path: &str) -> Vec<usize> {
        let rules = self.value.iter().enumerate();
        rules.filter(|(_, rule)| path_matches(&rule.path, path)).map(|(at, _)| at).collect()
    }

    /// Equal, or mapped by one of `rules`.
    pub(super) fn agree(
        &self,
        was: Option<&str>,
        is: Option<&str>,
        rules: &[usize],
        used: &mut BTreeSet<Rule>,
    ) -> bool {
        if was == is {
            return true;
        }
        // An unwritten field belongs to an unused variant: see `trace::changes`.
        let (was, is) = (was.unwrap_or(ABSENT), is.unwrap_or(ABSENT));
        let fits = |at: &usize| {
            self.value.get(*at).is_some_and(|NewText { old, new, .. }| {
                translate(old, new, was, '\n').is_some_and(|expected| expected == is)
            })
        };
        let rule = rules.iter().copied().find(fits);
        used.extend(rule.map(Rule::Value));
        rule.is_some()
    }

    pub(super) fn unused(&self, used: &BTreeSet<Rule>) -> Vec<String> {
        let renamed = self.renamed.iter().map(|r| format!("renamed {} to {}", r.old, r.new));
        let dropped = self.dropped.iter().map(|r| format!("dropped {}: {}", r.path, r.reason));
        let added = self.added.iter().map(|r| format!("added {}: {}", r.path, r.reason));
        let value = self.value.iter().map(|r| format!("value of {}: {:?} to {:?}", r.path, r.old, r.new));
        let renamed = renamed.enumerate().map(|(at, text)| (Rule::Renamed(at), text));
        let dropped = dropped.enumerate().map(|(at, text)| (Rule::Dropped(at), text));
        let added = added.enumerate().map(|(at, text)| (Rule::Added(at), text));
        let value = value.enumerate().map(|(at, text)| (Rule::Value(at), text));
        let all = renamed.chain(dropped).chain(added).chain(value);
        all.filter(|(rule, _)| !used.contains(rule)).map(|(_, text)| text).collect()
    }
}

fn path_matches(pattern: &str, path: &str) -> bool {
    captures(pattern, path, '.').is_some()
}

/// `None` if `text` does not match `old`.
fn translate(old: &str, new: &str, text: &str, border: char) -> Option<String> {
    let stars = captures(old, text, border)?;
    let mut pieces = new.split('*');
    let mut result = pieces.next().unwrap_or_default().to_owned();
    for (star, piece) in stars.into_iter().zip(pieces) {
        result.push_str(star);
        result.push_str(piece);
    }
    Some(result)
}

/// The matches of the stars; `None` if `text` does not match. Only a last star passes `border`.
fn captures<'a>(pattern: &str, text: &'a str, border: char) -> Option<Vec<&'a str>> {
    let Some((front, rest)) = pattern.split_once('*') else {
        return (pattern == text).then(Vec::new);
    };
    let text = text.strip_prefix(front)?;
    if rest.is_empty() {
        return Some(vec![text]);
    }
    let longest = text.find(border).unwrap_or(text.len());
    (0..=longest).rev().filter(|at| text.is_char_boundary(*at)).find_map(|at| {
        let (star, behind) = text.split_at(at);
        let mut found = captures(rest, behind, border)?;
        found.insert(0, star);
        Some(found)
    })
}
