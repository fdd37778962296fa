//! The bytes of a journal (docs/design/resume.md "Format").
//!
//! ```text
//! head     RCSJRNL\0   version u32   slots u32   layout u64   description u32   length u32   identity   zeros   hash u64
//! layout   description of the entries, compressed   zeros
//! slot 0   sequence u64   entry   hash u64   zeros
//! ...
//! note     tick u64   zeros
//! ```
//!
//! All numbers are little-endian. The hash of a slot includes that of the head, so that a slot of another journal is
//! invalid. Entry `n` is in slot `n mod slots`: an interrupted write damages only one slot, so the earlier entries
//! stay. The note is the first tick whose entry the disk did not accept, and zero when it has accepted a later one.

use std::{collections::BTreeMap, sync::LazyLock};

use interfaces::{CommonMemory, HwsCommand};
use rcs_core::{
    Plain,
    digest::Digest,
    plain::{Writer, from_bytes},
    tick::Tick,
};

use super::{
    described::{differences, layout_of_entries, packed, unpacked},
    doubt::{RunEnd, doubted},
    kept::resumed,
};

pub const MAGIC: [u8; 8] = *b"RCSJRNL\0"; // first bytes of every journal
const VERSION: u32 = 2;
const BLOCK: usize = 4096; // unit of the parts of a journal, bytes: no two parts share a block of the disk
const HEAD: usize = BLOCK; // bytes of the head
pub const SLOTS: usize = 8;
pub const SLOT: usize = (8 + Entry::SIZE + 8).div_ceil(BLOCK) * BLOCK; // bytes of a slot
pub const FIRST: u64 = 1;
const HEAD_HASH: usize = HEAD - 8; // position of the hash in the head
const DESCRIBED: usize = 24; // position of the length of the description in the head
const IDENTITY: usize = 32; // position of the identity in the head

/// Position of the first slot.
static BEGIN: LazyLock<usize> = LazyLock::new(|| HEAD + packed().len().div_ceil(BLOCK) * BLOCK);

/// The length of a journal, bytes.
#[must_use]
pub fn length() -> usize {
    note_at() + BLOCK
}

/// The position of the note on trouble.
#[must_use]
pub fn note_at() -> usize {
    *BEGIN + SLOTS * SLOT
}

/// The knowledge of a controller after a tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Entry {
    /// The last tick for which the entry is valid.
    pub tick: Tick,
    /// Milliseconds since 1970; 0 in fast clock.
    pub written: u64,
    /// The job has ended: nothing is left to resume.
    pub over: bool,
    /// Present line of the job, from 1; 0 before the first.
    pub line: u32,
    /// False if the line has not begun.
    pub begun: bool,
    /// Lines `** after` before it whose actions have not started, one bit each, the nearest first.
    pub delayed: u16,
    /// A person must name the line, and has not named it.
    pub asks_line: bool,
    /// Generation of the task data.
    pub generation: u32,
    /// The command of the workstation controller.
    pub hws: HwsCommand,
    /// The buffers, as of [`super::kept()`].
    pub memory: CommonMemory,
}

/// Task data, job, cell and program of a journal, by name.
pub type Identity = BTreeMap<String, String>;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    #[error("it is not a journal: it does not begin with RCSJRNL")]
    Foreign,
    #[error("it is a journal in version {found} of the format, expected {VERSION}")]
    Version { found: u32 },
    #[error("a journal of {} bytes was expected, found {found}: the file was cut or extended", length())]
    Length { found: usize },
    #[error("the head of the journal is damaged")]
    Head,
    /// The program that wrote it has other buffers.
    #[error("its buffers differ: {differences}; use the program that wrote it{}", by(.program))]
    Layout { differences: String, program: String },
    #[error("the journal has no entry: the run was stopped before its first tick")]
    Empty,
    #[error(
        "{damaged} of {SLOTS} entries of the journal are damaged: one write that was cut off damages one"
    )]
    Damaged { damaged: usize },
    #[error("the entry before number {newest} of the journal is damaged or missing")]
    Gap { newest: u64 },
}

