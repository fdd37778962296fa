//! The buffers that a process reads and writes, field by field.

use std::sync::LazyLock;

use interfaces::{CommonMemory, ExternalInputs, ProcessId, for_each_process};
use os_io::text::amount;
use rcs_core::{Plain, plain::Writer};
use record::layout::{self, Leaf};

use super::{Section, Text, Tone, units::unit};
use crate::rcs_console::picture::Picture;

/// All fields of common memory and of the external inputs.
static MEMORY: LazyLock<Vec<Leaf>> = LazyLock::new(|| layout::leaves(CommonMemory::STRUCT));
static OUTSIDE: LazyLock<Vec<Leaf>> = LazyLock::new(|| layout::leaves(ExternalInputs::STRUCT));

#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Path from the buffer to the field: the manual's names in Rust's spelling.
    pub name: String,
    pub value: String,
    /// Type, such as `u32`, `option text 10`, or the name of an enum.
    pub kind: String,
    pub unit: &'static str,
    pub changed: bool, // since the previous picture
}

struct Images {
    memory: Vec<u8>,
    outside: Vec<u8>,
}

impl Images {
    fn of(picture: &Picture) -> Self {
        Self { memory: image(&picture.memory), outside: image(&picture.external) }
    }
}

fn image<T: Plain>(value: &T) -> Vec<u8> {
    let mut bytes = vec![0; T::SIZE];
    value.encode(&mut Writer::new(&mut bytes));
    bytes
}

/// The buffers that a process reads: its command, the status of the processes below it, its external inputs.
#[must_use]
pub fn inputs(process: ProcessId, picture: &Picture, last: Option<&Picture>) -> Vec<Field> {
    let (now, was) = (Images::of(picture), last.map(Images::of));
    let command = command_field(process);
    let status: Vec<String> = process.below().map(|below| format!("{}.status", below.field())).collect();
    let inner = |leaf: &&Leaf| {
        let below = status.iter().map(String::as_str);
        command.iter().copied().chain(below).any(|buffer| is_within(&leaf.path, buffer))
    };
    let outer = |leaf: &&Leaf| match process {
        ProcessId::Task if is_within(&leaf.path, "hws") => true,
        _ => process.reads().iter().any(|front| leaf.path.starts_with(front)),
    };
    let before = |pick: fn(&Images) -> &Vec<u8>| was.as_ref().map(pick);
    let inner =
        MEMORY.iter().filter(inner).map(|leaf| field(leaf, &now.memory, before(|images| &images.memory)));
    let outer =
        OUTSIDE.iter().filter(outer).map(|leaf| field(leaf, &now.outside, before(|images| &images.outside)));
    inner.chain(outer).collect()
}

#[must_use]
pub fn outputs(process: ProcessId, picture: &Picture, last: Option<&Picture>) -> Vec<Field> {
    let (now, was) = (Images::of(picture), last.map(Images::of));
    let header = format!("{}.header", process.field());
    let own = |leaf: &&Leaf| is_within(&leaf.path, process.field()) && !is_within(&leaf.path, &header);
    MEMORY
        .iter()
        .filter(own)
        .map(|leaf| field(leaf, &now.memory, was.as_ref().map(|images| &images.memory)))
        .collect()
}

/// True if a field is the buffer itself or inside it.
#[must_use]
pub fn is_within(path: &str, buffer: &str) -> bool {
    path.strip_prefix(buffer).is_some_and(|rest| rest.starts_with(['.', '[']) || rest.is_empty())
}

pub fn paths() -> impl Iterator<Item = &'static str> {
    MEMORY.iter().chain(OUTSIDE.iter()).map(|leaf| leaf.path.as_str())
}

#[must_use]
pub fn under(buffers: &[&str], picture: &Picture, last: Option<&Picture>) -> Vec<Field> {
    let (now, was) = (Images::of(picture), last.map(Images::of));
    let of = |buffer: &str| {
        let within = |leaf: &&Leaf| is_within(&leaf.path, buffer);
        let memory = MEMORY.iter().filter(within);
        let memory = memory.map(|leaf| field(leaf, &now.memory, was.as_ref().map(|images| &images.memory)));
        let outside = OUTSIDE.iter().filter(within);
        let outside =
            outside.map(|leaf| field(leaf, &now.outside, was.as_ref().map(|images| &images.outside)));
        memory.chain(outside).collect::<Vec<_>>()
    };
    buffers.iter().flat_map(|buffer| of(buffer)).collect()
}

