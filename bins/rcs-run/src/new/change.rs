//! Planned changes of a data directory: shown as a diff, tried in a copy, written.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use os_io::{files, replace::replace_text};
use similar::TextDiff;
use taskdata::load::{Source, source::BLOCK_LINES, source::blocks};

use crate::rcs_run::error::Error;

const AROUND: usize = 2; // unchanged lines that the diff shows around a change

#[derive(Clone)]
pub struct Change {
    data: PathBuf,
    files: BTreeMap<String, Texts>,
}

/// Text of a file before and after; a new file is empty before.
#[derive(Clone)]
struct Texts {
    before: String,
    after: String,
}

impl Change {
    pub fn of(data: &Path) -> Self {
        Self { data: data.to_owned(), files: BTreeMap::new() }
    }

    /// The text of a file, to be changed; `file` is its path in the data directory.
    pub fn text(&mut self, file: &str) -> Result<&mut String, Error> {
        if !self.files.contains_key(file) {
            let path = self.data.join(file);
            let text = files::read_text(&path)
                .map_err(|error| Error::New(format!("{} cannot be read: {error}", path.display())))?;
            self.files.insert(file.to_owned(), Texts { before: text.clone(), after: text });
        }
        Ok(&mut self.files.entry(file.to_owned()).or_insert_with(Texts::empty).after)
    }

    pub fn add(&mut self, file: &str, text: String) -> Result<(), Error> {
        if fs::symlink_metadata(self.data.join(file)).is_ok() || files::is_file(&self.data.join(file)) {
            let path = self.data.join(file);
            return Err(Error::New(format!("{} already exists: choose another name", path.display())));
        }
        self.files.insert(file.to_owned(), Texts { before: String::new(), after: text });
        Ok(())
    }

    /// Insert a line after the last line of a block. Fails with [`Error::New`] if the block is full or missing.
    pub fn add_to_block(&mut self, file: &str, block: u32, line: &str) -> Result<(), Error> {
        let text = self.text(file)?;
        let source = Source { name: file.to_owned(), text: text.as_str().into() };
        let (blocks, _) = blocks(0, &source);
        let found = blocks.iter().find(|found| found.number.number == block);
        let found = found.ok_or_else(|| Error::New(format!("{file}: there is no block {block}")))?;
        if found.lines.len() >= BLOCK_LINES {
            let what = format!("{file}: the directory block {block} has {BLOCK_LINES} lines and is full");
            return Err(Error::New(what + ": move a line of it into a further block (data/README.md)"));
        }
        let last = found.lines.last().map_or(found.header, |line| line.at);
        let start = usize::try_from(last.start).unwrap_or(usize::MAX);
        let end = text.get(start..).and_then(|rest| rest.find('\n')).map_or(text.len(), |at| start + at);
        text.insert_str(end, &format!("\n{line}"));
        Ok(())
    }

    /// Add a member, a location point, to an owner (VII.5).
    pub fn add_member(&mut self, file: &str, owner: &str, member: &str) -> Result<(), Error> {
        let text = self.text(file)?;
        let mut lines: Vec<&str> = text.lines().collect();
        let begins = |line: &&str| line.split_whitespace().take(2).eq(["-own-", owner]);
        let first = lines.iter().position(begins);
        let first = first.ok_or_else(|| Error::New(format!("{file} has no form of the owner {owner}")))?;
        let more = lines.iter().skip(first + 1).take_while(|line| line.trim_start().starts_with("-m-"));
        let end = first + 1 + more.count();
        let line = format!("{:24}-m-   lpt        {member}", "");
        lines.insert(end, &line);
        *text = lines.join("\n") + "\n";
        Ok(())
    }

    /// Insert a table after the last table of kind `kind` with the entry `behind`. Every table has the empty entry.
    pub fn add_table(&mut self, file: &str, kind: &str, behind: &str, table: &str) -> Result<(), Error> {
        let text = self.text(file)?;
        let mut lines: Vec<&str> = text.lines().collect();
        let ends = |line: &&str| line.trim().is_empty() || line.starts_with('[');
        let begin = (0..lines.len()).rev().find(|at| {
            let body = lines.iter().skip(at + 1).take_while(|line| !line.starts_with('['));
            lines.get(*at).is_some_and(|line| line.trim() == format!("[[{kind}]]"))
                && body.clone().any(|line| line.trim_start().starts_with(behind))
        });
        let begin =
            begin.ok_or_else(|| Error::New(format!("{file} has no table [[{kind}]] with {behind}")))?;
        let end = lines.iter().skip(begin + 1).position(ends).map_or(lines.len(), |at| begin + 1 + at);
        lines.splice(end..end, std::iter::once("").chain(table.lines()));
        *text = lines.join("\n") + "\n";
        Ok(())
    }

    pub fn diff(&self) -> String {
        let one = |(file, texts): (&String, &Texts)| {
            let path = self.data.join(file).display().to_string();
            let old = if texts.before.is_empty() { "/dev/null".to_owned() } else { path.clone() };
            let diff = TextDiff::from_lines(&texts.before, &texts.after);
            diff.unified_diff().context_radius(AROUND).header(&old, &path).to_string()
        };
        self.files.iter().map(one).collect()
    }

    /// Write the whole data directory with the changes into another directory.
    pub fn copy_to(&self, directory: &Path) -> Result<(), Error> {
        let mut open = vec![self.data.clone()];
        while let Some(folder) = open.pop() {
            for path in files::list(&folder)? {
                if files::is_directory(&path) {
                    open.push(path);
                } else if files::is_file(&path)
                    && let Ok(name) = path.strip_prefix(&self.data)
                {
                    put(&directory.join(name), &files::read_text(&path)?)?;
                }
            }
        }
        self.files.iter().try_for_each(|(file, texts)| put(&directory.join(file), &texts.after))
    }

    pub fn write(&self) -> Result<(), Error> {
        self.files.iter().try_for_each(|(file, texts)| put(&self.data.join(file), &texts.after))
    }
}

impl Texts {
    const fn empty() -> Self {
        Self { before: String::new(), after: String::new() }
    }
}

/// Check whether the files of a data directory can be changed. The data built into the program cannot.
pub fn changeable(data: &Path) -> Result<(), Error> {
    let why = "the data are those in the program: `rcs-run init .` writes a copy that can be changed";
    data.is_dir().then_some(()).ok_or_else(|| Error::New(why.to_owned()))
}

fn put(path: &Path, text: &str) -> Result<(), Error> {
    let write = || {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        replace_text(path, text)
    };
    write().map_err(|source| Error::Write { path: path.to_owned(), source })
}
