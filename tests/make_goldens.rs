//! Makes the golden runs again: all of `tests/goldens/scenarios.toml`, or those that are named.
//!
//! `cargo run --release -p whole-system-tests --bin goldens [NAME...]`
//!
//! A run that ends in another way than its scenario says is reported, its files are left, and the exit status is 1.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
    time::Instant,
};

use whole_system_tests::{
    golden::{Scenario, directory, scenarios},
    rcs_run,
};

fn main() -> ExitCode {
    let all = scenarios();
    let names: Vec<String> = env::args().skip(1).collect();
    if let Some(unknown) = names.iter().find(|name| !all.iter().any(|scenario| scenario.name == **name)) {
        let known: Vec<&str> = all.iter().map(|scenario| scenario.name.as_str()).collect();
        eprintln!("goldens: there is no scenario {unknown}; there are {}", known.join(", "));
        return ExitCode::from(2);
    }
    println!("runs of {}", rcs_run().display());
    let started = Instant::now();
    let wanted: Vec<&Scenario> = all.iter().filter(|s| names.is_empty() || names.contains(&s.name)).collect();
    let failed = make(&wanted);
    for path in strays(&all) {
        match fs::remove_file(&path) {
            Ok(()) => println!("removed {}: no scenario has this name", path.display()),
            Err(error) => eprintln!("{}: {error}", path.display()),
        }
    }
    let seconds = started.elapsed().as_secs_f64();
    println!("{} goldens made, {failed} failed, in {seconds:.0} s", wanted.len() - failed);
    ExitCode::from(u8::from(failed > 0))
}

/// Make goldens on all processors; gives the number of those that could not be made.
fn make(wanted: &[&Scenario]) -> usize {
    let (next, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || {
        while let Some(scenario) = wanted.get(next.fetch_add(1, Ordering::Relaxed)) {
            match scenario.make() {
                Ok((last_words, played)) => {
                    let size = fs::metadata(scenario.golden()).map_or(0, |file| file.len());
                    let name = &scenario.name;
                    println!("{name:<24} {:>6} ticks {size:>8} bytes  {last_words}", played.ticks);
                }
                Err(error) => {
                    failed.fetch_add(1, Ordering::Relaxed);
                    eprintln!("{}: {error}", scenario.name);
                }
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    failed.into_inner()
}

/// Files of scenarios that are no more.
fn strays(all: &[Scenario]) -> Vec<PathBuf> {
    let known: Vec<PathBuf> = all.iter().flat_map(|s| [s.golden(), s.text()]).collect();
    let entries = fs::read_dir(directory()).into_iter().flatten().flatten().map(|entry| entry.path());
    let ours = |path: &Path| path.extension().is_some_and(|e| e == "golden" || e == "txt");
    entries.filter(|path| ours(path) && !known.contains(path)).collect()
}
