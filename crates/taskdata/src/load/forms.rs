//! The forms of chapter VII, one function each, in the order of the chapter.
//!
//! Ranges that the manual does not give are ASSUMED (SPECNOTES); they are wide enough for every figure.

use std::ops::RangeInclusive;

use diagnostics::{At, nearest};
use geometry::movetable::{MAX_LINES, MovetableLine, System};

use crate::files::{Direction, RefType, TrajPara};

use super::{
    entries::{
        ApprDeptEntry, ArrayEntry, Entry, FileEntry, GripEntry, MovetableEntry, ObjLocEntry, ObjectEntry,
        OwnerEntry, PointAt, PointEntry, PoseEntry, TrajEntry, ViewEntry,
    },
    lex::Word,
    parser::{Parser, Skip, is_integer},
    store::{FILE_NAMES, FILE_RECORDS},
};

const COORDINATE: RangeInclusive<i32> = -20_000..=20_000; // 0.01 in: twice the reach
const ANGLE: RangeInclusive<i32> = -18_000..=18_000; // 0.01 degree
pub(super) const GRIP: RangeInclusive<i32> = -99..=99;
pub(super) const OPENING: RangeInclusive<i32> = 0..=500; // 0.01 in: the parts gripper opens to 5.00 in
pub(super) const FORCE: RangeInclusive<i32> = 0..=200; // lb
const ELEMENTS: RangeInclusive<i32> = 1..=100; // per dimension of an array
const VELOCITY: RangeInclusive<i32> = 1..=140; // 140 counts are the link's 14 in/s (A 2.3)
const FACTOR: RangeInclusive<i32> = 1..=1000; // `acc-fac` and `smooth-acc`
const BREAK_DISTANCE: RangeInclusive<i32> = 0..=5000; // 0.01 in

pub(super) const PLACES: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Owner, RefType::Any];
const ENDS: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Owner];
const MEMBERS: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Pose];
const ASSIGNED: &[RefType] = &[RefType::Array, RefType::LocationPoint];
const POINTS: &[RefType] = &[RefType::Pose, RefType::LocationPoint, RefType::Movetable];
const OFFSET_FROM: &[RefType] = &[RefType::LocationPoint, RefType::Array, RefType::Object];
const SUBJECTS: &[RefType] =
    &[RefType::Object, RefType::View, RefType::LocationPoint, RefType::Array, RefType::Owner, RefType::Any];

/// `-file- name records` (VII, blocks 100-199): the manual prints no declaration, so this form is an extension.
pub fn file(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let word = p.peek();
    let Some((word, file)) = word.and_then(|w| Some((w, *FILE_NAMES.iter().find(|f| **f == w.text)?))) else {
        let skip = p.expected("name of a file");
        if let Some(near) = word.and_then(|w| nearest(w.text, FILE_NAMES.iter().copied())) {
            p.nearest("file", near);
        }
        return Err(skip);
    };
    p.take();
    let most = i32::try_from(FILE_RECORDS).unwrap_or(i32::MAX);
    let records = p.integer("number of records", 1..=most)?;
    Ok(Entry::File(FileEntry {
        file,
        records: usize::try_from(records).unwrap_or(0),
        at: word.at.to(p.last_at()),
    }))
}

/// Nine numbers, `-pose-`, movetable, name (VII.1).
pub fn pose(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    pose_entry(p).inspect_err(|_| p.skip_past("-pose-", 2))
}

fn pose_entry(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let mut points = [[0; 3]; 3];
    let from = p.peek().map_or_else(|| p.last_at(), |w| w.at);
    for (point, name) in points.iter_mut().zip(["wrist", "tool", "finger"]) {
        for (value, axis) in point.iter_mut().zip(["x", "y", "z"]) {
            if p.peek().is_some_and(|word| word.text == "-pose-") {
                return Err(p.expected("a pose of nine numbers, wrist, tool and finger point,"));
            }
            *value = p.integer(format_args!("{axis} of the {name} point"), COORDINATE)?;
        }
    }
    let at = from.to(p.last_at());
    if p.take_if("-pose-").is_none() {
        return Err(p.expected("-pose- after nine numbers"));
    }
    Ok(Entry::Pose(PoseEntry {
        points,
        at,
        movetable: p.name("movetable")?,
        name: p.name("name of the pose")?,
    }))
}

