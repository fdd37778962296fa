//! The behaviour of a run as text, independent of the layout of records and of the numbers of tables and rows. A
//! golden has digests of byte images, which such a change alters. A trace names each field by its path and writes each
//! value as text; [`crate::compare`] compares the traces of two versions.
//!
//! ```text
//! 1       emove.status.report      idle              tick, path, value; in the first tick all fields,
//! 57      emove.fired              mov_to_loc 4      then those that changed; the row that fired, by name
//! 57      device.grip.bits         130               what goes to the devices
//! end     status                   0                 how the run ended
//! ```
//!
//! The columns are separated by tabs; the file is compressed (`zstd -dc < NAME.trace`).

use std::{
    fs::File,
    io::{self, BufRead, BufReader, BufWriter, Write},
    path::{Path, PathBuf},
};

use interfaces::{CommonMemory, Decided, DeviceOutputs, Header};
use rcs_core::{
    Plain,
    plain::{Schema, StructSchema, Writer, from_bytes},
    reflect,
    tick::Tick,
};
use record::{
    Log, ReadError,
    channels::{HeaderPlace, headers},
};
use zstd::stream::{read::Decoder, write::Encoder};

use crate::golden::{Ending, Failed};

pub const EXTENSION: &str = "trace";
pub const END: &str = "end"; // for a tick, in the lines about the end
pub const TICKS: &str = "ticks"; // number of ticks, a fact of the end
pub const FIRED: &str = ".fired"; // ends the path with the row that fired
pub const ABSENT: &str = "-"; // the field belongs to another variant of an enum with data
const DEVICE: &str = "device";
/// `age` is written for the stamp, and `fired` for the row and its step.
const NOT_WRITTEN: [&str; 3] = ["stamp", "decided", "step"];

#[must_use]
pub fn path(directory: &Path, scenario: &str) -> PathBuf {
    directory.join(scenario).with_added_extension(EXTENSION)
}

pub fn write(log: &Log, ending: &Ending, path: &Path) -> Result<u64, Failed> {
    log.check_layout()?;
    let failed = |source| Failed::File { path: path.to_owned(), source };
    let unfinished = path.with_added_extension("unfinished"); // an interrupted trace never gets its final name
    let file = File::create(&unfinished).map_err(failed)?;
    let encoder = Encoder::new(file, zstd::DEFAULT_COMPRESSION_LEVEL).map_err(failed)?;
    let mut tracer = Tracer::new(BufWriter::new(encoder));
    for logged in log.ticks() {
        let logged = logged?;
        if logged.gap > 0 {
            return Err(Failed::Gap(logged.tick));
        }
        let memory: CommonMemory =
            from_bytes(&logged.memory).map_err(|_| ReadError::Damaged { tick: logged.tick.0 })?;
        tracer.tick(logged.tick, &memory).map_err(failed)?;
    }
    let ticks = tracer.ticks;
    let buffered = tracer.finish(ending).map_err(failed)?;
    let encoder = buffered.into_inner().map_err(|error| failed(error.into_error()))?;
    encoder.finish().and_then(|file| file.sync_all()).map_err(failed)?;
    std::fs::rename(&unfinished, path).map_err(failed)?;
    Ok(ticks)
}

pub fn open(path: &Path) -> io::Result<impl BufRead + use<>> {
    Ok(BufReader::with_capacity(1 << 20, Decoder::new(File::open(path)?)?))
}

pub struct Tracer<W> {
    out: W,
    headers: Vec<HeaderPlace>,
    memory: Images,
    devices: Images,
    decided: Vec<Option<(u64, String)>>, // per process: age of the outputs, and the row that fired
    ticks: u64,
}

struct Images {
    was: Option<Vec<u8>>,
    is: Vec<u8>,
}

impl Images {
    const fn new() -> Self {
        Self { was: None, is: Vec::new() }
    }

    fn change<T: Plain>(&mut self, record: &T, prefix: &str, visit: &mut Visit<'_>) -> io::Result<()> {
        self.is.resize(T::SIZE, 0);
        record.encode(&mut Writer::new(&mut self.is));
        changes(&T::SCHEMA, &mut prefix.to_owned(), self.was.as_deref(), &self.is, visit)?;
        let was = self.was.get_or_insert_default();
        std::mem::swap(was, &mut self.is);
        Ok(())
    }
}

