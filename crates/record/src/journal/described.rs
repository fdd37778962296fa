//! The layout of the entries as compressed text in the journal, so that another program can name the fields that
//! differ.

use std::{collections::BTreeMap, fmt::Write as _, sync::LazyLock};

use rcs_core::digest::Digest;

use super::format::Entry;
use crate::layout;

const LEVEL: i32 = 19; // of the compression
const LONGEST: usize = 1 << 20; // of the text of another program, bytes
const NAMED: usize = 3; // fields that a refusal names

static TEXT: LazyLock<String> = LazyLock::new(|| layout::describe("entry", Entry::STRUCT));

/// The digest by which two layouts are compared.
#[must_use]
pub fn layout_of_entries() -> u64 {
    static DIGEST: LazyLock<u64> = LazyLock::new(|| digest(&TEXT));
    *DIGEST
}

fn digest(text: &str) -> u64 {
    let mut digest = Digest::new();
    digest.add(text.as_bytes());
    digest.value()
}

/// The text of this program's layout, compressed.
pub fn packed() -> &'static [u8] {
    static PACKED: LazyLock<Vec<u8>> =
        LazyLock::new(|| zstd::bulk::compress(TEXT.as_bytes(), LEVEL).unwrap_or_default());
    &PACKED
}

/// The text of another layout with this digest; `None` if it is damaged.
pub fn unpacked(bytes: &[u8], of: u64) -> Option<String> {
    let text = String::from_utf8(zstd::bulk::decompress(bytes, LONGEST).ok()?).ok()?;
    (digest(&text) == of).then_some(text)
}

/// The differences of another layout of entries from this program's.
pub fn differences(theirs: &str) -> String {
    compared(theirs, &TEXT)
}

/// The differences between two texts of [`layout::describe`]: at most three fields, and the number of the others. A
/// field that has only another position is named if no field has another type.
#[must_use]
pub fn compared(theirs: &str, ours: &str) -> String {
    let (theirs, ours) = (Layout::read(theirs), Layout::read(ours));
    let mut found = Vec::new();
    let mut moved = Vec::new();
    for (path, field) in &theirs.fields {
        match ours.fields.get(path) {
            None => found.push(format!("{path} ({field}) is only there")),
            Some(here) if (here.kind, here.size) != (field.kind, field.size) => {
                found.push(format!("{path} is {field} there, {here} here"));
            }
            Some(here) if here.offset != field.offset => {
                moved.push(format!("{path} is at byte {} there, {} here", field.offset, here.offset));
            }
            Some(_) => {}
        }
    }
    let new = ours.fields.iter().filter(|(path, _)| !theirs.fields.contains_key(*path));
    found.extend(new.map(|(path, field)| format!("{path} ({field}) is only here")));
    let differ = |(name, here): &(&&str, &&str)| theirs.types.get(*name).is_some_and(|there| there != *here);
    found.extend(ours.types.iter().filter(differ).map(|(name, _)| format!("the values of {name} differ")));
    if found.is_empty() {
        found = moved;
    }
    let mut text = found.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join("; ");
    let more = found.len().saturating_sub(NAMED);
    if more > 0 {
        let _ = write!(text, "; and {more} more");
    }
    text
}

struct Field<'a> {
    offset: &'a str,
    size: &'a str,
    kind: &'a str,
}

impl std::fmt::Display for Field<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} at byte {}", self.kind, self.offset)
    }
}

/// Fields by path, and the lines of enums and unions by name.
struct Layout<'a> {
    fields: BTreeMap<&'a str, Field<'a>>,
    types: BTreeMap<&'a str, &'a str>,
}

impl<'a> Layout<'a> {
    fn read(text: &'a str) -> Self {
        let (mut fields, mut types) = (BTreeMap::new(), BTreeMap::new());
        for line in text.lines() {
            if let Some((name, values)) = line.split_once(": ") {
                types.insert(name, values);
                continue;
            }
            let parts = line.trim_start().split_once(' ').and_then(|(offset, rest)| {
                let (size, rest) = rest.trim_start().split_once(' ')?;
                let (kind, path) = rest.trim_end().rsplit_once(' ')?;
                Some((path, Field { offset, size, kind: kind.trim_end() }))
            });
            fields.extend(parts);
        }
        // The first lines name records, with their sizes.
        types.retain(|name, _| name.contains(' '));
        Self { fields, types }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OURS: &str = "\
entry: Entry, 31 bytes
     0    3 option u16   number
     3    2 Phase        phase
     5    8 text 8       name
union Phase: 0 \"rest\", 1 \"moves\"
";

    #[test]
    fn fields_that_differ_are_named() {
        assert_eq!(compared(OURS, OURS), "");
        let longer = OURS.replace("text 8 ", "text 10").replace("phase", "stage");
        assert_eq!(
            compared(&longer, OURS),
            "name is text 10 at byte 5 there, text 8 at byte 5 here; stage (Phase at byte 3) is only there; phase \
             (Phase at byte 3) is only here"
        );
        let other = OURS.replace("\"moves\"", "\"stops\"");
        assert_eq!(compared(&other, OURS), "the values of union Phase differ");
        let moved = OURS.replace("     3    2 Phase", "     4    2 Phase");
        assert_eq!(compared(&moved, OURS), "phase is at byte 4 there, 3 here");
        let empty = "entry: Entry, 0 bytes\n";
        assert!(
            compared(empty, OURS).ends_with(
                "number (option u16 at byte 0) is only here; phase (Phase at byte 3) is only here"
            )
        );
    }

    #[test]
    fn packed_layout_is_read_again() {
        assert_eq!(unpacked(packed(), layout_of_entries()).as_deref(), Some(TEXT.as_str()));
        assert_eq!(unpacked(packed(), 1), None);
        assert!(differences(&TEXT).is_empty() && TEXT.lines().count() > 500);
    }
}
