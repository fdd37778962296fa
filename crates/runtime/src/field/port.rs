//! Couplers over TCP in a run: their threads, their start and end, and measurements.

use std::{
    sync::{Arc, atomic::Ordering},
    thread,
    time::{Duration, Instant},
};

use closed_loop::{ClosedLoop, field::FieldController};
use couplers::{Fault, Refusal, Report, State};
use executive::{
    alloc::Section,
    clock::{Monotonic, Time as _},
    field::{Device, neighbour},
    histogram::{Histogram, Summary},
    realtime,
};
use field::Mapping;
use interfaces::DeviceInputs;

use crate::{boards::Controller, config::RunConfig, error::StartError, observer::Observer};

/// Added to the time of the watchdog. Until then a device may refuse its set-up, because the watchdog of an earlier run
/// may not have fired yet.
const REFUSED_FOR: Duration = Duration::from_secs(2);
/// Time within which outputs that nobody writes are read back again.
const READ_BACK: Duration = Duration::from_millis(1200);
const PAUSE: Duration = Duration::from_millis(10); // pause between two looks at devices that are not ready

pub struct FieldPort {
    mapping: Arc<Mapping>,
    devices: Vec<Device>,
    ages: Box<Histogram>,   // greatest age of the inputs of any device at a tick, ns
    shares: Box<Histogram>, // time of a tick for reading and writing, ns
    reading: u64,
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

impl FieldPort {
    /// Start the threads of the devices. They connect and set up watchdogs, and write no output. Errors:
    /// [`StartError::FieldDevice`]. A device that does not answer is not an error here.
    pub fn open(mapping: Mapping) -> Result<Self, StartError> {
        let open = |device: &field::Device| {
            let timeout = Duration::from_millis(device.timeout_ms.into());
            let prepare = || {
                // Without the permission it runs with ordinary priority, as the run's verdict on real time says.
                let _ = realtime::raise_priority(realtime::FIELD_PRIORITY);
            };
            Device::open(device.address, timeout, device.plan.clone(), prepare)
                .map_err(|source| StartError::FieldDevice { device: device.name.clone(), source })
        };
        let devices = mapping.devices.iter().map(open).collect::<Result<_, _>>()?;
        Ok(Self {
            mapping: Arc::new(mapping),
            devices,
            ages: Box::default(),
            shares: Box::default(),
            reading: 0,
        })
    }

    /// Waits for fresh inputs of all devices. A resumed run also waits until the watchdogs of the interrupted run have
    /// fired and the outputs were read back. Fails if a device refuses its set-up, or is not ready in time.
    pub fn gather(
        &mut self,
        config: &RunConfig,
        job: &str,
        observer: &mut dyn Observer,
    ) -> Result<FieldController, StartError> {
        let (started, limit) = (Instant::now(), Duration::from_secs(config.wait.into()));
        let mut refused_since: Vec<Option<Instant>> = vec![None; self.devices.len()];
        let mut said = Vec::new();
        loop {
            let now = nanoseconds(Monotonic.now());
            let reports: Vec<Report> = self.devices.iter_mut().map(|device| *device.report()).collect();
            let planned = self.mapping.devices.iter().enumerate();
            let hindrances = planned.zip(&reports).filter_map(|((index, _), report)| {
                hindrance(&self.mapping, index, report, now).map(|text| (index, text))
            });
            let hindrances: Vec<(usize, String)> = hindrances.collect();
            if hindrances.is_empty() && config.resume.is_some() && started.elapsed() < self.settling_time() {
                thread::sleep(PAUSE);
                continue;
            }
            if hindrances.is_empty() {
                self.warn_of_old_packets(observer);
                let mut desk = FieldController::new(Arc::clone(&self.mapping));
                desk.observe(now, reports.into_iter());
                desk.begin();
                return Ok(desk);
            }
            if config.stop.load(Ordering::Relaxed) {
                return Err(StartError::Interrupted(job.to_owned()));
            }
            let texts: Vec<String> = hindrances.into_iter().map(|(_, text)| text).collect();
            let is_final = self.mapping.devices.iter().zip(&reports).zip(&mut refused_since).any(
                |((device, report), since)| {
                    let Some(refusal) = report.refusal else {
                        *since = None;
                        return false;
                    };
                    let lasts = Duration::from_millis(device.plan.watchdog_ms.into()) + REFUSED_FOR;
                    let since = since.get_or_insert_with(Instant::now);
                    matches!(refusal, Refusal::Lengths(_)) || since.elapsed() >= lasts
                },
            );
            if is_final || started.elapsed() >= limit {
                return Err(StartError::FieldNotReady(texts));
            }
            if said != texts {
                observer.message(&format!("waiting for couplers: {}", texts.join("; ")));
                said = texts;
            }
            thread::sleep(PAUSE);
        }
    }

    /// The time after which the outputs that an interrupted run has left stay as they are.
    fn settling_time(&self) -> Duration {
        let times = self.mapping.devices.iter().filter(|device| device.plan.kind.facts().watchdog.is_some());
        let longest = times.map(|device| device.plan.watchdog_ms).max();
        longest.map_or(Duration::ZERO, |ms| Duration::from_millis(ms.into()) + READ_BACK)
    }

