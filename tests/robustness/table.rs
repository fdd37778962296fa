//! One row per attack, one column per outcome.

use std::{
    fmt::Write as _,
    panic::{self, AssertUnwindSafe},
};

/// Any other outcome is a panic of the judge, and a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    WentOn,   // normal end; a tool printed its answer
    InOrder,  // at rest, log complete, exit status 3; or a tool found a difference
    InWords,  // the reason is in the last line
    BySignal, // by the sent signal, by one of the system's, or by iceoryx2 over garbage
}

const COLUMNS: [&str; 4] = ["continued", "ended in order", "ended with a message", "ended by force"];

pub struct Chance(u64); // determined by a seed

impl Chance {
    fn new(seed: u64, row: &str, case: u64) -> Self {
        let mixed = row.bytes().fold(seed ^ 0xCBF2_9CE4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
        });
        Self((mixed ^ case.wrapping_mul(0x9E37_79B9_7F4A_7C15)) | 1)
    }

    pub fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13; // george Marsaglia, Xorshift RNGs, Journal of Statistical Software 8 (2003)
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % limit.max(1)
    }

    pub fn place(&mut self, limit: usize) -> usize {
        usize::try_from(self.below(u64::try_from(limit).expect("64 bits"))).expect("it is below a usize")
    }

    pub fn byte(&mut self) -> u8 {
        u8::try_from(self.below(256)).expect("it is below 256")
    }
}

#[derive(Clone, Copy)]
pub struct Extent {
    pub sample: bool, // a few cases per row
    pub seed: u64,
}

impl Extent {
    pub fn of(self, full: u64, sample: u64) -> u64 {
        if self.sample { sample } else { full }
    }
}

pub struct Row {
    attack: String,
    on: &'static str,
    counts: [u64; 4],
    pub findings: Vec<String>, // the case, and the judge's message
}

impl Row {
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
