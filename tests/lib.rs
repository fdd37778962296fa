//! Runs the released programs like their users, and reads exit status, JSON, last line on standard error, and log. The
//! tests of this package check the whole system.

pub mod bench;
pub mod compare;
pub mod golden;
pub mod tables;
pub mod trace;

use std::{
    env, fs,
    os::unix::process::CommandExt as _,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::OnceLock,
};

use serde_json::Value;
use tempfile::TempDir;

#[must_use]
pub fn root() -> &'static Path {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap_or(tests)
}

/// The program `rcs-run`, rebuilt first, so that a test never tests an older one.
#[must_use]
pub fn rcs_run() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program("rcs-run", &PROGRAM)
}

#[must_use]
pub fn rcs_log() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program("rcs-log", &PROGRAM)
}

#[must_use]
pub fn rcs_neighbour() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program("rcs-neighbour", &PROGRAM)
}

#[must_use]
pub fn rcs_console() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program("rcs-console", &PROGRAM)
}

#[must_use]
pub fn rcs_cell() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    program("rcs-cell", &PROGRAM)
}

fn program(name: &str, built: &'static OnceLock<PathBuf>) -> &'static Path {
    built.get_or_init(|| {
        // Tests are in <target>/release/deps, programs in <target>/release.
        let own = env::current_exe().expect("a program has a path");
        let directory = own.parent().expect("a program lies in a directory");
        let profile = if directory.ends_with("deps") { directory.parent() } else { Some(directory) };
        let profile = profile.expect("a test lies two directories deep");
        let target = profile.parent().expect("a profile lies in the target directory");
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut build = Command::new(cargo);
        // In the workspace a program has the features of the tests, and most of it is already built.
        build
            .args(["build", "--quiet", "--release", "--workspace", "--bin", name, "--target-dir"])
            .arg(target);
        // Cargo's variables about the package of a test would rebuild crates that read them, and all their dependents.
        let told = env::vars_os().map(|(variable, _)| variable).filter(|variable| {
            let variable = variable.to_string_lossy();
            ["CARGO_PKG_", "CARGO_MANIFEST_", "CARGO_CRATE_"].iter().any(|front| variable.starts_with(front))
        });
        told.for_each(|variable| {
            build.env_remove(variable);
        });
        let built = build.current_dir(root()).status().expect("cargo can be started");
        assert!(built.success(), "{name} does not build");
        target.join("release").join(name)
    })
}

/// A directory that is removed with the run. Its name need not be unique among parallel tests.
pub struct Scratch(TempDir);

impl Scratch {
    #[must_use]
    pub fn new(name: &str) -> Self {
        let directory = tempfile::Builder::new().prefix(&format!("rcs-{name}-")).tempdir();
        Self(directory.expect("a directory can be made"))
    }

    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

impl Scratch {
    /// Replaces `from` by `to` in a copy of a shipped job.
    pub fn job_with(&self, job: &str, from: &str, to: &str) {
        let text = fs::read_to_string(root().join("data/jobs").join(job)).expect("the job is there");
        assert!(text.contains(from), "{job} has no {from:?}");
        fs::write(self.file(job), text.replacen(from, to, 1)).expect("the job can be written");
    }

    pub fn faults(&self, text: &str) {
        fs::write(self.file(FAULTS), text).expect("the faults can be written");
    }

    /// Sets the faults from a file of the data directory.
    pub fn faults_of(&self, name: &str) {
        let path = root().join("data/faults").join(name).with_extension("toml");
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        self.faults(&text);
    }

    /// Copies the task data, and replaces `from` by `to` in a file.
    pub fn data_with(&self, file: &str, from: &str, to: &str) {
        self.copy_data();
        let path = self.file("data").join(file);
        let text = fs::read_to_string(&path).expect("the file is there");
        assert!(text.contains(from), "{file} has no {from:?}");
        fs::write(path, text.replacen(from, to, 1)).expect("the file can be written");
    }

    /// Lowers the via point over UNIT_1 so that the arm meets the pot of the tray.
    pub fn with_a_low_via_point(&self) {
        self.data_with(
            "poses.blk",
            "   -4040    -1471     3398
   -5450    -1984      800
   -4424    -4803      800   -pose-   ...         UNIT-V1",
            "   -4040    -1471     1098
   -5450    -1984    -1500
   -4424    -4803    -1500   -pose-   ...         UNIT-V1",
        );
    }

    pub fn copy_data(&self) {
        copy(&root().join("data"), &self.file("data"));
    }
}

pub const NOBODY: u32 = 65_534; // a user without files, on every system

/// True if this user may start programs as [`NOBODY`] in a directory.
#[must_use]
pub fn may_become_nobody(directory: &Path) -> bool {
    let mut command = Command::new("true");
    command.uid(NOBODY).gid(NOBODY).current_dir(directory);
    command.status().is_ok_and(|status| status.success())
}

pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a directory can be made");
    for entry in fs::read_dir(from).expect("a directory can be read") {
        let entry = entry.expect("an entry can be read");
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).expect("a file can be copied");
        }
    }
}

pub struct Outcome {
    pub status: Option<i32>,
    pub result: Value,
    pub last_words: String, // on standard error; may be empty
    pub log: PathBuf,
    _scratch: Scratch,
}

impl Outcome {
    #[must_use]
    pub fn digest(&self) -> &str {
        self.result["digest"].as_str().expect("a result has a digest")
    }

    #[must_use]
    pub fn part(&self, name: &str) -> &Value {
        let parts = self.result["parts"].as_array().expect("a result has parts");
        parts.iter().find(|part| part["name"] == name).unwrap_or_else(|| panic!("no {name} among {parts:?}"))
    }
}

const FAULTS: &str = "faults.toml"; // in the directory of a run

/// The arguments are constant, so equal runs write equal logs. Task data in the directory take precedence.
#[must_use]
pub fn command(directory: &Scratch, job: &str, seed: u64) -> Command {
    let own = directory.file("data");
    let data = if own.is_dir() { own } else { root().join("data") };
    let mut command = Command::new(rcs_run());
    command
        .args(["run", job, "--json", "--seed"])
        .arg(seed.to_string())
        .arg("--data")
        .arg(data)
        .current_dir(&directory.0);
    if directory.file(FAULTS).is_file() {
        command.args(["--faults", FAULTS]);
    }
    command
}

fn logged(directory: &Scratch, job: &str, seed: u64) -> Command {
    let mut command = command(directory, job, seed);
    command.args(["--log", "run.mcap", "--shared-memory", "off"]);
    command
}

#[must_use]
pub fn run(job: &str, seed: u64, name: &str, prepare: impl FnOnce(&Scratch)) -> Outcome {
    run_with(job, seed, name, &[], prepare)
}

/// As [`run`], with further arguments.
#[must_use]
pub fn run_with(
    job: &str,
    seed: u64,
    name: &str,
    arguments: &[&str],
    prepare: impl FnOnce(&Scratch),
) -> Outcome {
    let scratch = Scratch::new(name);
    prepare(&scratch);
    let output = logged(&scratch, job, seed).args(arguments).output().expect("rcs-run can be started");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let result = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error} in {:?}; {said}", String::from_utf8_lossy(&output.stdout)));
    Outcome {
        status: output.status.code(),
        result,
        last_words: said.lines().last().unwrap_or_default().to_owned(),
        log: scratch.file("run.mcap"),
        _scratch: scratch,
    }
}

#[must_use]
pub fn start(scratch: &Scratch, job: &str, seed: u64) -> Child {
    logged(scratch, job, seed)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("rcs-run can be started")
}