impl<W: Write> Tracer<W> {
    #[must_use]
    pub fn new(out: W) -> Self {
        let headers = headers();
        let decided = vec![None; headers.len()];
        Self { out, headers, memory: Images::new(), devices: Images::new(), decided, ticks: 0 }
    }

    pub fn tick(&mut self, tick: Tick, memory: &CommonMemory) -> io::Result<()> {
        let Self { out, .. } = self;
        let mut line = |path: &str, value: &str| writeln!(out, "{tick}\t{path}\t{}", plain(value));
        self.memory.change(memory, "", &mut line)?;
        self.devices.change::<DeviceOutputs>(&memory.device_outputs(), DEVICE, &mut line)?;
        // `change` has made the image of this tick the previous one.
        let image = self.memory.was.as_deref().unwrap_or_default();
        for (place, decided) in self.headers.iter().zip(&mut self.decided) {
            let header = place.read(image);
            let (age, fired) = (tick.since(header.stamp), fired(place, &header));
            if decided.as_ref().is_none_or(|(before, _)| *before != age) {
                line(&format!("{}.header.age", place.field), &age.to_string())?;
            }
            if decided.as_ref().is_none_or(|(_, before)| *before != fired) {
                line(&format!("{}{FIRED}", place.field), &fired)?;
            }
            *decided = Some((age, fired));
        }
        self.ticks += 1;
        Ok(())
    }

    pub fn finish(mut self, ending: &Ending) -> io::Result<W> {
        let status = ending.status.map_or("a signal".to_owned(), |status| status.to_string());
        let last_line = without_rows(&ending.last_line);
        let facts = [(TICKS, self.ticks.to_string()), ("status", status), ("last line", last_line)];
        for (path, value) in facts {
            writeln!(self.out, "{END}\t{path}\t{}", plain(&value))?;
        }
        Ok(self.out)
    }
}

type Visit<'a> = dyn FnMut(&str, &str) -> io::Result<()> + 'a; // path and value of a field

/// Visits the fields that differ between `was` and `is`, or all of `is` without `was`. This `match` is the only place
/// in traces for a new kind of [`Schema`]:
/// * An option: `none`, or the value; of a record, an enum with data, `none` or `some`.
/// * An enum with data: the text of the variant at `path`, its fields below. A field that only the previous variant
///   had gets [`ABSENT`], as does a field that was never written; those of the new variant are visited without `was`.
fn changes(
    schema: &Schema,
    path: &mut String,
    was: Option<&[u8]>,
    is: &[u8],
    visit: &mut Visit<'_>,
) -> io::Result<()> {
    if was == Some(is) {
        return Ok(());
    }
    match schema {
        Schema::Struct(record) => record_changes(record, path, was, is, visit),
        // A frame on the line is written as one word, not as 64 numbers.
        Schema::Array(of, _) if **of == Schema::U8 => visit(path, &hex(is)),
        Schema::Array(of, _) => {
            let size = of.size();
            for (index, item) in is.chunks_exact(size).enumerate() {
                let was = was.and_then(|was| was.get(index * size..)?.get(..size));
                let length = path.len();
                path.push_str(&format!("[{index}]"));
                changes(of, path, was, item, visit)?;
                path.truncate(length);
            }
            Ok(())
        }
        Schema::U8 | Schema::U16 | Schema::U32 | Schema::U64 => {
            visit(path, &reflect::unsigned(is).to_string())
        }
        Schema::I16 | Schema::I32 => visit(path, &reflect::signed(is).to_string()),
        // The shortest text from which the same number comes back.
        Schema::F64 => visit(path, &f64::from_bits(reflect::unsigned(is)).to_string()),
        Schema::Bool => visit(path, if reflect::unsigned(is) == 0 { "false" } else { "true" }),
        Schema::Text(_) => visit(path, reflect::text(is)),
        Schema::Enum(of) => {
            let code = reflect::unsigned(is);
            match of.variants.iter().find(|variant| u64::from(variant.code) == code) {
                Some(variant) => visit(path, variant.text),
                None => visit(path, &format!("code {code}")),
            }
        }
        Schema::Option(of) => {
            let carried = |code: u8| (code != 0).then_some(**of);
            carried_changes(
                if is.first() == Some(&0) { "none" } else { "some" },
                carried,
                path,
                was,
                is,
                visit,
            )
        }
        Schema::Union(of) => {
            let variant = |code: u8| of.variants.iter().find(|variant| variant.code == code);
            let text =
                is.first().and_then(|code| variant(*code)).map_or("no variant", |variant| variant.text);
            carried_changes(text, |code| variant(code)?.payload, path, was, is, visit)
        }
    }
}

