//! Changes rows of the decision tables of `crates/levels`, and counts the changes that its tests detect.
//! `cargo-mutants` ignores `decision_table!`.
//!
//! ```text
//! cargo run --release -p whole-system-tests --bin row-mutants -- --help
//! cargo run --release -p whole-system-tests --bin row-mutants -- --number 60
//! cargo run --release -p whole-system-tests --bin row-mutants -- --own --only levels/src/grip
//! ```
//!
//! The order of the changes of [`mutate`] depends on the seed. A change that does not compile is counted separately:
//! the table is not total, has a dead row, or names do not match. A change that compiles is *killed* if a test fails or
//! does not end. Otherwise it has *survived*, and is printed as a difference. All changes are compiled at once
//! ([`switch`]) in a copy, `target/row-mutants/source`. Each test is run once to find the changes that it can detect.
//! Then these tests are run with each change, the quickest first, with fewer random cases, until one fails.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program of the developers, at a terminal")]

mod mutate;
mod switch;
mod testing;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs, io,
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::Instant,
};

use clap::Parser;
use mutate::Mutant;
use serde_json::Value;
use switch::Switched;
use testing::{Program, Test};
use whole_system_tests::root;

/// Change rows of decision tables one at a time, and count which changes the tests of `levels` notice
#[derive(Parser)]
struct Arguments {
    /// Changed rows that compile to try
    #[arg(long, value_name = "N", default_value_t = 60)]
    number: usize,
    /// Seed of the order in which changes are drawn
    #[arg(long, value_name = "N", default_value_t = 1988)]
    seed: u64,
    /// Only tables in files whose path contains TEXT
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    /// Only this row, as `"QC-LOCK 3"`; may be repeated
    #[arg(long, value_name = "TABLE ROW")]
    row: Vec<String>,
    /// Run only the tests of the process whose table is changed: survivors may be killed by others
    #[arg(long)]
    own: bool,
}

struct Copied {
    root: PathBuf,
    source: PathBuf,
    target: PathBuf,
}

impl Copied {
    fn new(root: &Path) -> Self {
        let scratch = root.join("target/row-mutants");
        Self { root: root.to_owned(), source: scratch.join("source"), target: scratch.join("target") }
    }

    /// Copies the tracked files that differ, so that builds remain valid. Removes old sources.
    fn write(&self, switched: &Switched) -> io::Result<()> {
        let mut earlier = Vec::new();
        if self.source.is_dir() {
            whole_system_tests::tables::files(&self.source, "rs", &mut earlier)?;
        }
        for path in earlier {
            let name = path.strip_prefix(&self.source).unwrap_or(&path);
            if !self.root.join(name).exists() {
                fs::remove_file(&path)?;
            }
        }
        let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(&self.root).output()?;
        for name in listed.stdout.split(|byte| *byte == 0).filter(|name| !name.is_empty()) {
            let name = String::from_utf8_lossy(name).into_owned();
            let (from, to) = (self.root.join(&name), self.source.join(&name));
            let content = match switched.texts.get(Path::new(&name)) {
                Some(text) => text.clone().into_bytes(),
                // A file tracked by git may have been deleted.
                None => match fs::read(from) {
                    Ok(content) => content,
                    Err(_) => continue,
                },
            };
            if fs::read(&to).ok().as_ref() != Some(&content) {
                fs::create_dir_all(to.parent().unwrap_or(&to))?;
                fs::write(to, content)?;
            }
        }
        Ok(())
    }

    fn cargo(&self, arguments: &[&str]) -> io::Result<(Vec<Value>, Option<String>)> {
        let mut command = Command::new("cargo");
        command.args(arguments).args(["--quiet", "--package", "levels", "--message-format=json"]);
        for package in ["levels", "geometry", "rcs-core", "depc", "interfaces"] {
            let profile = format!("profile.dev.package.{package}");
            command.args(["--config", &format!("{profile}.opt-level=1")]);
            command.args(["--config", &format!("{profile}.debug=false")]);
        }
        command.current_dir(&self.source).env("CARGO_TARGET_DIR", &self.target).env("CARGO_INCREMENTAL", "1");
        let output = command.stdin(Stdio::null()).output()?;
        let lines = String::from_utf8_lossy(&output.stdout).into_owned();
        let failed = !output.status.success();
        Ok((
            lines.lines().filter_map(|line| serde_json::from_str(line).ok()).collect(),
            failed.then(|| String::from_utf8_lossy(&output.stderr).into_owned()),
        ))
    }

