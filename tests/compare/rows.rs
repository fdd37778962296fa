//! New rows that fire in place of old ones.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

use record::channels::headers;

use super::{
    Comparison,
    renames::{Renames, Rule},
};

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pair {
    pub process: String, // in common memory of the new version
    pub old: Row,
    pub new: Row,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Row {
    table: String,
    number: Option<u32>,
}

impl Row {
    pub(super) fn new(text: &str) -> Self {
        let split = text.rsplit_once(' ').and_then(|(table, row)| Some((table, row.parse().ok()?)));
        let (table, number) = split.map_or((text, None), |(table, row)| (table, Some(row)));
        Self { table: table.to_owned(), number }
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.table)?;
        self.number.map_or(Ok(()), |row| write!(f, " {row}"))
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    pub ticks: u64,
    pub first: u64,
}

pub type Pairs = BTreeMap<Pair, Seen>;

/// A pair that fired in the ticks from `since` to `until` - 1.
pub(super) fn learn(pairs: &mut Pairs, pair: Pair, since: u64, until: u64) {
    if since < until {
        pairs.entry(pair).or_insert(Seen { ticks: 0, first: since }).ticks += until - since;
    }
}

#[derive(Clone, Debug, Default)]
pub struct RowMap {
    pairs: BTreeMap<Pair, (Seen, String)>, // scenario of the first tick
    used: BTreeSet<Rule>,
}

impl RowMap {
    pub fn add(&mut self, scenario: &str, found: &Comparison) {
        for (pair, seen) in &found.rows {
            let new = || (Seen { ticks: 0, ..seen.clone() }, scenario.to_owned());
            self.pairs.entry(pair.clone()).or_insert_with(new).0.ticks += seen.ticks;
        }
        self.used.extend(&found.used);
    }

    /// Entries of [`Renames`] that no scenario needed.
    #[must_use]
    pub fn unused(&self, renames: &Renames) -> Vec<String> {
        renames.unused(&self.used)
    }

    #[must_use]
    pub fn split(&self) -> Vec<&Pair> {
        let mut new_rows: BTreeMap<(&str, &Row), usize> = BTreeMap::new();
        for pair in self.pairs.keys() {
            *new_rows.entry((&pair.process, &pair.old)).or_default() += 1;
        }
        let is_split = |pair: &&Pair| new_rows.get(&(pair.process.as_str(), &pair.old)) > Some(&1);
        self.pairs.keys().filter(is_split).collect()
    }

    #[must_use]
    pub fn not_named(&self) -> Vec<(&'static str, &'static str, Vec<u8>)> {
        let fired: BTreeSet<(&str, String)> =
            self.pairs.keys().map(|pair| (pair.process.as_str(), pair.new.to_string())).collect();
        let mut found = Vec::new();
        for place in headers() {
            for table in place.process.tables {
                let silent = |row: &u8| !fired.contains(&(place.field, format!("{} {row}", table.name)));
                let rows: Vec<u8> = table.rows.iter().map(|row| row.number).filter(silent).collect();
                if !rows.is_empty() {
                    found.push((place.field, table.name, rows));
                }
            }
        }
        found
    }

    fn table<'a>(
        &self,
        f: &mut fmt::Formatter<'_>,
        pairs: impl IntoIterator<Item = &'a Pair>,
    ) -> fmt::Result {
        writeln!(f, "| process | old row | new row | ticks | for example |\n|---|---|---|--:|---|")?;
        for pair in pairs {
            let Some((Seen { ticks, first }, scenario)) = self.pairs.get(pair) else { continue };
            let Pair { process, old, new } = pair;
            writeln!(f, "| {process} | {old} | {new} | {ticks} | {scenario}, tick {first} |")?;
        }
        Ok(())
    }
}

impl fmt::Display for RowMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let changed = self.pairs.keys().filter(|pair| pair.old != pair.new).count();
        writeln!(f, "## Rows\n\n{} pairs, {changed} with another name or number.\n", self.pairs.len())?;
        self.table(f, self.pairs.keys())?;
        writeln!(f, "\n## Old rows that became more than one new row\n")?;
        match self.split() {
            split if split.is_empty() => writeln!(f, "None."),
            split => self.table(f, split),
        }
    }
}
