//! The report of a campaign: a table, the branches that are not done, and both as JSON or Markdown.

use std::{collections::BTreeMap, fmt::Write as _, io};

use os_io::text::amount;
use serde::Serialize;

use closed_loop::truth::Verdict as TruthVerdict;

use super::{
    coverage::Coverage,
    disturbance::{self, Follow},
    markdown::Column,
    parent::Parent,
    verdict::{BranchResult, OutageResult, Verdict},
};
use crate::rcs_run::error::Error;

const LISTED: usize = 3;

#[derive(Debug, Default, Serialize)]
struct Row {
    interruption: String,
    branches: usize,
    without_command: usize, // branches that were interrupted while Task executed no command
    done: usize,
    stranded: usize,
    apart: usize,
    hurt: usize,
    #[serde(rename = "false")]
    lies: usize,
    /// Largest number of ticks from the interruption to rest, if the branches are judged at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    rest_after: Option<u64>,
    /// Number of branches that have got over an outage without a person, and the greatest delay of any, ticks.
    #[serde(skip_serializing_if = "Option::is_none")]
    unattended: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    late: Option<u64>,
}

impl Row {
    fn add(&mut self, result: &BranchResult) {
        self.branches += 1;
        self.without_command += usize::from(!result.met_command);
        self.rest_after = self.rest_after.max(result.rest_after);
        if let Some(OutageResult { attended, late }) = result.outage {
            let alone = usize::from(result.verdict == Verdict::Done && !attended);
            self.unattended = Some(self.unattended.unwrap_or(0) + alone);
            self.late = self.late.max(late);
        }
        match result.verdict {
            Verdict::Done => self.done += 1,
            Verdict::Stranded => self.stranded += 1,
            Verdict::Apart => self.apart += 1,
            Verdict::Hurt => self.hurt += 1,
            Verdict::False => self.lies += 1,
        }
    }

    fn cell(&self) -> String {
        let mut text = format!("{}/{}", self.done, self.branches);
        for (count, word) in
            [(self.stranded, "stranded"), (self.hurt, "hurt"), (self.lies, "false"), (self.apart, "apart")]
        {
            if count > 0 {
                let _ = write!(text, ", {count} {word}");
            }
        }
        text
    }

    fn share(&self) -> f64 {
        let counted = self.branches - self.apart;
        if counted == 0 { 100.0 } else { 100.0 * self.done as f64 / counted as f64 }
    }
}

/// The row of the table in which a branch is counted: its interruption, or the number of its interruptions.
fn title(result: &BranchResult) -> String {
    let name = result.interruption.as_str();
    let word = name.split(':').next().unwrap_or_default();
    match name.matches('+').count() {
        0 if disturbance::WORDS.contains(&word) => {
            let end = Follow::ALL[1..].iter().find(|(_, end)| name.ends_with(end));
            format!("{word}{}", end.map_or("", |(_, end)| end))
        }
        0 => result.interruption.clone(),
        more => format!("{} interruptions", more + 1),
    }
}

/// The cause by which a branch is counted. For a stranded branch: the process that failed, its command and its row.
fn cause(result: &BranchResult) -> &str {
    let known = (result.verdict == Verdict::Stranded)
        .then(|| result.detail.strip_prefix("tick ")?.split_once(": "))
        .flatten();
    known.map_or(&result.reason, |(_, cause)| cause)
}

pub struct CampaignReport<'a> {
    job: &'a str,
    parent: &'a Parent,
    results: &'a [BranchResult],
    rows: Vec<Row>,
    decisions: usize, // number of rows of the decision tables, and the rows that have fired in no branch
    never_fired: Vec<String>,
    command: String,
}

#[derive(Serialize)]
struct Json<'a> {
    job: &'a str,
    ticks: u64,
    digest: &'a str,
    rows: &'a [Row],
    branches: &'a [BranchResult],
    decisions: usize, // number of rows of the decision tables, and the rows that have fired in no branch
    never_fired: &'a [String],
}

impl<'a> CampaignReport<'a> {
    /// A report on these branches; `command` is the command line that repeats the campaign.
    #[must_use]
    pub fn new(
        job: &'a str,
        command: String,
        parent: &'a Parent,
        results: &'a [BranchResult],
        met: &Coverage,
    ) -> Self {
        let mut rows: Vec<Row> = Vec::new();
        for result in results {
            let title = title(result);
            let at = rows.iter().position(|row| row.interruption == title).unwrap_or_else(|| {
                rows.push(Row { interruption: title, ..Row::default() });
                rows.len() - 1
            });
            rows[at].add(result);
        }
        let (decisions, never_fired) = met.missing();
        Self { job, parent, results, rows, decisions, never_fired, command }
    }

    /// The report as one JSON object. Fails with [`Error::Output`] if it cannot be written.
    pub fn json(&self) -> Result<String, Error> {
        let Parent { ticks, digest, .. } = self.parent;
        let Self { job, results: branches, rows, decisions, never_fired, .. } = self;
        let json = Json { job, ticks: *ticks, digest, rows, branches, decisions: *decisions, never_fired };
        Ok(serde_json::to_string(&json).map_err(io::Error::from)? + "\n")
    }

