//! Blocks that no directory loads (orphans), and directory lines without a block. One message reports all effects of a
//! wrong or missing number: there is no report for a name that only an orphan defines.

use std::collections::{BTreeMap, HashMap, HashSet};

use diagnostics::{At, BlockNumber, Problems, Severity, distance};
use os_io::text::amount;

use super::{entries::LoadLine, parse::Parsed, print, source::LAST_BLOCK};

const SLIP: usize = 2; // greatest edit distance of a misspelt number

#[derive(Debug)]
struct Orphan {
    number: BlockNumber,
    header: At,
    first: Option<At>, // header of the loaded block with this number
    loads: Vec<LoadLine>,
    needed: Vec<String>, // names used elsewhere and defined in it, or in a block that only it loads
    told: bool,          // reported with another problem
}

#[derive(Debug, Default)]
pub(super) struct Orphans {
    list: Vec<Orphan>,
    words: HashMap<String, usize>, // words of the orphans' entries, with the first orphan's position in `list`
    pub(super) missing: Vec<LoadLine>, // name a missing block
    pub(super) again: Vec<LoadLine>, // name an already loaded block
    pub(super) directories: BTreeMap<BlockNumber, Vec<BlockNumber>>, // with the blocks that they name
    /// An unreadable file may contain any name and block, so only names that are probably misspelt are reported.
    pub(super) incomplete: bool,
}

impl Orphans {
    pub(super) fn add(&mut self, number: BlockNumber, header: At, parsed: Parsed, first: Option<At>) {
        let position = self.list.len();
        let printed = parsed.entries.iter().flat_map(print::form);
        let words = printed.flat_map(|line| line.split(' ').map(str::to_owned).collect::<Vec<_>>());
        for word in words.chain(parsed.broken).filter(|word| !word.is_empty()) {
            self.words.entry(word).or_insert(position);
        }
        let readable = number.offset != BlockNumber::UNREADABLE && number.number <= LAST_BLOCK;
        let orphan =
            Orphan { number, header, first, loads: parsed.loads, needed: Vec::new(), told: !readable };
        self.list.push(orphan);
    }

    /// A block is missing although all files were read. Unknown names may be in it: they are reported when it exists.
    pub(super) fn lack_blocks(&self) -> bool {
        !self.incomplete && !self.missing.is_empty()
    }

    pub(super) fn words(&self) -> impl Iterator<Item = &String> {
        self.words.keys()
    }

    pub(super) fn have(&mut self, name: &str) -> bool {
        let orphan = self.words.get(name).and_then(|&position| self.list.get_mut(position));
        if let Some(orphan) = orphan {
            if !orphan.needed.iter().any(|needed| needed == name) {
                orphan.needed.push(name.to_owned());
            }
            return true;
        }
        false
    }

    /// Reports orphans and lines, after every name was looked up.
    pub(super) fn report(mut self, problems: &mut Problems) {
        let below = self.gather();
        for line in std::mem::take(&mut self.missing) {
            self.missing(line, problems);
        }
        for line in std::mem::take(&mut self.again) {
            self.again(line, problems);
        }
        for orphan in self.list.iter().filter(|orphan| !orphan.told) {
            if let Some(first) = orphan.first {
                problems.duplicate(orphan.header, format!("{} is given twice", orphan.number), first);
                continue;
            }
            let mut message = format!("{} is loaded by no directory block", orphan.number);
            match below.get(&orphan.number) {
                None => {}
                Some(1) => message += ", nor is the one that it names",
                Some(count) => message += &format!(", nor are the {count} that it names"),
            }
            match &orphan.needed[..] {
                [] => {}
                [name] => message += &format!("; {name} is used and defined there"),
                [name, others @ ..] => {
                    let others = amount(others.len(), "more name");
                    message += &format!("; {name} and {others} are used and defined there");
                }
            }
            let severity = if orphan.needed.is_empty() { Severity::Warning } else { Severity::Error };
            let help = self.directory_of(orphan).map_or_else(
                || format!("name it in a directory block: `{} load`", orphan.number.number),
                |directory| format!("add `{} load` to {directory}", orphan.number.number),
            );
            problems.push(severity, "block.unloaded", orphan.header, message, Some(help));
        }
    }

