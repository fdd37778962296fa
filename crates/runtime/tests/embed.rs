//! A run inside another program.

use std::sync::{Arc, Mutex, atomic::Ordering};

use runtime::{Ending, LogTarget, Observer, Run, RunConfig, StartError, TickReport};

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");

fn config(job: &str) -> RunConfig {
    RunConfig { log: LogTarget::None, shared_memory: false, ..RunConfig::new(DATA, job) }
}

#[derive(Clone, Default)]
struct Lines(Arc<Mutex<Vec<String>>>);

impl Observer for Lines {
    fn tick(&mut self, report: &TickReport<'_>) {
        let mut lines = self.0.lock().unwrap();
        let known = lines.len();
        lines.extend(report.steps.iter().skip(known).map(|step| step.text.clone()));
        assert!(lines.len() <= report.lines + 1, "{lines:?}");
    }
}

#[test]
fn linkbar_finishes_and_is_observed() {
    let lines = Lines::default();
    let outcome = Run::new(config("linkbar"), Box::new(lines.clone())).unwrap().complete();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure.map(|failure| failure.account));
    let lines = lines.0.lock().unwrap();
    assert!(lines.iter().any(|line| line.contains("MOVE LINKBAR1_BH")), "{lines:?}");
    let again = Run::new(config("linkbar"), Box::new(())).unwrap().complete();
    assert_eq!(outcome.result.digest, again.result.digest);
}

#[test]
fn run_after_a_hang_up_is_stopped() {
    let mut run = Run::new(config("linkbar"), Box::new(())).unwrap();
    for tick in 1..=100 {
        assert!(run.step());
        assert_eq!(run.last_tick().0, tick);
    }
    let outcome = run.finish();
    assert!(matches!(outcome.ending, Ending::Stopped));
    assert_eq!(outcome.result.ticks, 100);
}

#[test]
fn stop_request_brings_the_robot_to_rest() {
    let config = config("linkbar");
    let stop = Arc::clone(&config.stop);
    let mut run = Run::new(config, Box::new(())).unwrap();
    while run.last_tick().0 < 200 {
        assert!(run.step());
    }
    stop.store(true, Ordering::Relaxed);
    while run.step() {}
    let outcome = run.finish();
    assert!(matches!(outcome.ending, Ending::StoppedByUser), "{}", outcome.ending.text());
    assert!(outcome.result.failure.is_none());
    assert!(outcome.result.ramp_ticks > 0);
}

#[test]
fn impossible_run_is_refused_before_any_motion() {
    let error = Run::new(config("no-such-job"), Box::new(())).err().unwrap();
    assert!(
        matches!(&error, StartError::NoFile(file) if file.known.contains(&"linkbar".to_owned())),
        "{error}"
    );
    let nowhere = RunConfig { data: "/no/such/directory".into(), ..config("linkbar") };
    assert!(matches!(Run::new(nowhere, Box::new(())).err().unwrap(), StartError::NoData(_)));
}
