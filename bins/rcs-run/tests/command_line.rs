//! The command line as scripts see it: exit status, the last line on standard error, and the JSON object.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    time::{Duration, Instant},
};

use executive::memory::{Attached, RunName};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use tempfile::TempDir;

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data")
}

/// An empty directory that is removed at the end of a test.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn job(&self, name: &str, text: &str) -> String {
        let path = self.0.path().join(name).with_extension("job");
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }

    fn data(&self) -> PathBuf {
        let to = self.0.path().join("data");
        copy(&data(), &to);
        to
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-run"));
    command
        .args(arguments)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .stdin(Stdio::null());
    command
}

fn rcs_run(arguments: &[&str]) -> Output {
    command(arguments).output().expect("the program starts")
}

fn last_line(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn json(output: &Output) -> Value {
    let text = stdout(output);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text:?}; {}", last_line(output)))
}

#[test]
fn blocks_are_loaded_from_regular_files_only() {
    let place = Place::new();
    let job = place.job("device", "** load /dev/null\n** vise open PFIXTURE\n");
    let output = command(&["run", &job, "--log", "none"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    let why = "/dev/null cannot be read: a regular file was expected";
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains(why), "{said}");
}

/// A pedestal form that turns the part beyond the table's limit, in the blocks that a job loads.
#[test]
fn blocks_loaded_by_a_job_are_checked_against_the_cell() {
    let place = Place::new();
    let blocks = "BLOCK# 1 OFFSET 22000\n:S \"p-object\" <= LCLEVIS_IH\nped-appr <= 500 ped-grasp-size <= 250\n\
                  ped-force <= 0 ped-release-size <= 450\nped-table-pos <= 100 ped-flip-angle <= 1835 :R\n\
                  >FILE PED-PARA\n";
    fs::write(place.0.path().join("pedestal.blk"), blocks).unwrap();
    let refused = |line: &str| {
        let output = rcs_run(&["run", &place.job("loads", &format!("{line}\n")), "--log", "none"]);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    for line in ["** load pedestal.blk", "** after 50 load pedestal.blk"] {
        let said = refused(&format!("{line}\n== PAUSE -- +0 -- 0 +0 -- 0 -- 0"));
        for found in ["ped-table-pos is 10.0 degrees", "ped-force 0 lb, 1 to"] {
            let place = "pedestal.blk: block 1 (offset 22000), line";
            assert!(said.contains(found) && said.contains(place), "{found}: {said}");
        }
    }
    let marked = place.job("marked", "** load pedestal.blk expect error\n** wait 1\n");
    assert_eq!(rcs_run(&["run", &marked, "--log", "none"]).status.code(), Some(0));
    fs::write(
        place.0.path().join("pedestal.blk"),
        blocks.replace("<= 100", "<= -2135").replace("<= 0", "<= 50"),
    )
    .unwrap();
    let said = refused("** load pedestal.blk expect error");
    assert!(said.contains("the blocks fit the cell"), "{said}");
}

/// Two objects that differ only in their vision ids. The cell has two parts with these names, of different sizes.
#[test]
fn objects_differing_only_in_vision_id_cause_a_warning() {
    let place = Place::new();
    let data = place.data();
    let blocks = "BLOCK# 1 OFFSET 22000\n-obj- ONE 1 300 60 30 350   -obj- TWO 1 300 60 30 350\n\
                  -grip- ONE 1 lpt UNIT_1 LK-GRP-1\n-grip- TWO 1 lpt UNIT_1 LK-GRP-1\n\
                  -vu- ONE 1 21 lpt UNIT_1 GR-PIC lpt 561 1\n-vu- TWO 1 22 lpt UNIT_1 GR-PIC lpt 561 1\n";
    fs::write(data.join("objects/two.blk"), blocks).unwrap();
    let directory = fs::read_to_string(data.join("directory.blk")).unwrap();
    let last = "874 load ( brush, vise      )";
    assert!(directory.contains(last));
    fs::write(data.join("directory.blk"), directory.replacen(last, &format!("{last}    22000 1 OLOAD"), 1))
        .unwrap();
    let cell = fs::read_to_string(data.join("cell.toml")).unwrap();
    let part = |name, id: i32, width: f64| {
        format!(
            "[[part]]\nname = \"{name}\"\nsize = [1.0, {width:?}, 4.0]\nweight = 0.4\nvision_id = {id}\n\n"
        )
    };
    let warned = |width| {
        let parts = format!("{cell}\n{}{}", part("ONE", 21, 0.5), part("TWO", 22, width));
        fs::write(data.join("cell.toml"), parts).unwrap();
        let output = rcs_run(&["check", "--json", "--data", &data.display().to_string()]);
        let found = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(found.contains("TWO is a part, and no OBJ-GRIPS record"), "{found}");
        assert_announced(&data.display().to_string());
        found.contains("TWO differs from ONE in nothing but its vision id")
    };
    assert!(warned(0.5));
    assert!(!warned(0.6));
}

#[test]
fn help_and_version_have_status_0() {
    let help = rcs_run(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    assert!(stdout(&help).contains("Examples:") && stdout(&help).contains("Exit status"));
    let version = rcs_run(&["--version"]);
    // The commit follows the version if the source is a repository.
    assert!(
        stdout(&version).starts_with(concat!("rcs-run ", env!("CARGO_PKG_VERSION"))),
        "{}",
        stdout(&version)
    );
}

#[test]
fn usage_error_has_status_2_and_a_sentence() {
    for (arguments, sentence) in [
        (&["--robot", "serial:/dev/ttyS0"][..], "add --clock real"),
        (&["--clock", "slow"], "fast, real"),
        (&["--data", "/nowhere"], "there is no task data directory /nowhere"),
        (&["no-such-job"], "there is no job no-such-job: the data directory has "),
        // The nearest name.
        (&["lnkbar"], "there is no job lnkbar: the nearest is linkbar"),
        (&["chekc"], "there is no job chekc: the nearest is the subcommand check"),
        (&["chekc", "--all"], "a similar subcommand exists: 'check'"),
        (&["--faults", "air-lots"], "there is no fault file air-lots: the nearest is air-lost"),
        (&["--faults", "data/faults/air-lots.toml"], "air-lots.toml: the nearest is air-lost"),
        (&["--robot", "egm:sim,robot=irb670"], "there is no robot irb670: the nearest is irb6700"),
        (&["check", "--robot", "smae"], "there is no robot smae: the nearest is same"),
        (&["check", "--explain-job", "cleivs"], "there is no job cleivs: the nearest is clevis"),
        (&["check", "--explain", "MOVE LINKBR1 +2 UNIT_1 1 +2 PFIXTURE 0 -- 0"], "LINKBAR1"),
        (&["pose", "--of", "HOME-PSO"], "no pose is named HOME-PSO: the nearest is HOME-POS"),
        (&["new", "part", "X", "--size", "1x1x1", "--like", "LINKBR1"], "the nearest is LINKBAR1"),
        (&["campaign", "--interrupt", "puase"], "no interruption puase: the nearest is pause"),
        (&["campaign", "--interrupt", "held:emov"], "no interruption held:emov: the nearest is emove"),
        (&["campaign", "--interrupt", "fault:air-lots"], "the nearest is air-lost"),
    ] {
        let output = rcs_run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stdout(&output).is_empty(), "{arguments:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(sentence), "{arguments:?}: {said}");
    }
}

#[test]
fn jobs_are_listed_one_per_line() {
    let listed = stdout(&rcs_run(&["jobs"]));
    let names: Vec<_> = listed.lines().filter_map(|line| line.split_whitespace().next()).collect();
    let shipped = ["brush", "clevis", "linkbar", "shift", "tool-change", "turned-part", "vise-and-back"];
    assert_eq!(names, shipped);
    assert!(listed.contains("linkbar        The linkbar (VIII.2)\n"), "{listed}");
    assert!(listed.lines().all(|line| line.chars().count() <= 104), "{listed}");
    assert_eq!(json(&rcs_run(&["jobs", "--json"]))["jobs"][2]["job"], "linkbar");
}

#[test]
fn faults_are_found_by_name() {
    let place = Place::new();
    let by = |faults: &str| {
        let output = rcs_run(&["--faults", faults, "--ticks", "90", "--log", "none", "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", last_line(&output));
        json(&output)["cell_faults"].clone()
    };
    let named = by("blank-missing");
    assert_eq!(named[0]["number"], 1, "{named}");
    assert_eq!(by("data/faults/blank-missing.toml"), named);
    let own = place.0.path().join("mine.toml");
    fs::copy(data().join("faults/blank-missing.toml"), &own).unwrap();
    assert_eq!(by(&own.display().to_string()), named);
}

#[test]
fn shipped_data_have_no_findings() {
    let output = rcs_run(&["check", "--json", "--data", "data"]);
    let found = json(&output);
    assert_eq!(found["findings"], serde_json::json!([]), "nor is anything warned of");
    assert_eq!(rcs_run(&["check", "data", "--data", "data"]).status.code(), Some(2), "one of the two");
    assert_eq!(
        (output.status.code(), &found["ok"], &found["errors"]),
        (Some(0), &true.into(), &0.into()),
        "{found}"
    );
    assert!(found["jobs"].as_array().unwrap().contains(&"linkbar".into()));
    assert!(found["records"]["POSE"].as_u64().unwrap() > 0, "{found}");
}

fn data_with(place: &Place, file: &str, from: &str, to: &str) -> String {
    let data = place.data();
    let path = data.join(file);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{file} has no {from:?}");
    fs::write(&path, text.replacen(from, to, 1)).unwrap();
    data.display().to_string()
}

const NEEDS_OBJECT: &str = "sector 2 of UNIT_1 needs an object, which says how the tray is divided";

#[test]
fn job_line_and_explained_command_get_the_same_verdict() {
    let place = Place::new();
    let command = "TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 3 UNIT_1 2";
    let job = place.job("end-at-sector", &format!("** tray UNIT_1 4 LINKBAR1_BH\n== {command}\n"));
    for arguments in [&[job.as_str(), "--log", "none"][..], &["check", "--explain", command]] {
        let output = rcs_run(arguments);
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(NEEDS_OBJECT), "{said}");
    }
}

#[test]
fn tool_command_without_a_path_to_its_end_at_location_is_refused() {
    for verb in ["RELEASE-TOOL", "REMOVE-TOOL"] {
        let refused = rcs_run(&["check", "--explain", &format!("{verb} ENDMILL-1 +1 -- 0 +1 -- 0 HOME 0")]);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains("no trajectory leads from TOOL-TRNS to HOME"), "{said}");
        let safe = rcs_run(&["check", "--explain", &format!("{verb} ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0")]);
        assert!(!String::from_utf8_lossy(&safe.stderr).contains("refuse"), "{verb} to TOOL-SAFE");
    }
}

/// The approach A/D-15 leads down instead of up, so the fingers collide with the floor of the tray.
const DOWN: [&str; 2] = [
    "    1    t    -1500        0      0      -mtb-   A/D-15\n",
    "    1    t      300        0      0      -mtb-   A/D-15\n",
];

#[test]
fn run_refuses_a_job_using_a_wrong_datum() {
    let place = Place::new();
    let data = data_with(&place, "movetables.blk", DOWN[0], DOWN[1]);
    let run = |more: &[&str]| rcs_run(&[&["--log", "none", "--data", &data], more].concat());
    let refused = run(&["linkbar"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("line 23, `== TRANSFER LINKBAR1") && said.contains("A/D-15"), "{said}");
    assert!(last_line(&refused).contains("--unchecked runs it"), "{}", last_line(&refused));
    let unchecked = run(&["linkbar", "--unchecked", "--ticks", "5", "--json"]);
    assert_eq!((unchecked.status.code(), &json(&unchecked)["ticks"]), (Some(0), &5.into()));
    // A job that does not use the wrong datum can run.
    let other = place.job("other", "== MOVE -- 0 -- 0 0 HOME 0 -- 0\n");
    assert_eq!(run(&[&other]).status.code(), Some(0), "{}", last_line(&run(&[&other])));
}

/// Mistyped records of the holster of the v-gripper, in a file, with the missing datum.
const HOLSTER: [(&str, &str, &str, &str); 7] = [
    ("locations.blk", "-pt-  HOLSTER-L ", "...  HOLSTER-L ", "GRIPPER-2 is assigned to no location point"),
    ("locations.blk", "-pt-  HOLSTER-L ", "-pt-  HOLSTER-X ", "GRIPPER-2 is assigned to no location point"),
    (
        "locations.blk",
        "lpt        HOLSTER-L",
        "lpt        HOLSTER-C",
        "no relative move QCA-FAST at HOLSTER-L",
    ),
    (
        "objects/grippers.blk",
        "-o-loc- GRIPPER-2 ",
        "-o-loc- GRIPPER-3 ",
        "GRIPPER-2 is assigned to no location point",
    ),
    (
        "objects/grippers.blk",
        "GRIPPER-2        2     lpt",
        "GRIPPER-3        2     lpt",
        "has no movetable at HOLSTER-L",
    ),
    ("objects/grippers.blk", "GRIPPER-2    2   lpt", "GRIPPER-3    2   lpt", "has no approach at HOLSTER-L"),
    ("guarded.blk", "QCA-BACK own HOLSTER", "QCA-BACK own UNIT   ", "no relative move QCA-BACK at HOLSTER-L"),
];

#[test]
fn run_refuses_a_job_with_a_mistyped_holster() {
    for (file, from, to, missing) in HOLSTER {
        let place = Place::new();
        let data = data_with(&place, file, from, to);
        let run = |job: &str| rcs_run(&[job, "--log", "none", "--ticks", "1", "--data", &data]);
        let refused = run("turned-part");
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{file} {to}: {said}");
        assert!(
            said.contains("line 6, `== TRANSFER SHAFT_BH") && said.contains(missing),
            "{file} {to}: {said}"
        );
        assert!(said.contains("objects/grippers.blk, block 703"), "{file} {to}: {said}");
        // A job that keeps its gripper does not need the holster. An error of a location form concerns all its names.
        if file != "locations.blk" {
            assert_eq!(run("linkbar").status.code(), Some(0), "{file} {to}: {}", last_line(&run("linkbar")));
        }
    }
}

#[test]
fn check_names_the_job_line_without_a_holster() {
    let place = Place::new();
    let entry = "-o-loc- GRIPPER-2         lpt          HOLSTER-L";
    let data = data_with(&place, "objects/grippers.blk", entry, "( no holster )");
    let found = stdout(&rcs_run(&["check", "--all", &data]));
    assert!(
        found.contains("shift.job: line 31, column 1: GET-ENDEFF needs the holster of GRIPPER-2"),
        "{found}"
    );
    assert!(found.contains("turned-part.job line 6"), "{found}");
    assert!(found.contains("add `-o-loc- GRIPPER-2 lpt` with its holster"), "{found}");
}

#[test]
fn run_starts_despite_an_unrelated_wrong_datum() {
    let place = Place::new();
    let data = data_with(&place, "objects/linkbar.blk", "LK-GRP-FX1", "LK-GPR-FX1");
    let run = |job: &str| rcs_run(&[job, "--log", "none", "--ticks", "5", "--data", &data]);
    let clevis = run("clevis");
    let said = String::from_utf8_lossy(&clevis.stderr).into_owned();
    assert_eq!(clevis.status.code(), Some(0), "{said}");
    assert!(said.contains("in the task data; commands that use these data are refused"), "{said}");
    let linkbar = run("linkbar");
    assert_eq!(linkbar.status.code(), Some(2));
    let said = String::from_utf8_lossy(&linkbar.stderr).into_owned();
    assert!(said.contains("no movetable is named LK-GPR-FX1"), "{said}");
}

/// Check that a run reports as many errors and warnings in task data and cell description as `check`.
fn assert_announced(data: &str) {
    let shown = json(&rcs_run(&["check", "--json", data]));
    let count = |severity: &str, extension: &str| {
        let findings = shown["findings"].as_array().unwrap().iter();
        let of = |finding: &&Value| {
            let file = finding["file"].as_str().unwrap_or_default();
            finding["severity"] == severity && file.ends_with(extension)
        };
        findings.filter(of).count()
    };
    let run = ["clevis", "--stand-by", "--clock", "real", "--log", "none", "--ticks", "1", "--data", data];
    let said = String::from_utf8_lossy(&rcs_run(&run).stderr).into_owned();
    let announced = |what: &str, source: &str| {
        let line = said.lines().find_map(|line| {
            let (before, _) = line.split_once(&format!(" in {source}"))?;
            let (count, kind) = before.trim_start_matches("rcs-run: ").split_once(' ')?;
            (kind.trim_end_matches('s') == what).then(|| count.parse::<usize>().unwrap())
        });
        line.unwrap_or(0)
    };
    for (severity, extension, source) in [
        ("error", ".blk", "the task data"),
        ("warning", ".blk", "the task data"),
        ("error", "cell.toml", "the cell description"),
        ("warning", "cell.toml", "the cell description"),
    ] {
        assert_eq!(
            announced(severity, source),
            count(severity, extension),
            "{severity} in {source}:\n{said}"
        );
    }
    assert!(said.contains("rcs-run check shows"), "{said}");
}

/// Changes of copied data, each with a finding that does not prevent `--stand-by`: file, text, replacement.
const TOLERATED: [&[(&str, &str, &str)]; 5] = [
    &[("cell.toml", "name = \"LINKBAR1_BH\"", "name = \"LINKBAR1_BX\"")],
    // The same with an error in the task data, which are then not compared with the cell.
    &[
        ("cell.toml", "name = \"LINKBAR1_BH\"", "name = \"LINKBAR1_BX\""),
        ("directory.blk", "100 load ( files            )", "999 load ( files            )"),
    ],
    // A place of the cell that disagrees with its form.
    &[("cell.toml", "location = \"BRUSH\"", "location = \"BRUSX\"")],
    // The same with an error in the task data.
    &[
        ("cell.toml", "location = \"BRUSH\"", "location = \"BRUSX\""),
        ("directory.blk", "642 load ( brush           )", "999 load ( brush           )"),
    ],
    // A mistyped line that no other line needs.
    &[("directory.blk", "642 load ( brush           )", "999 load ( brush           )")],
];

#[test]
fn run_announces_as_many_findings_as_check() {
    for changes in TOLERATED {
        let place = Place::new();
        let data = place.data();
        for (file, from, to) in changes {
            let path = data.join(file);
            let text = fs::read_to_string(&path).unwrap();
            assert!(text.contains(from), "{file}: {from}");
            fs::write(&path, text.replacen(from, to, 1)).unwrap();
        }
        assert_announced(&data.display().to_string());
    }
}

#[test]
fn count_of_one_is_singular() {
    let page =
        stdout(&rcs_run(&["vise-and-back", "--ticks", "1", "--log", "none", "--shared-memory", "off"]));
    assert!(page.contains("\ncontroller 1 tick;"), "{page}");
    let page =
        stdout(&rcs_run(&["vise-and-back", "--ticks", "2", "--log", "none", "--shared-memory", "off"]));
    assert!(page.contains("\nlink       1 frame, 0 NAKs, 0 retries,"), "{page}");
    assert!(page.contains("\ncontroller 2 ticks;"), "{page}");
}

#[test]
fn findings_are_grouped_by_datum() {
    let place = Place::new();
    let data = data_with(&place, "movetables.blk", DOWN[0], DOWN[1]);
    let found = json(&rcs_run(&["check", "--json", &data]));
    let all = found["findings"].as_array().unwrap().len();
    let groups = found["data"].as_array().unwrap();
    let of_all: u64 = groups.iter().map(|group| group["findings"].as_u64().unwrap()).sum();
    assert_eq!(of_all, all as u64, "each finding is in one group");
    let worst = &groups[0];
    assert_eq!((&worst["datum"], &worst["of"]), (&"A/D-15".into(), &all.into()), "{worst}");
    let count = worst["findings"].as_u64().unwrap();
    assert!(count > 1, "{worst}");
    let short = stdout(&rcs_run(&["check", &data]));
    assert!(short.starts_with(&format!("A/D-15: {count} of {all} findings\nerror: ")), "{short}");
    assert!(short.contains("--all prints them"), "{short}");
    let long = stdout(&rcs_run(&["check", "--all", &data]));
    let errors = |text: &str| text.matches("error: ").count() + text.matches("warning: ").count();
    assert_eq!((errors(&short), errors(&long)), (groups.len(), all));
}

#[test]
fn data_error_has_a_place_and_prevents_the_run() {
    let place = Place::new();
    let data = place.data();
    let poses = data.join("poses.blk");
    let text = fs::read_to_string(&poses).unwrap().replace("PFIX-P", "PFIX-Q");
    fs::write(&poses, text).unwrap();
    for arguments in [&["check"][..], &["--log", "none", "--data"]] {
        let mut arguments = arguments.to_vec();
        let path = data.display().to_string();
        arguments.push(&path);
        let output = rcs_run(&arguments);
        assert_eq!(output.status.code(), Some(2));
        let all = stdout(&output) + &String::from_utf8_lossy(&output.stderr);
        assert!(all.contains("PFIX-P") && all.contains("locations.blk"), "{all}");
        assert!(last_line(&output).contains("cannot be used: "), "{}", last_line(&output));
    }
}

/// The findings of `check` and of a run of the linkbar, for the shipped data with one replaced text.
fn said_of(place: &Place, file: &str, from: &str, to: &str) -> [String; 2] {
    let data = place.data();
    let path = data.join(file);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{file} has no {from:?}");
    fs::write(&path, text.replacen(from, to, 1)).unwrap();
    let data = data.display().to_string();
    [&["check", &data][..], &["--log", "none", "--data", &data]].map(|arguments| {
        let output = rcs_run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", last_line(&output));
        stdout(&output) + &String::from_utf8_lossy(&output.stderr)
    })
}

#[test]
fn name_only_in_the_cell_is_reported_before_the_run() {
    let place = Place::new();
    let unknown = |from: &str, to: &str, sentences: &[&str]| {
        for said in said_of(&place, "cell.toml", from, to) {
            for sentence in sentences {
                assert!(said.contains(sentence), "{sentence}: {said}");
            }
        }
    };
    unknown(
        "location = \"PFIXTURE\"",
        "location = \"PFIXTUR\"",
        &[
            "cell.toml: line 217, column 12: vise.location: expected a location of the task data, found PFIXTUR",
            "the nearest one is PFIXTURE",
            ".job: line 7, column ",
            ": there is no vise at PFIXTURE; the cell description has one at PFIXTUR",
        ],
    );
    unknown("unit = \"UNIT_1\"", "unit = \"UNIT_11\"", &["tray[1].unit: expected", "no unit named UNIT_1;"]);
    unknown(
        "name = \"LINKBAR1_BH\"",
        "name = \"LINKBAR_BH\"",
        &[
            "no part named LINKBAR1_BH; the cell description has LINKBAR_BH, ",
            "the nearest one is LINKBAR_BH",
        ],
    );
}

#[test]
fn name_only_in_the_job_is_reported_before_the_run() {
    let place = Place::new();
    let said = said_of(&place, "jobs/linkbar.job", "vise partial PFIXTURE", "vise partial PFIXTURE CLEVISS");
    for said in said {
        assert!(said.contains("linkbar.job: line 7, column 26: the vise has no program CLEVISS;"), "{said}");
        assert!(said.contains("the nearest one is CLEVIS"), "{said}");
    }
}

#[test]
fn finding_opens_in_an_editor() {
    let place = Place::new();
    let data = place.data();
    let poses = data.join("poses.blk");
    let text = fs::read_to_string(&poses).unwrap().replace("PFIX-P", "PFIX-Q");
    fs::write(&poses, text).unwrap();
    let output = rcs_run(&["check", "--json", &data.display().to_string()]);
    let findings = json(&output)["findings"].as_array().unwrap().clone();
    let finding = findings.iter().find(|f| f["code"] == "name.unknown").unwrap();
    assert_eq!(
        (&finding["file"], &finding["severity"], &finding["nearest"], &finding["expected"]),
        (&"locations.blk".into(), &"error".into(), &"PFIX-Q".into(), &"the name of a pose".into()),
        "{finding}"
    );
    for field in ["offset", "block", "line", "column"] {
        assert!(finding[field].is_u64(), "{field}: {finding}");
    }
    assert_eq!(finding["length"], 6, "{finding}");
}

#[test]
fn explain_shows_a_command_without_a_run() {
    let command = "MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0";
    let output = rcs_run(&["check", "--json", "--explain", command]);
    let found = json(&output);
    assert_eq!((output.status.code(), &found["from"]), (Some(0), &"HOME".into()), "{found}");
    let phases = found["phases"].as_array().unwrap();
    assert!(phases.iter().any(|phase| phase["what"].as_str().unwrap().starts_with("MOV-TO-VU")), "{found}");
    assert!(found["motion_s"].as_f64().is_some_and(|s| s > 5.0), "{found}");
    for (command, names) in [
        ("MOVE LINKBAR1_BH +3 UNIT_1 4 +3 PFIXTURE 0 -- 0", "LINKBAR1_BH has grip +2"),
        ("ACQUIRE LCLEVIS_IH +1 TABLE 0 +0 -- 0 -- 0", "grip +1 of LCLEVIS_IH is for PFIXTURE, PEDESTAL"),
        ("ACQUIRE LCLEVIS_IH +1 UNIT_1 1 +0 -- 0 -- 0", "(-o-loc-, VII.7.3) has LCLEVIS_IH"),
    ] {
        let refused = rcs_run(&["check", "--explain", command]);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(names), "{names}: {said}");
    }
    let refused = rcs_run(&["check", "--explain", command, "--from", "NOWHERE"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(last_line(&refused).contains("--from NOWHERE: no location point"), "{}", last_line(&refused));
    assert_eq!(rcs_run(&["check", "--from", "SAFE"]).status.code(), Some(2), "--from needs --explain");
}

/// `check --where` is `pose --of`: the same text, and the same refusals.
#[test]
fn check_where_equals_pose_of() {
    let (checked, posed) = (rcs_run(&["check", "--where", "PFIX-P"]), rcs_run(&["pose", "--of", "PFIX-P"]));
    assert_eq!((checked.status.code(), stdout(&checked)), (Some(0), stdout(&posed)));
    for word in ["joints  base", "nearest to its limit", "in from", "near    PFIX-P"] {
        assert!(stdout(&checked).contains(word), "{word}: {}", stdout(&checked));
    }
    let unknown = rcs_run(&["check", "--where", "PFIX-Q"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(
        last_line(&unknown).contains("no pose is named PFIX-Q: the nearest is PFIX-P"),
        "{}",
        last_line(&unknown)
    );
}

#[test]
fn all_tables_are_printed_as_markdown() {
    let output = rcs_run(&["tables"]);
    assert_eq!(output.status.code(), Some(0));
    let text = stdout(&output);
    for process in levels::ladder::Ladder::processes() {
        assert!(text.contains(&format!("\n## {}\n", process.name)));
        for table in process.tables {
            assert!(text.contains(&format!(". {}\n", table.name)), "{}", table.name);
        }
    }
}

#[test]
fn few_ticks_repeat_bit_for_bit() {
    let arguments = ["--ticks", "50", "--json", "--log", "none", "--shared-memory", "off"];
    let (one, other) = (json(&rcs_run(&arguments)), json(&rcs_run(&arguments)));
    assert_eq!((&one["ticks"], &one["simulated_s"]), (&50.into(), &2.0.into()));
    assert_eq!(one["digest"], other["digest"]);
    assert_eq!(one["allocations_after_start"], 0);
    assert_eq!(one["overruns"], 0);
    assert_eq!(one["commands"][0]["text"], "PAUSE");
    assert!(one["failure"].is_null() && one["log"].is_null());
    let shared = json(&rcs_run(&["--ticks", "50", "--json", "--log", "none", "--shared-memory", "on"]));
    assert_eq!(shared["digest"], one["digest"], "a reader changes nothing");
}

#[test]
fn real_time_run_has_one_tick_per_slot() {
    let output = rcs_run(&["--clock", "real", "--ticks", "10", "--json", "--log", "none"]);
    let result = json(&output);
    let slots = result["ticks"].as_u64().unwrap() + result["overruns"].as_u64().unwrap();
    let elapsed = result["wall_s"].as_f64().unwrap();
    // The clock starts slightly later than the reported time.
    assert!(slots as f64 * 0.040 <= elapsed + 0.040, "{result}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("real time: "));
    let fast = json(&rcs_run(&["--ticks", "10", "--json", "--log", "none"]));
    assert_eq!(result["digest"], fast["digest"], "the clock changes no bit");
}

#[test]
fn missing_blank_fails_the_job_with_the_detecting_row() {
    let place = Place::new();
    let job = place
        .job("no-blank", "** vise partial PFIXTURE\n== MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0\n");
    let output = rcs_run(&[&job, "--json", "--log", "none"]);
    assert_eq!(output.status.code(), Some(1), "{}", last_line(&output));
    let result = json(&output);
    let failure = &result["failure"];
    assert!(failure["row"].as_u64().is_some_and(|row| row > 0), "{failure}");
    assert!(failure["table"].is_string() && failure["process"].is_string(), "{failure}");
    assert!(failure["text"].as_str().unwrap().contains("vision sees no object"), "{failure}");
    assert!(last_line(&output).ends_with(failure["text"].as_str().unwrap()), "{}", last_line(&output));
    assert_eq!(result["commands"].as_array().unwrap().last().unwrap()["status"], "error");
}

#[test]
fn occupied_place_fails_the_job_with_a_message() {
    let place = Place::new();
    let twice = "** tray UNIT_1 4 LINKBAR1_BH 0 0 0\n";
    let job = place.job("taken", &format!("{twice}{twice}== PAUSE -- 0 -- 0 0 -- 0 -- 0\n"));
    let output = rcs_run(&[&job, "--json", "--log", "none"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(json(&output)["failure"]["process"], "HWSC");
    assert!(last_line(&output).contains("in the way"), "{}", last_line(&output));
}

#[test]
fn interrupt_ends_the_run_in_order() {
    let place = Place::new();
    let log = place.0.path().join("cut.mcap").display().to_string();
    let mut child = command(&["--clock", "real", "--json", "--log", &log])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    wait_for(|| executive_runs(child.id()) == 1);
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let mut output = Output { status: child.wait().unwrap(), stdout: Vec::new(), stderr: Vec::new() };
    std::io::Read::read_to_end(&mut child.stdout.take().unwrap(), &mut output.stdout).unwrap();
    std::io::Read::read_to_end(&mut child.stderr.take().unwrap(), &mut output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(last_line(&output).contains("was stopped by the user"), "{}", last_line(&output));
    assert_eq!(json(&output)["ending"], "stopped");
    assert!(fs::metadata(&log).unwrap().len() > 0);
    assert_eq!(executive_runs(child.id()), 0, "shared memory is empty");
}

#[test]
fn observing_program_leaves_the_digest_unchanged() {
    let child = command(&["--clock", "real", "--ticks", "40", "--json", "--log", "none"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let name: RunName = format!("linkbar-{}", child.id()).parse().unwrap();
    let mut reader = None;
    wait_for(|| {
        reader = Attached::open(&name).ok();
        reader.is_some()
    });
    let reader = reader.unwrap();
    let mut seen = std::collections::BTreeSet::new();
    wait_for(|| {
        if let Ok(memory) = reader.memory() {
            seen.insert(memory.task.header.stamp);
        }
        reader.pulse().is_ok_and(|pulse| pulse.over)
    });
    assert!(seen.len() > 2, "{seen:?}");
    assert_eq!(reader.memory().unwrap().task.header.stamp.0, 40);
    assert_eq!(reader.pulse().unwrap().allocations, 0);
    let watched = json(&child.wait_with_output().unwrap());
    drop(reader);
    assert_eq!(executive_runs_named(name.as_str()), 0, "the last one out removes everything");
    let alone = json(&rcs_run(&["--ticks", "40", "--json", "--log", "none", "--shared-memory", "off"]));
    assert_eq!(watched["digest"], alone["digest"]);
}

#[test]
fn clean_removes_the_remains_of_a_killed_run() {
    let mut child = command(&["--clock", "real", "--log", "none"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    wait_for(|| executive_runs(child.id()) == 1);
    let alive = rcs_run(&["clean"]);
    assert!(stdout(&alive).contains(&format!("linkbar-{} is running", child.id())), "{}", stdout(&alive));
    child.kill().unwrap();
    child.wait().unwrap();
    // Another test may have cleaned up already. This test requires only that nothing remains.
    let cleaned = rcs_run(&["clean"]);
    assert_eq!(cleaned.status.code(), Some(0));
    assert_eq!(executive_runs(child.id()), 0);
    let name: RunName = format!("linkbar-{}", child.id()).parse().expect("it is a name");
    assert_eq!(executive::memory::traces(&name).len(), 0);
}

/// Traces in shared memory of the linkbar run of a process.
fn executive_runs(process: u32) -> usize {
    executive_runs_named(&format!("linkbar-{process}"))
}

fn executive_runs_named(name: &str) -> usize {
    let start = format!("{name}@");
    let runs = fs::read_dir(executive::memory::root()).into_iter().flatten().flatten();
    runs.filter(|entry| entry.file_name().to_string_lossy().starts_with(&start)).count()
}

fn wait_for(mut condition: impl FnMut() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(started.elapsed() < Duration::from_secs(60), "it did not happen within a minute");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The arm can execute all jobs from its shipped place, but not from a place nearer to the parts.
#[test]
fn reach_check_covers_every_pose_and_motion() {
    let check = |robot: &str| {
        let output = rcs_run(&["check", "--json", "--robot", robot]);
        let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        (output.status.code(), result["reach"].clone())
    };
    let (status, reach) = check("irb6700");
    assert_eq!(status, Some(0), "{reach}");
    assert!(
        reach["poses"].as_u64() > Some(30) && reach["jobs"].as_array().is_some_and(|jobs| jobs.len() >= 5)
    );
    for job in reach["jobs"].as_array().expect("jobs") {
        assert!(job["ways"].as_u64() > Some(15) && job["margin_deg"].as_f64() > Some(1.0), "{job}");
    }
    let text = fs::read_to_string(data().join("robots/irb6700.toml")).unwrap();
    let nearer = text.replace("[0.0, -800.0, 1200.0]", "[0.0, 0.0, 780.0]");
    assert_ne!(nearer, text);
    let place = Place::new();
    let file = place.0.path().join("nearer.toml");
    fs::write(&file, nearer).unwrap();
    let (status, reach) = check(&file.display().to_string());
    assert_eq!(status, Some(2));
    let trouble =
        |job: &Value| job["trouble"]["why"].as_str().is_some_and(|why| why.contains("beyond its limit"));
    assert!(reach["jobs"].as_array().is_some_and(|jobs| jobs.iter().any(trouble)), "{reach}");

    let output = rcs_run(&["check", "--robot", "same"]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && text.contains("has no [arm]"), "{text}");
}
