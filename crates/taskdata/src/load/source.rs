//! Text files that contain blocks: the "disk" (IV.2.7).
//!
//! A block has a header `BLOCK# 619 OFFSET 21000` and at most 16 lines of 64 columns. Two extensions: a line that
//! begins with `%%` is a remark outside the blocks, of any length; line numbers 0 to 15 of a copied listing are
//! ignored.

use std::{collections::BTreeSet, fs, io, os::unix::fs::MetadataExt as _, path::Path};

use diagnostics::{At, BlockLines, BlockNumber, Places, Source, lines_of};
use os_io::files;

pub const BLOCK_LINES: usize = 16; // per block
pub const LAST_BLOCK: u32 = 999; // then block 0 of the next offset (IV.2.7)
pub const BLOCK_COLUMNS: usize = 64; // per line
const REMARK: &str = "%%"; // on the file
const HEADER: &str = "BLOCK#";

#[derive(Clone, Copy, Debug)]
pub struct SourceLine<'a> {
    pub text: &'a str,
    pub at: At,
}

#[derive(Clone, Debug)]
pub struct Block<'a> {
    pub number: BlockNumber, // with its offset
    pub header: At,
    pub lines: Vec<SourceLine<'a>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockFault {
    Header,         // without two numbers
    Number(u32),    // above `LAST_BLOCK`
    NoHeader,       // text before the first header
    TooManyLines,   // more than 16
    TooWide(usize), // columns, more than 64
    NotAscii,       // a character
    Tab(usize),     // lines with a tab; reported at the first
}

/// `shown` is the path in messages. Errors: see [`files::read_text`].
pub fn read(path: &Path, shown: &str) -> io::Result<Source> {
    Ok(Source { name: shown.to_owned(), text: files::read_text(path)?.into() })
}

pub type Unreadable = (String, io::Error); // a path and its error

/// All files `*.blk` under a directory, sorted, with relative paths, and the paths that cannot be read.
#[must_use]
pub fn read_blocks_under(directory: &Path) -> (Vec<Source>, Vec<Unreadable>) {
    let (mut paths, mut unreadable) = (Vec::new(), Vec::new());
    let mut open = vec![directory.to_path_buf()];
    let mut seen = BTreeSet::new(); // a symbolic link can form a cycle: each directory is read once
    while let Some(folder) = open.pop() {
        // Built-in directories have no metadata, and no links.
        let identity = fs::metadata(&folder).map(|found| (found.dev(), found.ino()));
        if identity.is_ok_and(|identity| !seen.insert(identity)) {
            continue;
        }
        match files::list(&folder) {
            Ok(listed) => {
                for path in listed {
                    if path.extension().is_some_and(|e| e == "blk") {
                        paths.push(path);
                    } else if files::is_directory(&path) {
                        open.push(path);
                    }
                }
            }
            // A directory that cannot be listed.
            Err(error) => unreadable.push((folder.display().to_string(), error)),
        }
    }
    paths.sort();
    let mut sources = Vec::with_capacity(paths.len());
    for path in paths {
        let shown = path.strip_prefix(directory).unwrap_or(&path).display().to_string();
        match read(&path, &shown) {
            Ok(source) => sources.push(source),
            Err(error) => unreadable.push((path.display().to_string(), error)),
        }
    }
    (sources, unreadable)
}

