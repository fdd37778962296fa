//! Prints entries as the manual's forms, which can be read again. Each part with a compiling word (`-ppt`, `-m-`,
//! `----`) has its own line. If a form has more lines than a block, its parts are not separated by line breaks. This
//! always fits, since an entry of a block fits into a block.

use super::{
    entries::{
        ApprDeptEntry, ArrayEntry, Entry, FileEntry, GripEntry, MovetableEntry, ObjLocEntry, ObjectEntry,
        OwnerEntry, PointAt, PointEntry, PoseEntry, RelativeEntry, SensorEntry, ShowEntry, TrajEntry, Typed,
        ViewEntry,
    },
    show::{OBJ_GRIPS, PED_PARA},
    source::{BLOCK_COLUMNS, BLOCK_LINES, LAST_BLOCK},
};
use crate::files::{RefType, TrajPara};
use geometry::movetable::{MovetableLine, System};

const INDENT: &str = "  "; // without this indent a form could be read as a listing with line numbers

#[must_use]
pub fn form(entry: &Entry) -> Vec<String> {
    let parts = parts(entry);
    let lines: Vec<String> = parts.iter().flat_map(|words| filled(words)).collect();
    if lines.len() <= BLOCK_LINES { lines } else { filled(&parts.concat()) }
}

/// Prints blocks from `first` on, at `offset`. Block 999 is followed by block 0 of the next offset. An entry with more
/// lines than a block gets its own block, which cannot be loaded.
#[must_use]
pub fn blocks<'e>(entries: impl IntoIterator<Item = &'e Entry>, offset: u32, first: u32) -> String {
    let (mut offset, mut number) = (offset, first);
    let mut text = String::new();
    let mut free = 0;
    for entry in entries {
        let lines = form(entry);
        if lines.len() > free {
            text.push_str(&format!("BLOCK# {number} OFFSET {offset}\n"));
            free = BLOCK_LINES;
            (offset, number) =
                if number >= LAST_BLOCK { (offset.saturating_add(1000), 0) } else { (offset, number + 1) };
        }
        free = free.saturating_sub(lines.len());
        for line in lines {
            text.push_str(&line);
            text.push('\n');
        }
    }
    text
}

fn filled(words: &[String]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= BLOCK_COLUMNS => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(format!("{INDENT}{word}")),
        }
    }
    lines
}

fn parts(entry: &Entry) -> Vec<Vec<String>> {
    match entry {
        Entry::File(e) => vec![file(e)],
        Entry::Pose(e) => pose(e),
        Entry::Movetable(e) => movetable(e),
        Entry::Locpt(e) => vec![point_at("-pt-", e)],
        Entry::Array(e) => vec![array(e)],
        Entry::ArrayAt(e) => vec![point_at("-ar-", e)],
        Entry::Owner(e) => owner(e),
        Entry::Traj(e) => trajectory(e),
        Entry::Object(e) => vec![object(e)],
        Entry::ObjGrips(e) => {
            let names: Vec<&str> = OBJ_GRIPS.iter().map(|variable| variable.0).collect();
            show(e, "\"object\"", &names, "OBJ-GRIPS")
        }
        Entry::ObjLoc(e) => vec![object_location(e)],
        Entry::PedPara(e) => {
            let names: Vec<&str> = PED_PARA.iter().map(|variable| variable.0).collect();
            show(e, "\"p-object\"", &names, "PED-PARA")
        }
        Entry::Grip(e) => vec![grip(e)],
        Entry::View(e) => vec![view(e)],
        Entry::ApprDept(e) => approach_depart(e),
        Entry::Sensor(e) => vec![sensor(e)],
        Entry::Relative(e) => vec![relative_move(e)],
    }
}

macro_rules! words {
    ($($word:expr),+ $(,)?) => { vec![$($word.to_string()),+] };
}

fn file(e: &FileEntry) -> Vec<String> {
    words!["-file-", e.file, e.records]
}

fn pose(e: &PoseEntry) -> Vec<Vec<String>> {
    let mut parts: Vec<Vec<String>> =
        e.points.iter().map(|point| point.iter().map(i32::to_string).collect()).collect();
    if let Some(last) = parts.last_mut() {
        last.extend(words!["-pose-", e.movetable.name, e.name.name]);
    }
    parts
}

fn movetable(e: &MovetableEntry) -> Vec<Vec<String>> {
    let count = e.lines.len();
    let numbered = e.lines.iter().zip(1..);
    numbered
        .map(|(line, number)| {
            let mut words = words![number, line.system.text()];
            words.extend(values(line).iter().map(i32::to_string));
            if number == count {
                words.extend(words!["-mtb-", e.name.name]);
            } else {
                words.push("----".to_owned());
            }
            words
        })
        .collect()
}

