//! Makes the golden runs again: all of `tests/goldens/scenarios.toml`, or those that are named.
//!
//! `cargo run --release -p whole-system-tests --bin goldens [NAME...]`
//!
//! A run that ends in another way than its scenario says is reported, its files are left, and the exit status
//! is 1.
//!
//! A change that gives records another layout, or tables and rows other numbers, changes the digests of all
//! goldens. Traces show what the controller does:
//!
//! ```text
//! goldens --trace DIR                              write DIR/NAME.trace
//! ```

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
    golden::{Failed, Made, Scenario, directory, scenarios},
    rcs_run, trace,
};

/// Make the golden runs again, or write what they do as text
#[derive(Parser)]
struct Arguments {
    /// Write a trace of each run to DIR, and leave the goldens as they are
    #[arg(long, value_name = "DIR")]
    trace: Option<PathBuf>,
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
        _ => make_all(&wanted, &all),
    }
}

fn unusable(error: &str) -> ExitCode {
    eprintln!("goldens: {error}");
    ExitCode::from(2)
}

/// Do something with all scenarios, on all processors; gives the results in their order. An error is printed.
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

/// Remove the files of scenarios that are no more.
fn remove_strays(all: &[Scenario]) {
    for path in strays(all) {
        match fs::remove_file(&path) {
            Ok(()) => println!("removed {}: no scenario has this name", path.display()),
            Err(error) => eprintln!("{}: {error}", path.display()),
        }
    }
}

/// Files of scenarios that are no more.
fn strays(all: &[Scenario]) -> Vec<PathBuf> {
    let known: Vec<PathBuf> = all.iter().flat_map(|s| [s.golden(), s.text()]).collect();
    let entries = fs::read_dir(directory()).into_iter().flatten().flatten().map(|entry| entry.path());
    let ours = |path: &Path| path.extension().is_some_and(|e| e == "golden" || e == "txt");
    entries.filter(|path| ours(path) && !known.contains(path)).collect()
}
