//! The result of a test of couplers: a verdict per device, input, output and watchdog.

use std::fmt;

use serde::Serialize;

use super::probes::Reading;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    Good,
    Usable,     // a device with at most one failed exchange in a hundred
    Steady,     // an analog input did not change by a bit: the sensor may be absent
    BrokenWire, // a converter at an end of its range: a broken wire, or a wrong `raw`
    NotUsable,  // a device with more failed exchanges
    NotReady,   // a device that could not be set up
    NoEffect,   // an output that was not read back as written, or that the person did not see
    NoChange,   // an input that did not change when a person worked its sensor
    Elsewhere,  // the same, but another input has changed: swapped wires, or a wrong address
    Inverted,   // an input that was off when the person had switched it on, or lowest at its highest value
    WrongScale, // an analog input whose values are not those of its sensor
    NotHeld,    // a part that a gripper has lost, or holds with less force
    Refused,    // an output that may not be switched on in this state of the cell
    Skipped,    // a point that was not tested
}

impl Verdict {
    const fn text(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Usable => "usable: exchanges have failed",
            Self::Steady => "steady: is the sensor there?",
            Self::BrokenWire => "BROKEN WIRE, or a wrong `raw`",
            Self::NotUsable => "NOT USABLE",
            Self::NotReady => "NOT READY",
            Self::NoEffect => "NO EFFECT",
            Self::NoChange => "NO CHANGE: is it connected?",
            Self::Elsewhere => "CHANGES ANOTHER POINT: swapped wires, or a wrong address?",
            Self::Inverted => "INVERTED: `invert`, or `counts` in the other order?",
            Self::WrongScale => "WRONG SCALE: a wrong `raw`, `counts` or `type`?",
            Self::NotHeld => "NOT HELD",
            Self::Refused => "REFUSED",
            Self::Skipped => "skipped",
        }
    }

    const fn is_failure(self) -> bool {
        match self {
            Self::Good | Self::Usable | Self::Steady | Self::Skipped => false,
            Self::BrokenWire
            | Self::NotUsable
            | Self::NotReady
            | Self::NoEffect
            | Self::NoChange
            | Self::Elsewhere
            | Self::Inverted
            | Self::WrongScale
            | Self::NotHeld
            | Self::Refused => true,
        }
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct DeviceTally {
    pub name: String,
    pub address: String,
    pub identity: String, // text of the coupler about itself; empty without one
    pub verdict: Verdict,
    pub hindrance: String, // why it is not ready; empty if it is
    pub exchanges: u32,
    pub failures: u32,
    pub exchange_ms: [f64; 3], // durations of exchanges, ms: median, 99th percentile, greatest
    /// Time from the last write to the fallback, ms; `None` if it was not tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fallback_ms: Option<u64>,
}

#[derive(Clone, Debug, Serialize)]
pub struct InputTally {
    pub name: String,
    pub device: String,
    pub raw: [i64; 2], // least and greatest raw value
    /// Least and greatest value in the controller; `None` for a point of the workstation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counts: Option<[i64; 2]>,
    pub changes: u32,
    pub verdict: Verdict,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String, // what was observed, if that explains the verdict
}

#[derive(Clone, Debug, Serialize)]
pub struct OutputTally {
    pub name: String,
    pub device: String,
    pub changed: Vec<String>, // inputs that changed while it was on
    pub verdict: Verdict,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// A gripper with a part, before and after its connection was silent.
#[derive(Clone, Debug, Serialize)]
pub struct HoldTally {
    pub gripper: String,
    pub silent_s: u64,
    pub readings: Vec<HoldReading>,
    pub verdict: Verdict,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// Counts of a sensor of a gripper.
#[derive(Clone, Debug, Serialize)]
pub struct HoldReading {
    pub name: String,
    pub open: i64, // before the gripper closed
    pub held: i64,
    pub after: i64,
}

impl InputTally {
    /// The entry of an input with its first reading.
    pub fn new(name: &str, device: &str, reading: Reading, verdict: Verdict) -> Self {
        Self {
            name: name.to_owned(),
            device: device.to_owned(),
            raw: [reading.raw; 2],
            counts: reading.counts.map(|counts| [counts; 2]),
            changes: 0,
            verdict,
            note: String::new(),
        }
    }

    pub fn add(&mut self, Reading { raw, counts }: Reading) {
        let is_changed = raw != self.raw[1] && raw != self.raw[0];
        self.changes += u32::from(is_changed);
        self.raw = [self.raw[0].min(raw), self.raw[1].max(raw)];
        let widened = |([least, most], counts): ([i64; 2], i64)| [least.min(counts), most.max(counts)];
        self.counts = self.counts.zip(counts).map(widened);
    }

    /// Difference between its greatest and least value.
    pub fn noise(&self) -> i64 {
        let [least, most] = self.counts.unwrap_or(self.raw);
        most - least
    }

    /// Its verdict with the note.
    pub fn outcome(&self) -> String {
        format!("{}: {}{}", self.name, self.verdict.text(), after(&self.note))
    }
}

/// The result. The names of the fields are those of the JSON object.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Tally {
    pub mapping: String,
    pub devices: Vec<DeviceTally>,
    pub inputs: Vec<InputTally>,
    pub outputs: Vec<OutputTally>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold: Option<HoldTally>,
}

impl Tally {
    pub fn failure(&self) -> Option<String> {
        let devices = self.devices.iter().map(|device| (&device.name, device.verdict));
        let inputs = self.inputs.iter().map(|input| (&input.name, input.verdict));
        let outputs = self.outputs.iter().map(|output| (&output.name, output.verdict));
        let holds = self.hold.iter().map(|hold| (&hold.gripper, hold.verdict));
        let all = devices.chain(inputs).chain(outputs).chain(holds);
        let mut failed = all.filter(|(_, verdict)| verdict.is_failure());
        failed.next().map(|(name, verdict)| format!("{name}: {}", verdict.text()))
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for device in &self.devices {
            let [median, p99, most] = device.exchange_ms;
            writeln!(
                f,
                "{:<12} {:<22} {:<16} {}",
                device.name,
                device.address,
                device.identity,
                device.verdict.text()
            )?;
            if device.hindrance.is_empty() {
                writeln!(
                    f,
                    "             {} exchanges, {} failed; {median:.1} ms, p99 {p99:.1} ms, max {most:.1} ms",
                    device.exchanges, device.failures
                )?;
            } else {
                writeln!(f, "             {}", device.hindrance)?;
            }
            if let Some(ms) = device.fallback_ms {
                writeln!(f, "             the watchdog fired after {ms} ms")?;
            }
        }
        for InputTally { name, device, raw: [least, most], counts, changes, verdict, note } in &self.inputs {
            let counts =
                counts.map_or_else(String::new, |[least, most]| format!(" counts {least} to {most}"));
            writeln!(
                f,
                "{name:<26} {device:<10} raw {least} to {most}{counts}, {changes} changes  {}{}",
                verdict.text(),
                after(note)
            )?;
        }
        for OutputTally { name, device, changed, verdict, note } in &self.outputs {
            writeln!(f, "{name:<26} {device:<10} {}{}", verdict.text(), after(note))?;
            if !changed.is_empty() {
                writeln!(f, "             changed {}", changed.join(", "))?;
            }
        }
        if let Some(HoldTally { gripper, silent_s, readings, verdict, note }) = &self.hold {
            writeln!(
                f,
                "{gripper}: after {silent_s} s without exchanges: {}{}",
                verdict.text(),
                after(note)
            )?;
            for HoldReading { name, open, held, after } in readings {
                writeln!(f, "             {name}: open {open}, with the part {held}, after {after} counts")?;
            }
        }
        Ok(())
    }
}

/// A note after a verdict.
fn after(note: &str) -> String {
    if note.is_empty() { String::new() } else { format!("; {note}") }
}
