//! The summary of a run as text for review: commands with their durations, failures, and the number of firings
//! of each row of each decision table.
//!
//! A digest only detects a change of behaviour. The summary shows the change: a row that fires less often, a command
//! that takes longer, a new failure.

use std::{collections::BTreeMap, fmt::Write as _};

use interfaces::{CommonMemory, Decided, ExternalInputs, Unconfirmed, hws::HwsReport};
use rcs_core::{
    Plain as _,
    digest::Digest,
    plain::Writer,
    tick::{TICK_S, Tick},
};

use crate::{
    channels::{HeaderPlace, headers},
    proto::foxglove::Level,
    remarks::remarks,
};

/// Number of warnings and errors that are written out; further ones are counted.
const TROUBLES: usize = 30;

struct Command {
    text: String,
    first: Tick,
    last: Tick,
    report: HwsReport,
    unconfirmed: Unconfirmed,
}

pub struct Summary {
    run: BTreeMap<String, String>,
    headers: Vec<HeaderPlace>,
    image: Vec<u8>,
    commands: Vec<Command>,
    troubles: Vec<String>,
    /// Number of firings of each row, by position of the process, number of the table, row.
    rows: BTreeMap<(usize, u8, u8), u64>,
    ticks: u64,
}

impl Summary {
    #[must_use]
    pub fn new(run: &BTreeMap<String, String>) -> Self {
        Self {
            run: run.clone(),
            headers: headers(),
            image: vec![0; CommonMemory::SIZE],
            commands: Vec::new(),
            troubles: Vec::new(),
            rows: BTreeMap::new(),
            ticks: 0,
        }
    }

    pub fn observe(
        &mut self,
        tick: Tick,
        external: &ExternalInputs,
        before: &CommonMemory,
        after: &CommonMemory,
    ) {
        self.ticks += 1;
        after.encode(&mut Writer::new(&mut self.image));
        for (at, place) in self.headers.iter().enumerate() {
            let header = place.read(&self.image);
            if let Some(Decided { table, row }) = header.fired() {
                *self.rows.entry((at, table, row)).or_default() += 1;
            }
        }
        let said = remarks(&self.headers, &external.hws, before, after);
        for remark in said.into_iter().filter(|remark| remark.level >= Level::Warning) {
            self.troubles.push(format!("tick {tick}  {}: {}", remark.source, remark.text));
        }
        self.command(tick, external, before, after);
    }

    fn command(
        &mut self,
        tick: Tick,
        external: &ExternalInputs,
        before: &CommonMemory,
        after: &CommonMemory,
    ) {
        let (was, is) = (&before.task.status, &after.task.status);
        if was.echo != is.echo {
            let text = external.hws.in_words().to_string();
            let unconfirmed = is.unconfirmed;
            self.commands.push(Command { text, first: tick, last: tick, report: is.report, unconfirmed });
        }
        if let Some(command) = self.commands.last_mut()
            && (was.echo != is.echo || command.report == HwsReport::Executing)
        {
            (command.last, command.report, command.unconfirmed) = (tick, is.report, is.unconfirmed);
        }
    }

    #[must_use]
    pub fn text(&self, digest: Digest) -> String {
        let mut text = String::new();
        for (key, value) in &self.run {
            let _ = writeln!(text, "{key:<8} {value}");
        }
        let _ = writeln!(text, "{:<8} {} ({:.2} s)", "ticks", self.ticks, self.ticks as f64 * TICK_S);
        let _ = writeln!(text, "{:<8} {digest}", "digest");
        let _ = writeln!(text, "\ncommands\n    tick   for s  status     command");
        for command in &self.commands {
            let seconds = (command.last.since(command.first) + 1) as f64 * TICK_S;
            let (tick, report) = (command.first, command.report.text());
            let unconfirmed = command.unconfirmed.suffix();
            let _ =
                writeln!(text, "{:>8} {seconds:>7.2}  {report:<10} {}{unconfirmed}", tick.0, command.text);
        }
        if !self.troubles.is_empty() {
            let _ = writeln!(text, "\nwarnings and errors");
            self.troubles.iter().take(TROUBLES).for_each(|trouble| {
                let _ = writeln!(text, "  {trouble}");
            });
        }
        if let Some(more) = self.troubles.len().checked_sub(TROUBLES).filter(|more| *more > 0) {
            let _ = writeln!(text, "  and {more} more");
        }
        let _ = writeln!(text, "\nrows that fired, and how often");
        self.rows_text(&mut text);
        text
    }

    fn rows_text(&self, text: &mut String) {
        let mut last = None;
        for ((at, table, row), count) in &self.rows {
            if last != Some((at, table)) {
                let Some(process) = self.headers.get(*at).map(|place| place.process) else { continue };
                let name = process.table(*table).map_or("no table", |table| table.name);
                let lead = if last.is_some() { "\n" } else { "" };
                let _ = write!(text, "{lead}  {} {name}:", process.name);
                last = Some((at, table));
            }
            let _ = write!(text, " {row} x{count}");
        }
        text.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Basis, Reason};
    use rcs_core::name::Name16;

    #[test]
    fn summary_of_one_failed_command() {
        let run = [("job".to_owned(), "try".to_owned())].into();
        let mut summary = Summary::new(&run);
        let mut external = ExternalInputs::default();
        external.hws.command = Name16::new("MOVE").unwrap();
        let (mut before, mut after) = (CommonMemory::default(), CommonMemory::default());
        for tick in 1..=40 {
            if tick == 5 {
                (after.task.status.echo, after.task.status.report) = (1, HwsReport::Executing);
                after.task.header.decided = Some(Decided { table: 1, row: 2 });
            }
            after.task.header.stamp = Tick(tick);
            if (5..=30).contains(&tick) {
                after.task.header.basis = Some(Basis { tick: Tick(tick), ..Basis::default() });
            }
            if tick == 30 {
                after.task.status.report = HwsReport::Error;
                after.task.status.reason = Reason::UnknownLocation;
            }
            summary.observe(Tick(tick), &external, &before, &after);
            before = after;
        }
        let text = summary.text(Digest::new());
        assert!(
            text.starts_with("job      try\nticks    40 (1.60 s)\ndigest   cbf29ce484222325\n"),
            "{text}"
        );
        assert!(text.contains("       5    1.04  error      MOVE\n"), "{text}");
        assert!(text.contains("  tick 30  Task: the location is not in the task data"), "{text}");
        assert!(
            text.contains("  Task ") && text.contains(": 2 x26\n"),
            "a row that rests is not counted: {text}"
        );
    }
}