fn by(program: &str) -> String {
    if program.is_empty() { String::new() } else { format!(" (version {program})") }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    pub identity: Identity,
    pub newest: Entry, // the newest complete entry
    pub sequence: u64, // its number; 0 for the image of a log
    pub end: RunEnd,
}

impl Contents {
    /// Buffers for a start after tick `after`, as far as DOUBT keeps them.
    #[must_use]
    pub fn memory(&self, after: Tick) -> CommonMemory {
        resumed(&doubted(&self.newest.memory, self.end), after)
    }
}

pub const PROGRAM: &str = "program"; // key of the identity: version of the program
pub const LOG: &str = "log"; // key of the identity: path of the log of the run

/// Also returns the hash on which the hashes of its slots are based. A too long identity is cut at a line.
#[must_use]
pub fn head(identity: &Identity) -> (Vec<u8>, u64) {
    let mut text = String::new();
    for (key, value) in identity {
        let line = format!("{key} {}\n", value.replace('\n', " "));
        if IDENTITY + text.len() + line.len() <= HEAD_HASH {
            text += &line;
        }
    }
    let length = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let slots = u32::try_from(SLOTS).unwrap_or(u32::MAX);
    let described = u32::try_from(packed().len()).unwrap_or(u32::MAX);
    let mut bytes = Vec::with_capacity(HEAD);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(slots.to_le_bytes());
    bytes.extend(layout_of_entries().to_le_bytes());
    bytes.extend(described.to_le_bytes());
    bytes.extend(length.to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.resize(HEAD_HASH, 0);
    let hash = hash(0, &bytes);
    bytes.extend(hash.to_le_bytes());
    (bytes, hash)
}

/// A journal with at most one entry, and the hash on which the hashes of its slots are based.
#[must_use]
pub fn begun(identity: &Identity, first: Option<&Entry>) -> (Vec<u8>, u64) {
    let (mut bytes, hash) = head(identity);
    bytes.extend(packed());
    bytes.resize(length(), 0);
    if let (Some(entry), Some(slot)) = (first, bytes.get_mut(place(FIRST)..)) {
        fill(slot, hash, FIRST, entry);
    }
    (bytes, hash)
}

#[must_use]
pub fn place(sequence: u64) -> usize {
    let slots = u64::try_from(SLOTS).unwrap_or(1);
    *BEGIN + usize::try_from(sequence % slots).unwrap_or(0) * SLOT
}

/// Write an entry into the bytes of its slot. Does not allocate.
pub fn fill(slot: &mut [u8], of_head: u64, sequence: u64, entry: &Entry) {
    let Some((number, rest)) = slot.split_first_chunk_mut::<8>() else { return };
    let Some((image, rest)) = rest.split_at_mut_checked(Entry::SIZE) else { return };
    *number = sequence.to_le_bytes();
    entry.encode(&mut Writer::new(image));
    let hash = hash_of_slot(of_head, sequence, image);
    let Some((place, _)) = rest.split_first_chunk_mut::<8>() else { return };
    *place = hash.to_le_bytes();
}

/// Read a journal. Fails unless its newest complete entry is certain. One later entry may be incomplete.
pub fn read(bytes: &[u8]) -> Result<Contents, FormatError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(FormatError::Foreign);
    }
    let number =
        |at: usize| bytes.get(at..).and_then(|rest| rest.first_chunk()).map(|n| u32::from_le_bytes(*n));
    let long =
        |at: usize| bytes.get(at..).and_then(|rest| rest.first_chunk()).map(|n| u64::from_le_bytes(*n));
    let found = number(8).ok_or(FormatError::Head)?;
    if found != VERSION {
        return Err(FormatError::Version { found });
    }
    let (head, of_head) = bytes.get(..HEAD_HASH).zip(long(HEAD_HASH)).ok_or(FormatError::Head)?;
    if hash(0, head) != of_head {
        return Err(FormatError::Head);
    }
    let size = |at: usize| number(at).and_then(|size| usize::try_from(size).ok()).unwrap_or_default();
    let text =
        head.get(IDENTITY..).and_then(|rest| rest.get(..size(IDENTITY - 4))).ok_or(FormatError::Head)?;
    let text = std::str::from_utf8(text).map_err(|_| FormatError::Head)?;
    let identity: Identity = text
        .lines()
        .filter_map(|line| line.split_once(' '))
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .collect();
    let layout = long(16).unwrap_or_default();
    if layout != layout_of_entries() {
        let program = identity.get(PROGRAM).cloned().unwrap_or_default();
        let described = bytes.get(HEAD..).and_then(|rest| rest.get(..size(DESCRIBED)));
        let text = described.and_then(|described| unpacked(described, layout));
        let differences =
            text.map_or_else(|| "their description is damaged".to_owned(), |text| differences(&text));
        return Err(FormatError::Layout { differences, program });
    }
    if bytes.len() != length() {
        return Err(FormatError::Length { found: bytes.len() });
    }
    let slots = bytes.get(*BEGIN..note_at()).unwrap_or_default().chunks(SLOT);
    let slots: Vec<Slot> = slots.map(|slot| look(of_head, slot)).collect();
    let damaged = slots.iter().filter(|slot| matches!(slot, Slot::Damaged)).count();
    if damaged > 1 {
        return Err(FormatError::Damaged { damaged });
    }
    let newest = slots.iter().filter_map(Slot::entry).max_by_key(|(sequence, _)| *sequence);
    let Some((newest, entry)) = newest else {
        return Err(if damaged == 0 { FormatError::Empty } else { FormatError::Damaged { damaged } });
    };
    // Entries are numbered without a gap, so only the one after the newest can be incomplete.
    let at = |sequence: u64| slots.get((place(sequence) - *BEGIN) / SLOT);
    let before =
        (1..).take(SLOTS - 1).filter_map(|back| newest.checked_sub(back)).filter(|number| *number > 0);
    let torn = matches!(at(newest.saturating_add(1)), Some(Slot::Damaged));
    for number in before {
        let is_next = place(number) == place(newest.saturating_add(1));
        let is_there = matches!(at(number), Some(Slot::Entry(found)) if found.0 == number);
        let may_be_missing = is_next && torn;
        if !is_there && !may_be_missing {
            return Err(FormatError::Gap { newest });
        }
    }
    let has_note = bytes.get(note_at()..).unwrap_or_default().iter().any(|byte| *byte != 0);
    let end = match (torn, has_note) {
        (true, _) => RunEnd::CutOff,
        (false, true) => RunEnd::Trouble,
        (false, false) => RunEnd::Reached,
    };
    Ok(Contents { identity, newest: entry, sequence: newest, end })
}

