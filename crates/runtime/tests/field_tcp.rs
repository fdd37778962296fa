//! Runs whose devices are behind couplers over TCP: emulated ones, with the inputs of a cell in which nothing moves.

use std::{
    fs,
    net::{Ipv4Addr, SocketAddr},
    path::{Path, PathBuf},
    sync::atomic::Ordering,
    thread,
    time::{Duration, Instant},
};

use couplers::{Emulated, InWords, Kind};
use executive::field::Station;
use field::{Mapping, SAFETY};
use interfaces::device::GroupHealth;
use os_io::alloc::Counting;
use plant::{Cell, CellDescription};
use rcs_core::Plain as _;
use runtime::{ClockKind, Ending, FieldConfig, LogTarget, OperatorAccess, Run, RunConfig, StartError};
use tempfile::TempDir;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");
/// The devices of the shipped mapping, in the order of their names, and their addresses there.
const DEVICES: [(&str, &str); 3] =
    [("arm", "127.0.0.1:21502"), ("fixture", "127.0.0.1:21503"), ("pedestal", "127.0.0.1:21504")];
const ARM: usize = 0;
const WORDS: (u16, u16) = (32, 16); // registers of the emulated couplers: inputs, outputs
const SUPPLY: u16 = 1 << 7; // `grip.supply` and `tool.close` in the first output word of the arm
const TOOL_CLOSE: u16 = 1 << 11;
const TICKS: u64 = 25; // ticks of a run in real time: one second

/// Three couplers, and the shipped mapping with their addresses.
struct Couplers {
    stations: Vec<Station>,
    directory: TempDir,
}

impl Couplers {
    fn new() -> Self {
        let local = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let open = |_| Station::open(local, Emulated::new(Kind::Bk9000, 1, WORDS.0, WORDS.1)).unwrap();
        let stations: Vec<Station> = DEVICES.iter().map(open).collect();
        let mut text = fs::read_to_string(Path::new(DATA).join("field/station.toml")).unwrap();
        for ((_, address), station) in DEVICES.iter().zip(&stations) {
            text = text.replace(address, &station.address().to_string());
        }
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("cell.toml"), text).unwrap();
        let couplers = Self { stations, directory };
        couplers.sense();
        couplers
    }

    fn mapping(&self) -> PathBuf {
        self.directory.path().join("cell.toml")
    }

    fn log(&self) -> PathBuf {
        self.directory.path().join("run.mcap")
    }

    fn sense(&self) {
        let description = CellDescription::load(&Path::new(DATA).join("cell.toml")).unwrap();
        let inputs = Cell::new(&description, 1).unwrap().inputs();
        let mapping: Mapping = runtime::field::read(&self.mapping()).unwrap();
        let mut images = [InWords::ZERO; DEVICES.len()];
        mapping.sample(&inputs, &mut images);
        // The safety circuit is closed, and the devices of the workstation are off.
        let closed: Vec<i64> = mapping.inputs.iter().map(|point| i64::from(point.name == SAFETY)).collect();
        mapping.sample_station(&closed, &mut images);
        for ((station, image), device) in self.stations.iter().zip(images).zip(&mapping.devices) {
            let first = usize::from(device.plan.reads[0].first);
            station.with(|coupler| {
                let there = coupler.inputs_mut().iter_mut().skip(first);
                there.zip(image.words).for_each(|(register, word)| *register = word);
            });
        }
    }

    fn config(&self) -> RunConfig {
        RunConfig {
            log: LogTarget::File(self.log()),
            shared_memory: false,
            clock: ClockKind::Real,
            field: Some(FieldConfig::tcp(self.mapping())),
            wait: 30,
            ..RunConfig::new(DATA, "linkbar")
        }
    }

    fn refused(&self, config: RunConfig) -> StartError {
        Run::new(config, Box::new(())).err().expect("the run is refused")
    }

    fn outputs_of(&self, device: usize) -> u16 {
        self.stations[device].with(|coupler| coupler.outputs()[0])
    }
}

