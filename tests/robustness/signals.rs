use std::{fs, path::Path, thread, time::Duration};

use record::Log;
use rustix::process::{Pid, Resource, Rlimit, Signal, getrlimit, prlimit};
use whole_system_tests::{
    Scratch,
    bench::{Running, wait_for},
};

use crate::{
    runs::{BOARDS, assert_no_harm, end, judge, start},
    table::{Chance, Extent, Outcome, Row},
};

const SIGNALS: [(&str, Signal, Outcome); 7] = [
    ("SIGTERM", Signal::TERM, Outcome::InOrder),
    ("SIGINT", Signal::INT, Outcome::InOrder),
    ("SIGHUP", Signal::HUP, Outcome::InOrder),
    ("SIGQUIT", Signal::QUIT, Outcome::BySignal),
    ("SIGKILL", Signal::KILL, Outcome::BySignal),
    ("SIGXFSZ", Signal::XFSZ, Outcome::WentOn),
    ("SIGPIPE", Signal::PIPE, Outcome::WentOn),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Start,    // in the first 30 ms, before or after the handlers
    WarmUp,   // once there are buffers to read
    AtRest,   // in the PAUSE at the start of the job
    InMotion, // in the first motion
    End,      // after the last tick: ramp, and end of the log
}

const PHASES: [Phase; 5] = [Phase::Start, Phase::WarmUp, Phase::AtRest, Phase::InMotion, Phase::End];

impl Phase {
    const fn ticks(self) -> &'static str {
        match self {
            Self::Start => "30",
            Self::WarmUp | Self::AtRest => "60",
            Self::InMotion => "125",
            Self::End => "105",
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Start => "at the start",
            Self::WarmUp => "at the first tick",
            Self::AtRest => "at rest",
            Self::InMotion => "in motion",
            Self::End => "at the end",
        }
    }

    fn wait(self, run: &mut Running, chance: &mut Chance) {
        let tick = match self {
            Self::Start => return thread::sleep(Duration::from_millis(chance.below(30))),
            Self::WarmUp => 0,
            Self::AtRest => 30,
            Self::InMotion => 100,
            Self::End => 105,
        };
        let reader = run.attach();
        // On a busy machine the run may end before its last tick is observed.
        wait_for("the phase", || {
            let over = run.child.try_wait().expect("a child").is_some();
            over || reader.pulse().is_ok_and(|pulse| pulse.over || pulse.tick.0 >= tick)
        });
    }
}

/// False if the system forbids a core file or writes it elsewhere.
fn allow_core(run: &Running) -> bool {
    let pattern = fs::read_to_string("/proc/sys/kernel/core_pattern").unwrap_or_default();
    let most = getrlimit(Resource::Core).maximum;
    let limit = Rlimit { current: most, maximum: most };
    let allowed = prlimit(Some(Pid::from_child(&run.child)), Resource::Core, limit).is_ok();
    pattern.starts_with("core") && most != Some(0) && allowed
}

fn core(directory: &Path) -> bool {
    let entries = fs::read_dir(directory).expect("a directory").flatten();
    entries.filter(|entry| entry.file_name().to_string_lossy().starts_with("core")).count() > 0
}

fn attempt(signal: (Signal, Outcome), phase: Phase, boards: &str, chance: &mut Chance) -> Outcome {
    let scratch = Scratch::new("signals");
    let place = scratch.file("");
    let (signal, expected) = signal;
    let mut run = start(&place, boards, phase.ticks(), "run.mcap");
    let name = run.name.clone();
    phase.wait(&mut run, chance);
    let dumps = allow_core(&run);
    run.signal(signal);
    let ended = end(run);
    let outcome = judge(&ended);
    let said = format!("{phase:?}: {outcome:?} {:?}: {}", ended.signal, ended.said);
    let allowed = match phase {
        // The system's default, before the installation of handlers.
        Phase::Start => outcome == expected || outcome == Outcome::BySignal,
        Phase::End => outcome == expected || outcome == Outcome::WentOn, // it may have ended before
        _ => outcome == expected,
    };
    assert!(allowed, "{said}");
    if outcome == Outcome::BySignal {
        assert_eq!(ended.signal, Some(signal.as_raw()), "{said}");
        assert!(signal != Signal::QUIT || phase == Phase::Start || !dumps || core(&place), "no core file");
    }
    let file = scratch.file("run.mcap");
    // A run interrupted before its first tick leaves no log.
    let begun = phase != Phase::Start || outcome == Outcome::WentOn || file.exists();
    if begun && (phase != Phase::Start || outcome != Outcome::BySignal) {
        let log = Log::open(&file).expect("the log can be read");
        assert_eq!(log.complete, outcome != Outcome::BySignal, "{said}");
    }
    assert_no_harm(&place, &name);
    outcome
}

pub fn rows(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (number, (name, signal, expected)) in SIGNALS.into_iter().enumerate() {
        for (shift, (boards, on)) in BOARDS.into_iter().enumerate() {
            let phases = PHASES.into_iter().enumerate(); // a sample uses another phase in each row
            let of_sample = (2 * number + shift) % PHASES.len();
            for (_, phase) in phases.filter(|(index, _)| !extent.sample || *index == of_sample) {
                let attack = format!("{name}, {}", phase.words());
                rows.push(Row::of(extent, &attack, on, 0..1, |_, chance| {
                    attempt((signal, expected), phase, boards, chance)
                }));
            }
        }
    }
    rows
}
