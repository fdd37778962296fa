//! Task data: any text, as one file of blocks.
//!
//! Whatever a person types, loading says what is wrong with it and nothing worse. What can be read is printed as forms that read
//! the same; what loads can be loaded over itself without giving any record another number.

#![no_main]

use diagnostics::{Problems, Source};
use libfuzzer_sys::fuzz_target;
use taskdata::load::{Store, entries::Entry, lex::words, parse::parse, print, source::blocks};

/// The entries of all blocks that are not broken by their size.
fn entries(text: &str) -> Vec<Entry> {
    let source = Source { name: "fuzz.blk".to_owned(), text: text.into() };
    let (blocks, faults) = blocks(0, &source);
    if !faults.is_empty() {
        return Vec::new();
    }
    let mut problems = Problems::default();
    let mut entries = Vec::new();
    for block in &blocks {
        let words = words(block, &mut problems);
        entries.extend(parse(&words, block.number, block.header, &mut problems).entries);
    }
    entries
}

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    let printed = print::blocks(&entries(&text), 30_000, 0);
    let again = print::blocks(&entries(&printed), 30_000, 0);
    assert_eq!(again, printed, "{text}");

    let source = || vec![Source { name: "fuzz.blk".to_owned(), text: text.as_ref().into() }];
    match Store::from_sources(source()) {
        Ok((store, _)) => {
            let (next, _) = store.with_blocks(source()).unwrap_or_else(|report| panic!("{report}\n{text}"));
            assert_eq!(next.loaded(), store.loaded());
            assert_eq!(next.view().locpts, store.view().locpts);
        }
        Err(report) => {
            assert!(report.has_errors());
            // Every message can be shown.
            let _ = report.render(true).len() + report.to_string().len();
        }
    }
});