#[test]
fn run_reads_the_devices_and_ends_with_confirmed_safe_outputs() {
    let couplers = Couplers::new();
    let mut run =
        Run::new(RunConfig { ticks: Some(TICKS), ..couplers.config() }, Box::new(())).expect("all are ready");
    couplers.stations[ARM].with(|coupler| coupler.inputs_mut()[0] = 16_384);
    let mut was_on = false;
    while run.step() {
        was_on |= couplers.outputs_of(ARM) != 0;
    }
    let inputs = run.external_inputs().devices;
    assert_eq!(inputs.grip.potentiometer, 2048, "raw 16384 of 32767, in counts");
    assert_eq!(inputs.field.grip, GroupHealth::Fresh);
    let outcome = run.finish();
    assert!(was_on, "the arm's valves are commanded");
    let field = outcome.result.field.expect("couplers");
    assert!(field.is_real && field.simulated.starts_with(&["robot"]), "{field}");
    assert!(field.devices.iter().all(|device| device.confirmed && device.exchanges > 40), "{field}");
    assert_eq!(outcome.result.allocations_after_start, Some(0));
    assert!(outcome.result.parts.is_empty() && outcome.result.truth.is_none(), "nobody judges the parts");
    for (device, (name, ..)) in DEVICES.iter().enumerate() {
        assert_eq!(couplers.outputs_of(device), 0, "{name}");
    }
    drop(couplers.stations);
    let report = record::replay(&couplers.directory.path().join("run.mcap")).unwrap();
    assert!(report.is_same() && report.skipped == 0, "a replay needs no device");
    let unpacked = tempfile::tempdir().unwrap();
    let log = record::Log::open(&couplers.directory.path().join("run.mcap")).unwrap();
    let error = runtime::repeat::unpack(&log, unpacked.path()).unwrap_err();
    assert!(error.to_string().contains("the devices of"), "a repetition needs them: {error}");
}

#[test]
fn lost_coupler_trips_and_ends_the_run_as_stopped() {
    let couplers = Couplers::new();
    let mut run = Run::new(couplers.config(), Box::new(())).expect("all are ready");
    for _ in 0..TICKS {
        assert!(run.step());
    }
    couplers.stations[ARM].cut(true);
    let cut = run.last_tick();
    while run.step() {
        let passed = run.last_tick().since(cut);
        if passed == 2 * TICKS {
            couplers.stations[ARM].cut(false);
        }
        assert!(passed < 60 * TICKS, "the run ends");
    }
    let outcome = run.finish();
    let Ending::Failed(account) = &outcome.ending else { panic!("{}", outcome.ending.text()) };
    assert!(account.is_stopped(), "{account}");
    let field = outcome.result.field.expect("couplers");
    assert_eq!(field.devices[ARM].trips, 1, "{field}");
    assert_eq!(couplers.outputs_of(ARM), 0);
}

#[test]
fn stop_and_panic_leave_safe_outputs() {
    for panics in [false, true] {
        let couplers = Couplers::new();
        let config = couplers.config();
        let stop = config.stop.clone();
        let address = couplers.mapping();
        let running = thread::spawn(move || {
            let mut run = Run::new(config, Box::new(())).expect("all are ready");
            while run.step() {
                if panics && run.last_tick().0 == TICKS {
                    std::panic::resume_unwind(Box::new("a panic in the tick"));
                }
            }
            run.finish().ending.word()
        });
        assert!(address.is_file());
        let begun = Instant::now();
        while couplers.stations[ARM].with(|coupler| coupler.writes()) < 5 {
            assert!(begun.elapsed() < Duration::from_secs(60), "the run begins");
            thread::sleep(Duration::from_millis(5));
        }
        stop.store(!panics, Ordering::Relaxed);
        let ended = running.join();
        assert_eq!(ended.ok(), (!panics).then_some("stopped"));
        let fallbacks = couplers.stations[ARM].with(|coupler| coupler.fallbacks());
        assert_eq!((couplers.outputs_of(ARM), fallbacks), (0, 0), "before the watchdog");
    }
}

