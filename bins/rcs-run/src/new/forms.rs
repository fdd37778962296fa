//! The file of blocks for the new forms.

use taskdata::load::{entries::Entry, print, source::BLOCK_LINES};

const LOADS_A_LINE: usize = 2; // load commands per line of a directory block

/// Blocks of forms, and the directory block that loads them, which comes first.
pub struct Blocks {
    name: String,
    from: String,
    area: u32,
    blocks: Vec<(String, Vec<String>)>,
}

impl Blocks {
    /// Blocks without forms. `from` names the source from which the forms are derived.
    pub fn new(name: &str, from: String, area: u32) -> Self {
        Self { name: name.to_owned(), from, area, blocks: Vec::new() }
    }

    /// Add forms of one kind, in as many blocks as they need.
    pub fn group(&mut self, title: &str, entries: &[Entry]) {
        let mut forms: Vec<Vec<String>> = entries.iter().map(print::form).collect();
        align(&mut forms);
        let mut fresh = true;
        for form in forms {
            let fits = |(_, lines): &&mut (String, Vec<String>)| lines.len() + form.len() < BLOCK_LINES;
            match self.blocks.last_mut().filter(fits).filter(|_| !fresh) {
                Some((_, lines)) => lines.extend(form),
                None => self.blocks.push((title.to_owned(), form)),
            }
            fresh = false;
        }
    }

    pub fn count(&self) -> u32 {
        u32::try_from(self.blocks.len() + 1).unwrap_or(u32::MAX)
    }

    /// Text of the file; `first` is the number of the directory block.
    pub fn text(&self, first: u32) -> String {
        let Self { name, from, area, .. } = self;
        let derived = "%% From: derived, as the first line of this file says.\n";
        let mut text = format!("%% {name}, derived by rcs-run new from {from}.\n%%\n");
        text += &format!("\nBLOCK# {first:03} OFFSET {area}\n{derived}( *** Data-forms :   {name} *** )\n");
        text += &format!("( {first:03} ref-blk )\n\n");
        let numbers: Vec<u32> = (first + 1..).take(self.blocks.len()).collect();
        for numbers in numbers.chunks(LOADS_A_LINE) {
            let loads: Vec<String> = numbers.iter().map(|number| format!("{number:03} load")).collect();
            text += &format!("  {}\n", loads.join("   "));
        }
        for (number, (title, lines)) in numbers.iter().zip(&self.blocks) {
            text += &format!("\nBLOCK# {number:03} OFFSET {area}\n{derived}( {title} )\n");
            text.extend(lines.iter().map(|line| format!("{line}\n")));
        }
        text
    }
}

fn align(forms: &mut [Vec<String>]) {
    let alone = forms.iter().all(|form| form.len() == 1);
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let rows: Vec<Vec<String>> = forms.iter().flatten().map(|line| words(line)).collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(String::len).max();
    let widths: Vec<usize> = (0..columns).filter_map(width).collect();
    let fits = widths.iter().map(|width| width + 1).sum::<usize>() < taskdata::load::source::BLOCK_COLUMNS;
    if !alone || !fits {
        return;
    }
    for (form, row) in forms.iter_mut().zip(rows) {
        let padded = row.iter().zip(&widths).map(|(word, width)| format!("{word:<width$}"));
        *form = vec![format!("  {}", padded.collect::<Vec<_>>().join(" ").trim_end())];
    }
}
