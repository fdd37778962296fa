//! `rcs-run io-test` finds wiring mistakes: a person works the sensors of a cell that is not wired like its mapping.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::{Ipv4Addr, SocketAddr},
    process::{Child, ChildStdin, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

use couplers::{Emulated, InWords, Kind, OutWords};
use diagnostics::Source;
use executive::field::Station;
use field::{Mapping, Target};
use interfaces::{DeviceInputs, device::FORCE_ZERO, point};
use rcs_core::Plain as _;
use serde_json::Value;

use crate::common::{command, root};

const ADDRESSES: [&str; 3] = ["127.0.0.1:21502", "127.0.0.1:21503", "127.0.0.1:21504"];
const ARM: usize = 0;
const FIXTURE: usize = 1;
const PEDESTAL: usize = 2;
const LIMIT: Duration = Duration::from_secs(10); // for an output to go on, on a busy machine

/// A text of the mapping, and its replacement.
type Change = (&'static str, &'static str);

/// What differs between the cell and the mapping that is tested.
#[derive(Clone, Copy, Default)]
struct Mistake {
    /// Changes of the cell: its wires, as a mapping.
    wired: &'static [Change],
    /// Changes of the mapping that is tested.
    mapped: &'static [Change],
    /// A bit that is always on: device, word, mask.
    stuck: Option<(usize, usize, u16)>,
    /// The cables of two couplers are exchanged; true if both have the same size.
    exchanged: Option<(usize, usize, bool)>,
    /// A coupler without power.
    absent: Option<usize>,
}

const RIGHT: Mistake = Mistake { wired: &[], mapped: &[], stuck: None, exchanged: None, absent: None };

fn wired(wired: &'static [Change]) -> Mistake {
    Mistake { wired, ..RIGHT }
}

fn mapped(mapped: &'static [Change]) -> Mistake {
    Mistake { mapped, ..RIGHT }
}

fn changed(text: &str, changes: &[Change]) -> String {
    // Two points exchange their places, so no place is replaced twice.
    let lines = text.lines().map(|line| {
        let change = changes.iter().find(|(from, _)| line.contains(from));
        change.map_or_else(|| line.to_owned(), |(from, to)| line.replace(from, to))
    });
    lines.map(|line| line + "\n").collect()
}

fn parsed(text: &str) -> Mapping {
    Mapping::parse(&Source { name: "wires".to_owned(), text: text.to_owned().into() })
        .unwrap_or_else(|problems| panic!("{problems:?}"))
}

/// The cell: its sensors, valves and couplers as they are wired.
struct Cell {
    wires: Mapping,
    stations: Vec<Option<Station>>,
    sensors: DeviceInputs,
    values: Vec<i64>,
    stuck: Option<(usize, usize, u16)>,
}

impl Cell {
    /// Returns the cell, and the text of the mapping that is tested.
    fn new(mistake: &Mistake) -> (Self, String) {
        let shipped = fs::read_to_string(root().join("data/field/station.toml")).unwrap();
        let wires = parsed(&changed(&shipped, mistake.wired));
        let local = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let same = mistake.exchanged.is_some_and(|(_, _, same)| same);
        let open = |device: &field::Device| {
            let exact = Emulated::of(&device.plan);
            let coupler = if same { Emulated::new(Kind::Bk9000, 1, 40, 16) } else { exact };
            Some(Station::open(local, coupler).unwrap())
        };
        let mut stations: Vec<Option<Station>> = wires.devices.iter().map(open).collect();
        let mut addresses: Vec<SocketAddr> =
            stations.iter().flatten().map(|station| station.address()).collect();
        if let Some((first, second, _)) = mistake.exchanged {
            addresses.swap(first, second);
        }
        if let Some(absent) = mistake.absent {
            stations[absent] = None;
        }
        let mut text = changed(&shipped, mistake.mapped);
        for (shipped, address) in ADDRESSES.iter().zip(addresses) {
            text = text.replace(shipped, &address.to_string());
        }
        // Times are not tested, because the machine may be busy.
        text = text.replace("exchange_ms = 20\ntimeout_ms = 15\n", "");
        text =
            text.replace("watchdog_ms = 500\n", "watchdog_ms = 2000\nexchange_ms = 1000\ntimeout_ms = 900\n");
        let mut sensors = DeviceInputs::default();
        let zero = u16::try_from(FORCE_ZERO).unwrap();
        (sensors.force.x, sensors.force.y, sensors.force.z, sensors.force.moment) = (zero, zero, zero, zero);
        for name in ["grip", "pedestal"] {
            for (part, counts) in [("potentiometer", 205), ("strain-left", 310), ("strain-right", 287)] {
                point::Input::named(&format!("{name}.{part}")).unwrap().write(&mut sensors, counts);
            }
        }
        sensors.pedestal.table_potentiometer = 2000;
        let values = vec![0; wires.inputs.len()];
        let cell = Self { wires, stations, sensors, values, stuck: mistake.stuck };
        cell.show();
        (cell, text)
    }

    /// The sensors set the words of the couplers.
    fn show(&self) {
        let mut images = vec![InWords::ZERO; self.stations.len()];
        self.wires.sample(&self.sensors, &mut images);
        self.wires.sample_station(&self.values, &mut images);
        if let Some((device, word, mask)) = self.stuck {
            images[device].words[word] |= mask;
        }
        for ((station, device), image) in self.stations.iter().zip(&self.wires.devices).zip(images) {
            let Some(station) = station else { continue };
            station.with(|coupler| coupler.show(&device.plan, &image));
        }
    }

    /// A person brings a sensor into a state, in the words of the question.
    fn work(&mut self, name: &str, asked: &str) {
        let index = self.wires.inputs.iter().position(|point| point.name == name).unwrap();
        let Target::Word(word) = self.wires.inputs[index].target else {
            self.values[index] = match asked {
                "switch it on" => 1,
                "switch it off" => 0,
                _ => self.values[index] + 1,
            };
            return self.show();
        };
        let range = word.range();
        let is_knob = word.kind() == point::Kind::Knob;
        let rest = word.read(&self.sensors);
        let value = match asked {
            "switch it on" => 1,
            "switch it off" => 0,
            "bring it to its highest value" if is_knob => *range.end(),
            "bring it to its lowest value" if is_knob => *range.start(),
            "bring it to its highest value" => rest + 1000,
            "bring it to its lowest value" => rest - 1000,
            "change it" => rest + 100,
            other => panic!("{other}"),
        };
        word.write(&mut self.sensors, value);
        self.show();
    }

    /// The outputs that are on at the valves.
    fn on(&self) -> Vec<&str> {
        let images: Vec<OutWords> = self
            .stations
            .iter()
            .zip(&self.wires.devices)
            .map(|(station, device)| {
                station
                    .as_ref()
                    .map_or(OutWords::ZERO, |station| station.with(|coupler| coupler.image(&device.plan)))
            })
            .collect();
        let is_on = |point: &&field::OutPoint| point.get(&images[point.device()]) != point.safe;
        self.wires.outputs.iter().filter(is_on).map(|point| point.name.as_str()).collect()
    }

    /// True if this output, and no other one, goes on.
    fn goes_on(&self, name: &str) -> bool {
        let begun = Instant::now();
        while begun.elapsed() < LIMIT {
            let on = self.on();
            if !on.is_empty() {
                return on == [name];
            }
            thread::sleep(Duration::from_millis(5));
        }
        false
    }
}

/// A program with its questions, until it ends.
struct Program {
    child: Child,
    answers: ChildStdin,
}

impl Program {
    fn start(arguments: &[&str]) -> Self {
        let pipe = Stdio::piped;
        let mut child = command(arguments)
            .stdin(pipe())
            .stdout(pipe())
            .stderr(pipe())
            .spawn()
            .expect("it can be started");
        let answers = child.stdin.take().expect("piped");
        Self { child, answers }
    }

    /// Answers each question by the person. Returns the exit status and the tally.
    fn complete(mut self, cell: &mut Cell) -> (ExitStatus, Value, String) {
        let mut questions = self.child.stderr.take().expect("piped");
        let (mut said, mut byte) = (Vec::new(), [0]);
        let mut begins = 0;
        let mut worked = true;
        while questions.read(&mut byte).expect("it can be read") == 1 {
            said.push(byte[0]);
            let line = String::from_utf8_lossy(&said[begins..]).into_owned();
            let answer = if line.ends_with("(s skips, q ends): ") || line.ends_with("[y/N] ") {
                Self::answer(&line, cell, &mut worked)
            } else {
                if byte[0] == b'\n' {
                    begins = said.len();
                }
                continue;
            };
            begins = said.len();
            self.answers.write_all(answer.as_bytes()).expect("it reads answers");
            if let Some(name) = line.strip_suffix(": on for a second? [y/N] ") {
                worked = cell.goes_on(name.trim());
            }
        }
        let output = self.child.wait_with_output().expect("it ends");
        let said = String::from_utf8_lossy(&said).into_owned();
        let tally = serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"));
        (output.status, tally, said)
    }

    fn answer(line: &str, cell: &mut Cell, worked: &mut bool) -> &'static str {
        // `3 of 89: beam.1: switch it on, then press Enter (s skips, q ends): `
        if let Some((_, rest)) = line.split_once(" of ")
            && let Some((name, asked)) = rest.split_once(": ").and_then(|(_, rest)| rest.split_once(": "))
            && let Some((asked, _)) = asked.split_once(", then press Enter")
        {
            cell.work(name, asked);
            return "\n";
        }
        if line.contains("did it work?") && !*worked { "n\n" } else { "y\n" }
    }
}

