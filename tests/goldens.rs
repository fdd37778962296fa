//! The golden runs, replayed: the same bits and the same summaries.

use std::{
    fs,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use record::golden;
use similar::TextDiff;
use whole_system_tests::golden::{COMMAND, Scenario, directory, scenarios};

fn replayed(scenario: &Scenario) -> String {
    let name = &scenario.name;
    let kept = match fs::read_to_string(scenario.text()) {
        Ok(text) => text,
        Err(error) => return format!("{name}: {}: {error}\n", scenario.text().display()),
    };
    let (heading, summary) = kept.split_once("\n\n").unwrap_or_default();
    let begin = scenario.heading("");
    let as_said = heading.starts_with(begin.trim_end()) && heading.contains(&scenario.says);
    let mut found =
        if as_said { String::new() } else { format!("{name}: the scenario is another one now\n") };
    match golden::read(&scenario.golden()).and_then(|golden| golden::replay(&golden)) {
        Ok(played) => {
            if let Some((first, last)) = played.difference {
                found += &format!("{name}: other outputs, first between ticks {first} and {last}\n");
            }
            if played.summary != summary {
                let difference = TextDiff::from_lines(summary, &played.summary);
                found += &format!("{name}:\n{}", difference.unified_diff().context_radius(1));
            }
        }
        Err(error) => found += &format!("{name}: {error}\n"),
    }
    found
}

#[test]
fn every_golden_run_replays_unchanged() {
    let all = scenarios();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut found = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(scenario) = all.get(at) else { return found };
            found.push((at, replayed(scenario)));
        }
    };
    let mut found = thread::scope(|scope| {
        let threads = thread::available_parallelism().map_or(1, usize::from);
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        running
            .into_iter()
            .flat_map(|thread| thread.join().expect("a replay does not panic"))
            .collect::<Vec<_>>()
    });
    found.sort();
    let found: String = found.into_iter().map(|(_, found)| found).collect();
    assert!(found.is_empty(), "{found}\nIf this is what was meant: {COMMAND}, and review the texts\n");
}

#[test]
fn every_golden_has_a_scenario() {
    let known: Vec<_> = scenarios().iter().flat_map(|s| [s.golden(), s.text()]).collect();
    for entry in fs::read_dir(directory()).expect("the directory can be read") {
        let path = entry.expect("an entry can be read").path();
        let ours = path.extension().is_some_and(|e| e == "golden" || e == "txt");
        assert!(!ours || known.contains(&path), "{}: no scenario has this name", path.display());
    }
}