/// Numbered lines that end with `----`, and with `-mtb-` and a name (VII.2).
pub fn movetable(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    movetable_entry(p).inspect_err(|_| p.skip_past("-mtb-", 1))
}

fn movetable_entry(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let mut lines = Vec::new();
    let mut ninth = None;
    loop {
        let number_at = p.peek().map_or_else(|| p.last_at(), |w| w.at);
        let number = p.integer("number of a line", 1..=99)?;
        let expected = i32::try_from(lines.len() + 1).unwrap_or(i32::MAX);
        if number != expected {
            p.flaw(
                "movetable.number",
                number_at,
                format!("line number {expected} was expected, {number} found"),
                None,
            );
        }
        lines.push(movetable_line(p)?);
        if lines.len() == MAX_LINES + 1 {
            ninth = Some(number_at);
        }
        if p.take_if("-mtb-").is_some() {
            break;
        }
        if p.take_if("----").is_none() {
            return Err(p.expected("---- or -mtb- after the values of a line"));
        }
    }
    lines.shrink_to_fit(); // most have one line
    let name = p.name("name of the movetable")?;
    if let Some(at) = ninth {
        let message = format!("a movetable has at most {MAX_LINES} lines, {} has {}", name.name, lines.len());
        p.flaw("movetable.lines", at, message, None);
    }
    Ok(Entry::Movetable(MovetableEntry { lines, name }))
}

/// A coordinate system with one to three values (Table VII.1).
fn movetable_line(p: &mut Parser<'_, '_>) -> Result<MovetableLine, Skip> {
    let word = p.peek().map_or("", |w| w.text);
    let Some(system) = System::from_text(word).filter(|s| *s != System::None) else {
        return Err(p.expected("a coordinate system (rw, t, to, wo, ro)"));
    };
    p.take();
    let (range, names): (_, &[&str]) = match system {
        System::None | System::World | System::Tool => (COORDINATE, &["x", "y", "z"]),
        System::ToolOrigin | System::WristOrigin => (ANGLE, &["pit", "yaw"]),
        System::Roll => (ANGLE, &["roll"]),
    };
    let mut values = [0; 3];
    for (value, name) in values.iter_mut().zip(names) {
        *value = p.integer(name, range.clone())?;
    }
    // The columns that a rotation does not use contain zeros.
    for _ in names.len()..values.len() {
        if p.peek().is_some_and(|w| is_integer(w.text)) {
            p.integer(format_args!("unused column of {system}"), 0..=0)?;
        }
    }
    Ok(MovetableLine { system, values })
}

/// `-pt-` and `-ar-`: name, pose, movetable (VII.3, VII.4).
pub fn point_at(p: &mut Parser<'_, '_>, what: &str) -> Result<PointAt, Skip> {
    Ok(PointAt {
        name: p.name(format_args!("name of the {what}"))?,
        pose: p.name("pose")?,
        movetable: p.name("movetable")?,
    })
}

/// `-arr-` (VII.4): an array of one dimension omits the fields of the second (Figure VII.5, TL-SECTORS).
pub fn array(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let name = p.name("name of the array")?;
    let word = p.peek();
    let dimensions = p.integer("number of dimensions", 1..=2)?;
    // With a wrong number of dimensions the rest has no known meaning.
    if word.is_some_and(|word| word.text.parse() != Ok(dimensions)) {
        return Err(Skip);
    }
    let columns = p.integer("elements in the first dimension", ELEMENTS)?;
    let rows = if dimensions == 2 { p.integer("elements in the second dimension", ELEMENTS)? } else { 1 };
    let column_step = p.name("movetable of the first dimension")?;
    let row_step = if dimensions == 2 { Some(p.name("movetable of the second dimension")?) } else { None };
    let present = p.integer("# pres", 0..=columns.saturating_mul(rows))?;
    Ok(Entry::Array(ArrayEntry { name, dimensions, columns, rows, column_step, row_step, present }))
}

pub fn owner(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let name = p.name("name of the owner")?;
    let mut members = Vec::new();
    while p.take_if("-m-").is_some() {
        members.push(p.typed("member", MEMBERS)?);
    }
    if members.is_empty() {
        return Err(p.expected("-m- with a member of the owner"));
    }
    Ok(Entry::Owner(OwnerEntry { name, members }))
}

