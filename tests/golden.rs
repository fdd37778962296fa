//! Golden runs: recorded behaviour of the controller in small files, so that a change shows all its effects.
//!
//! `goldens/scenarios.toml` lists the runs: job, seed, faults, expected end. The program `goldens` makes them and
//! writes `NAME.golden` with the inputs and the digests of the outputs, and `NAME.txt` for readers. The test `goldens`
//! replays the inputs and compares both. Changed records need new goldens. First [`crate::trace`] and
//! [`crate::compare`] show that the new version behaves like the old one.

use std::{
    fs, io,
    path::{Path, PathBuf},
    process::Command,
};

use rcs_core::tick::Tick;
use record::{
    Log,
    golden::{self, Golden, GoldenError, Played},
};
use serde::Deserialize;

use crate::{
    Scratch,
    compare::{CompareError, Comparison, Renames, compare},
    rcs_run, root, trace,
};

pub const COMMAND: &str = "cargo run --release -p whole-system-tests --bin goldens"; // makes all goldens again

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    pub name: String,
    pub about: String, // purpose, in one sentence
    pub job: String,
    #[serde(default = "one")]
    pub seed: u64,
    pub faults: Option<String>, // a plan of the data's directory `faults`
    #[serde(default)]
    pub status: i32,
    #[serde(default)]
    pub says: String, // text of the last words; empty if the job finishes
    #[serde(default)]
    pub change: Vec<Change>, // in order
    #[serde(default)]
    pub file: Vec<NewFile>, // added to the data directory
}

