//! Commands against the shipped data.

use std::path::Path;

use interfaces::HwsCommand;
use rcs_core::name::Name16;

use super::{super::Store, super::job::own_command, Before, Verdict, in_words, with_nearest};
use crate::load::{Job, Source, Step};

fn store() -> Store {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
    Store::load(data).map_or_else(|report| panic!("{report}"), |(store, _)| store)
}

fn command(fields: &str) -> HwsCommand {
    let words: Vec<&str> = fields.split_whitespace().collect();
    let name = |at: usize| Some(words[at]).filter(|word| *word != "--").map(Name16::clipped);
    let number = |at: usize| words[at].parse::<i32>().unwrap();
    let sector = |at: usize| Some(number(at)).filter(|sector| *sector != 0);
    HwsCommand {
        command: Name16::clipped(words[0]),
        object: name(1),
        source_grip: number(2),
        source: name(3),
        source_sector: sector(4),
        destination_grip: number(5),
        destination: name(6),
        destination_sector: sector(7),
        end_at: name(8),
        end_at_sector: sector(9),
        ..HwsCommand::default()
    }
}

fn verdict(fields: &str, store: &Store) -> String {
    in_words(&Verdict::of(&command(fields), &store.view(), Before::unknown()).findings)
}

#[test]
fn commands_from_line_request_and_mailbox_get_the_same_text() {
    let store = store();
    let cases = [
        (
            "TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 3 UNIT_1 2",
            "sector 2 of UNIT_1 needs an object, which says how the tray is divided",
        ),
        ("RELEASE-TOOL ENDMILL-1 +1 -- 0 +1 -- 0 HOME 0", "no trajectory leads from TOOL-TRNS to HOME"),
        ("REMOVE-TOOL ENDMILL-1 +1 -- 0 +1 -- 0 HOME 0", "no trajectory leads from TOOL-TRNS to HOME"),
        (
            "TRANSFER LCLEVIS_IH +1 PFIXTURE 0 +1 PEDESTAL 0 HOME 0",
            "TRANSFER releases LCLEVIS_IH at PEDESTAL, but does not command the hand there to grip it",
        ),
        ("MOVE LINKBAR9 +2 UNIT_1 4 +2 PFIXTURE 0 -- 0", "no object is named LINKBAR9"),
        ("MOV -- 0 -- 0 0 HOME 0 -- 0", "no command of Task is named MOV"),
        (
            "MOVE LINKBAR1_BH +0 UNIT_1 0 +2 PFIXTURE 0 -- 0",
            "MOVE needs a grip of LINKBAR1_BH at UNIT_1, +0 found; UNIT_1 is a tray and needs a sector, 0 found",
        ),
    ];
    for (fields, expected) in cases {
        let found = verdict(fields, &store);
        assert!(found.contains(expected), "{fields}: {found}");
        let request = own_command(fields, &store).unwrap_err().to_string();
        assert_eq!(request, found, "{fields}");
        // The joystick makes the held object unknown.
        let text = format!("** joystick frame OFF\n== {fields}\n");
        let source = Source { name: "try.job".into(), text: text.into() };
        let report = Job::from_source(source, &store).unwrap_err();
        let line: Vec<_> = report.errors().map(|error| with_nearest(error.message(), error.help())).collect();
        assert_eq!(line.join("; "), found, "{fields}");
    }
}

#[test]
fn valid_commands_pass_as_line_request_and_mailbox() {
    let store = store();
    for fields in [
        "MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0",
        "RELEASE-TOOL ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0",
        "MOVE LCLEVIS_IH +1 PFIXTURE 0 +1 PEDESTAL 0 -- 0",
        "MOVE -- 0 -- 0 0 HOME 0 -- 0",
    ] {
        assert_eq!(verdict(fields, &store), "");
        let Step::Command(read) = own_command(fields, &store).unwrap().step else { panic!("{fields}") };
        assert_eq!(read, command(fields));
    }
}

#[test]
fn fields_of_pause_are_ignored() {
    let store = store();
    for verb in ["PAUSE", "STARTUP", "SHUTDOWN"] {
        assert_eq!(verdict(&format!("{verb} NOTHING 9 NOWHERE 9 9 NOWHERE 9 NOWHERE 9"), &store), "");
    }
}

#[test]
fn tool_commands_may_be_cut_to_ten_characters() {
    let store = store();
    assert_eq!(verdict("RELEASE-TO ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0", &store), "");
    assert!(
        verdict("RELEASE-TOO ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0", &store).contains("no command of Task")
    );
}