fn short(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

/// A header, or a line that is probably meant as one.
fn is_header(line: &str) -> bool {
    let start = line.trim_start().as_bytes().get(..HEADER.len());
    start.is_some_and(|start| start.eq_ignore_ascii_case(HEADER.as_bytes()))
}

fn header_number(line: &str) -> Option<BlockNumber> {
    let mut words = line.split_whitespace();
    let (Some(HEADER), Some(number), Some("OFFSET"), Some(offset)) =
        (words.next(), words.next(), words.next(), words.next())
    else {
        return None;
    };
    if words.next().is_some_and(|w| !w.starts_with('%') && !w.starts_with('(')) {
        return None;
    }
    Some(BlockNumber { offset: offset.parse().ok()?, number: number.parse().ok()? })
}

/// Keeps the readable part of blocks with errors.
#[must_use]
pub fn blocks(index: usize, source: &Source) -> (Vec<Block<'_>>, Vec<(At, BlockFault)>) {
    let mut found: Vec<Block<'_>> = Vec::new();
    let mut faults = Vec::new();
    let mut tabs: Option<(At, usize)> = None;
    for (start, text) in lines_of(&source.text) {
        let at = At { source: short(index), start: short(start), length: short(text.len()) };
        let printable = |b: u8| (b' '..=b'~').contains(&b);
        // Without a branch per byte this is much faster than a search for the first one.
        let plain = text.bytes().fold(true, |all, b| all & printable(b));
        if !plain
            && !text.starts_with(REMARK)
            && let Some(position) = text.bytes().position(|b| !printable(b))
        {
            let bad = text.get(position..).and_then(|rest| rest.chars().next()).unwrap_or_default();
            let bad_at = At { start: short(start + position), length: short(bad.len_utf8()), ..at };
            if bad == '\t' {
                tabs.get_or_insert((bad_at, 0)).1 += 1;
            } else {
                faults.push((bad_at, BlockFault::NotAscii));
            }
        }
        if text.starts_with(REMARK) {
            continue;
        }
        if is_header(text) {
            let number = header_number(text).unwrap_or_else(|| {
                faults.push((at, BlockFault::Header));
                BlockNumber { offset: BlockNumber::UNREADABLE, number: short(found.len()) }
            });
            if number.number > LAST_BLOCK && number.offset != BlockNumber::UNREADABLE {
                faults.push((at, BlockFault::Number(number.number)));
            }
            found.push(Block { number, header: at, lines: Vec::with_capacity(BLOCK_LINES) });
            continue;
        }
        match found.last_mut() {
            Some(block) => block.lines.push(SourceLine { text, at }),
            None if text.trim().is_empty() => {}
            None => faults.push((at, BlockFault::NoHeader)),
        }
    }
    for block in &mut found {
        settle(block, &mut faults);
    }
    faults.extend(tabs.map(|(at, lines)| (at, BlockFault::Tab(lines))));
    (found, faults)
}

#[must_use]
pub fn places_in_blocks(sources: &[Source]) -> Places<'_> {
    Places::in_blocks(sources, |source| {
        let lines = |block: Block<'_>| BlockLines {
            number: block.number,
            start: block.header.start,
            lines: block.lines.into_iter().map(|line| line.at).collect(),
        };
        blocks(0, source).0.into_iter().map(lines).collect()
    })
}

/// Removes empty lines at the end and the line numbers of a listing, and checks the size.
fn settle(block: &mut Block<'_>, faults: &mut Vec<(At, BlockFault)>) {
    while block.lines.last().is_some_and(|line| line.text.trim().is_empty()) {
        block.lines.pop();
    }
    if is_listing(&block.lines) {
        for line in &mut block.lines {
            let (number, text) = line.text.split_at_checked(LISTING_WIDTH).unwrap_or((line.text, ""));
            line.text = text;
            line.at.start = line.at.start.saturating_add(short(number.len()));
            line.at.length = short(text.len());
        }
    }
    if let Some(line) = block.lines.iter().skip(BLOCK_LINES).find(|line| !line.text.trim().is_empty()) {
        // The lines are kept, so that their contents are checked, too.
        faults.push((line.at, BlockFault::TooManyLines));
    }
    for line in &block.lines {
        let columns = line.text.trim_end().len();
        if columns > BLOCK_COLUMNS {
            let past = short(BLOCK_COLUMNS);
            let at = At {
                start: line.at.start.saturating_add(past),
                length: short(columns - BLOCK_COLUMNS),
                ..line.at
            };
            faults.push((at, BlockFault::TooWide(columns)));
        }
    }
}

const LISTING_WIDTH: usize = 3; // a line number with its blanks, ` 4 `