pub fn trajectory(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let name = p.name("name of the trajectory")?;
    let start = p.typed("start", ENDS)?;
    let end = p.typed("end", ENDS)?;
    let points = points(p)?;
    for point in points.iter().filter(|point| point.target.is_none()) {
        p.flaw("path.stop", point.at, "only an approach has a stop point", None);
    }
    Ok(Entry::Traj(TrajEntry { name, start, end, points }))
}

fn points(p: &mut Parser<'_, '_>) -> Result<Vec<PointEntry>, Skip> {
    let mut points = Vec::new();
    while let Some(word) = p.take_if("-ppt") {
        let para = parameters(p)?;
        let target = if p.take_if("stop").is_some() { None } else { Some(p.typed("path point", POINTS)?) };
        points.push(PointEntry { para, target, at: word.at.to(p.last_at()) });
    }
    points.shrink_to_fit(); // most paths have one or two points
    Ok(points)
}

/// The four parameters of a segment (VII.6).
pub fn parameters(p: &mut Parser<'_, '_>) -> Result<TrajPara, Skip> {
    Ok(TrajPara {
        acc_fac: p.integer("acc-fac", FACTOR)?,
        vel_max: p.integer("vel-max", VELOCITY)?,
        smooth: p.integer("smooth-acc", FACTOR)?,
        brk_dst: p.integer("brk-dst", BREAK_DISTANCE)?,
    })
}

pub fn object(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let name = p.name("name of the object")?;
    let grip = p.integer("grip number", GRIP)?;
    let at = name.at.to(p.last_at());
    let values = [
        p.integer("approach size", OPENING)?,
        p.integer("grasp size", OPENING)?,
        p.integer("grasp force", FORCE)?,
        p.integer("depart size", OPENING)?,
    ];
    Ok(Entry::Object(ObjectEntry { name, grip, at, values }))
}

pub fn object_location(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    Ok(Entry::ObjLoc(ObjLocEntry {
        object: p.name("object")?,
        assigned: p.typed("assigned location", ASSIGNED)?,
    }))
}

pub fn grip(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    Ok(Entry::Grip(GripEntry {
        object: p.name("object")?,
        grip: p.integer("grip number", GRIP)?,
        place: p.typed("location", PLACES)?,
        movetable: p.name("grip movetable")?,
    }))
}

pub fn view(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    Ok(Entry::View(ViewEntry {
        object: p.name("object")?,
        grip: p.integer("grip number", GRIP)?,
        id: p.integer("vision id", 0..=255)?,
        place: p.typed("location", PLACES)?,
        movetable: p.name("view movetable")?,
        offset_from: p.kind("type of the movetable's reference", OFFSET_FROM)?.0,
        range: p.integer("range in mm", 1..=3000)?,
        enabled: p.integer("en", 0..=1)? == 1,
    }))
}

pub fn approach_depart(p: &mut Parser<'_, '_>, word: Word<'_>) -> Result<Entry, Skip> {
    let direction =
        if word.text == Direction::Approach.text() { Direction::Approach } else { Direction::Depart };
    let subject = p.typed("what is approached or departed", SUBJECTS)?;
    let of_object = matches!(subject.kind, RefType::Object | RefType::View);
    let (grip, place) = if of_object {
        (p.integer("grip number", GRIP)?, Some(p.typed("location", PLACES)?))
    } else {
        (0, None)
    };
    let at = word.at.to(p.last_at());
    let points = points(p)?;
    check_stop(p, direction, at, &points);
    Ok(Entry::ApprDept(ApprDeptEntry { direction, subject, grip, place, points, at }))
}

/// An approach ends with its only stop point; a depart has none (VII.7.7).
fn check_stop(p: &mut Parser<'_, '_>, direction: Direction, at: At, points: &[PointEntry]) {
    if direction == Direction::Depart {
        for point in points.iter().filter(|point| point.target.is_none()) {
            p.flaw("path.stop", point.at, "a depart has no stop point", None);
        }
        return;
    }
    match points.split_last() {
        Some((last, before)) if last.target.is_none() => {
            for point in before.iter().filter(|point| point.target.is_none()) {
                p.flaw("path.stop", point.at, "the stop point is the last point of an approach", None);
            }
        }
        _ => {
            let help = "add a last line such as `-ppt 04 05 40 0 stop`".to_owned();
            p.flaw("path.stop", at, "an approach ends with a stop point, this one does not", Some(help));
        }
    }
}