/// The note that the disk has not accepted the entry of this tick, for [`note_at`]. Zeros withdraw it.
#[must_use]
pub const fn note(tick: Tick) -> [u8; 8] {
    tick.0.to_le_bytes()
}

const OF_CELL: [u8; 8] = *b"RCSJCEL\0"; // first bytes of every saved cell of a journal
const CELL_HEAD: usize = 24; // bytes before the entry of a saved cell: magic, layout, hash

/// A simulated cell after the tick of an entry, for the file beside the journal.
#[must_use]
pub fn cell(entry: &Entry, saved: &[u8]) -> Vec<u8> {
    let mut image = vec![0; Entry::SIZE];
    entry.encode(&mut Writer::new(&mut image));
    let rest = [image.as_slice(), saved].concat();
    let layout = layout_of_entries();
    let parts: [&[u8]; 4] = [&OF_CELL, &layout.to_le_bytes(), &hash(layout, &rest).to_le_bytes(), &rest];
    parts.concat()
}

/// The entry and the saved cell in a file beside the journal; `None` if it is damaged or of another layout.
#[must_use]
pub fn read_cell(bytes: &[u8]) -> Option<(Entry, &[u8])> {
    let (head, rest) = bytes.split_at_checked(CELL_HEAD)?;
    let word = |at: usize| head.get(at..)?.first_chunk().map(|word| u64::from_le_bytes(*word));
    let layout = word(8)?;
    if !head.starts_with(&OF_CELL) || layout != layout_of_entries() || word(16)? != hash(layout, rest) {
        return None;
    }
    let (image, saved) = rest.split_at_checked(Entry::SIZE)?;
    Some((from_bytes(image).ok()?, saved))
}