/// Every line begins with its own number in two columns, like the manual's listings. A form cannot look like this: the
/// lines of a movetable begin at 1.
fn is_listing(lines: &[SourceLine<'_>]) -> bool {
    if lines.first().is_none_or(|line| !line.text.starts_with(" 0")) {
        return false;
    }
    let own_number = |(number, line): (usize, &SourceLine<'_>)| {
        line.text
            .strip_prefix(format!("{number:2}").as_str())
            .is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
    };
    lines.len() > 1 && lines.iter().enumerate().all(own_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source { name: "test.blk".to_owned(), text: text.into() }
    }

    #[test]
    fn blocks_begin_at_their_headers() {
        let s = source(
            "%% a remark \u{b7} on the file\n\nBLOCK# 721 OFFSET 21000\n\n  -pt- A\n%% another\n  -pt- B\n\n\nBLOCK# 722 OFFSET 21000 % x\nC\n",
        );
        let (blocks, faults) = blocks(0, &s);
        assert_eq!(faults, []);
        assert_eq!(blocks.len(), 2);
        let texts: Vec<&str> = blocks[0].lines.iter().map(|l| l.text).collect();
        assert_eq!(texts, ["", "  -pt- A", "  -pt- B"]);
        let at = blocks[0].lines[2].at;
        assert_eq!(&s.text[at.start as usize..(at.start + at.length) as usize], "  -pt- B");
        assert_eq!(blocks[1].number, BlockNumber { offset: 21_000, number: 722 });
    }

    #[test]
    fn lines_count_from_0_in_a_block_and_from_1_in_the_file() {
        let text =
            "%% remark\nBLOCK# 7 OFFSET 21000\nA\n%% remark\n  B\n\nBLOCK# 8 OFFSET 21000\n 0 C\n 1   D\n";
        let sources = [Source { name: "f.blk".to_owned(), text: text.into() }];
        let mut places = places_in_blocks(&sources);
        let mut place = |word: &str| {
            let at = At { source: 0, start: short(text.find(word).unwrap()), length: 1 };
            let found = places.position(at).unwrap();
            (found.block.map(|block| block.number), found.line, found.column)
        };
        assert_eq!(place("A\n"), (Some(7), 0, 1));
        assert_eq!(place("B\n"), (Some(7), 1, 3));
        assert_eq!(place("D\n"), (Some(8), 1, 3));
        assert_eq!(place("BLOCK# 8"), (None, 7, 1));
        assert_eq!(place("remark"), (None, 1, 4));
        assert_eq!(
            places.words(At { source: 0, start: 32, length: 1 }),
            "f.blk, block 7 (offset 21000), line 0"
        );
        assert_eq!(places.words(At { source: 1, start: 0, length: 1 }), "?");
    }

    #[test]
    fn listing_is_read_without_its_line_numbers() {
        let listing = source("BLOCK# 435 OFFSET 21000\n 0\n 1   1    t        0\n 2\n 3 x\n");
        let texts: Vec<&str> = blocks(0, &listing).0[0].lines.iter().map(|l| l.text).collect();
        assert_eq!(texts, ["", "  1    t        0", "", "x"]);
        let table = source("BLOCK# 435 OFFSET 21000\n  1 t 0 0 0 ----\n  2 t 1 1 1 -mtb- A\n");
        assert_eq!(blocks(0, &table).0[0].lines[0].text, "  1 t 0 0 0 ----");
    }

    #[test]
    fn block_faults_have_their_places() {
        let wide = "x".repeat(65);
        let text = format!(
            "stray\nBLOCK# one OFFSET 21000\nBLOCK# 1 OFFSET 21000\n{wide}\n{}caf\u{e9}\n",
            "y\n".repeat(16)
        );
        let (_, faults) = blocks(0, &source(&text));
        let kinds: Vec<BlockFault> = faults.iter().map(|f| f.1).collect();
        assert_eq!(
            kinds,
            [
                BlockFault::NoHeader,
                BlockFault::Header,
                BlockFault::NotAscii,
                BlockFault::TooManyLines,
                BlockFault::TooWide(65)
            ]
        );
        let text = |at: At| &text[at.start as usize..(at.start + at.length) as usize];
        assert_eq!(
            faults[1..].iter().map(|f| text(f.0)).collect::<Vec<_>>(),
            ["BLOCK# one OFFSET 21000", "\u{e9}", "y", "x"]
        );
    }
}