    /// Marks orphans that another orphan names. Returns the orphans that name others, each
    /// with the number of orphans that it names.
    fn gather(&mut self) -> BTreeMap<BlockNumber, usize> {
        let named: HashSet<BlockNumber> =
            self.list.iter().flat_map(|orphan| &orphan.loads).map(|line| line.block).collect();
        let mut below = BTreeMap::new();
        for root in 0..self.list.len() {
            let Some(top) = self.list.get(root).filter(|orphan| !named.contains(&orphan.number)) else {
                continue;
            };
            let number = top.number;
            let mut open: Vec<BlockNumber> = top.loads.iter().map(|line| line.block).collect();
            let (mut needed, mut count) = (Vec::new(), 0);
            while let Some(next) = open.pop() {
                let Some(orphan) = self.list.iter_mut().find(|o| o.number == next && !o.told) else {
                    continue;
                };
                orphan.told = true;
                count += 1;
                needed.append(&mut orphan.needed);
                open.extend(orphan.loads.iter().map(|line| line.block));
            }
            if let Some(top) = self.list.get_mut(root) {
                top.needed.append(&mut needed);
            }
            if count > 0 {
                below.insert(number, count);
            }
        }
        below
    }

    fn missing(&mut self, line: LoadLine, problems: &mut Problems) {
        if self.incomplete {
            return;
        }
        // The block's header may be unreadable or its number invalid, which is already reported.
        let unreadable = |o: &Orphan| {
            o.number.offset == BlockNumber::UNREADABLE
                || o.number.offset == line.block.offset && o.number.number > LAST_BLOCK
        };
        if self.list.iter().any(unreadable) {
            return;
        }
        let message = format!("there is no {}", line.block);
        match self.meant(line.block) {
            Some(orphan) => {
                orphan.told = true;
                let (found, header) = (orphan.number, orphan.header);
                let state =
                    if orphan.first.is_some() { "is given twice" } else { "is loaded by no directory block" };
                problems.error("block.missing", line.at, message);
                problems.elsewhere(
                    format!("one of two numbers is wrong: {found} {state}; its header is in"),
                    header,
                );
            }
            None => problems.error_help(
                "block.missing",
                line.at,
                message,
                "give the number of a block that there is, or take the line out",
            ),
        }
    }

    fn again(&mut self, line: LoadLine, problems: &mut Problems) {
        let message = format!("{} is loaded already", line.block);
        match self.meant(line.block).filter(|orphan| orphan.first.is_none()) {
            Some(orphan) => {
                orphan.told = true;
                let (found, header) = (orphan.number, orphan.header);
                let severity = if orphan.needed.is_empty() { Severity::Warning } else { Severity::Error };
                problems.push(severity, "block.again", line.at, message, None);
                problems.elsewhere(
                    format!("did you mean {found}? No directory block loads it; its header is in"),
                    header,
                );
            }
            None => problems.warning("block.again", line.at, message, Some("take the line out".to_owned())),
        }
    }

    fn meant(&mut self, number: BlockNumber) -> Option<&mut Orphan> {
        let wanted = number.number.to_string();
        let slip = |orphan: &Orphan| distance(&wanted, &orphan.number.number.to_string());
        let near = self
            .list
            .iter_mut()
            .filter(|orphan| !orphan.told && orphan.number.offset == number.offset && slip(orphan) <= SLIP);
        near.min_by_key(|orphan| slip(orphan))
    }

    /// The loaded directory block that should name an orphan: the last one before the orphan. If there is none, the
    /// directory block that names the nearest number. An orphan that is itself a directory belongs to a block that
    /// names directories.
    fn directory_of(&self, orphan: &Orphan) -> Option<BlockNumber> {
        let is_directory = |block: &BlockNumber| self.directories.contains_key(block);
        let fits = |(directory, named): &(&BlockNumber, &Vec<BlockNumber>)| {
            directory.offset == orphan.number.offset
                && named.iter().any(|block| is_directory(block) != orphan.loads.is_empty())
        };
        let directories = || self.directories.iter().filter(fits);
        let before = directories().map(|(directory, _)| *directory).filter(|d| *d <= orphan.number).max();
        let distance = |named: &Vec<BlockNumber>| {
            named.iter().map(|block| block.number.abs_diff(orphan.number.number)).min()
        };
        before.or_else(|| directories().min_by_key(|(_, named)| distance(named)).map(|(d, _)| *d))
    }
}