enum Slot {
    Empty,
    Damaged,
    Entry(Box<(u64, Entry)>),
}

impl Slot {
    fn entry(&self) -> Option<(u64, Entry)> {
        match self {
            Self::Entry(entry) => Some(**entry),
            Self::Empty | Self::Damaged => None,
        }
    }
}

fn look(of_head: u64, slot: &[u8]) -> Slot {
    if slot.iter().all(|byte| *byte == 0) {
        return Slot::Empty;
    }
    let parts = slot.split_first_chunk::<8>().and_then(|(number, rest)| {
        let (image, rest) = rest.split_at_checked(Entry::SIZE)?;
        let (hash, rest) = rest.split_first_chunk::<8>()?;
        Some((u64::from_le_bytes(*number), image, u64::from_le_bytes(*hash), rest))
    });
    let Some((sequence, image, hash, rest)) = parts else { return Slot::Damaged };
    if hash != hash_of_slot(of_head, sequence, image) || rest.iter().any(|byte| *byte != 0) {
        return Slot::Damaged;
    }
    from_bytes(image).map_or(Slot::Damaged, |entry| Slot::Entry(Box::new((sequence, entry))))
}

fn hash(of: u64, bytes: &[u8]) -> u64 {
    let mut digest = Digest::new();
    digest.add_hash(of);
    digest.add(bytes);
    digest.value()
}

