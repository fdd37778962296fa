//! `rcs-log diff`: the differences between two runs: changed rows, motions and times ([`Changes`]), the first tick that
//! differs, then all differences by field. Record numbers are ignored for different task data. Ticks are aligned by
//! number, or from the tick in which Task took the command, so that one longer command does not shift all later ticks.

use std::{
    collections::{BTreeMap, HashMap},
    fmt,
    path::{Path, PathBuf},
    process::ExitCode,
};

use interfaces::{CommonMemory, ExternalInputs};
use os_io::text::amount;
use rcs_core::{Plain, plain::Writer};
use record::{
    Attachment, Log,
    layout::{self, Leaf},
};
use serde::Serialize;

use crate::{
    Answer, DIFFERENT, Error,
    difference::{Align, Changes, Trace},
    print,
    story::{Moment, open, walk},
};

const LISTED: usize = 40; // greatest number of fields in the answer

/// Arguments of `diff`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The one log
    pub a: PathBuf,
    /// The other log
    pub b: PathBuf,
    /// What is compared with what
    #[arg(long, value_enum, default_value_t = Align::Tick)]
    pub align: Align,
    #[command(flatten)]
    answer: Answer,
}

#[derive(Debug, Serialize)]
struct Differences {
    compared: u64,  // number of ticks that both logs have
    only_a: u64,    // number of ticks that only the first log has
    only_b: u64,    // number of ticks that only the second log has
    different: u64, // number of compared ticks that differ
    changes: Changes,
    first: Option<First>,
    fields: Vec<FieldStory>, // fields that differ, in the order of their first difference
    more_fields: usize,      // number of differing fields that are not in the list
}

#[derive(Debug, Serialize)]
struct First {
    tick_a: u64,
    tick_b: u64,
    field: String,
    a: String,
    b: String,
}

#[derive(Clone, Debug, Serialize)]
struct FieldStory {
    field: String,
    first_tick: u64,
    ticks: u64,
}

pub fn diff(arguments: &Arguments) -> Result<ExitCode, Error> {
    let differences = compare(&arguments.a, &arguments.b, arguments.align)?;
    print(&differences, arguments.answer.json)?;
    let same = differences.different + differences.only_a + differences.only_b == 0;
    Ok(ExitCode::from(if same { 0 } else { DIFFERENT }))
}

struct Images {
    tick: u64,
    cell: Option<u64>,
    external: Box<[u8]>,
    memory: Box<[u8]>,
}

impl Images {
    fn of(moment: &Moment) -> Self {
        let mut external = vec![0; ExternalInputs::SIZE].into_boxed_slice();
        moment.external.encode(&mut Writer::new(&mut external));
        let mut memory = vec![0; CommonMemory::SIZE].into_boxed_slice();
        moment.after.encode(&mut Writer::new(&mut memory));
        Self { tick: moment.tick.0, cell: moment.world, external, memory }
    }
}

fn compare(a: &Path, b: &Path, align: Align) -> Result<Differences, Error> {
    let (log_a, log_b) = (open(a)?, open(b)?);
    let (mut trace_b, mut images_b) = (Trace::default(), Vec::new());
    walk(&log_b, b, |moment| {
        trace_b.note(moment);
        images_b.push(Images::of(moment));
        true
    })?;
    let mut of_b: HashMap<_, _> = trace_b.keys(align).zip(images_b).collect();
    // Only the images of the second log are kept in memory.
    let trace_a = Trace::of_log(&log_a, a)?;
    let mut keys = trace_a.keys(align);
    let mut found = Comparison::new(task_data(&log_a) != task_data(&log_b));
    walk(&log_a, a, |moment| {
        let other = keys.next().and_then(|key| of_b.remove(&key));
        found.note(&Images::of(moment), other.as_ref());
        true
    })?;
    Ok(found.differences(Changes::between(&trace_a, &trace_b, align), of_b.len()))
}