fn values(line: &MovetableLine) -> &[i32] {
    let count = match line.system {
        System::None | System::World | System::Tool => 3,
        System::ToolOrigin | System::WristOrigin => 2,
        System::Roll => 1,
    };
    line.values.get(..count).unwrap_or_default()
}

fn point_at(word: &str, e: &PointAt) -> Vec<String> {
    words![word, e.name.name, e.pose.name, e.movetable.name]
}

fn array(e: &ArrayEntry) -> Vec<String> {
    let mut words = words!["-arr-", e.name.name, e.dimensions, e.columns];
    if e.dimensions == 2 {
        words.push(e.rows.to_string());
    }
    words.push(e.column_step.name.to_string());
    words.extend(e.row_step.iter().map(|step| step.name.to_string()));
    words.push(e.present.to_string());
    words
}

fn typed(typed: &Typed) -> Vec<String> {
    if typed.kind == RefType::Any {
        words![typed.kind.text()]
    } else {
        words![typed.kind.text(), typed.name.name]
    }
}

fn owner(e: &OwnerEntry) -> Vec<Vec<String>> {
    let mut parts = vec![words!["-own-", e.name.name]];
    for (i, member) in e.members.iter().enumerate() {
        let mut words = words!["-m-"];
        words.extend(typed(member));
        match parts.first_mut() {
            Some(first) if i == 0 => first.extend(words),
            _ => parts.push(words),
        }
    }
    parts
}

fn parameters(para: &TrajPara) -> Vec<String> {
    words![para.acc_fac, para.vel_max, para.smooth, para.brk_dst]
}

fn points(entries: &[PointEntry]) -> impl Iterator<Item = Vec<String>> {
    entries.iter().map(|point| {
        let mut words = words!["-ppt"];
        words.extend(parameters(&point.para));
        words.extend(point.target.as_ref().map_or_else(|| words!["stop"], typed));
        words
    })
}

fn trajectory(e: &TrajEntry) -> Vec<Vec<String>> {
    let mut first = words!["-traj", e.name.name];
    first.extend(typed(&e.start));
    first.extend(typed(&e.end));
    std::iter::once(first).chain(points(&e.points)).collect()
}

fn object(e: &ObjectEntry) -> Vec<String> {
    let mut words = words!["-obj-", e.name.name, e.grip];
    words.extend(e.values.iter().map(i32::to_string));
    words
}

fn show<const N: usize>(e: &ShowEntry<N>, name: &str, variables: &[&str], file: &str) -> Vec<Vec<String>> {
    let mut parts = vec![words![":S", name, "<=", e.object.name]];
    parts.extend(variables.iter().zip(e.values).map(|(variable, value)| words![variable, "<=", value]));
    parts.push(words![":R", ">FILE", file]);
    parts
}

fn object_location(e: &ObjLocEntry) -> Vec<String> {
    let mut words = words!["-o-loc-", e.object.name];
    words.extend(typed(&e.assigned));
    words
}

fn grip(e: &GripEntry) -> Vec<String> {
    let mut words = words!["-grip-", e.object.name, e.grip];
    words.extend(typed(&e.place));
    words.push(e.movetable.name.to_string());
    words
}

fn view(e: &ViewEntry) -> Vec<String> {
    let mut words = words!["-vu-", e.object.name, e.grip, e.id];
    words.extend(typed(&e.place));
    words.extend(words![e.movetable.name, e.offset_from.text(), e.range, i32::from(e.enabled)]);
    words
}

fn approach_depart(e: &ApprDeptEntry) -> Vec<Vec<String>> {
    let mut first = words![e.direction.text()];
    first.extend(typed(&e.subject));
    if let Some(place) = &e.place {
        first.push(e.grip.to_string());
        first.extend(typed(place));
    }
    std::iter::once(first).chain(points(&e.points)).collect()
}

fn sensor(e: &SensorEntry) -> Vec<String> {
    words!["-sen-", e.name.name, e.source.text(), e.which, e.threshold]
}

fn relative_move(e: &RelativeEntry) -> Vec<String> {
    let mut words = words!["-rel-", e.name.name];
    words.extend(typed(&e.place));
    words.extend(parameters(&e.para));
    words.push(e.movetable.name.to_string());
    words.extend(e.sensor.iter().map(|sensor| sensor.name.to_string()));
    words
}