/// Runs a test. Returns the exit status, the tally, and the questions.
fn run(mistake: &Mistake, arguments: &[&str]) -> (ExitStatus, Value, String) {
    let (mut cell, text) = Cell::new(mistake);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cell.toml");
    fs::write(&path, text).unwrap();
    let mut words = vec!["io-test", path.to_str().unwrap(), "--seconds", "1", "--json"];
    words.extend(arguments);
    Program::start(&words).complete(&mut cell)
}

fn entry<'v>(tally: &'v Value, list: &str, name: &str) -> &'v Value {
    let entries = tally[list].as_array().unwrap();
    entries.iter().find(|entry| entry["name"] == name).unwrap_or_else(|| panic!("{name}: {tally}"))
}

#[test]
fn full_mapping_gets_a_verdict_per_point() {
    let (status, tally, said) = run(&RIGHT, &["--wiggle", "--outputs"]);
    assert_eq!(status.code(), Some(0), "{said}");
    let [inputs, outputs] = ["inputs", "outputs"].map(|list| tally[list].as_array().unwrap());
    let wires = Cell::new(&RIGHT).0.wires;
    assert_eq!((inputs.len(), outputs.len()), (wires.inputs.len(), wires.outputs.len()));
    assert!(inputs.len() + outputs.len() >= 128, "the mapping has the whole cell");
    for point in inputs.iter().chain(outputs) {
        assert_eq!(point["verdict"], "good", "{point}: {said}");
    }
}