    #[must_use]
    pub fn column(&self) -> Column {
        let cells = self.rows.iter().map(|row| (row.interruption.clone(), row.cell()));
        Column { job: self.job.to_owned(), cells: cells.collect() }
    }

    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:<24}{:>9}{:>7}{:>10}{:>6}{:>7}{:>7}{:>8}  no command\n",
            self.job, "branches", "done", "stranded", "hurt", "false", "apart", "done %"
        );
        for row in &self.rows {
            let _ = writeln!(
                text,
                "{:<24}{:>9}{:>7}{:>10}{:>6}{:>7}{:>7}{:>8.1}{:>12}{}{}",
                row.interruption,
                row.branches,
                row.done,
                row.stranded,
                row.hurt,
                row.lies,
                row.apart,
                row.share(),
                row.without_command,
                row.rest_after.map_or_else(String::new, |ticks| format!(
                    "  at rest after {} at most",
                    amount(ticks, "tick")
                )),
                row.unattended.map_or_else(String::new, |alone| format!(
                    "  {alone} without a person, at most {} later",
                    amount(row.late.unwrap_or(0), "tick")
                ))
            );
        }
        for (verdict, title) in [
            (Verdict::False, "False confirmations"),
            (Verdict::Hurt, "Hurt"),
            (Verdict::Stranded, "Stranded"),
            (Verdict::Apart, "Apart"),
        ] {
            self.list(&mut text, verdict, title);
        }
        self.confirmations(&mut text);
        let fired = self.decisions - self.never_fired.len();
        let _ = writeln!(text, "\n{fired} of {} rows of the decision tables have fired", self.decisions);
        text
    }

    fn confirmations(&self, text: &mut String) {
        let untrue = || self.results.iter().flat_map(|result| &result.untrue);
        let judged: u64 = self.results.iter().map(|result| result.judged).sum();
        let lies = untrue().filter(|one| one.is_false()).count();
        let remedied = self.results.iter().filter(|one| one.remedied && one.verdict == Verdict::Done).count();
        let _ = writeln!(
            text,
            "\n{} judged: {lies} false, {} not sensed; {} continued after the remedy",
            amount(judged, "confirmation"),
            untrue().count() - lies,
            amount(remedied, "failed job")
        );
        let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
        for one in untrue() {
            if let TruthVerdict::NotSensed(why) = one.verdict {
                *reasons.entry(format!("{} {}", one.level, why.text())).or_default() += 1;
            }
        }
        for (reason, count) in reasons {
            let _ = writeln!(text, "{count:>6}  not sensed: {reason}");
        }
    }

    /// Number of branches of a verdict per reason, most frequent first.
    fn totals(&self, verdict: Verdict) -> String {
        let mut totals: BTreeMap<&str, usize> = BTreeMap::new();
        for result in self.results.iter().filter(|result| result.verdict == verdict) {
            *totals.entry(&result.reason).or_default() += 1;
        }
        let mut totals: Vec<_> = totals.into_iter().collect();
        totals.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        totals.iter().map(|(reason, count)| format!("{count:>6}  {reason}\n")).collect()
    }

    /// List the branches of a verdict by cause, most frequent first.
    fn list(&self, text: &mut String, verdict: Verdict, title: &str) {
        let mut reasons: BTreeMap<&str, Vec<&BranchResult>> = BTreeMap::new();
        for result in self.results.iter().filter(|result| result.verdict == verdict) {
            reasons.entry(cause(result)).or_default().push(result);
        }
        let mut reasons: Vec<_> = reasons.into_iter().collect();
        reasons.sort_by_key(|(_, branches)| std::cmp::Reverse(branches.len()));
        if !reasons.is_empty() {
            let _ = writeln!(text, "\n{title}:");
            if verdict == Verdict::Stranded {
                let _ = writeln!(text, "{}", self.totals(verdict));
            }
        }
        for (reason, branches) in reasons {
            let _ = writeln!(text, "{:>6}  {reason}", branches.len());
            for branch in branches.iter().take(LISTED) {
                let BranchResult { at, interruption, smallest, line, detail, .. } = branch;
                let interruption = smallest.as_ref().unwrap_or(interruption);
                let command = &self.command;
                let whole = if branch.whole { " --judge job" } else { "" };
                let _ =
                    writeln!(text, "        {command} --at {at} --interrupt {interruption}{whole}  ({line})");
                if !detail.ends_with(reason) {
                    let _ = writeln!(text, "            {detail}");
                }
            }
            if branches.len() > LISTED {
                let more: Vec<String> = branches
                    .iter()
                    .skip(LISTED)
                    .map(|branch| format!("{} {}", branch.interruption, branch.at))
                    .collect();
                let _ = writeln!(text, "        and {}", more.join(", "));
            }
        }
    }
}
