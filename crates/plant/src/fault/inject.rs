//! The injector: begins and ends the faults of a plan, and changes the data between cell and controller.
//!
//! Each fault has its own stream of random numbers, so that the faults of one device do not depend on the
//! others. Its state is plain data, so a restored cell continues with its faults.

use interfaces::{
    device::{DeviceInputs, DeviceOutputs},
    point::Input,
};
use rcs_core::tick::TICK_S;
use serde::{Deserialize, Serialize};

use super::{
    DeliveryFault, Disorder, Fault, FaultPlan, FaultSubject,
    valve::{cut_air, hold_ring},
};
use crate::{description::CellDescription, noise::Noise, sensor::DelayLine};

/// First random stream of faults; devices use lower ones ([`crate::noise::Stream`]).
const STREAMS: u64 = 1000;
/// Mixes the seed of the plan with that of the run: 2^64 divided by the golden ratio.
const MIX: u64 = 0x9E37_79B9_7F4A_7C15;

#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Injector {
    tick: u64,
    faults: Vec<Running>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
struct Running {
    fault: Fault,
    noise: Noise,
    active: bool,
    began: u64,          // the tick in which it began
    until: u64,          // the first tick after its end, if it has a rate
    caught: Option<i64>, // the value at which a sensor is stuck
    late: DelayLine,     // words in the delay line of a sensor
    times: u64,
    first: u64,
    last: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct FaultResult {
    /// Its number in the file, from 1.
    pub number: usize,
    pub text: String,
    pub times: u64,
    pub first: u64, // the tick in which it first began
    pub last: u64,  // the last tick in which it was present
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Delivery {
    pub missing: bool,
    pub instead: Option<String>,
    pub aside: [f64; 2], // offset from its place along world X and Y, in
    pub angle: f64,      // rotation about the tool's X, degrees
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Change {
    pub number: usize,
    pub text: String,
    pub begins: bool,
}

impl Injector {
    /// The faults of a plan before the first tick; the seed of the run is combined with that of the plan.
    #[must_use]
    pub fn new(plan: &FaultPlan, seed: u64) -> Self {
        let mut injector = Self::default();
        injector.push(plan.faults.iter(), plan.seed, seed);
        injector
    }

    /// Add the faults of another plan, except initial displacements.
    pub(crate) fn add(&mut self, plan: &FaultPlan, seed: u64) {
        let stays = |fault: &&Fault| !matches!(fault.what, FaultSubject::PedestalMoved { .. });
        self.push(plan.faults.iter().filter(stays), plan.seed, seed);
    }

    pub(crate) fn forget_past(&mut self) {
        let next = self.tick + 1;
        self.faults.retain(|running| running.active || running.fault.when.until > next);
    }

    fn push<'f>(&mut self, faults: impl Iterator<Item = &'f Fault>, of_plan: u64, of_run: u64) {
        let seed = of_run ^ of_plan.wrapping_mul(MIX);
        let first = STREAMS + self.faults.len() as u64;
        self.faults.extend((first..).zip(faults).map(|(stream, fault)| Running {
            fault: fault.clone(),
            noise: Noise::numbered(seed, stream),
            active: false,
            began: 0,
            until: 0,
            caught: None,
            late: DelayLine::default(),
            times: 0,
            first: 0,
            last: 0,
        }));
    }

    pub(crate) fn turn(&mut self) -> Vec<Change> {
        let tick = self.tick;
        self.faults.iter_mut().filter_map(|running| running.turn(tick)).collect()
    }

    /// Advance to the next tick. Returns the faults that begin or end in it.
    pub(crate) fn next(&mut self) -> Vec<Change> {
        self.tick += 1;
        self.turn()
    }

    fn active(&self) -> impl Iterator<Item = &FaultSubject> {
        self.faults.iter().filter(|running| running.active).map(|running| &running.fault.what)
    }

    #[must_use]
    pub fn outputs(&self, outputs: &DeviceOutputs) -> DeviceOutputs {
        let mut arrives = *outputs;
        for what in self.active() {
            match what {
                FaultSubject::Valve(valve, open) => valve.write(&mut arrives, i64::from(*open)),
                FaultSubject::RingStuck => hold_ring(&mut arrives),
                _ => {}
            }
        }
        // Without air supply, a valve that is stuck open passes no air.
        if self.air_lost() {
            cut_air(&mut arrives);
        }
        arrives
    }

    pub fn inputs(&mut self, inputs: &mut DeviceInputs) {
        let tick = self.tick;
        for running in self.faults.iter_mut().filter(|running| running.active) {
            if let FaultSubject::Sensor(sensor, disorder) = running.fault.what {
                running.disturb(sensor, disorder, tick, inputs);
            }
        }
    }

    /// Apply the faults to the answer of a vision system that arrives after the sensor words.
    pub(crate) fn vision(&mut self, inputs: &mut DeviceInputs) {
        let tick = self.tick;
        for running in self.faults.iter_mut().filter(|running| running.active) {
            if let FaultSubject::Sensor(sensor, disorder) = running.fault.what
                && sensor.is_camera()
            {
                running.disturb(sensor, disorder, tick, inputs);
            }
        }
    }

    #[must_use]
    pub fn air_lost(&self) -> bool {
        self.active().any(|what| *what == FaultSubject::AirLost)
    }

    #[must_use]
    pub fn hydraulics_lost(&self) -> bool {
        self.active().any(|what| *what == FaultSubject::HydraulicsLost)
    }

    #[must_use]
    pub fn jaw_stuck(&self) -> bool {
        self.active().any(|what| *what == FaultSubject::JawStuck)
    }

    #[must_use]
    pub fn camera_blind(&self) -> bool {
        self.active().any(|what| *what == FaultSubject::CameraBlind)
    }

    #[must_use]
    pub fn is_device_cut(&self, device: &str) -> bool {
        self.active().any(|what| matches!(what, FaultSubject::FieldCut(cut) if cut == device))
    }

    /// Errors of the delivery of a part, and the faults that begin or end with it.
    pub(crate) fn delivery(&mut self, part: &str) -> (Delivery, Vec<Change>) {
        let tick = self.tick;
        let mut delivery = Delivery::default();
        let mut changes = Vec::new();
        for running in &mut self.faults {
            let FaultSubject::Delivery(object, mishap) = &running.fault.what else { continue };
            let meant = object.as_deref().is_none_or(|object| object == part);
            if !meant
                || !running.fault.when.covers(tick)
                || !happens(running.fault.when.rate, &mut running.noise)
            {
                continue;
            }
            match mishap {
                DeliveryFault::Missing => delivery.missing = true,
                DeliveryFault::Misplaced { x, y } => {
                    delivery.aside = [delivery.aside[0] + x, delivery.aside[1] + y];
                }
                DeliveryFault::Turned(angle) => delivery.angle += angle,
                DeliveryFault::WrongPart(other) => delivery.instead = Some(other.clone()),
            }
            changes.push(running.note(tick, true));
            running.last = tick;
        }
        (delivery, changes)
    }

    #[must_use]
    pub fn displaced(&self, description: &CellDescription) -> CellDescription {
        super::displaced(self.faults.iter().map(|running| &running.fault), description)
    }

    /// The faults that have happened so far, in the order of the file.
    #[must_use]
    pub fn struck(&self) -> Vec<FaultResult> {
        let struck = self.faults.iter().filter(|running| running.times > 0);
        let told = struck.map(|running| FaultResult {
            number: running.fault.number,
            text: running.fault.what.to_string(),
            times: running.times,
            first: running.first,
            last: running.last,
        });
        told.collect()
    }
}

/// True if a fault with a rate happens, or has no rate. It draws a number only for a rate.
fn happens(rate: Option<f64>, noise: &mut Noise) -> bool {
    rate.is_none_or(|rate| (noise.within(1.0) + 1.0) / 2.0 < rate)
}

impl Running {
    fn turn(&mut self, tick: u64) -> Option<Change> {
        if self.fault.what.is_delivery() {
            return None;
        }
        let when = self.fault.when;
        let inside = when.covers(tick);
        let active = match when.rate {
            None => inside,
            Some(_) if self.active && tick < self.until => true,
            Some(_) => inside && happens(when.rate, &mut self.noise),
        };
        let begins = active && !self.active;
        let again = active && self.active && when.rate.is_some() && tick >= self.until;
        if begins || again {
            self.until = tick.saturating_add(when.ticks);
        }
        if active {
            self.last = tick;
        }
        if active == self.active {
            return None;
        }
        self.active = active;
        (self.caught, self.began) = (None, tick);
        self.late.clear();
        Some(self.note(tick, begins))
    }

    fn note(&mut self, tick: u64, begins: bool) -> Change {
        if begins {
            self.first = if self.times == 0 { tick } else { self.first };
            self.times += 1;
        }
        Change { number: self.fault.number, text: self.fault.what.to_string(), begins }
    }

    fn disturb(&mut self, sensor: Input, disorder: Disorder, tick: u64, inputs: &mut DeviceInputs) {
        let shown = sensor.read(inputs);
        let counts = |by: f64| libm::round(by) as i64;
        let value = match disorder {
            Disorder::Off => 0,
            Disorder::Stuck(Some(value)) => value,
            Disorder::Stuck(None) => *self.caught.get_or_insert(shown),
            Disorder::Noisy(by) => shown + counts(self.noise.within(by)),
            Disorder::Slow(ticks) => self.late.pass(shown, ticks),
            Disorder::Offset(by) => shown + counts(by),
            Disorder::Drift(by) => shown + counts(by * (tick - self.began) as f64 * TICK_S),
        };
        sensor.write(inputs, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::When;
    use interfaces::point::Output;

    fn injector(whats: Vec<(FaultSubject, When)>) -> Injector {
        let faults = whats.into_iter().enumerate();
        let faults = faults.map(|(index, (what, when))| Fault { number: index + 1, what, when }).collect();
        Injector::new(&FaultPlan { seed: 1, faults }, 1)
    }

    fn sensor(name: &str, disorder: Disorder) -> FaultSubject {
        FaultSubject::Sensor(Input::named(name).unwrap(), disorder)
    }

    /// The values shown, from tick 1, for a word that counts up by 10 every tick.
    fn shown(disorder: Disorder, when: When, ticks: u16) -> Vec<i64> {
        let what = sensor("grip.potentiometer", disorder);
        let mut injector = injector(vec![(what, when)]);
        let word = Input::named("grip.potentiometer").unwrap();
        (1..=ticks)
            .map(|tick| {
                injector.next();
                let mut inputs = DeviceInputs::default();
                inputs.grip.potentiometer = 1000 + 10 * tick;
                injector.inputs(&mut inputs);
                word.read(&inputs)
            })
            .collect()
    }

    const FROM_3_TO_6: When = When { from: 3, until: 6, rate: None, ticks: 1 };

    #[test]
    fn every_fault_acts_only_in_its_window() {
        for (disorder, expected) in [
            (Disorder::Off, [1010, 1020, 0, 0, 0, 1060]),
            (Disorder::Stuck(None), [1010, 1020, 1030, 1030, 1030, 1060]),
            (Disorder::Stuck(Some(7)), [1010, 1020, 7, 7, 7, 1060]),
            (Disorder::Slow(1), [1010, 1020, 1030, 1030, 1040, 1060]),
            (Disorder::Offset(-30.0), [1010, 1020, 1000, 1010, 1020, 1060]),
            (Disorder::Drift(100.0), [1010, 1020, 1030, 1044, 1058, 1060]),
            (Disorder::Offset(9999.0), [1010, 1020, 4095, 4095, 4095, 1060]),
        ] {
            assert_eq!(shown(disorder, FROM_3_TO_6, 6), expected, "{disorder}");
        }
        let noisy = shown(Disorder::Noisy(5.0), When::ALWAYS, 200);
        let away: Vec<i64> = noisy.iter().zip(1..).map(|(shown, tick)| shown - 1000 - 10 * tick).collect();
        assert!(away.iter().all(|away| away.abs() <= 5) && away.iter().any(|away| away.abs() >= 4));
    }

    #[test]
    fn rate_starts_a_fault_at_random_for_its_ticks() {
        let when = When { from: 0, until: u64::MAX, rate: Some(0.05), ticks: 4 };
        let mut injector = injector(vec![(sensor("beam.1", Disorder::Off), when)]);
        let (mut begun, mut active) = (0, 0);
        for _ in 0..10_000 {
            begun += injector.next().iter().filter(|change| change.begins).count();
            active += u32::from(injector.faults[0].active);
        }
        // A chance of 1 in 20 per tick, and 4 ticks each: a sixth of the time.
        assert!((1450..2050).contains(&active), "{active} of 10,000 ticks");
        assert!((330..500).contains(&begun), "{begun} times");
        let [struck] = &injector.struck()[..] else { panic!("one fault") };
        assert_eq!((struck.number, struck.times, struck.text.as_str()), (1, begun as u64, "beam.1 is off"));
    }

    #[test]
    fn equal_seeds_give_equal_fault_plans() {
        let run = |seed, plan_seed| {
            let when = When { rate: Some(0.1), ..When::ALWAYS };
            let fault = Fault { number: 1, what: sensor("beam.1", Disorder::Off), when };
            let mut injector = Injector::new(&FaultPlan { seed: plan_seed, faults: vec![fault] }, seed);
            (0..200).map(|_| injector.next().len()).collect::<Vec<_>>()
        };
        assert_eq!(run(1, 1), run(1, 1));
        assert_ne!(run(1, 1), run(2, 1));
        assert_ne!(run(1, 1), run(1, 2));
    }

    #[test]
    fn stuck_valves_pass_no_air() {
        let open = FaultSubject::Valve(Output::named("grip.open-fine").unwrap(), true);
        let late = When { from: 2, ..When::ALWAYS };
        let mut injector = injector(vec![(open, When::ALWAYS), (FaultSubject::AirLost, late)]);
        injector.next();
        assert_eq!(injector.outputs(&DeviceOutputs::default()).grip.bits, 1);
        injector.next();
        assert_eq!(injector.outputs(&DeviceOutputs::default()).grip.bits, 0);
    }

    #[test]
    fn delivery_fault_applies_to_its_delivery() {
        let bar = || Some("BAR".to_owned());
        let late = When { from: 10, ..When::ALWAYS };
        let mut injector = injector(vec![
            (FaultSubject::Delivery(bar(), DeliveryFault::Misplaced { x: 0.5, y: -1.0 }), When::ALWAYS),
            (FaultSubject::Delivery(None, DeliveryFault::Turned(30.0)), When::ALWAYS),
            (FaultSubject::Delivery(None, DeliveryFault::Missing), late),
        ]);
        let (delivery, changes) = injector.delivery("BAR");
        let expected = Delivery { missing: false, instead: None, aside: [0.5, -1.0], angle: 30.0 };
        assert_eq!((delivery, changes.len()), (expected, 2));
        let (other, _) = injector.delivery("OTHER");
        assert_eq!(other, Delivery { angle: 30.0, ..Delivery::default() });
        (0..10).for_each(|_| drop(injector.next()));
        assert!(injector.delivery("OTHER").0.missing);
        assert_eq!(injector.struck().iter().map(|struck| struck.times).collect::<Vec<_>>(), [1, 3, 1]);
    }
}
