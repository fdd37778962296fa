//! The table of the campaign: one row per attack, one column per outcome.

use std::{
    fmt::Write as _,
    panic::{self, AssertUnwindSafe},
};

/// The outcome of an attack. Any other one is a panic of the judge, and a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It continued to its normal end; a tool printed its answer.
    WentOn,
    /// The robot came to rest, the log is complete, and the exit status is 3; a tool found a difference.
    InOrder,
    /// It ended, or refused to start, with the reason in its last line.
    InWords,
    /// It was ended by the sent signal, by one of the system's, or by iceoryx2 due to garbage in memory.
    BySignal,
}

/// The columns, in the order of [`Outcome`].
const COLUMNS: [&str; 4] = ["continued", "ended in order", "ended with a message", "ended by force"];

/// Random numbers, determined by a seed.
pub struct Chance(u64);

impl Chance {
    /// A separate stream for each case of each row.
    fn new(seed: u64, row: &str, case: u64) -> Self {
        let mixed = row.bytes().fold(seed ^ 0xCBF2_9CE4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
        });
        Self((mixed ^ case.wrapping_mul(0x9E37_79B9_7F4A_7C15)) | 1)
    }

    /// A number from 0 to `limit` - 1; 0 if `limit` is 0.
    pub fn below(&mut self, limit: u64) -> u64 {
        // Xorshift: George Marsaglia, Xorshift RNGs, Journal of Statistical Software 8 (2003).
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % limit.max(1)
    }

    /// The same for positions in memory.
    pub fn place(&mut self, limit: usize) -> usize {
        usize::try_from(self.below(u64::try_from(limit).expect("64 bits"))).expect("it is below a usize")
    }

    pub fn byte(&mut self) -> u8 {
        u8::try_from(self.below(256)).expect("it is below 256")
    }
}

#[derive(Clone, Copy)]
pub struct Extent {
    /// True for a few cases per row.
    pub sample: bool,
    pub seed: u64,
}

impl Extent {
    /// The number of cases in a full campaign, or in a sample of it.
    pub fn of(self, full: u64, sample: u64) -> u64 {
        if self.sample { sample } else { full }
    }
}

/// An attack and its outcomes.
pub struct Row {
    attack: String,
    on: &'static str,
    counts: [u64; 4],
    /// Violations: the case, and the judge's message.
    pub findings: Vec<String>,
}

impl Row {
    /// Try an attack in some cases.
    pub fn of(
        extent: Extent,
        attack: &str,
        on: &'static str,
        cases: impl IntoIterator<Item = u64>,
        mut attempt: impl FnMut(u64, &mut Chance) -> Outcome,
    ) -> Self {
        let mut row = Self { attack: attack.to_owned(), on, counts: [0; 4], findings: Vec::new() };
        for case in cases {
            let mut chance = Chance::new(extent.seed, attack, case);
            match panic::catch_unwind(AssertUnwindSafe(|| attempt(case, &mut chance))) {
                Ok(outcome) => row.counts[outcome as usize] += 1,
                Err(words) => row.findings.push(format!("{attack}, {on}, case {case}: {}", text(&*words))),
            }
        }
        row
    }

    fn cells(&self) -> Vec<String> {
        let held: u64 = self.counts.iter().sum();
        let findings = self.findings.len();
        let cases = held + u64::try_from(findings).expect("64 bits");
        let counts = self.counts.iter().map(u64::to_string);
        [self.attack.clone(), self.on.to_owned(), cases.to_string()]
            .into_iter()
            .chain(counts)
            .chain([findings.to_string()])
            .collect()
    }
}

fn text(payload: &(dyn std::any::Any + Send)) -> String {
    let words = payload.downcast_ref::<String>().map(String::as_str);
    words.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("a panic without words").to_owned()
}

fn heads() -> Vec<String> {
    let columns = ["attack", "on", "cases"].into_iter().chain(COLUMNS).chain(["not held"]);
    columns.map(str::to_owned).collect()
}

pub fn plain(rows: &[Row]) -> String {
    let lines: Vec<Vec<String>> = std::iter::once(heads()).chain(rows.iter().map(Row::cells)).collect();
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..lines[0].len()).map(width).collect();
    let mut text = String::new();
    for line in &lines {
        for (column, (cell, width)) in line.iter().zip(&widths).enumerate() {
            let written =
                if column < 2 { write!(text, "{cell:<width$}  ") } else { write!(text, "{cell:>width$}  ") };
            written.expect("a string takes everything");
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text
}

pub fn markdown(rows: &[Row]) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(heads());
    text.push_str("|---|---|---:|---:|---:|---:|---:|---:|\n");
    rows.iter().for_each(|row| text.push_str(&line(row.cells())));
    text
}