/// `text` at `path` for a new variant, then its data.
fn carried_changes(
    text: &str,
    carried: impl Fn(u8) -> Option<Schema>,
    path: &mut String,
    was: Option<&[u8]>,
    is: &[u8],
    visit: &mut Visit<'_>,
) -> io::Result<()> {
    let (Some((code, is)), was) = (is.split_first(), was.and_then(<[u8]>::split_first)) else {
        return Ok(());
    };
    let same = was.filter(|(before, _)| *before == code);
    // A value without parts is written as its own text.
    let alone = |schema: &Schema| !matches!(schema, Schema::Struct(_) | Schema::Option(_) | Schema::Union(_));
    let now = carried(*code);
    if same.is_none() && now.as_ref().is_none_or(|schema| !alone(schema)) {
        visit(path, text)?;
    }
    if let Some((before, bytes)) = was.filter(|_| same.is_none())
        && let Some(schema) = carried(*before).filter(|schema| !alone(schema))
    {
        let mut absent = |path: &str, _: &str| visit(path, ABSENT);
        changes(&schema, path, None, bytes.get(..schema.size()).unwrap_or_default(), &mut absent)?;
    }
    match now {
        Some(schema) => {
            let size = schema.size();
            let was = same.and_then(|(_, bytes)| bytes.get(..size));
            changes(&schema, path, was, is.get(..size).unwrap_or_default(), visit)
        }
        None => Ok(()),
    }
}

fn record_changes(
    record: &StructSchema,
    path: &mut String,
    was: Option<&[u8]>,
    is: &[u8],
    visit: &mut Visit<'_>,
) -> io::Result<()> {
    let is_header = record.name == Header::STRUCT.name;
    let mut start = 0;
    for field in record.fields {
        let bytes = start..start + field.schema.size();
        start = bytes.end;
        if is_header && NOT_WRITTEN.contains(&field.name) {
            continue;
        }
        let length = path.len();
        if length > 0 {
            path.push('.');
        }
        path.push_str(field.name);
        let was = was.and_then(|was| was.get(bytes.clone()));
        changes(&field.schema, path, was, is.get(bytes).unwrap_or_default(), visit)?;
        path.truncate(length);
    }
    Ok(())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect()
}

/// The only place that knows how a header names a row.
fn fired(place: &HeaderPlace, header: &Header) -> String {
    let Some(Decided { table, row }) = header.decided else { return "none".into() };
    match place.process.table(table) {
        Some(table) => format!("{} {row}", table.name),
        None => format!("table-{table} {row}"),
    }
}

/// `the gripper is stuck (table position, row 2: clock Expired => Fail(Stuck))` becomes `the gripper is stuck`.
fn without_rows(sentence: &str) -> String {
    let mut rest = sentence;
    let mut text = String::new();
    while let Some((front, behind)) = rest.split_once(" (table ") {
        text.push_str(front);
        let mut open = 1;
        let end = behind.find(|letter| {
            open += match letter {
                '(' => 1,
                ')' => -1,
                _ => 0,
            };
            open == 0
        });
        rest = end.and_then(|end| behind.get(end + 1..)).unwrap_or_default();
    }
    text + rest
}

fn plain(value: &str) -> String {
    let escape = |letter: char| match letter.is_control() {
        true => letter.escape_default().to_string(),
        false => letter.to_string(),
    };
    value.chars().map(escape).collect()
}
