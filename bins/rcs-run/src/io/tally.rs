//! The result of a test of couplers: a verdict per device, input, output and watchdog.

use std::fmt;

use serde::Serialize;

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
    Skipped,    // an output or a watchdog that was not tested
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
            Self::Skipped => "skipped",
        }
    }

    const fn is_failure(self) -> bool {
        matches!(self, Self::BrokenWire | Self::NotUsable | Self::NotReady | Self::NoEffect)
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
}

#[derive(Clone, Debug, Serialize)]
pub struct OutputTally {
    pub name: String,
    pub device: String,
    pub verdict: Verdict,
}

/// The result. The names of the fields are those of the JSON object.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Tally {
    pub mapping: String,
    pub devices: Vec<DeviceTally>,
    pub inputs: Vec<InputTally>,
    pub outputs: Vec<OutputTally>,
}

impl Tally {
    pub fn failure(&self) -> Option<String> {
        let devices = self.devices.iter().map(|device| (&device.name, device.verdict));
        let inputs = self.inputs.iter().map(|input| (&input.name, input.verdict));
        let outputs = self.outputs.iter().map(|output| (&output.name, output.verdict));
        let mut failed = devices.chain(inputs).chain(outputs).filter(|(_, verdict)| verdict.is_failure());
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
        for InputTally { name, device, raw: [least, most], counts, changes, verdict } in &self.inputs {
            let counts =
                counts.map_or_else(String::new, |[least, most]| format!(" counts {least} to {most}"));
            writeln!(
                f,
                "{name:<26} {device:<10} raw {least} to {most}{counts}, {changes} changes  {}",
                verdict.text()
            )?;
        }
        for OutputTally { name, device, verdict } in &self.outputs {
            writeln!(f, "{name:<26} {device:<10} {}", verdict.text())?;
        }
        Ok(())
    }
}