    fn warn_of_old_packets(&self, observer: &mut dyn Observer) {
        for device in &self.mapping.devices {
            let ip = device.address.ip();
            if matches!(neighbour::is_permanent(ip), Ok(Some(false))) {
                observer.message(&format!(
                    "{}: {ip} has no permanent entry in the table of neighbours, so this machine may deliver old \
                     outputs after a loss of its own link: `ip neighbour replace` adds one (docs/field.md)",
                    device.name
                ));
            }
        }
    }

    /// Align the exchanges with the slots of the run's clock: `start` is the time of slot 0, of `CLOCK_MONOTONIC`.
    pub fn align(&self, start: Duration) {
        self.devices.iter().for_each(|device| device.align(start));
    }

    /// Shortly before a tick, fetches the newest reports and everything that the tick needs into the caches.
    pub fn warm_up(&mut self, closed: &mut ClosedLoop<Controller>) {
        self.devices.iter_mut().for_each(Device::warm_up);
        if let Some(field) = closed.workstation.field.as_deref_mut() {
            field.desk_mut().warm_up();
        }
    }

    /// Before the controller's tick, sets its inputs from the newest reports. Does not wait or allocate.
    pub fn receive(&mut self, closed: &mut ClosedLoop<Controller>) {
        let _section = Section::enter();
        let now = nanoseconds(Monotonic.now());
        let mut oldest = 0;
        let reports = self.devices.iter_mut().map(|device| *device.report()).inspect(|report| {
            oldest = oldest.max(report.age(now).unwrap_or_default());
        });
        closed.observe_couplers(now, reports);
        self.ages.add(oldest);
        self.reading = nanoseconds(Monotonic.now()).saturating_sub(now);
    }

    /// After the controller's tick, passes its outputs to the devices. Does not wait or allocate.
    pub fn send(&mut self, closed: &mut ClosedLoop<Controller>) {
        let _section = Section::enter();
        let begun = nanoseconds(Monotonic.now());
        for (device, orders) in self.devices.iter_mut().zip(closed.coupler_orders()) {
            device.order(orders);
        }
        let writing = nanoseconds(Monotonic.now()).saturating_sub(begun);
        self.shares.add(self.reading.saturating_add(writing));
    }

    /// Ends all devices at once: writes the final outputs and reads them back. `inputs` are the controller's last.
    pub fn end(&mut self, desk: &mut FieldController, inputs: &DeviceInputs) {
        desk.end();
        for (device, orders) in self.devices.iter_mut().zip(desk.orders()) {
            device.order(orders);
        }
        for device in &mut self.devices {
            device.end();
        }
        let now = nanoseconds(Monotonic.now());
        desk.observe(now, self.devices.iter_mut().map(|device| *device.report()));
        desk.note_changes(inputs);
    }

    #[must_use]
    pub fn ages(&self) -> Summary {
        self.ages.summary()
    }

    #[must_use]
    pub fn shares(&self) -> Summary {
        self.shares.summary()
    }
}

/// Why a device is not ready at the time `now`, ns, as a sentence; `None` if it is.
#[must_use]
pub fn hindrance(mapping: &Mapping, index: usize, report: &Report, now: u64) -> Option<String> {
    let device = mapping.devices.get(index)?;
    let named = |text: String| Some(format!("{} at {}: {text}", device.name, device.address));
    match (report.state, report.refusal) {
        (_, Some(Refusal::OutputsOn)) => {
            let on: Vec<&str> =
                mapping.outputs_on(index, &report.acknowledged).map(|point| point.name.as_str()).collect();
            let names = if on.is_empty() { "outputs without a name".to_owned() } else { on.join(", ") };
            named(format!(
                "{names} on, which may not be on at rest: look at the device, then `rcs-run io-release`"
            ))
        }
        (_, Some(refusal)) => named(refusal.to_string()),
        (State::Running, None) if report.is_valid(now, device.plan.stale_ms) => None,
        (_, None) => named(match report.fault {
            Some(fault @ Fault::Exception(_)) => format!("{fault}; is its kind right?"),
            Some(fault) => fault.to_string(),
            None => "it has not answered yet".to_owned(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use couplers::OutWords;
    use rcs_core::Plain as _;

    use super::*;

    #[test]
    fn hindrance_names_device_address_and_outputs_that_are_on() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/field/station.toml"));
        let mapping = crate::field::read(path).unwrap();
        let arm = mapping.device("arm").unwrap();
        let mut report = Report::STARTING;
        let text = hindrance(&mapping, arm, &report, 0).unwrap();
        assert_eq!(text, "arm at 127.0.0.1:21502: it has not answered yet");
        report.fault = Some(Fault::NoConnection);
        let text = hindrance(&mapping, arm, &report, 0).unwrap();
        assert_eq!(text, "arm at 127.0.0.1:21502: it does not accept a connection");
        report.refusal = Some(Refusal::OutputsOn);
        report.acknowledged = OutWords::ZERO;
        report.acknowledged.words[0] = 1 << 5 | 1 << 7 | 1 << 11;
        let text = hindrance(&mapping, arm, &report, 0).unwrap();
        assert!(text.contains("grip.close-coarse, grip.supply on"), "tool.close may be on: {text}");
        (report.state, report.refusal, report.read_at) = (State::Running, None, Some(0));
        assert_eq!(hindrance(&mapping, arm, &report, 50_000_000), None);
        assert!(hindrance(&mapping, arm, &report, 500_000_000).is_some(), "the inputs are old");
    }
}
