//! The block editor (IV.2.3): 16 lines of 64 columns, with the checker's messages at their lines.
//!
//! ```text
//!   n EDIT ──► text ──F2: all data are checked with it──► diff ──Enter──► file, `load`
//!               ▲  errors: their lines are shown           │
//!               └──────────────Esc─────────────────────────┘
//! ```
//!
//! Only the lines of the block are changed in its file. A file that has changed in the meantime is not overwritten.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use os_io::replace::replace_text;
use os_io::text::amount;
use taskdata::load::{
    BlockNumber, Source, Store,
    source::{BLOCK_COLUMNS, BLOCK_LINES, blocks},
};

use crate::rcs_console::model::{Key, Section, Text, Tone};

/// Number of remarks about a form that fit above the 16 lines of a block in the smallest terminal. The diff shows all.
const ABOUT: usize = 2;

#[derive(Clone, Debug, PartialEq, Eq)]
struct Message {
    line: Option<usize>, // line of the block; `None` if the message is about another place
    is_error: bool,      // true for an error, false for a warning
    text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The lines, with the messages of the last check.
    Text,
    Diff,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EditorRequest {
    None,
    Close,
    Write,
    Say(&'static str),
}

#[derive(Clone, Debug)]
pub struct Editor {
    number: BlockNumber,
    path: PathBuf,
    before: String,       // text of the file when the editor was opened
    sources: Vec<Source>, // all texts of the task data, and the index of the edited file among them
    at: usize,
    old: Vec<String>, // the lines when the editor was opened
    lines: Vec<String>,
    row: usize,
    column: usize,
    stage: Stage,
    messages: Vec<Message>,
    about: Vec<String>,
}

pub type Refused = String;

impl Editor {
    /// Open a block of the files under a directory; `sources` are their texts. Fails with the reason as a message.
    pub fn begin(number: BlockNumber, directory: &Path, sources: &[Source]) -> Result<Self, Refused> {
        let holds = |source: &Source| blocks(0, source).0.iter().any(|block| block.number == number);
        let at = sources.iter().rposition(holds).ok_or_else(|| format!("there is no {number}"))?;
        let source = sources.get(at).ok_or("there is no such file")?;
        let path = directory.join(&source.name);
        if !path.is_file() {
            return Err(format!(
                "{} is built into the program: rcs-run init DIR writes a copy, and --data DIR uses it",
                path.display()
            ));
        }
        let old = lines_of_block(source, number);
        let (sources, before) = (sources.to_vec(), source.text.to_string());
        let (lines, messages) = (old.clone(), Vec::new());
        Ok(Self {
            number,
            path,
            before,
            sources,
            at,
            old,
            lines,
            row: 0,
            column: 0,
            stage: Stage::Text,
            messages,
            about: Vec::new(),
        })
    }

    /// Insert a form. It replaces the form with the same last words, or follows the last line.
    pub fn with_form(mut self, form: &[String], about: Vec<String>) -> Result<Self, Refused> {
        let words = |line: &str| line.split_whitespace().rev().take(3).map(str::to_owned).collect::<Vec<_>>();
        let key = |line: &str| {
            let words = words(line);
            // The last words are the name and the compiling word. In a pose, the movetable is between them.
            (
                words.first().cloned(),
                ["-pose-", "-mtb-"].into_iter().find(|word| words.iter().any(|is| is == word)),
            )
        };
        let wanted = form.last().map(|line| key(line)).unwrap_or_default();
        let used = self.lines.iter().rposition(|line| !line.is_empty()).map_or(0, |last| last + 1);
        let old = self.lines.iter().position(|line| wanted.1.is_some() && key(line) == wanted);
        let first = match old {
            Some(last) => {
                let before = self.lines.get(..last).unwrap_or_default().iter().rev();
                let more = match wanted.1 {
                    Some("-mtb-") => before.take_while(|line| line.ends_with("----")).count(),
                    _ => 2.min(last),
                };
                self.lines.drain(last - more..=last);
                last - more
            }
            None if used == 0 => 0,
            None => used + 1,
        };
        let after = self.lines.len().min(first);
        self.lines.splice(after..after, form.iter().cloned());
        let full = || format!("{} has no room for {}", self.number, amount(form.len(), "line"));
        if self.lines.iter().skip(BLOCK_LINES).any(|line| !line.is_empty())
            || first + form.len() > BLOCK_LINES
        {
            return Err(full());
        }
        self.lines.resize(BLOCK_LINES, String::new());
        (self.row, self.about) = (first, about);
        Ok(self)
    }

    #[must_use]
    pub const fn number(&self) -> BlockNumber {
        self.number
    }

    /// True if the editor shows the diff instead of the text.
    #[must_use]
    pub fn shows_change(&self) -> bool {
        self.stage == Stage::Diff
    }

    pub fn key(&mut self, key: Key) -> EditorRequest {
        match (self.stage, key) {
            (Stage::Diff, Key::Enter) => return EditorRequest::Write,
            (Stage::Diff, Key::Esc) => self.stage = Stage::Text,
            (Stage::Diff, _) => {
                return EditorRequest::Say("Enter writes the block and loads it, Esc goes back to the text");
            }
            (Stage::Text, Key::Esc) => return EditorRequest::Close,
            (Stage::Text, Key::F2) => return self.check(),
            (Stage::Text, key) => return self.edit(key),
        }
        EditorRequest::None
    }

    fn edit(&mut self, key: Key) -> EditorRequest {
        let Some(line) = self.lines.get_mut(self.row) else { return EditorRequest::None };
        self.column = self.column.min(line.len());
        match key {
            Key::Char(typed) if !(' '..='~').contains(&typed) => {
                return EditorRequest::Say("a block has ASCII characters only");
            }
            Key::Char(_) if line.len() >= BLOCK_COLUMNS => {
                return EditorRequest::Say("a line has 64 columns");
            }
            Key::Char(typed) => {
                line.insert(self.column, typed);
                self.column += 1;
            }
            Key::Backspace if self.column > 0 => {
                self.column -= 1;
                line.remove(self.column);
            }
            Key::Left => self.column = self.column.saturating_sub(1),
            Key::Right => self.column = (self.column + 1).min(line.len()),
            Key::Home => self.column = 0,
            Key::End => self.column = line.len(),
            Key::Up => self.row = self.row.saturating_sub(1),
            Key::Down => self.row = (self.row + 1).min(BLOCK_LINES - 1),
            Key::Enter => (self.row, self.column) = ((self.row + 1).min(BLOCK_LINES - 1), 0),
            _ => {
                return EditorRequest::Say(
                    "F2 checks the block and shows the change, Esc leaves it as it was",
                );
            }
        }
        EditorRequest::None
    }

    fn check(&mut self) -> EditorRequest {
        if self.changes().is_empty() {
            return EditorRequest::Say("nothing has changed");
        }
        let mut sources = self.sources.clone();
        let Some(source) = sources.get_mut(self.at) else { return EditorRequest::None };
        source.text = self.text().into();
        let name = source.name.clone();
        let report = match Store::from_sources(sources) {
            Ok((_, report)) => report,
            Err(report) => *report,
        };
        let errors = report.errors().map(|found| (true, found));
        let found = errors.chain(report.warnings().map(|found| (false, found)));
        self.messages = found
            .filter_map(|(is_error, found)| {
                let is_here = found.file() == name && found.block() == Some(self.number);
                let line = found.line().filter(|_| is_here).and_then(|line| usize::try_from(line).ok());
                let place = if is_here { String::new() } else { format!("{}: ", found.place()) };
                // Warnings about other blocks do not result from the edit.
                (is_error || is_here).then(|| Message {
                    line,
                    is_error,
                    text: format!("{place}{}", found.message()),
                })
            })
            .collect();
        if self.messages.iter().any(|message| message.is_error) {
            return EditorRequest::Say("with this change the data have errors: nothing is written");
        }
        self.stage = Stage::Diff;
        EditorRequest::None
    }

    /// Write the block into the file. Fails with the reason as a message; the file is then unchanged.
    pub fn write(&self) -> Result<(), String> {
        let told = |error: io::Error| format!("{}: {error}", self.path.display());
        if fs::read_to_string(&self.path).map_err(told)? != self.before {
            return Err(format!(
                "{} was changed by another program: leave the editor and open the block again",
                self.path.display()
            ));
        }
        replace_text(&self.path, &self.text()).map_err(told)
    }

    fn changes(&self) -> Vec<(usize, &str, &str)> {
        let pairs = self.old.iter().zip(&self.lines).enumerate();
        let pairs = pairs.map(|(at, (old, new))| (at, old.trim_end(), new.trim_end()));
        pairs.filter(|(_, old, new)| old != new).collect()
    }

    fn text(&self) -> String {
        let source = Source { name: String::new(), text: self.before.as_str().into() };
        let (found, _) = blocks(0, &source);
        let Some(block) = found.iter().rfind(|block| block.number == self.number) else {
            return self.before.clone();
        };
        let byte = |at: u32| usize::try_from(at).unwrap_or(usize::MAX);
        let used = self.lines.iter().rposition(|line| !line.trim().is_empty()).map_or(0, |last| last + 1);
        let mut text = self.before.clone();
        let header = byte(block.header.start) + byte(block.header.length);
        let end = block.lines.last().map_or(header, |line| byte(line.at.start) + byte(line.at.length));
        let end =
            end + text.get(end..).and_then(|rest| rest.find('\n')).unwrap_or(text.len().saturating_sub(end));
        let more: String = self
            .lines
            .iter()
            .take(used)
            .skip(block.lines.len())
            .map(|line| format!("\n{}", line.trim_end()))
            .collect();
        text.insert_str(end, &more);
        // Replacing from the end keeps the positions of the lines still to be replaced.
        for (line, old) in self.lines.iter().zip(&block.lines).rev() {
            let start = byte(old.at.start);
            text.replace_range(start..start + byte(old.at.length), line.trim_end());
        }
        text
    }

    #[must_use]
    pub fn sections(&self) -> Vec<Section> {
        let title = format!("{}, {}", self.number, self.path.display());
        match self.stage {
            Stage::Text => {
                vec![Section {
                    at: self.about.len().min(ABOUT) + self.row,
                    ..Section::new(title, self.shown())
                }]
            }
            Stage::Diff => {
                let lines = self.changes().into_iter().flat_map(|(at, old, new)| {
                    let removed =
                        (!old.is_empty()).then(|| Text::verbatim(Tone::Faint, format!(" -{at:>2} {old}")));
                    let added =
                        (!new.is_empty()).then(|| Text::verbatim(Tone::Marked, format!(" +{at:>2} {new}")));
                    removed.into_iter().chain(added)
                });
                let mut lines: Vec<Text> = lines.collect();
                lines.extend(self.about.iter().map(|line| Text::new(Tone::Faint, format!("    {line}"))));
                lines.extend(self.messages.iter().map(said));
                let load = format!("   Enter writes the file and asks for: {}", self.request());
                lines.extend([Text::default(), Text::plain(load)]);
                vec![Section::new(format!("the change of {title}"), lines)]
            }
        }
    }

    /// The lines with the checker's messages about them, then the messages about other places.
    fn shown(&self) -> Vec<Text> {
        let about = self.about.iter().take(ABOUT);
        let mut shown: Vec<Text> = about.map(|line| Text::new(Tone::Faint, format!("    {line}"))).collect();
        for (at, line) in self.lines.iter().enumerate() {
            let mark = if at == self.row { '>' } else { ' ' };
            let tone = if at == self.row { Tone::Marked } else { Tone::Plain };
            let text = if at == self.row { with_cursor(line, self.column) } else { line.clone() };
            shown.push(Text::verbatim(tone, format!("{mark}{at:>2} {text}")));
            shown.extend(self.messages.iter().filter(|message| message.line == Some(at)).map(said));
        }
        shown.extend(self.messages.iter().filter(|message| message.line.is_none()).map(said));
        shown
    }

    #[must_use]
    pub fn request(&self) -> String {
        format!("load {} {}", self.number.offset, self.number.number)
    }
}

/// The line with a mark at the cursor, which is visible without colour.
fn with_cursor(line: &str, column: usize) -> String {
    let (front, behind) = line.split_at(column.min(line.len()));
    format!("{front}_{behind}")
}

fn said(message: &Message) -> Text {
    let (mark, tone) = if message.is_error { ("!!", Tone::Trouble) } else { (" ?", Tone::Marked) };
    Text::new(tone, format!("{mark}  {}", message.text))
}

/// The lines of a block of a text, always 16.
fn lines_of_block(source: &Source, number: BlockNumber) -> Vec<String> {
    let (found, _) = blocks(0, source);
    let block = found.iter().rfind(|block| block.number == number);
    let lines = block.into_iter().flat_map(|block| &block.lines);
    let mut lines: Vec<String> = lines.map(|line| line.text.trim_end().to_owned()).collect();
    lines.resize(BLOCK_LINES, String::new());
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use taskdata::load::source::read_blocks_under;

    const POSES: BlockNumber = BlockNumber { offset: 21_000, number: 610 };
    const COMMANDS: BlockNumber = BlockNumber { offset: 16_000, number: 863 };

    /// A copy of the blocks in the shipped data.
    fn data() -> tempfile::TempDir {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
        let to = tempfile::tempdir().unwrap();
        for source in read_blocks_under(&from).0 {
            let path = to.path().join(&source.name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, source.text.as_bytes()).unwrap();
        }
        to
    }

    fn editor(directory: &Path, number: BlockNumber) -> Editor {
        Editor::begin(number, directory, &read_blocks_under(directory).0).unwrap()
    }

    fn typed(editor: &mut Editor, text: &str) {
        for sign in text.chars() {
            assert_eq!(editor.key(Key::Char(sign)), EditorRequest::None);
        }
    }

    fn screen(editor: &Editor) -> String {
        let lines = editor.sections().into_iter().flat_map(|section| section.lines);
        lines.map(|line| format!("{}\n", line.text)).collect()
    }

    #[test]
    fn added_line_is_shown_as_a_change_and_written() {
        let directory = data();
        let before = fs::read_to_string(directory.path().join("commands.blk")).unwrap();
        let mut editor = editor(directory.path(), COMMANDS);
        assert_eq!(editor.key(Key::F2), EditorRequest::Say("nothing has changed"));
        (0..5).for_each(|_| assert_eq!(editor.key(Key::Down), EditorRequest::None));
        assert_eq!(editor.lines[5], "", "line 5 is free");
        typed(&mut editor, "== PAUSE -- +0 -- 0 +0 -- 0 -- 0");
        assert_eq!(editor.key(Key::F2), EditorRequest::None);
        let shown = screen(&editor);
        assert!(shown.contains(" + 5 == PAUSE") && shown.contains("asks for: load 16000 863"), "{shown}");
        assert_eq!(editor.key(Key::Enter), EditorRequest::Write);
        editor.write().unwrap();
        let after = fs::read_to_string(directory.path().join("commands.blk")).unwrap();
        let changed: Vec<_> = before.lines().zip(after.lines()).filter(|(old, new)| old != new).collect();
        assert_eq!(changed, [("", "== PAUSE -- +0 -- 0 +0 -- 0 -- 0")]);
        assert_eq!(before.lines().count(), after.lines().count());
    }

    #[test]
    fn form_follows_the_last_line_or_replaces_the_old_one() {
        let directory = data();
        let form =
            |name: &str| vec!["1".to_owned(), "2".to_owned(), format!("3   -pose-   ...         {name}")];
        let about = vec!["limits".to_owned()];
        let new = editor(directory.path(), POSES).with_form(&form("NEW-P"), about.clone()).unwrap();
        assert_eq!((new.lines[10].as_str(), new.lines[13].ends_with("NEW-P")), ("", true), "{:?}", new.lines);
        assert!(screen(&new).starts_with("    limits\n"));
        let old = editor(directory.path(), POSES).with_form(&form("HOME-POS"), about.clone()).unwrap();
        assert_eq!(old.lines[3..6].join(" "), "1 2 3   -pose-   ...         HOME-POS", "{:?}", old.lines);
        assert_eq!(old.changes().len(), 3);
        let full = new.with_form(&form("MORE-P"), about).map(|_| ());
        assert!(full.unwrap_err().contains("has no room for 3 lines"));
    }

    #[test]
    fn errors_are_shown_at_their_lines_and_prevent_writing() {
        let directory = data();
        let mut editor = editor(directory.path(), COMMANDS);
        (0..4).for_each(|_| assert_eq!(editor.key(Key::Down), EditorRequest::None));
        typed(&mut editor, "NONSENSE ");
        assert!(matches!(editor.key(Key::F2), EditorRequest::Say(why) if why.contains("errors")));
        let shown = screen(&editor);
        let lines: Vec<&str> = shown.lines().collect();
        let at = lines.iter().position(|line| line.starts_with("> 4")).unwrap();
        assert!(lines[at + 1].starts_with("!!"), "{shown}");
        assert!(
            matches!(editor.key(Key::Enter), EditorRequest::None),
            "it is a new line, and no order to write"
        );
        assert_eq!(editor.key(Key::Esc), EditorRequest::Close);
    }

    #[test]
    fn line_has_64_columns_and_lines_can_be_inserted() {
        let directory = data();
        let mut editor = editor(directory.path(), POSES);
        (0..15).for_each(|_| assert_eq!(editor.key(Key::Down), EditorRequest::None));
        assert_eq!(editor.lines[15], "", "line 15 is free");
        typed(&mut editor, &"x".repeat(64));
        assert!(matches!(editor.key(Key::Char('y')), EditorRequest::Say(why) if why.contains("64 columns")));
        assert!(matches!(editor.key(Key::Char('é')), EditorRequest::Say(why) if why.contains("ASCII")));
        assert_eq!(editor.key(Key::Home), EditorRequest::None);
        assert_eq!(
            editor.key(Key::Backspace),
            EditorRequest::Say("F2 checks the block and shows the change, Esc leaves it as it was")
        );
    }

    #[test]
    fn new_lines_follow_the_block_and_removed_ones_are_empty() {
        let text = "%% file\nBLOCK# 1 OFFSET 21000\n%% remark\na\nb\nBLOCK# 2 OFFSET 21000\nc";
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("x.blk"), text).unwrap();
        let one = BlockNumber { offset: 21_000, number: 1 };
        let mut first = editor(directory.path(), one);
        first.lines[0] = "A".into();
        first.lines[1] = String::new();
        first.lines[2] = "new".into();
        assert_eq!(
            first.text(),
            "%% file\nBLOCK# 1 OFFSET 21000\n%% remark\nA\n\nnew\nBLOCK# 2 OFFSET 21000\nc"
        );
        let mut last = editor(directory.path(), BlockNumber { offset: 21_000, number: 2 });
        last.lines[1] = "d".into();
        assert!(last.text().ends_with("OFFSET 21000\nc\nd"), "{}", last.text());
        fs::write(directory.path().join("x.blk"), "other").unwrap();
        assert!(last.write().unwrap_err().contains("was changed by another program"));
        let missing = Editor::begin(BlockNumber { offset: 1, number: 1 }, directory.path(), &[]);
        assert!(missing.unwrap_err().contains("there is no block 1"));
    }
}
