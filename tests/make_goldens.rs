//! Makes the golden runs again, all or the named ones: `cargo run --release -p whole-system-tests --bin goldens
//! [NAME...]`. A run that does not end as its scenario says is reported, its files remain, and the exit status is 1.
//!
//! New layouts of records, or new numbers of tables and rows, change the digests of all goldens. Traces show that the
//! controller behaves the same:
//!
//! ```text
//! goldens --trace DIR                              in the old version: write DIR/NAME.trace
//! goldens --against DIR --check --renames FILE     in the new version: compare
//! goldens --against DIR --renames FILE             the same, and make the goldens again if nothing differs
//! ```
//!
//! Both comparisons print, as Markdown, the new row that fired in place of each old row. FILE lists the intended
//! changes, see [`Renames`]:
//!
//! ```toml
//! renamed = [{ old = "emove.status.at", new = "emove.status.location" }, { old = "grip.*", new = "jaw.*" }]
//! dropped = [{ path = "prim.status.sensed", reason = "it is not read" }]
//! added = [{ path = "task.status.since", reason = "for the screen" }]
//! value = [{ path = "*.status.reason", old = "", new = "none" }]
//! ```

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program of the developers, at a terminal")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::Instant,
};

use clap::Parser;
use whole_system_tests::{
    compare::{Comparison, Renames, RowMap},
    golden::{Failed, Made, Scenario, directory, scenarios},
    rcs_run, trace,
};

/// Make the golden runs again, or compare them with those of an older version
#[derive(Parser)]
struct Arguments {
    /// Write a trace of each run to DIR, and leave the goldens as they are
    #[arg(long, value_name = "DIR", conflicts_with = "against")]
    trace: Option<PathBuf>,
    /// Compare each run with its trace in DIR, and make the goldens again only if nothing differs
    #[arg(long, value_name = "DIR")]
    against: Option<PathBuf>,
    /// What differs on purpose: a TOML file with `renamed`, `dropped`, `added` and `value`
    #[arg(long, value_name = "FILE", requires = "against")]
    renames: Option<PathBuf>,
    /// Compare only
    #[arg(long, requires = "against")]
    check: bool,
    /// Scenarios; all if none is named
    #[arg(value_name = "NAME")]
    names: Vec<String>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let all = scenarios();
    let names = &arguments.names;
    if let Some(unknown) = names.iter().find(|name| !all.iter().any(|scenario| scenario.name == **name)) {
        let known: Vec<&str> = all.iter().map(|scenario| scenario.name.as_str()).collect();
        return unusable(&format!("there is no scenario {unknown}; there are {}", known.join(", ")));
    }
    let wanted: Vec<&Scenario> = all.iter().filter(|s| names.is_empty() || names.contains(&s.name)).collect();
    match &arguments {
        Arguments { trace: Some(directory), .. } => trace_all(&wanted, directory),
        Arguments { against: Some(directory), renames, check, .. } => match read(renames.as_deref()) {
            Ok(renames) => against(&wanted, &all, directory, &renames, *check),
            Err(error) => unusable(&error),
        },
        _ => make_all(&wanted, &all),
    }
}

fn unusable(error: &str) -> ExitCode {
    eprintln!("goldens: {error}");
    ExitCode::from(2)
}

fn read(renames: Option<&Path>) -> Result<Renames, String> {
    let Some(path) = renames else { return Ok(Renames::default()) };
    let at = |error: &dyn std::error::Error| format!("{}: {error}", path.display());
    let text = fs::read_to_string(path).map_err(|error| at(&error))?;
    Renames::parse(&text).map_err(|error| at(&error))
}