fn task_data(log: &Log) -> Vec<(&str, &[u8])> {
    let is_meant = |attachment: &&Attachment| attachment.name.starts_with(Attachment::TASK_DATA);
    log.attachments.iter().filter(is_meant).map(|one| (one.name.as_str(), &one.data[..])).collect()
}

struct Comparison {
    external: Vec<Leaf>,
    memory: Vec<Leaf>,
    fields: BTreeMap<String, FieldStory>,
    first: Option<First>,
    compared: u64,
    only_a: u64,
    different: u64,
}

impl Comparison {
    /// Ignores record numbers if `by_name` is true, because the task data differ.
    fn new(by_name: bool) -> Self {
        let mut memory = layout::leaves(CommonMemory::STRUCT);
        memory.retain(|leaf| !by_name || !leaf.is_record_number());
        Self {
            external: layout::leaves(ExternalInputs::STRUCT),
            memory,
            fields: BTreeMap::new(),
            first: None,
            compared: 0,
            only_a: 0,
            different: 0,
        }
    }

    fn note(&mut self, a: &Images, b: Option<&Images>) {
        let Some(b) = b else {
            self.only_a += 1;
            return;
        };
        self.compared += 1;
        // Stamps differ whenever ticks with different numbers are compared.
        let matters = |leaf: &&Leaf| a.tick == b.tick || !leaf.path.ends_with("stamp");
        let pairs = [
            (&self.external, "external.", &a.external, &b.external),
            (&self.memory, "", &a.memory, &b.memory),
        ];
        let mut different: Vec<(String, [String; 2])> = Vec::new();
        for (leaves, prefix, was, is) in pairs {
            if was == is {
                continue;
            }
            for leaf in leaves.iter().filter(matters).filter(|leaf| leaf.differs(was, is)) {
                different.push((format!("{prefix}{}", leaf.path), [leaf.text(was), leaf.text(is)]));
            }
        }
        // The inputs show a changed cell only later; the digest shows the tick in which the change begins.
        if let (Some(was), Some(is)) = (a.cell, b.cell)
            && was != is
        {
            different.push(("cell.digest".to_owned(), [was, is].map(|digest| format!("{digest:016x}"))));
        }
        self.different += u64::from(!different.is_empty());
        for (field, [was, is]) in different {
            self.first.get_or_insert_with(|| First {
                tick_a: a.tick,
                tick_b: b.tick,
                field: field.clone(),
                a: was,
                b: is,
            });
            self.fields
                .entry(field.clone())
                .or_insert(FieldStory { field, first_tick: a.tick, ticks: 0 })
                .ticks += 1;
        }
    }

    fn differences(self, changes: Changes, only_b: usize) -> Differences {
        let mut fields: Vec<FieldStory> = self.fields.into_values().collect();
        fields.sort_by_key(|story| story.first_tick);
        let more_fields = fields.len().saturating_sub(LISTED);
        fields.truncate(LISTED);
        Differences {
            compared: self.compared,
            only_a: self.only_a,
            only_b: only_b as u64,
            different: self.different,
            changes,
            first: self.first,
            fields,
            more_fields,
        }
    }
}

impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { compared, only_a, only_b, different, .. } = self;
        writeln!(
            f,
            "{} compared, {different} different; {only_a} only in the first log, {only_b} only in the second",
            amount(*compared, "tick")
        )?;
        write!(f, "{}", self.changes)?;
        let Some(First { tick_a, tick_b, field, a, b }) = &self.first else { return Ok(()) };
        let ticks = if tick_a == tick_b { tick_a.to_string() } else { format!("{tick_a} and {tick_b}") };
        writeln!(f, "first      tick {ticks}, {field}: {a} and {b}")?;
        writeln!(f, "\n  from tick   ticks  field")?;
        for story in &self.fields {
            writeln!(f, "  {:>9} {:>7}  {}", story.first_tick, story.ticks, story.field)?;
        }
        if self.more_fields > 0 {
            writeln!(f, "  and {}", amount(self.more_fields, "more field"))?;
        }
        Ok(())
    }
}
