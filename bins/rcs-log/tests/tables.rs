//! `rcs-log why` on logs with decision tables of another program, and on logs without tables.

use std::{io::Read as _, path::Path, process::Command};

use interfaces::{CommonMemory, Decided, ExternalInputs, Header};
use rcs_core::tick::Tick;
use record::{
    Attachment, End, Epoch, Pace, Recorder, Setup,
    explanation::{self, TABLES},
};
use serde_json::Value;

const EMOVE: usize = 2; // position of E-move in the ladder

/// A log of one tick in which row 1 of E-move's first table fired, with these attachments.
fn log(path: &Path, attachments: Vec<Attachment>) {
    let setup = Setup { epoch: Epoch::Fixed, attachments, ..Setup::default() };
    let mut recorder = Recorder::start(path, Pace::Wait, setup).expect("the log begins");
    let mut memory = CommonMemory::default();
    memory.emove.header =
        Header { stamp: Tick(1), decided: Some(Decided { table: 1, row: 1 }), ..Header::default() };
    recorder.tick(Tick(1), &ExternalInputs::default(), &memory, Default::default);
    recorder.finish(End::default()).expect("the log ends");
}

fn explained(path: &Path) -> (String, String) {
    let mut why = Command::new(env!("CARGO_BIN_EXE_rcs-log"));
    let output = why.args(["why", "--json", "--tick", "1"]).arg(path).output().expect("the program starts");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{stderr}");
    let answer: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    (answer["levels"][EMOVE]["action"].as_str().unwrap_or_default().to_owned(), stderr)
}

fn other_tables(mut file: Attachment) -> Attachment {
    let mut text = String::new();
    zstd::Decoder::new(file.data.as_slice()).unwrap().read_to_string(&mut text).unwrap();
    let mut tables: Value = serde_json::from_str(&text).unwrap();
    tables[EMOVE]["tables"][0]["rows"][0]["action"] = "Yodel(Loudly)".into();
    file.data = zstd::encode_all(tables.to_string().as_bytes(), 1).unwrap();
    file
}

#[test]
fn log_is_explained_with_its_own_tables() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let [tables, reasons] = explanation::attachments();
    assert_eq!(tables.name, TABLES);
    log(&path("same.mcap"), vec![tables.clone(), reasons]);
    log(&path("other.mcap"), vec![other_tables(tables)]);
    log(&path("old.mcap"), Vec::new());
    let (own, said) = explained(&path("same.mcap"));
    assert_eq!(said, "");
    let (action, said) = explained(&path("other.mcap"));
    assert_eq!(action, "Yodel(Loudly)");
    assert!(said.contains("differ from those of this program"), "{said}");
    let (action, said) = explained(&path("old.mcap"));
    assert_eq!(action, own);
    assert!(said.contains("an older program wrote it without decision tables"), "{said}");
}