    /// The first `number` changes that compile, and the number of those before them that did not.
    fn compile(&self, mutants: &[Mutant], number: usize) -> Result<(BTreeMap<usize, Mutant>, usize), String> {
        let said = |error: io::Error| error.to_string();
        let mut refused = BTreeSet::new();
        let mut drawn = 0;
        loop {
            drawn = (drawn + 2 * number).min(mutants.len()); // about two thirds compile
            loop {
                let tried = mutants.iter().zip(1..).take(drawn).map(|(mutant, number)| (number, mutant));
                let tried: BTreeMap<_, _> = tried.filter(|(number, _)| !refused.contains(number)).collect();
                let switched = Switched::new(&self.root, &tried).map_err(said)?;
                self.write(&switched).map_err(said)?;
                let (messages, failed) = self.cargo(&["check", "--lib"]).map_err(said)?;
                let Some(text) = failed else { break };
                let errors: Vec<_> = messages.iter().filter(|it| it["message"]["level"] == "error").collect();
                let wrong: BTreeSet<_> = errors.iter().filter_map(|it| place(it, &switched)).collect();
                if wrong.is_empty() {
                    let texts = errors.iter().filter_map(|it| it["message"]["rendered"].as_str());
                    return Err(format!("levels does not build:\n{text}{}", texts.collect::<String>()));
                }
                refused.extend(wrong);
            }
            if drawn - refused.len() >= number || drawn == mutants.len() {
                break;
            }
        }
        let compiled = mutants.iter().cloned().zip(1..).take(drawn).map(|(mutant, number)| (number, mutant));
        let compiled: BTreeMap<_, _> =
            compiled.filter(|(number, _)| !refused.contains(number)).take(number).collect();
        let last = compiled.keys().next_back().copied().unwrap_or(drawn);
        let switched = Switched::new(&self.root, &compiled.iter().map(|(at, it)| (*at, it)).collect());
        self.write(&switched.map_err(said)?).map_err(said)?;
        Ok((compiled, refused.range(..last).count()))
    }

    fn tests(&self, own: bool) -> Result<Vec<Program>, String> {
        let arguments: &[&str] = if own { &["--lib"] } else { &["--lib", "--tests"] };
        let (messages, failed) =
            self.cargo(&[&["test", "--no-run"], arguments].concat()).map_err(|error| error.to_string())?;
        if let Some(text) = failed {
            return Err(format!("the tests of levels do not build:\n{text}"));
        }
        let programs = messages.iter().filter_map(|message| {
            let is_library = message["target"]["kind"][0] == "lib";
            message["executable"].as_str().map(|path| (!is_library, PathBuf::from(path)))
        });
        let mut programs: Vec<_> = programs.collect();
        programs.sort();
        let directory = self.source.join("crates/levels");
        Ok(programs.into_iter().map(|(_, path)| Program { path, directory: directory.clone() }).collect())
    }
}

fn place(error: &Value, switched: &Switched) -> Option<usize> {
    let spans = error["message"]["spans"].as_array()?;
    let primary = spans.iter().filter(|span| span["is_primary"] == true);
    let mut changes = primary.filter_map(|span| {
        let line = usize::try_from(span["line_start"].as_u64()?).ok()?;
        switched.change_at(Path::new(span["file_name"].as_str()?), line)
    });
    changes.next()
}

fn on_all_cores<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> io::Result<R> + Sync,
) -> io::Result<Vec<R>> {
    let (next, results) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let worker = || {
        while let Some((at, item)) = {
            let at = next.fetch_add(1, Ordering::Relaxed);
            items.get(at).map(|item| (at, item))
        } {
            let result = work(item);
            if let Ok(mut results) = results.lock() {
                results.push((at, result));
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(worker);
        }
    });
    let mut results = results.into_inner().map_err(|_| io::Error::other("a worker has panicked"))?;
    results.sort_by_key(|(at, _)| *at);
    results.into_iter().map(|(_, result)| result).collect()
}

