//! `rcs-run io-test`: tests the couplers of a mapping. Nothing moves unless outputs are tested.
//!
//! 1. Each device: identity, lengths of its process data, watchdog set and read back, exchanges timed.
//! 2. Each input: range and changes.
//! 3. With `--outputs`: each output alone, after a question.
//! 4. With `--watchdog`: the time from the last write to the fallback.

use std::{
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use couplers::{Fault, Kind, Link as _, Mode};
use executive::field::TcpLink;
use field::{Seen, Target};
use interfaces::{DeviceInputs, point};
use modbus::{MOST_FRAME_BYTES, Request, Words, request::Range};
use os_io::stderr_line;

use super::{
    Bench, Hindrance, PERIOD, Probe, ask, outputs,
    tally::{DeviceTally, InputTally, Tally, Verdict},
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
    let stop = interruption()?;
    let mut tally = Tally { mapping: bench.mapping.name.clone(), ..Tally::default() };
    let ticks = Duration::from_secs(arguments.seconds.into()).as_millis() / PERIOD.as_millis();
    inputs(&bench, u32::try_from(ticks).unwrap_or(u32::MAX), &mut tally, &stop);
    let is_ready = |index: usize| tally.devices[index].hindrance.is_empty();
    let ready: Vec<usize> = (0..bench.mapping.devices.len()).filter(|index| is_ready(*index)).collect();
    let asks = arguments.outputs || arguments.watchdog;
    if asks && !stop.load(Ordering::Relaxed) {
        stderr_line!("Outputs are written now. The robot must be switched off, and nothing may be held.");
        if !ask("Is it so?")? {
            return Err(Error::Field("no output is written".to_owned()));
        }
    }
    if arguments.outputs {
        for index in &ready {
            tally.outputs.extend(outputs::test(&bench, *index, &stop)?);
        }
    }
    if arguments.watchdog {
        for index in ready {
            let watchdog = bench.mapping.devices[index].plan.kind.facts().watchdog.as_ref();
            let shown = watchdog.and_then(|watchdog| Some((watchdog.fired?, watchdog.refuses_all)));
            if let Some(shown) = shown.filter(|_| !stop.load(Ordering::Relaxed)) {
                tally.devices[index].fallback_ms = fallback(&bench, index, shown);
                if tally.devices[index].fallback_ms.is_none() {
                    tally.devices[index].verdict = Verdict::NoEffect;
                }
            }
        }
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

struct Tested {
    probe: Probe,
    times: Vec<Duration>,
}

fn inputs(bench: &Bench, exchanges: u32, tally: &mut Tally, stop: &AtomicBool) {
    let mapping = &bench.mapping;
    let mut tested: Vec<Option<Tested>> = Vec::new();
    for (index, device) in mapping.devices.iter().enumerate() {
        let probe = bench.probe(index, Mode::Watch);
        let mut entry = DeviceTally {
            name: device.name.clone(),
            address: device.address.to_string(),
            identity: String::new(),
            verdict: Verdict::Good,
            hindrance: String::new(),
            exchanges: 0,
            failures: 0,
            exchange_ms: [0.0; 3],
            fallback_ms: None,
        };
        tested.push(match probe {
            Ok(mut probe) => {
                entry.identity = identity(device.plan.kind, probe.link());
                Some(Tested { probe, times: Vec::new() })
            }
            Err(Hindrance { text, .. }) => {
                (entry.verdict, entry.hindrance) = (Verdict::NotReady, text);
                None
            }
        });
        tally.devices.push(entry);
    }
    let mut seen = Vec::new();
    let mut next = Instant::now();
    for _ in 0..exchanges {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        for device in tested.iter_mut().flatten() {
            let time = device.probe.exchange();
            device.times.push(time);
        }
        note(bench, &tested, tally, &mut seen);
        next += PERIOD;
        thread::sleep(next.saturating_duration_since(Instant::now()));
    }
    for (entry, device) in tally.devices.iter_mut().zip(tested) {
        let Some(Tested { probe, mut times }) = device else { continue };
        let counters = probe.report().counters;
        (entry.exchanges, entry.failures) = (counters.exchanges, counters.failures);
        times.sort_unstable();
        let ms = |part: usize| {
            times.get(times.len() * part / 100).or(times.last()).map_or(0.0, |time| time.as_secs_f64() * 1e3)
        };
        entry.exchange_ms = [ms(50), ms(99), ms(100)];
        entry.verdict = match u64::from(counters.failures) * MOST_FAILED_OF {
            0 => Verdict::Good,
            failed if failed <= u64::from(counters.exchanges) => Verdict::Usable,
            _ => Verdict::NotUsable,
        };
        probe.end();
    }
    tally.inputs = seen.into_iter().flatten().map(judged).collect();
}

fn note(bench: &Bench, tested: &[Option<Tested>], tally: &Tally, seen: &mut Vec<Option<InputTally>>) {
    let mapping = &bench.mapping;
    let fresh = |device: &Option<Tested>| Seen {
        words: device
            .as_ref()
            .map_or(couplers::Report::STARTING.inputs, |device| device.probe.report().inputs),
        age_ms: device.as_ref().map(|_| 0),
        is_tripped: false,
    };
    let states: Vec<Seen> = tested.iter().map(fresh).collect();
    let mut counts = DeviceInputs::default();
    mapping.apply(&states, &mut counts);
    seen.resize(mapping.inputs.len(), None);
    for (place, input) in seen.iter_mut().zip(&mapping.inputs) {
        let Some(index) = input.device().filter(|index| tested[*index].is_some()) else { continue };
        let Some(raw) = input.raw(&states[index].words) else { continue };
        let count = match input.target {
            Target::Word(word) => Some(word.read(&counts)),
            Target::Station => None,
        };
        let device = tally.devices[index].name.clone();
        let entry = place.get_or_insert_with(|| InputTally {
            name: input.name.clone(),
            device,
            raw: [raw; 2],
            counts: count.map(|count| [count; 2]),
            changes: 0,
            verdict: if is_converter(input) { Verdict::Steady } else { Verdict::Good },
        });
        let is_changed = raw != entry.raw[1] && raw != entry.raw[0];
        entry.changes += u32::from(is_changed);
        entry.raw = [entry.raw[0].min(raw), entry.raw[1].max(raw)];
        entry.counts =
            entry.counts.zip(count).map(|([least, most], count)| [least.min(count), most.max(count)]);
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

fn registers(link: &mut TcpLink, first: u16, count: u16) -> Result<Vec<u16>, Fault> {
    let mut answer = [0; MOST_FRAME_BYTES];
    let request = Request::ReadHoldingRegisters(Range { first, count });
    let words = link.exchange(&request, &mut answer)?.words();
    Ok(words.into_iter().flat_map(Words::iter).collect())
}

/// The time from the last write of a device to its fallback, over a second connection, ms. A register with a value
/// shows the fallback, or that the coupler refuses every request (`refuses_all`).
fn fallback(
    bench: &Bench,
    index: usize,
    ((register, value), refuses_all): ((u16, u16), bool),
) -> Option<u64> {
    let device = &bench.mapping.devices[index];
    let mut probe = bench.probe(index, Mode::Watch).ok()?;
    probe.orders.words = probe.report().acknowledged;
    probe.orders.mode = Mode::Run;
    probe.exchange_for(Duration::from_millis(100));
    let written = Instant::now();
    let mut second =
        TcpLink::new(device.address, device.plan.unit, Duration::from_millis(device.timeout_ms.into()));
    second.connect().ok()?;
    let limit = Duration::from_millis(device.plan.watchdog_ms.into()) + Duration::from_secs(1);
    let fired = loop {
        let is_fired = match registers(&mut second, register, 1) {
            Ok(words) => words == [value],
            Err(Fault::Exception(_)) => refuses_all,
            Err(_) => false,
        };
        if is_fired {
            break u64::try_from(written.elapsed().as_millis()).ok();
        }
        if written.elapsed() > limit {
            break None;
        }
        thread::sleep(Duration::from_millis(1));
    };
    probe.end();
    fired
}