#[test]
fn wiring_mistakes_are_named() {
    const INPUTS: &str = "inputs";
    const DEVICES: &str = "devices";
    const OUTPUTS: &str = "outputs";
    let cases: Vec<(&str, Mistake, &str, &str, &str)> = vec![
        (
            "swapped switches",
            wired(&[("arm input 8.0\"", "arm input 8.1\""), ("arm input 8.1\"", "arm input 8.0\"")]),
            INPUTS,
            "beam.1",
            "elsewhere: beam.2 changed",
        ),
        (
            "swapped strain gages",
            wired(&[("arm input 1\"", "arm input 2\""), ("arm input 2\"", "arm input 1\"")]),
            INPUTS,
            "grip.strain-left",
            "elsewhere: grip.strain-right changed",
        ),
        (
            "swapped between couplers",
            wired(&[("arm input 8.8\"", "fixture input 2.0\""), ("fixture input 2.0\"", "arm input 8.8\"")]),
            INPUTS,
            "quick-change.locked",
            "elsewhere: holster.right.large-1 changed",
        ),
        (
            "inverted sensor",
            wired(&[("arm input 8.2\"", "arm input 8.2\", invert = true")]),
            INPUTS,
            "beam.3",
            "inverted",
        ),
        (
            "inverted in the mapping",
            mapped(&[("fixture input 3.2\"", "fixture input 3.2\", invert = true")]),
            INPUTS,
            "vise.PFIXTURE.clamped",
            "inverted",
        ),
        (
            "dead switch",
            wired(&[("at = \"arm input 8.3\"", "fixed = 0")]),
            INPUTS,
            "beam.4",
            "no-change: always 0",
        ),
        (
            "stuck switch",
            Mistake {
                wired: &[("at = \"arm input 8.4\"", "fixed = 0")],
                stuck: Some((ARM, 8, 1 << 4)),
                ..RIGHT
            },
            INPUTS,
            "beam.5",
            "no-change: always 1",
        ),
        (
            "dead potentiometer",
            wired(&[(
                "at = \"arm input 0\", raw = [0, 32767], counts = [0, 4095], stale_ms = 100",
                "fixed = 9",
            )]),
            INPUTS,
            "grip.potentiometer",
            "no-change: always 1",
        ),
        (
            "broken wire of 4 to 20 mA",
            Mistake {
                wired: &[(
                    "at = \"arm input 0\", raw = [0, 32767], counts = [0, 4095], stale_ms = 100",
                    "fixed = 9",
                )],
                mapped: &[("arm input 0\", raw = [0,", "arm input 0\", raw = [6554,")],
                ..RIGHT
            },
            INPUTS,
            "grip.potentiometer",
            "broken-wire",
        ),
        (
            "scale of 12 bits",
            wired(&[("arm input 0\", raw = [0, 32767]", "arm input 0\", raw = [0, 4095]")]),
            INPUTS,
            "grip.potentiometer",
            "wrong-scale",
        ),
        (
            "half the scale",
            wired(&[("arm input 0\", raw = [0, 32767]", "arm input 0\", raw = [0, 65534]")]),
            INPUTS,
            "grip.potentiometer",
            "wrong-scale",
        ),
        (
            "unsigned converter",
            wired(&[(
                "arm input 5\", type = \"i16\", raw = [-32768, 32767]",
                "arm input 5\", type = \"u16\", raw = [0, 65535]",
            )]),
            INPUTS,
            "force.z",
            "wrong-scale",
        ),
        (
            "reversed knob",
            wired(&[(
                "arm input 24\", raw = [0, 32767], counts = [0, 1000]",
                "arm input 24\", raw = [0, 32767], counts = [1000, 0]",
            )]),
            INPUTS,
            "joystick.velocity",
            "inverted",
        ),
        (
            "stick with half its travel",
            wired(&[(
                "arm input 25\", type = \"i16\", raw = [-32768, 32767]",
                "arm input 25\", type = \"i16\", raw = [-16384, 16383]",
            )]),
            INPUTS,
            "joystick.x",
            "wrong-scale",
        ),
        (
            "wrong register",
            wired(&[("fixture input 3.0\"", "fixture input 7.0\"")]),
            INPUTS,
            "vise.PFIXTURE.opened",
            "no-change: always 0",
        ),
        (
            "wrong unit",
            mapped(&[("unit = 1", "unit = 2")]),
            DEVICES,
            "arm",
            "not-ready: it refuses a request with exception 11",
        ),
        (
            "smaller coupler",
            Mistake { exchanged: Some((ARM, FIXTURE, false)), ..RIGHT },
            DEVICES,
            "arm",
            "not-ready",
        ),
        (
            "exchanged couplers of one size",
            Mistake { exchanged: Some((FIXTURE, PEDESTAL, true)), ..RIGHT },
            INPUTS,
            "table.limit-plus",
            "elsewhere: tray.UNIT_1.1 changed",
        ),
        (
            "coupler without power",
            Mistake { absent: Some(PEDESTAL), ..RIGHT },
            DEVICES,
            "pedestal",
            "not-ready: it does not accept a connection",
        ),
        (
            "swapped valves",
            wired(&[
                ("0x800.8\", safe = 0 }", "0x800.9\", safe = 0 }"),
                ("arm holding 0x800.9\"", "arm holding 0x800.8\""),
            ]),
            OUTPUTS,
            "v.open",
            "no-effect",
        ),
        (
            "valve at another terminal",
            wired(&[("arm holding 0x800.10\"", "arm holding 0x801.9\"")]),
            OUTPUTS,
            "tool.open",
            "no-effect",
        ),
    ];
    assert!(cases.len() >= 20);
    thread::scope(|scope| {
        let tests = cases.iter().map(|case| {
            scope.spawn(move || {
                let (title, mistake, list, name, expected) = case;
                let points = if *list == DEVICES { "beam." } else { name };
                let step = if *list == OUTPUTS { "--outputs" } else { "--wiggle" };
                let (status, tally, said) = run(mistake, &[step, "--points", points]);
                assert_eq!(status.code(), Some(1), "{title}: {said}");
                let entry = entry(&tally, list, name);
                let (verdict, note) = expected.split_once(": ").unwrap_or((expected, ""));
                assert_eq!(entry["verdict"], *verdict, "{title}: {entry}: {said}");
                let text = entry.to_string();
                assert!(text.contains(note), "{title}: {text}");
                let last = said.lines().last().unwrap_or_default();
                assert!(last.contains(name), "{title}: the last line names it: {last}");
            })
        });
        let tests: Vec<_> = tests.collect();
        for test in tests {
            test.join().expect("the mistake is named");
        }
    });
}