fn measured<'a>(
    programs: &'a [Program],
    scratch: &Path,
    own: Option<&BTreeSet<String>>,
) -> io::Result<Vec<Test<'a>>> {
    let mut wanted = Vec::new();
    for program in programs {
        let names = program.tests()?;
        let is_wanted =
            |name: &String| own.is_none_or(|own| own.iter().any(|process| name.starts_with(process)));
        wanted.extend(names.into_iter().filter(is_wanted).map(|name| (program, name)));
    }
    let numbered: Vec<_> = wanted.into_iter().zip(0..).collect();
    let mut tests = on_all_cores(&numbered, |((program, name), at)| {
        Test::measure(program, name.clone(), &scratch.join(format!("reached-{at}")))
    })?;
    tests.sort_by_key(|test| test.taken);
    Ok(tests)
}

enum Fate {
    Killed,
    Survived(usize), // tests that reach it
}

fn judge(tests: &[Test<'_>], (number, mutant): &(usize, Mutant), own: bool) -> io::Result<Fate> {
    let process = mutant.process();
    let mut reach = 0;
    for test in tests {
        if test.reaches.contains(number) && (!own || test.name.starts_with(&process)) {
            reach += 1;
            if !test.passes(*number)? {
                println!("killed    {mutant}, by {}", test.name);
                return Ok(Fate::Killed);
            }
        }
    }
    let (before, after) = (mutant.before.trim(), mutant.after.trim());
    let other = mutant.other.iter().map(|(_, after)| format!("\n  + {}", after.trim())).collect::<String>();
    println!("SURVIVED  {mutant}, reached by {reach} tests\n  - {before}\n  + {after}{other}");
    Ok(Fate::Survived(reach))
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let said = |error: io::Error| error.to_string();
    let copied = Copied::new(root());
    let mut mutants = mutate::drawn(root(), arguments.seed, &arguments.only).map_err(said)?;
    if mutants.is_empty() {
        return Err(format!("no file with a table has {:?} in its path", arguments.only));
    }
    if let Some(unknown) = arguments.row.iter().find(|row| !mutants.iter().any(|mutant| mutant.is_of(row))) {
        return Err(format!(
            "expected a table and the number of a row, such as \"QC-LOCK 3\", found {unknown:?}"
        ));
    }
    mutants.retain(|mutant| arguments.row.is_empty() || arguments.row.iter().any(|row| mutant.is_of(row)));
    eprintln!("{} changes of rows are known", mutants.len());
    let began = Instant::now();
    let (compiled, refused) = copied.compile(&mutants, arguments.number)?;
    let programs = copied.tests(arguments.own)?;
    let built = began.elapsed().as_secs();
    eprintln!("{} of them are built in {built} s, {refused} more do not compile", compiled.len());

    let began = Instant::now();
    let own: BTreeSet<String> = compiled.values().map(Mutant::process).collect();
    let tests = measured(&programs, &copied.target, arguments.own.then_some(&own)).map_err(said)?;
    let without = began.elapsed().as_secs();
    eprintln!("{} tests pass without a change in {without} s", tests.len());

    let began = Instant::now();
    let compiled: Vec<(usize, Mutant)> = compiled.into_iter().collect();
    let fates = on_all_cores(&compiled, |change| judge(&tests, change, arguments.own)).map_err(said)?;
    let killed = fates.iter().filter(|fate| matches!(fate, Fate::Killed)).count();
    let unreached = fates.iter().filter(|fate| matches!(fate, Fate::Survived(0))).count();
    println!(
        "{built} s to build, {without} s without a change, {} s with, seed {}: {} changed rows compile, {killed} \
         killed, {} survived, of which no test reaches {unreached}; the compiler refused {refused} more",
        began.elapsed().as_secs(),
        arguments.seed,
        fates.len(),
        fates.len() - killed,
    );
    Ok(())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