#[test]
fn outputs_that_are_on_refuse_the_start_by_name() {
    let couplers = Couplers::new();
    couplers.stations[ARM].with(|coupler| coupler.outputs_mut()[0] = SUPPLY);
    let error = couplers.refused(couplers.config()).to_string();
    assert!(error.contains("arm at 127.0.0.1:") && error.contains("grip.supply on"), "{error}");
    assert_eq!(couplers.outputs_of(ARM), SUPPLY, "nothing was written");
}

#[test]
fn resumed_run_keeps_its_outputs_off_and_refuses_unknown_ones() {
    let couplers = Couplers::new();
    let journal = couplers.directory.path().join("run.journal");
    let config = RunConfig { journal: Some(journal.clone()), ..couplers.config() };
    let mut run = Run::new(config, Box::new(())).expect("all are ready");
    while run.last_tick().0 < 2 * TICKS && run.step() {}
    drop(run);
    assert_eq!(couplers.outputs_of(ARM), 0);
    let ended = Instant::now();
    while couplers.stations[ARM].with(|coupler| coupler.fallbacks()) == 0 {
        assert!(ended.elapsed() < Duration::from_secs(60), "its watchdog fires after each run");
        thread::sleep(Duration::from_millis(5));
    }
    // A resumed run needs an operator, who reaches it by the shared memory.
    let resume = RunConfig {
        resume: Some(journal),
        shared_memory: true,
        operator: OperatorAccess::Owner,
        ..couplers.config()
    };
    couplers.stations[ARM].with(|coupler| coupler.outputs_mut()[0] = TOOL_CLOSE);
    let error = couplers.refused(resume.clone()).to_string();
    assert!(error.contains("arm at 127.0.0.1:") && error.contains("tool.close on"), "{error}");
    assert_eq!(couplers.outputs_of(ARM), TOOL_CLOSE, "nothing was written");
    couplers.stations[ARM].with(|coupler| coupler.outputs_mut()[0] = 0);
    let mut run = Run::new(resume, Box::new(())).expect("no output is on");
    let writes = couplers.stations[ARM].with(|coupler| coupler.writes());
    for _ in 0..TICKS {
        assert!(run.step());
        assert_eq!(couplers.outputs_of(ARM), 0, "no output is switched on before a command");
    }
    assert!(couplers.stations[ARM].with(|coupler| coupler.writes()) > writes + TICKS / 2);
}

#[test]
fn device_that_is_absent_or_too_short_is_refused_with_its_address() {
    let couplers = Couplers::new();
    couplers.stations[ARM].cut(true);
    let error = couplers.refused(RunConfig { wait: 1, ..couplers.config() }).to_string();
    assert!(error.contains("arm at 127.0.0.1:") && error.contains("answer"), "{error}");
    let mut couplers = Couplers::new();
    let address = couplers.stations[ARM].address();
    couplers.stations.remove(ARM);
    let short = Station::open(address, Emulated::new(Kind::Bk9000, 1, 4, WORDS.1)).unwrap();
    let error = couplers.refused(couplers.config()).to_string();
    assert!(error.contains("it has 64 bits of inputs"), "{error}");
    drop(short);
}

#[test]
fn couplers_over_tcp_need_the_real_clock() {
    let couplers = Couplers::new();
    let error = couplers.refused(RunConfig { clock: ClockKind::Fast, ..couplers.config() });
    assert!(matches!(error, StartError::FieldNotInRealTime), "{error}");
    let faults = couplers.directory.path().join("cuts.toml");
    fs::write(&faults, "[[fault]]\nkind = \"field-cut\"\ndevice = \"arm\"\nat = 5\n").unwrap();
    let error = couplers.refused(RunConfig { faults: Some(faults), ..couplers.config() });
    assert!(matches!(error, StartError::CutOverTcp(_)), "{error}");
}