fn each<T: Send>(
    wanted: &[&Scenario],
    work: impl Fn(&Scenario) -> Result<T, Failed> + Sync,
) -> Vec<Option<T>> {
    println!("runs of {}", rcs_run().display());
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let work = || {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(scenario) = wanted.get(at) else { return };
            let result = work(scenario).map_err(|error| eprintln!("{}: {error}", scenario.name)).ok();
            done.lock().expect("no thread panics").push((at, result));
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let mut done = done.into_inner().expect("no thread has panicked");
    done.sort_by_key(|(at, _)| *at);
    done.into_iter().map(|(_, result)| result).collect()
}

fn make_all(wanted: &[&Scenario], all: &[Scenario]) -> ExitCode {
    let started = Instant::now();
    let made = each(wanted, |scenario| scenario.make().and_then(|made| write(scenario, &made)));
    remove_strays(all);
    let made = made.iter().flatten().count();
    let failed = wanted.len() - made;
    println!("{made} goldens made, {failed} failed, in {:.0} s", started.elapsed().as_secs_f64());
    ExitCode::from(u8::from(failed > 0))
}

fn write(scenario: &Scenario, made: &Made) -> Result<(), Failed> {
    made.write()?;
    let size = fs::metadata(scenario.golden()).map_or(0, |file| file.len());
    println!("{:<24} {:>6} ticks {size:>8} bytes  {}", scenario.name, made.played.ticks, made.last_line);
    Ok(())
}

fn trace_all(wanted: &[&Scenario], directory: &Path) -> ExitCode {
    if let Err(error) = fs::create_dir_all(directory) {
        return unusable(&format!("{}: {error}", directory.display()));
    }
    let started = Instant::now();
    let traced = each(wanted, |scenario| {
        let (ending, ticks) = scenario.trace(directory)?;
        let size = fs::metadata(trace::path(directory, &scenario.name)).map_or(0, |file| file.len());
        println!("{:<24} {ticks:>6} ticks {size:>8} bytes  {}", scenario.name, ending.last_line);
        Ok(())
    });
    let traced = traced.iter().flatten().count();
    let failed = wanted.len() - traced;
    println!("{traced} traces written, {failed} failed, in {:.0} s", started.elapsed().as_secs_f64());
    ExitCode::from(u8::from(failed > 0))
}

fn against(
    wanted: &[&Scenario],
    all: &[Scenario],
    directory: &Path,
    renames: &Renames,
    check: bool,
) -> ExitCode {
    if wanted.len() == all.len()
        && let Some(stray) = stray_trace(directory, all)
    {
        return unusable(&format!("{}: there is no scenario of this name any more", stray.display()));
    }
    let started = Instant::now();
    let compared = each(wanted, |scenario| {
        let (found, made) = scenario.against(directory, renames, !check)?;
        println!("{:<24} {:>6} ticks  {}", scenario.name, found.ticks.1, verdict(&found));
        Ok((found, made))
    });
    let found = wanted.iter().zip(&compared).filter_map(|(s, found)| Some((&s.name, &found.as_ref()?.0)));
    let found: Vec<(&String, &Comparison)> = found.collect();
    print_rows(&found, renames, wanted.len() == all.len());
    let different: Vec<_> = found.iter().filter(|(_, found)| !found.differences.is_empty()).collect();
    for (name, found) in &different {
        print!("\n{name}: {}\n{found}", verdict(found));
    }
    let failed = compared.iter().filter(|result| result.is_none()).count();
    let seconds = started.elapsed().as_secs_f64();
    let (compared_well, differ) = (wanted.len() - failed, different.len());
    println!("\n{compared_well} scenarios compared, {differ} differ, {failed} failed, in {seconds:.0} s");
    if differ + failed > 0 {
        return ExitCode::FAILURE;
    }
    if check {
        return ExitCode::SUCCESS;
    }
    let made = wanted.iter().zip(compared.iter().flatten());
    let written = made.filter_map(|(scenario, (_, made))| Some(write(scenario, made.as_ref()?)));
    let failed = written.filter_map(Result::err).inspect(|error| eprintln!("{error}")).count();
    remove_strays(all);
    ExitCode::from(u8::from(failed > 0))
}

fn stray_trace(directory: &Path, all: &[Scenario]) -> Option<PathBuf> {
    let known: Vec<PathBuf> = all.iter().map(|scenario| trace::path(directory, &scenario.name)).collect();
    let entries = fs::read_dir(directory).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_trace = |path: &Path| path.extension().is_some_and(|extension| extension == trace::EXTENSION);
    entries.filter(|path| is_trace(path)).find(|path| !known.contains(path))
}

/// Prints the rows and the entries of the renames, even without a difference.
fn print_rows(found: &[(&String, &Comparison)], renames: &Renames, all: bool) {
    let mut rows = RowMap::default();
    found.iter().for_each(|(name, found)| rows.add(name, found));
    print!("\n{rows}");
    if all {
        println!("\n## Rows of this version that no header named\n");
        println!("A row that did not fire is not compared. A header names one row per tick, so a row may");
        println!("also have fired before another one of its process in the same tick.\n");
        println!("| process | table | rows |\n|---|---|---|");
        for (process, table, numbers) in rows.not_named() {
            let numbers: Vec<String> = numbers.iter().map(u8::to_string).collect();
            println!("| {process} | {table} | {} |", numbers.join(", "));
        }
    }
    let unused = rows.unused(renames);
    if !unused.is_empty() {
        println!("\n## Entries of the renames that no scenario needs\n");
        unused.iter().for_each(|entry| println!("* {entry}"));
    }
}

fn verdict(found: &Comparison) -> String {
    match found.differences.as_slice() {
        [] => "no difference".into(),
        [first, ..] => format!("{} fields differ, first at {}", found.differences.len(), first.first),
    }
}

fn remove_strays(all: &[Scenario]) {
    for path in strays(all) {
        match fs::remove_file(&path) {
            Ok(()) => println!("removed {}: no scenario has this name", path.display()),
            Err(error) => eprintln!("{}: {error}", path.display()),
        }
    }
}

fn strays(all: &[Scenario]) -> Vec<PathBuf> {
    let known: Vec<PathBuf> = all.iter().flat_map(|s| [s.golden(), s.text()]).collect();
    let entries = fs::read_dir(directory()).into_iter().flatten().flatten().map(|entry| entry.path());
    let ours = |path: &Path| path.extension().is_some_and(|e| e == "golden" || e == "txt");
    entries.filter(|path| ours(path) && !known.contains(path)).collect()
}
