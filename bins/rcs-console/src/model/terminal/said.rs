//! Words of the manual that have no effect here: their effect in the manual, and their replacement (IV.2, IV.5).

static OLD: [(&[&str], &str); 12] = [
    (&[":C", "}R"], "there is no compiler at the terminal: routines are compiled with the program"),
    (
        &["RUN-RCS", "CBOOT", "MBOOT", "CUSTOM", "BOOT-SYSTEM", "init-cm", "BGO", "CLP", "^X"],
        "boards need no boot: rcs-run starts them, in one process or in five (docs/boards.md)",
    ),
    (&["HEX", "OUTPUT", "ERASE"], "there are no ports to set: the run sets up its devices before tick 1"),
    (
        &["NQUIT", "NEW-MOLE2", "SAVE", "DO-BUCKET"],
        "the system is reloaded by building it: cargo build --release (IV.2.10)",
    ),
    (&["CPRINT"], "blocks are text files under data/: print them as any other (IV.2.9)"),
    (&["ADD-TO-TAPE"], "the source is under version control: there is no tape (IV.2.9)"),
    (
        &["WUNLOAD"],
        "there is no disk to shut down: the run ends with SIGINT, and its log is complete (IV.2.11)",
    ),
    (
        &["READ-HWS-COMMAND", "WRITE-HWS-COMMAND", "WRITE-HWS-STATUS", "UPDATE-MAILGRAM?"],
        "block 903, 907: --outside workstation and the job line ** workstation connect the HWSC (IV.4.1)",
    ),
    (
        &["READ-DAS-STATUS", "WRITE-DAS-COMMAND", "UPDATE-MAILGRAM->DAS-?", "Parse-das-status"],
        "block 903, 907: STARTUP (667 0 0 LINE-LOAD) connects the Data System, SHUTDOWN drops it (IV.4.2)",
    ),
    (
        &["lld", "DIAGNOSTIC"],
        "each level relies on sensors: a lower level that is left out would not change them (IV.3.2)",
    ),
    (
        &["READ-AP-STATUS", "WRITE-AP-COMMAND"],
        "the pedestal runs on board 8, or elsewhere with --outside pedestal (IV.4.3)",
    ),
    (
        &["READ-VISION-DATA", "WRITE-VISION-REQUEST"],
        "vision is always connected; --outside vision takes another process for it (IV.4.4)",
    ),
];

/// Blocks that the manual loads for their effect. They are at Task's offset and at the offset of each board.
static BLOCKS: [(u32, &str); 5] = [
    (28, "28 LOAD initialized a board: each process does it in its first tick (IV.2.8)"),
    (188, "188 LOAD prepared the network for the HWSC: connecting does it (IV.4.1)"),
    (641, "641 LOAD initialized the mailboxes: done when the HWSC connects (IV.4.1, IX.1)"),
    (903, "block 903 chose what is read: the run's options and DB-DONE do (IV.3.2)"),
    (907, "block 907 chose what postprocess writes: the run's options choose it (IV.3.2)"),
];

/// The answer to a word; `None` if it is not such a word.
#[must_use]
pub fn of_word(word: &str) -> Option<&'static str> {
    OLD.iter().find(|(words, _)| words.contains(&word)).map(|(_, text)| *text)
}

/// The answer to loading a block; `None` for ordinary blocks.
#[must_use]
pub fn of_block(number: u32) -> Option<&'static str> {
    let number = if (642..=643).contains(&number) { 641 } else { number };
    BLOCKS.iter().find(|(block, _)| *block == number).map(|(_, text)| *text)
}