fn field(leaf: &Leaf, now: &[u8], was: Option<&Vec<u8>>) -> Field {
    Field {
        name: leaf.path.clone(),
        value: leaf.text(now),
        kind: leaf.schema.to_string(),
        unit: unit(&leaf.path),
        changed: was.is_some_and(|was| leaf.differs(was, now)),
    }
}

/// The buffers as lines that contain the text of the filter.
#[must_use]
pub fn section(process: ProcessId, picture: &Picture, last: Option<&Picture>, filter: &str) -> Section {
    let lines = |way: &'static str, fields: Vec<Field>| {
        fields.into_iter().filter(|field| holds(field, filter)).map(move |field| text(way, &field))
    };
    let lines: Vec<Text> = lines("in ", inputs(process, picture, last))
        .chain(lines("out", outputs(process, picture, last)))
        .collect();
    Section::new(format!("buffers, {}", amount(lines.len(), "field")), lines)
}

fn holds(field: &Field, filter: &str) -> bool {
    let filter = filter.to_lowercase();
    [&field.name, &field.value, &field.kind].iter().any(|text| text.to_lowercase().contains(&filter))
}

fn text(way: &str, field: &Field) -> Text {
    let Field { name, value, kind, unit, changed } = field;
    let (mark, tone) = if *changed { ("> ", Tone::Marked) } else { ("  ", Tone::Plain) };
    Text::verbatim(
        tone,
        format!("{mark}{way} {name:<38} {:<20} {kind}", format!("{value} {unit}")).trim_end().to_owned(),
    )
}

macro_rules! commands {
    ($(
        #[doc = $doc:literal]
        $id:ident $text:literal {
            buffers: $field:ident, $outputs:ty;
            failure: $failure:ident;
            board: $board:literal;
            commander: $($commander:ident, $above:ident . $command:ident)?;
            reads: $reads:expr;
        }
    )+) => {
        /// The field of common memory with the command of a process; none for Task.
        fn command_field(process: ProcessId) -> Option<&'static str> {
            match process { $( ProcessId::$id => {
                let command: &[&str] = &[ $( concat!(stringify!($above), ".", stringify!($command)) )? ];
                command.first().copied()
            } )+ }
        }
    };
}
for_each_process!(commands);

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::tick::Tick;

    fn picture() -> Picture {
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        Picture { tick: Tick(1), external, memory, timing: None }
    }

    fn value(fields: &[Field], name: &str) -> (String, String, &'static str, bool) {
        let found = fields.iter().find(|field| field.name == name);
        let field = found.unwrap_or_else(|| panic!("{name} is not there"));
        (field.value.clone(), field.kind.clone(), field.unit, field.changed)
    }

    #[test]
    fn process_inputs_are_command_status_below_and_devices() {
        let (was, mut is) = (picture(), picture());
        is.memory.emove.grip.force = 25;
        is.external.devices.grip.strain_left = 1500;
        let fields = inputs(ProcessId::Grip, &is, Some(&was));
        assert_eq!(value(&fields, "emove.grip.force"), ("25".into(), "i32".into(), "lb", true));
        assert_eq!(value(&fields, "devices.grip.strain_left"), ("1500".into(), "u16".into(), "counts", true));
        assert_eq!(value(&fields, "emove.grip.position"), ("0".into(), "i32".into(), "0.01 in", false));
        assert!(fields.iter().all(|field| !field.name.starts_with("emove.v_grip")));
        let fields = inputs(ProcessId::Prim, &is, None);
        assert_eq!(
            value(&fields, "t3i.status.report"),
            ("\"finished\"".into(), "T3iReport".into(), "", false)
        );
        let fields = inputs(ProcessId::Task, &is, None);
        assert_eq!(value(&fields, "hws.number").0, "0");
    }

    #[test]
    fn process_outputs_exclude_its_header() {
        let fields = outputs(ProcessId::Grip, &picture(), None);
        assert!(fields.iter().all(|field| field.name.starts_with("grip.")));
        assert!(fields.iter().all(|field| !field.name.starts_with("grip.header")));
        assert_eq!(value(&fields, "grip.status.position").2, "0.01 in");
    }

    #[test]
    fn filter_matches_names_and_values() {
        let lines = |filter| section(ProcessId::Grip, &picture(), None, filter).lines.len();
        assert!(lines("FORCE") > 0 && lines("FORCE") < lines(""));
        assert_eq!(lines("no such field"), 0);
    }
}