const fn one() -> u64 {
    1
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    pub file: String,
    pub from: String,
    pub to: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NewFile {
    pub name: String, // from the data directory
    pub text: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Scenarios {
    golden: Vec<Scenario>,
}

#[derive(Debug, thiserror::Error)]
pub enum Failed {
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("{file} does not say {from:?}, which was to be changed")]
    Change { file: String, from: String },
    #[error("rcs-run cannot be started: {0}")]
    Start(io::Error),
    #[error("exit status {expected} and {says:?} were expected, {} came with {last_words:?}", status(.found))]
    Ending { expected: i32, says: String, found: Option<i32>, last_words: String },
    #[error(transparent)]
    Log(#[from] record::ReadError),
    #[error(transparent)]
    Golden(#[from] GoldenError),
    #[error("the replay differs from the run that it was made of, from tick {0} to {1}")]
    Difference(u64, u64),
    #[error("the run has no log that can be read: {source}; its last line is {last_line:?}")]
    NoLog { source: record::ReadError, last_line: String },
    #[error("ticks are missing in the log before tick {0}")]
    Gap(Tick),
    #[error(transparent)]
    Compare(#[from] CompareError),
}

fn status(found: &Option<i32>) -> String {
    found.map_or("a signal".to_owned(), |status| format!("{status}"))
}

#[must_use]
pub fn directory() -> PathBuf {
    root().join("tests/goldens")
}

#[must_use]
pub fn scenarios() -> Vec<Scenario> {
    let path = directory().join("scenarios.toml");
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let list: Scenarios = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    for (i, scenario) in list.golden.iter().enumerate() {
        let twice = list.golden.iter().skip(i + 1).any(|other| other.name == scenario.name);
        assert!(!twice, "{}: two goldens are named {}", path.display(), scenario.name);
    }
    list.golden
}

impl Scenario {
    #[must_use]
    pub fn golden(&self) -> PathBuf {
        directory().join(&self.name).with_added_extension(golden::EXTENSION)
    }

    #[must_use]
    pub fn text(&self) -> PathBuf {
        directory().join(&self.name).with_added_extension("txt")
    }

    /// Runs without writing the golden. Fails with [`Failed`], for example if the run does not end as expected.
    pub fn make(&self) -> Result<Made, Failed> {
        self.made_of(&self.run()?)
    }

    /// Runs and writes the trace. An unexpected end is part of the trace, not an error.
    pub fn trace(&self, directory: &Path) -> Result<(Ending, u64), Failed> {
        let run = self.run()?;
        let ticks = trace::write(&run.log()?, &run.ending, &trace::path(directory, &self.name))?;
        Ok((run.ending, ticks))
    }

    /// Compares a run with its trace, and makes the golden with `make` if nothing differs.
    pub fn against(
        &self,
        directory: &Path,
        renames: &Renames,
        make: bool,
    ) -> Result<(Comparison, Option<Made>), Failed> {
        let old = trace::path(directory, &self.name);
        let open =
            |path: &Path| trace::open(path).map_err(|source| Failed::File { path: path.to_owned(), source });
        let was = open(&old)?;
        let run = self.run()?;
        let new = run.scratch.file("run.trace");
        trace::write(&run.log()?, &run.ending, &new)?;
        let found = compare(was, open(&new)?, renames)?;
        let made = if make && found.differences.is_empty() { Some(self.made_of(&run)?) } else { None };
        Ok((found, made))
    }

    fn made_of(&self, run: &Run) -> Result<Made, Failed> {
        let Ending { status, last_line } = &run.ending;
        if *status != Some(self.status) || !last_line.contains(&self.says) {
            let (expected, found) = (self.status, *status);
            let (says, last_words) = (self.says.clone(), last_line.clone());
            return Err(Failed::Ending { expected, says, found, last_words });
        }
        let golden = golden::from_log(&run.log()?)?;
        let played = golden::replay(&golden)?;
        if let Some((first, last)) = played.difference {
            return Err(Failed::Difference(first, last));
        }
        let text = format!("{}{}", self.heading(last_line), played.summary);
        let last_line = last_line.clone();
        Ok(Made { files: (self.golden(), self.text()), golden, text, last_line, played })
    }

    fn run(&self) -> Result<Run, Failed> {
        let scratch = Scratch::new(&format!("golden-{}", self.name));
        scratch.copy_data();
        for Change { file, from, to } in &self.change {
            let path = scratch.file("data").join(file);
            let text =
                fs::read_to_string(&path).map_err(|source| Failed::File { path: path.clone(), source })?;
            if !text.contains(from) {
                return Err(Failed::Change { file: file.clone(), from: from.clone() });
            }
            write(&path, &text.replacen(from, to, 1))?;
        }
        for new in &self.file {
            write(&scratch.file("data").join(&new.name), &new.text)?;
        }
        let mut command = Command::new(rcs_run()); // the directory has no effect: equal runs make equal goldens
        command.args([
            "run",
            self.job.as_str(),
            "--json",
            "--log",
            "run.mcap",
            "--shared-memory",
            "off",
            "--seed",
        ]);
        command.arg(self.seed.to_string()).current_dir(scratch.file(""));
        if let Some(plan) = &self.faults {
            command.arg("--faults").arg(Path::new("data/faults").join(plan));
        }
        let output = command.output().map_err(Failed::Start)?;
        let said = String::from_utf8_lossy(&output.stderr);
        let last_line = said.lines().last().unwrap_or_default().to_owned();
        Ok(Run { ending: Ending { status: output.status.code(), last_line }, scratch })
    }

    #[must_use]
    pub fn heading(&self, last_words: &str) -> String {
        // The last words of a finished job are only remarks on the data.
        let said =
            if self.status == 0 || last_words.is_empty() { String::new() } else { format!(": {last_words}") };
        format!("# {}\n# exit status {}{said}\n\n", self.about, self.status)
    }
}

struct Run {
    ending: Ending,
    scratch: Scratch,
}

impl Run {
    fn log(&self) -> Result<Log, Failed> {
        let last_line = self.ending.last_line.clone();
        Log::open(&self.scratch.file("run.mcap")).map_err(|source| Failed::NoLog { source, last_line })
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ending {
    pub status: Option<i32>, // `None` after a signal
    pub last_line: String,
}

pub struct Made {
    files: (PathBuf, PathBuf),
    golden: Golden,
    text: String,
    pub last_line: String, // of the run on standard error
    pub played: Played,
}

impl Made {
    pub fn write(&self) -> Result<(), Failed> {
        let (golden, text) = &self.files;
        golden::write(&self.golden, golden)?;
        write(text, &self.text)
    }
}

fn write(path: &Path, text: &str) -> Result<(), Failed> {
    fs::write(path, text).map_err(|source| Failed::File { path: path.to_owned(), source })
}
