//! Blocks of commands: LINE-LOAD finds those of the manual, and errors are reported.

use std::path::Path;

use taskdata::load::{Source, Step, Store};

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

fn store() -> Store {
    Store::load(data()).unwrap_or_else(|report| panic!("{report}")).0
}

fn said(store: &Store, block: u32, line: usize) -> String {
    match store.line_load(block, line, line).unwrap().step {
        Step::Command(command) => {
            let to = command.destination.map(|name| name.to_string());
            format!("{} {}", command.command, to.unwrap_or_default()).trim_end().to_owned()
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn lines_of_chapter_four_exist() {
    let store = store();
    let named = [(863, 3), (863, 12), (667, 0), (667, 1), (667, 10)];
    let found = named.map(|(block, line)| said(&store, block, line));
    assert_eq!(found, ["MOVE HOME", "PAUSE", "STARTUP", "SHUTDOWN", "MOVE HOME"]);
}

#[test]
fn block_893_is_the_job_of_the_linkbar() {
    let store = store();
    let text = std::fs::read_to_string(data().join("jobs/linkbar.job")).unwrap();
    let job: Vec<_> = text.lines().filter(|line| line.starts_with("==")).collect();
    let block = [3, 5, 7, 9, 11, 13].map(|line| store.line_load(893, line, line).unwrap().text);
    let said = |text: &str| text.trim_start_matches("==").split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(block.map(|text| said(&text)).to_vec(), job.into_iter().map(said).collect::<Vec<_>>());
}

#[test]
fn invalid_commands_are_not_loaded() {
    let store = store();
    let refused = |block, from, to| store.line_load(block, from, to).unwrap_err().to_string();
    assert_eq!(
        refused(610, 0, 0),
        "there is no block 610 at offset 16000; blocks with commands: 667, 863, 893"
    );
    assert_eq!(refused(863, 12, 3), "two lines from 0 to 15 were expected, the first one first; found 12 3");
    assert_eq!(refused(863, 0, 16), "two lines from 0 to 15 were expected, the first one first; found 0 16");
    assert_eq!(refused(863, 0, 2), "one command was expected in lines 0 to 2 of block 863; found 0");
    assert_eq!(refused(893, 3, 5), "one command was expected in lines 3 to 5 of block 893; found 2");
    assert!(store.line_load(893, 2, 4).is_ok(), "comments do not count");
}

#[test]
fn wrong_command_is_reported_at_its_line() {
    let with = |line: &str| {
        let text = format!("BLOCK# 870 OFFSET 16000\n{line}\n");
        store().with_blocks(vec![Source { name: "more.blk".into(), text: text.into() }])
    };
    assert!(with("== MOVE -- +0 -- 0 +0 SAFE 0 -- 0").unwrap().0.line_load(870, 0, 0).is_ok());
    for (line, word) in [
        ("== MOVE -- +0 -- 0 +0 SAVE 0 -- 0", "SAVE"),
        ("== MOVE SAFE", "more.blk: block 870 (offset 16000), line 0"),
        ("-pose- ... X", "a command `== ...` or a comment was expected"),
    ] {
        let report = with(line).unwrap_err().render(false);
        assert!(report.contains(word), "{line}: {report}");
    }
    let twice = "BLOCK# 870 OFFSET 16000\n\nBLOCK# 870 OFFSET 16000\n";
    let twice = store().with_blocks(vec![Source { name: "more.blk".into(), text: twice.into() }]);
    assert!(twice.unwrap_err().render(false).contains("block 870 (offset 16000) is given twice"));
}
