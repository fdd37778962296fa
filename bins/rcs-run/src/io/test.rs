//! `rcs-run io-test`: tests the couplers of a mapping. Nothing moves unless outputs are tested.
//!
//! 1. Each device: identity, lengths of its process data, watchdog set and read back, exchanges timed.
//! 2. Each input: range and changes.
//! 3. With `--wiggle`: a person works each sensor.
//! 4. With `--outputs`: each output alone, after a question.
//! 5. With `--watchdog`: the time from the last write to the fallback.
//! 6. With `--hold`: whether a gripper keeps a part without exchanges.

use std::{
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use couplers::Kind;
use executive::field::TcpLink;
use field::Target;
use interfaces::point;
use os_io::stderr_line;

use super::{
    Bench, Obstacle, PERIOD, hold, outputs,
    person::Person,
    probes::Probes,
    tally::{DeviceTally, InputTally, Tally, Verdict},
    watchdog::{self, registers},
    wiggle::Wiggle,
};
use crate::rcs_run::{
    answer::answer,
    arguments::IoTestArguments,
    error::{Error, FAILED, STOPPED},
    interrupt::interruption,
};

const MOST_FAILED_OF: u64 = 100; // a device of which more than one exchange in so many fails is not usable

/// Exit status 0 if all verdicts are good, 1 if not, 3 after an interruption.
pub fn test(arguments: &IoTestArguments) -> Result<ExitCode, Error> {
    let bench = Bench::open(&arguments.mapping)?;
    check_points(&bench, arguments)?;
    let (stop, person) = (interruption()?, Person::new());
    let mut tally = Tally { mapping: bench.mapping.name.clone(), ..Tally::default() };
    let mut probes = devices(&bench, &mut tally);
    let ticks = Duration::from_secs(arguments.seconds.into()).as_millis() / PERIOD.as_millis();
    let exchanges = u32::try_from(ticks).unwrap_or(u32::MAX);
    let noise = inputs(&bench, &mut probes, exchanges, arguments, &mut tally, &stop);
    if arguments.wiggle {
        let mut wiggle = Wiggle { bench: &bench, probes: &mut probes, person: &person, stop: &stop, noise };
        wiggle.test(&mut tally.inputs)?;
    }
    judge_devices(&mut probes, &mut tally);
    probes.end();
    if !stop.load(Ordering::Relaxed) {
        write_outputs(&bench, arguments, &person, &mut tally, &stop)?;
    }
    answer(&tally, arguments.json)?;
    if stop.load(Ordering::Relaxed) {
        return Ok(ExitCode::from(STOPPED));
    }
    Ok(match tally.failure() {
        Some(reason) => {
            stderr_line!("rcs-run: {reason}");
            ExitCode::from(FAILED)
        }
        None => ExitCode::SUCCESS,
    })
}

/// The steps that write outputs. Each asks first.
fn write_outputs(
    bench: &Bench,
    arguments: &IoTestArguments,
    person: &Person,
    tally: &mut Tally,
    stop: &AtomicBool,
) -> Result<(), Error> {
    let is_ready = |index: &usize| tally.devices[*index].hindrance.is_empty();
    let ready: Vec<usize> = (0..bench.mapping.devices.len()).filter(is_ready).collect();
    if arguments.outputs || arguments.watchdog {
        outputs::check_nothing_held(bench, &ready)?;
        stderr_line!("Outputs are written now. The robot must be switched off, and nothing may be held.");
        if !person.ask("Is it so?")? {
            return Err(Error::Field("no output is written".to_owned()));
        }
    }
    if arguments.outputs {
        for index in &ready {
            tally.outputs.extend(outputs::test(bench, *index, &arguments.points, person, stop)?);
        }
    }
    if arguments.watchdog {
        for index in ready {
            let watchdog = bench.mapping.devices[index].plan.kind.facts().watchdog.as_ref();
            let shown = watchdog.and_then(|watchdog| Some((watchdog.fired?, watchdog.refuses_all)));
            if let Some(shown) = shown.filter(|_| !stop.load(Ordering::Relaxed)) {
                tally.devices[index].fallback_ms = watchdog::fallback(bench, index, shown);
                if tally.devices[index].fallback_ms.is_none() {
                    tally.devices[index].verdict = Verdict::NoEffect;
                }
            }
        }
    }
    if let Some(gripper) = &arguments.hold {
        tally.hold = Some(hold::test(bench, gripper, person, stop)?);
    }
    Ok(())
}

/// Fails if `--points` selects nothing.
fn check_points(bench: &Bench, arguments: &IoTestArguments) -> Result<(), Error> {
    let mapping = &bench.mapping;
    let names = || {
        let inputs = mapping.inputs.iter().map(|point| &point.name);
        inputs.chain(mapping.outputs.iter().map(|point| &point.name))
    };
    let unknown = arguments.points.iter().find(|beginning| !names().any(|name| name.starts_with(*beginning)));
    unknown.map_or(Ok(()), |beginning| {
        Err(Error::Field(format!("--points {beginning}: no point of the mapping begins with it")))
    })
}

/// True for the points of `--points`: those whose names begin with one of its texts, or all without it.
pub fn is_selected(name: &str, beginnings: &[String]) -> bool {
    beginnings.is_empty() || beginnings.iter().any(|beginning| name.starts_with(beginning))
}

/// Sets up the devices, and makes their entries.
fn devices(bench: &Bench, tally: &mut Tally) -> Probes {
    let (mut probes, hindrances) = Probes::open(bench);
    for ((index, device), hindrance) in bench.mapping.devices.iter().enumerate().zip(hindrances) {
        let identity = probes.get(index).map(|probe| identity(device.plan.kind, probe.link()));
        tally.devices.push(DeviceTally {
            name: device.name.clone(),
            address: device.address.to_string(),
            identity: identity.unwrap_or_default(),
            verdict: if hindrance.is_some() { Verdict::NotReady } else { Verdict::Good },
            hindrance: hindrance.map_or_else(String::new, |Obstacle { text, .. }| text),
            exchanges: 0,
            failures: 0,
            exchange_ms: [0.0; 3],
            fallback_ms: None,
        });
    }
    probes
}

/// Reads all inputs for a time, and measures the exchanges. Returns the noise of each input of the mapping.
fn inputs(
    bench: &Bench,
    probes: &mut Probes,
    exchanges: u32,
    arguments: &IoTestArguments,
    tally: &mut Tally,
    stop: &AtomicBool,
) -> Vec<i64> {
    let mapping = &bench.mapping;
    let mut times: Vec<Vec<Duration>> = vec![Vec::new(); mapping.devices.len()];
    let mut seen: Vec<Option<InputTally>> = vec![None; mapping.inputs.len()];
    let mut next = Instant::now();
    for _ in 0..exchanges {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        for (times, time) in times.iter_mut().zip(probes.exchange()) {
            times.extend(time);
        }
        for ((place, point), reading) in seen.iter_mut().zip(&mapping.inputs).zip(probes.read(mapping)) {
            let Some((reading, device)) = reading.zip(point.device()) else { continue };
            let begin = if is_converter(point) { Verdict::Steady } else { Verdict::Good };
            let device = &mapping.devices[device].name;
            place.get_or_insert_with(|| InputTally::new(&point.name, device, reading, begin)).add(reading);
        }
        next += PERIOD;
        thread::sleep(next.saturating_duration_since(Instant::now()));
    }
    for (entry, mut times) in tally.devices.iter_mut().zip(times) {
        times.sort_unstable();
        let ms = |part: usize| {
            times.get(times.len() * part / 100).or(times.last()).map_or(0.0, |time| time.as_secs_f64() * 1e3)
        };
        entry.exchange_ms = [ms(50), ms(99), ms(100)];
    }
    let noise = seen.iter().map(|input| input.as_ref().map_or(0, InputTally::noise)).collect();
    let selected = seen.into_iter().flatten().filter(|input| is_selected(&input.name, &arguments.points));
    tally.inputs = selected.map(judged).collect();
    noise
}

/// The verdicts of the devices, after their last exchange.
fn judge_devices(probes: &mut Probes, tally: &mut Tally) {
    for (index, entry) in tally.devices.iter_mut().enumerate() {
        let Some(counters) = probes.get(index).map(|probe| probe.report().counters) else { continue };
        (entry.exchanges, entry.failures) = (counters.exchanges, counters.failures);
        entry.verdict = match u64::from(counters.failures) * MOST_FAILED_OF {
            0 => Verdict::Good,
            failed if failed <= u64::from(counters.exchanges) => Verdict::Usable,
            _ => Verdict::NotUsable,
        };
    }
}

fn is_converter(input: &field::InPoint) -> bool {
    matches!(input.target, Target::Word(word) if matches!(word.kind(), point::Kind::Converter | point::Kind::Force))
}

/// An input with its verdict. Only converters begin as steady; a value at an end of their range means a broken wire.
fn judged(mut input: InputTally) -> InputTally {
    if input.verdict == Verdict::Steady {
        let is_broken = input.counts.is_some_and(|[least, most]| least == 0 || most == 4095);
        if is_broken {
            input.verdict = Verdict::BrokenWire;
        } else if input.raw[0] != input.raw[1] {
            input.verdict = Verdict::Good;
        }
    }
    input
}

/// The text of a coupler about itself; empty without one.
fn identity(kind: Kind, link: &mut TcpLink) -> String {
    let Some((first, count)) = kind.facts().identity else { return String::new() };
    let words = registers(link, first, count).unwrap_or_default();
    let bytes = words.into_iter().flat_map(u16::to_be_bytes).filter(u8::is_ascii_graphic);
    bytes.map(char::from).collect()
}