fn hash_of_slot(of_head: u64, sequence: u64, image: &[u8]) -> u64 {
    let mut digest = Digest::new();
    digest.add_hash(of_head);
    digest.add_hash(sequence);
    digest.add(image);
    digest.value()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::layout;

    fn identity() -> Identity {
        [(PROGRAM, "0.2.0"), ("job", "linkbar")].map(|(key, value)| (key.to_owned(), value.to_owned())).into()
    }

    fn entry(tick: u64) -> Entry {
        Entry { tick: Tick(tick), line: 3, ..Entry::default() }
    }

    /// A journal with the entries 1 to `last`. Entry `n` has tick `100 + n`.
    fn journal(last: u64) -> Vec<u8> {
        let (mut bytes, of_head) = begun(&identity(), None);
        for sequence in 1..=last {
            let at = place(sequence);
            fill(&mut bytes[at..at + SLOT], of_head, sequence, &entry(100 + sequence));
        }
        bytes
    }

    #[test]
    fn newest_entry_is_read() {
        for last in [1, 2, 7, 8, 9, 20, 1000] {
            let read = read(&journal(last)).expect("it is whole");
            assert_eq!((read.newest, read.end), (entry(100 + last), RunEnd::Reached));
            assert_eq!(read.sequence, last);
            assert_eq!(read.identity, identity());
        }
    }

    #[test]
    fn write_cut_off_at_any_byte_costs_one_entry() {
        for last in [1_u64, 7, 8, 12] {
            let (before, after) = (journal(last), journal(last + 1));
            let at = place(last + 1);
            for cut in (1..8 + Entry::SIZE + 8).step_by(97) {
                let mut bytes = before.clone();
                bytes[at..at + cut].copy_from_slice(&after[at..at + cut]);
                let read = read(&bytes).expect("the entry before it is whole");
                if bytes == before || bytes == after {
                    continue;
                }
                assert_eq!((read.newest, read.end), (entry(100 + last), RunEnd::CutOff), "{last}, {cut}");
            }
        }
    }

    #[test]
    fn journal_without_entry_of_another_kind_or_length_is_refused() {
        assert_eq!(read(&journal(0)), Err(FormatError::Empty));
        assert_eq!(read(b"hello"), Err(FormatError::Foreign));
        assert_eq!(read(&[]), Err(FormatError::Foreign));
        let whole = journal(9);
        for cut in (0..length()).step_by(BLOCK / 3) {
            assert!(read(&whole[..cut]).is_err(), "{cut}");
        }
        let longer = [whole, vec![0]].concat();
        assert_eq!(read(&longer), Err(FormatError::Length { found: length() + 1 }));
    }

    #[test]
    fn slot_of_another_journal_is_not_read() {
        let mut bytes = journal(3);
        let other = Identity::from([("job".to_owned(), "clevis".to_owned())]);
        let (_, of_head) = begun(&other, None);
        let at = place(4);
        fill(&mut bytes[at..at + SLOT], of_head, 4, &entry(900));
        let read = read(&bytes).expect("the others are whole");
        assert_eq!((read.newest.tick, read.end), (Tick(103), RunEnd::CutOff));
    }

    #[test]
    fn note_of_trouble_leads_to_doubt() {
        let mut bytes = journal(9);
        bytes[note_at()..note_at() + 8].copy_from_slice(&note(Tick(110)));
        assert_eq!(read(&bytes).map(|read| (read.newest.tick, read.end)), Ok((Tick(109), RunEnd::Trouble)));
        bytes[note_at()..].fill(0);
        assert_eq!(read(&bytes).map(|read| read.end), Ok(RunEnd::Reached));
    }

    #[test]
    fn journal_of_another_layout_is_refused_with_its_fields() {
        let described = layout::describe("entry", Entry::STRUCT).replace(" line\n", " lane\n");
        let mut digest = Digest::new();
        digest.add(described.as_bytes());
        let packed = zstd::bulk::compress(described.as_bytes(), 3).unwrap();
        let mut bytes = head(&identity()).0;
        bytes[16..24].copy_from_slice(&digest.value().to_le_bytes());
        bytes[DESCRIBED..DESCRIBED + 4].copy_from_slice(&u32::try_from(packed.len()).unwrap().to_le_bytes());
        let of_head = hash(0, &bytes[..HEAD_HASH]);
        bytes[HEAD_HASH..].copy_from_slice(&of_head.to_le_bytes());
        bytes.extend(packed);
        let refused = read(&bytes).unwrap_err().to_string();
        let (there, here) = ("lane (u32 at byte 17) is only there", "line (u32 at byte 17) is only here");
        assert!(refused.contains(there) && refused.contains(here), "{refused}");
        assert!(refused.ends_with("use the program that wrote it (version 0.2.0)"), "{refused}");
        bytes.truncate(HEAD + 20);
        assert!(read(&bytes).unwrap_err().to_string().contains("their description is damaged"));
    }

    #[test]
    fn changed_byte_of_a_saved_cell_is_refused() {
        let bytes = cell(&entry(7), b"bodies and devices");
        assert_eq!(read_cell(&bytes), Some((entry(7), b"bodies and devices".as_slice())));
        for at in (0..bytes.len()).step_by(31).chain([bytes.len() - 1]) {
            let mut changed = bytes.clone();
            changed[at] ^= 1;
            assert_eq!(read_cell(&changed), None, "{at}");
            assert_eq!(read_cell(&bytes[..at]), None, "{at}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        /// The newest entry, the one before it and marked as torn, or refused: never silently older.
        #[test]
        fn changed_bytes_are_never_silently_older(
            last in 1_u64..20,
            changes in proptest::collection::vec((0..length(), 1_u8..), 1..4),
        ) {
            let mut bytes = journal(last);
            for (at, by) in changes {
                bytes[at] ^= by;
            }
            if let Ok(read) = read(&bytes) {
                let tick = read.newest.tick.0;
                let is_torn = read.end == RunEnd::CutOff;
                prop_assert!(tick == 100 + last || is_torn && tick + 1 == 100 + last, "{} of {}", tick, last);
                prop_assert_eq!(read.newest, entry(tick));
            }
        }
    }
}
