//! Words for blocks (IV.2.3, IV.2.4, IV.2.7): list, edit, load, and search their text.

use interfaces::{ProcessId, operator::board_bit};
use levels::ladder::Ladder;
use taskdata::load::{BlockNumber, commands};

use super::{library::AREAS, said, teach::PoseLesson, words::Interpreter};

impl Interpreter<'_> {
    /// `n EDIT`: the manual has a screen editor for it (IV.2.3).
    pub(super) fn edit(&mut self) -> Result<(), String> {
        let number = self.pop("n EDIT")?;
        self.outcome.edits = Some(BlockNumber { offset: self.board.offset, number });
        Ok(())
    }

    /// `n TEACH name` and `n TEACH name pose`: write the recorded pose as a form, or as a movetable relative to a pose.
    pub(super) fn teach(&mut self, behind: &[&str]) -> Result<usize, String> {
        let number = BlockNumber { offset: self.board.offset, number: self.pop("n TEACH name")? };
        let mut names = behind.iter().map(|name| (*name).to_owned());
        let name = names.next().ok_or("a name is missing: n TEACH name, or n TEACH name pose")?;
        self.outcome.teaches = Some(PoseLesson { number, name, relative: names.next() });
        Ok(behind.len())
    }

    pub(super) fn list(&mut self) -> Result<(), String> {
        let number = BlockNumber { offset: self.board.offset, number: self.pop("n LIST")? };
        let Some((file, lines)) = self.library.block(number) else { return Err(self.missing(number)) };
        self.outcome.listed = Some(number);
        self.say(format!("  {number}, {file}"));
        // Empty lines are omitted: a screen of 24 lines has no room for a block of 16.
        for (at, line) in lines.iter().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            self.say(format!(" {at:>2} {line}"));
        }
        Ok(())
    }

    fn missing(&mut self, number: BlockNumber) -> String {
        let known = self.library.numbers(number.offset);
        let known: Vec<String> = known.iter().map(u32::to_string).collect();
        match (known.as_slice(), AREAS.iter().rev().find(|(offset, ..)| *offset <= number.offset)) {
            ([], Some((_, process, place))) => {
                format!("there are no blocks at offset {}; {process} is in {place}", number.offset)
            }
            _ => format!("there is no {number}; blocks there: {}", known.join(", ")),
        }
    }

    pub(super) fn load(&mut self, number: BlockNumber) -> Result<(), String> {
        let of_task = number.offset == commands::OFFSET || number.number == 28;
        if let Some(text) = said::of_block(number.number).filter(|_| of_task) {
            self.say(format!("  {text}"));
            return Ok(());
        }
        self.library.forget();
        if self.library.block(number).is_none() {
            return Err(self.missing(number));
        }
        self.outcome.asks.push(format!("load {} {}", number.offset, number.number));
        Ok(())
    }

    pub(super) fn line_load(&mut self) -> Result<(), String> {
        let form = "block line line LINE-LOAD";
        let (to, from) = (self.pop(form)?, self.pop(form)?);
        let block = self.pop(form)?;
        self.on(6)?;
        if self.board.offset != commands::OFFSET {
            let offset = commands::OFFSET;
            return Err(format!("blocks of commands are at offset {offset}: {offset} OFFSET !"));
        }
        let is_stopped = self
            .picture
            .is_some_and(|picture| picture.external.operator.stopped & (board_bit(6) | board_bit(0)) != 0);
        if is_stopped {
            self.say("  boards do not run: GO starts Task and Subtask");
        }
        self.outcome.asks.push(format!("line-load {block} {from} {to}"));
        Ok(())
    }

    pub(super) fn offset(&mut self, behind: Option<&str>) -> Result<usize, String> {
        match behind {
            Some("!") => {
                self.board.offset = self.pop("offset OFFSET !")?;
                Ok(1)
            }
            Some("@" | "?") => {
                let offset = self.board.offset;
                self.say(format!("  {offset}"));
                Ok(1)
            }
            _ => {
                for (offset, process, place) in &AREAS {
                    self.say(format!("  {offset:>5} {process:<24} {place}"));
                }
                Ok(0)
            }
        }
    }

    /// LOC: find the definition of a word (IV.2.7): an entry of the task data, a decision table, a process.
    pub(super) fn locate(&mut self, behind: Option<&str>) -> Result<usize, String> {
        let name = behind.ok_or("a name is missing: LOC name")?;
        for (process, info) in ProcessId::ALL.iter().zip(Ladder::processes()) {
            for table in info.tables.iter().filter(|table| table.name == name) {
                self.say(format!("  table {} of {process}: {}:{}", table.name, table.file, table.line));
            }
        }
        for (number, line, text) in self.library.find(name) {
            self.say(format!("  {} at {}, line {line}: {text}", number.number, number.offset));
        }
        if self.outcome.said.is_empty() {
            return Err(format!("no table and no block has {name}"));
        }
        Ok(1)
    }
}
