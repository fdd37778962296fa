//! JSON has each key once, text of files contains no terminal commands, and display units change only texts.

use std::{
    collections::BTreeSet,
    fmt, fs,
    path::Path,
    process::{Command, Output},
};

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use whole_system_tests::{Scratch, rcs_console, rcs_log, rcs_run, root};

struct Strict; // no object has a key twice

impl<'de> Deserialize<'de> for Strict {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StrictVisitor)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = Strict;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<Strict, E> {
        Ok(Strict)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Strict, E> {
        Ok(Strict)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Strict, E> {
        Ok(Strict)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Strict, E> {
        Ok(Strict)
    }

    fn visit_str<E>(self, _: &str) -> Result<Strict, E> {
        Ok(Strict)
    }

    fn visit_unit<E>(self) -> Result<Strict, E> {
        Ok(Strict)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Strict, A::Error> {
        while items.next_element::<Strict>()?.is_some() {}
        Ok(Strict)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Strict, A::Error> {
        let mut keys = BTreeSet::new();
        while let Some(key) = entries.next_key::<String>()? {
            entries.next_value::<Strict>()?;
            if !keys.insert(key.clone()) {
                return Err(serde::de::Error::custom(format!("the key {key} is there twice")));
            }
        }
        Ok(Strict)
    }
}

fn run_in(scratch: &Scratch, program: &Path, arguments: &[&str], units: &str) -> Output {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(scratch.file(".")).env("RCS_UNITS", units);
    command.output().expect("the program can be started")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn stdout(scratch: &Scratch, program: &Path, arguments: &[&str], units: &str) -> String {
    let output = run_in(scratch, program, arguments, units);
    assert!(!output.stdout.is_empty(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// The logs `a.mcap` of a failing run and `b.mcap` of a short one.
fn with_logs(name: &str) -> Scratch {
    let scratch = Scratch::new(name);
    let missing = root().join("data/faults/blank-missing.toml");
    let missing = missing.to_str().expect("a path in UTF-8");
    let run = ["run", "linkbar", "--shared-memory", "off", "--json", "--log"];
    for more in [&["a.mcap", "--faults", missing][..], &["b.mcap", "--ticks", "700"][..]] {
        stdout(&scratch, rcs_run(), &[&run[..], more].concat(), "in");
    }
    scratch
}

#[test]
fn every_json_output_has_each_key_once() {
    assert!(serde_json::from_str::<Strict>("{\"a\":1,\"b\":[{\"c\":2,\"c\":null}]}").is_err());
    let scratch = with_logs("json");
    let old = root().join("data");
    let old = old.to_str().expect("a path in UTF-8");
    let of_run: &[&[&str]] = &[
        &["run", "linkbar", "--ticks", "100", "--log", "none", "--shared-memory", "off", "--json"],
        &["check", "--json"],
        &["jobs", "--json"],
        &["check", "--json", "--where", "HOME-POS"],
        &[
            "check",
            "--json",
            "--explain",
            "MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0",
            "--from",
            "SAFE",
        ],
        &["check", "--json", "--explain-job", "linkbar"],
        &["pose", "--json", "--of", "HOME-POS"],
        &["latency", "--json", "--seconds", "1"],
        &["campaign", "linkbar", "--json", "--at", "60,120", "--interrupt", "pause"],
    ];
    let of_log: &[&[&str]] = &[
        &["info", "--json", "a.mcap"],
        &["why", "--json", "a.mcap"],
        &["why", "--json", "--tick", "200", "a.mcap"],
        &["replay", "--json", "a.mcap"],
        &["diff", "--json", "a.mcap", "b.mcap"],
        &["fork", "--json", "--tick", "100", "--set", "line=** wait 50", "b.mcap"],
        &["compare", "--json", old, old, "linkbar"],
        &["golden", "--json", "a.mcap", "-o", "goldens"],
    ];
    for (program, all) in [(rcs_run(), of_run), (rcs_log(), of_log)] {
        for arguments in all {
            let json = stdout(&scratch, program, arguments, "mm");
            serde_json::from_str::<Strict>(&json)
                .unwrap_or_else(|wrong| panic!("{arguments:?}: {wrong}\n{json}"));
        }
    }
}

/// Other subcommands need a robot at a port or a run.
#[test]
fn the_list_of_json_outputs_is_complete() {
    let page = fs::read_to_string(root().join("docs/cli.md")).expect("the page is there");
    let mut subcommand = "";
    let mut with_json = BTreeSet::new();
    for line in page.lines() {
        if line.starts_with('#') {
            subcommand = line.trim_start_matches(['#', ' ']);
        } else if line.starts_with("- `--json`") || line.starts_with("- As for") && line.contains("`--json`")
        {
            with_json.insert(subcommand);
        }
    }
    let known = [
        "rcs-log compare",
        "rcs-log diff",
        "rcs-log fork",
        "rcs-log golden",
        "rcs-log info",
        "rcs-log replay",
        "rcs-log why",
        "rcs-run",
        "rcs-run campaign",
        "rcs-run check",
        "rcs-run io-test",
        "rcs-run jobs",
        "rcs-run latency",
        "rcs-run link-test",
        "rcs-run pose",
        "rcs-run run",
        "rcs-run status",
    ];
    assert_eq!(with_json.into_iter().collect::<Vec<_>>(), known);
}

/// Sets the window title, clears the screen in one byte of ISO 6429, and reverses the following text.
const COMMANDS: &str = "\u{1b}]0;title\u{7}\u{9b}2J\u{202e}";

fn assert_plain(arguments: &[&str], output: &Output) {
    for bytes in [&output.stdout, &output.stderr] {
        let text = text(bytes);
        let found = text.chars().find(|c| (c.is_control() && !"\n\t".contains(*c)) || *c == '\u{202e}');
        assert_eq!(found, None, "{arguments:?}: {}", text.escape_debug());
    }
}

#[test]
fn text_of_files_reaches_a_terminal_without_control_characters() {
    let scratch = Scratch::new("escapes");
    scratch.copy_data();
    let data = scratch.file("data");
    let with = |file: &str, from: &str, to: &str| {
        let path = data.join(file);
        let text = fs::read_to_string(&path).expect("the file is there");
        assert!(text.contains(from), "{file}");
        fs::write(&path, text.replacen(from, to, 1)).expect("the file can be written");
    };
    fs::write(scratch.file("wrong.job"), format!("== MOVE {COMMANDS} +2 NOWHERE{COMMANDS} 0 -- 0 -- 0\n"))
        .expect("a job can be written");
    fs::write(scratch.file("wrong.toml"), format!("[[fault]]\nkind = \"{}\"\n", "x\\u001b[31m"))
        .expect("a fault file can be written");
    let log = format!("log{COMMANDS}.mcap");
    let short = ["run", "linkbar", "--ticks", "50", "--shared-memory", "off", "--log", &log];
    let cases: &[(&Path, &[&str], &str)] = &[
        (rcs_run(), &short, "the run"),
        (rcs_log(), &["info", &log], "the log"),
        (rcs_log(), &["info", "--json", &log], "the log as JSON"),
        (rcs_run(), &["run", "wrong.job", "--log", "none"], "the job"),
        (rcs_run(), &["run", "linkbar", "--log", "none", "--faults", "wrong.toml"], "the fault file"),
    ];
    for (program, arguments, what) in cases {
        let output = run_in(&scratch, program, arguments, "in");
        assert_plain(arguments, &output);
        assert!(output.stdout.len() + output.stderr.len() > 40, "{what}");
    }
    with("poses.blk", "-pose-", &format!("-pose-{COMMANDS}"));
    with("cell.toml", "name = \"", "name = \"\\u001b[31m\\u009b");
    for arguments in [&["check", "--data", "data"][..], &["check", "--data", "data", "--json"][..]] {
        let output = run_in(&scratch, rcs_run(), arguments, "in");
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        assert_plain(arguments, &output);
    }
}

fn quantities(text: &str, unit: &str) -> Vec<f64> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_unit = |word: &str| word.trim_end_matches([',', ';', ')', '.', ':']) == unit;
    let pairs = words.iter().zip(words.iter().skip(1)).filter(|(_, next)| is_unit(next));
    let number = |word: &str| word.trim_start_matches(['(', '+']).parse::<f64>().ok();
    // `0.01 in` is the unit of the numbers in a form.
    let is_length = |word: &str| word.contains('.') && word != "0.01";
    pairs.filter(|(word, _)| is_length(word)).filter_map(|(word, _)| number(word)).collect()
}

#[test]
fn texts_in_inches_and_in_millimetres_agree() {
    let scratch = with_logs("units");
    let explain = ["check", "--explain", "MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0", "--from", "SAFE"];
    let cases: &[(&Path, &[&str])] = &[
        (rcs_run(), &["pose", "--of", "HOME-POS"]),
        (rcs_run(), &["check", "--where", "UNIT-V1"]),
        (rcs_run(), &explain),
        (rcs_run(), &["check", "--explain-job", "linkbar"]),
        (rcs_run(), &["run", "linkbar", "--log", "none", "--shared-memory", "off"]),
        (rcs_log(), &["why", "a.mcap"]),
        (rcs_log(), &["diff", "a.mcap", "b.mcap"]),
        (rcs_log(), &["info", "a.mcap"]),
        (rcs_console(), &["--log", "a.mcap", "--once", "cell", "--tick", "300"]),
    ];
    let mut count = 0;
    for (program, arguments) in cases {
        let [inches, millimetres] = ["in", "mm"].map(|units| stdout(&scratch, program, arguments, units));
        let (of_in, of_mm) = (quantities(&inches, "in"), quantities(&millimetres, "mm"));
        assert_eq!(quantities(&millimetres, "in"), Vec::<f64>::new(), "{millimetres}");
        assert_eq!(of_in.len(), of_mm.len(), "{arguments:?}: {inches}\n{millimetres}");
        for (inch, millimetre) in of_in.iter().zip(&of_mm) {
            assert!((inch * 25.4 - millimetre).abs() <= 0.0501, "{arguments:?}: {inch} in, {millimetre} mm");
        }
        count += of_in.len();
    }
    assert!(count > 50, "{count} lengths were compared");
}

#[test]
fn units_of_the_person_change_neither_json_nor_logs() {
    let scratch = Scratch::new("units-json");
    let logs = ["in", "mm"].map(|units| {
        let run = ["run", "linkbar", "--shared-memory", "off", "--json", "--log", "run.mcap"];
        let json: serde_json::Value =
            serde_json::from_str(&stdout(&scratch, rcs_run(), &run, units)).expect("one JSON object");
        let log = fs::read(scratch.file("run.mcap")).expect("the log is written");
        fs::remove_file(scratch.file("run.mcap")).expect("the log can be removed");
        (json["digest"].clone(), json["parts"].clone(), log)
    });
    assert!(logs[0] == logs[1], "the result or the log differs");
}

#[test]
fn lengths_are_typed_in_the_units_of_the_person() {
    let scratch = Scratch::new("typed");
    let pose = |units: &str, point: [&str; 3]| {
        let arguments = [&["pose", "--json", "--units", units][..], &point[..]].concat();
        stdout(&scratch, rcs_run(), &arguments, "in")
    };
    assert_eq!(pose("in", ["-55", "-20", "0.5"]), pose("mm", ["-1397", "-508", "12.7"]));
    assert_ne!(pose("in", ["-55", "-20", "0.5"]), pose("in", ["-55", "-20", "0.6"]));
    let new = |units: &str, size: &str| {
        let arguments = ["new", "part", "WIDE", "--size", size, "--like", "LCLEVIS"];
        let output = run_in(&scratch, rcs_run(), &arguments, units);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
        text(&output.stderr)
    };
    let (inches, millimetres) = (new("in", "3x4x1"), new("mm", "76.2x101.6x25.4")); // too wide: 4.00 in
    assert!(inches.contains("this one is 4.00 in wide"), "{inches}");
    assert!(millimetres.contains("this one is 101.6 mm wide"), "{millimetres}");
    assert_eq!(new("mm", "3inx4inx1in"), millimetres);
}
