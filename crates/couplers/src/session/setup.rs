//! Setting a device up, and recognizing one that was set up before.

use super::{MOST_GAP_MS, Session, Stop, refused};
use crate::{
    MS,
    kind::Watchdog,
    link::{Fault, Link},
    report::{Lengths, Mode, Orders, Refusal, RegisterFault, State, Trip},
};

impl Session {
    /// Sets the device up. Its outputs must be permitted, its images long enough, and its watchdog as planned.
    pub(super) fn set_up(&mut self, link: &mut impl Link, orders: &Orders) -> Result<(), Stop> {
        let watchdog = self.plan.kind.facts().watchdog.as_ref();
        let outputs = match (self.read_outputs(link), watchdog) {
            // Its watchdog has fired, so its outputs are safe.
            (Err(Fault::Exception(_)), Some(watchdog)) if watchdog.refuses_all => {
                self.reset_watchdog(link, watchdog)?;
                self.read_outputs(link)?
            }
            (outputs, _) => outputs?,
        };
        self.report.acknowledged = outputs;
        let is_at_rest = outputs.outside(&self.plan.rest).is_zero();
        if self.report.state == State::Starting && orders.mode != Mode::Safe && !is_at_rest {
            return Err(Stop::Refused(Refusal::OutputsOn));
        }
        self.check_lengths(link)?;
        match watchdog {
            Some(watchdog) => self.set_watchdog(link, watchdog),
            None => Ok(()),
        }
    }

    /// After a lost connection, checks that the device was not away too long and is as the session left it.
    pub(super) fn come_back(&mut self, link: &mut impl Link) -> Result<(), Stop> {
        if self.written_at.is_some() {
            self.check_gap(link.now())?;
            let outputs = self.read_outputs(link).map_err(refused)?;
            // The last image may have been carried out although its answer was lost.
            let left = self.report.acknowledged.words.iter().zip(&self.sent.words);
            if !outputs.words.iter().zip(left).all(|(found, (known, sent))| found == known || found == sent) {
                return Err(Stop::Trip(Trip::Outputs));
            }
        }
        for index in 0..self.kept_registers() {
            self.check_kept(link, index)?;
        }
        self.report.counters.returns = self.report.counters.returns.wrapping_add(1);
        Ok(())
    }

    /// Checks the time since the last write. After a long gap the watchdog has fired, or an operator must look.
    pub(super) fn check_gap(&self, now: u64) -> Result<(), Stop> {
        let limit = match self.plan.kind.facts().watchdog {
            Some(_) => u64::from(self.plan.watchdog_ms).min(MOST_GAP_MS),
            None => MOST_GAP_MS,
        };
        let gap = self.written_at.map_or(0, |written_at| now.saturating_sub(written_at) / MS);
        if gap < limit { Ok(()) } else { Err(Stop::Trip(Trip::Gap(u32::try_from(gap).unwrap_or(u32::MAX)))) }
    }

    /// Starts a watchdog that writing alone does not start.
    pub(super) fn start_watchdog(&mut self, link: &mut impl Link) -> Result<(), Fault> {
        let start = self.plan.kind.facts().watchdog.as_ref().and_then(|watchdog| watchdog.start);
        if let Some(register) = start.filter(|_| !self.is_started && !self.plan.writes.is_empty()) {
            let [value] = self.read_registers(link, register)?;
            self.write_register(link, register, if value == 1 { 2 } else { 1 })?;
            self.is_started = true;
        }
        Ok(())
    }

    /// Number of registers that keep the value that the session left in them.
    pub(super) fn kept_registers(&self) -> usize {
        let count = |watchdog: &Watchdog| {
            let others = [watchdog.running, watchdog.count];
            watchdog.settings.len() + others.iter().flatten().count()
        };
        self.plan.kind.facts().watchdog.as_ref().map_or(0, count)
    }

    /// Reads one of the [`Self::kept_registers`]. Trips if its value has changed.
    pub(super) fn check_kept(&mut self, link: &mut impl Link, index: usize) -> Result<(), Stop> {
        let Some(watchdog) = &self.plan.kind.facts().watchdog else { return Ok(()) };
        let settings = watchdog.settings(self.plan.watchdog_ms, self.plan.fallback);
        let running = watchdog.running.map(|register| (register, u16::from(self.is_started)));
        let count = watchdog.count.map(|register| (register, self.fallbacks));
        let kept = settings.chain(running).chain(count).nth(index);
        let Some((register, expected)) = kept else { return Ok(()) };
        let [found] = self.read_registers(link, register).map_err(refused)?;
        if found == expected { Ok(()) } else { Err(Stop::Trip(Trip::Settings)) }
    }

    fn check_lengths(&mut self, link: &mut impl Link) -> Result<(), Stop> {
        let Some(register) = self.plan.kind.facts().lengths else { return Ok(()) };
        let [analog_out, analog_in, digital_out, digital_in] = self.read_registers(link, register)?;
        let bits = |analog: u16, digital: u16| u32::from(analog) + u32::from(digital);
        let lengths = Lengths {
            inputs_expected: self.plan.input_bits(),
            inputs_found: bits(analog_in, digital_in),
            outputs_expected: self.plan.output_bits(),
            outputs_found: bits(analog_out, digital_out),
        };
        if lengths.inputs_expected > lengths.inputs_found || lengths.outputs_expected > lengths.outputs_found
        {
            return Err(Stop::Refused(Refusal::Lengths(lengths)));
        }
        Ok(())
    }

    fn reset_watchdog(&mut self, link: &mut impl Link, watchdog: &Watchdog) -> Result<(), Fault> {
        self.is_started = false;
        for (register, value) in watchdog.reset {
            self.write_register(link, *register, *value)?;
        }
        Ok(())
    }

    /// Resets the watchdog, and sets its time and the other settings.
    fn set_watchdog(&mut self, link: &mut impl Link, watchdog: &Watchdog) -> Result<(), Stop> {
        if let (State::Starting, Some(address)) = (self.report.state, watchdog.running) {
            // The reset would stop the watchdog of an earlier run, or of another controller.
            let [found] = self.read_registers(link, address)?;
            if found == 1 {
                return Err(register_refused(address, 0, found));
            }
        }
        // A watchdog that fired in an earlier run refuses outputs and settings until it is reset.
        self.reset_watchdog(link, watchdog)?;
        for (register, expected) in watchdog.settings(self.plan.watchdog_ms, self.plan.fallback) {
            let [mut found] = self.read_registers(link, register)?;
            if found != expected {
                match self.write_register(link, register, expected) {
                    // The coupler refuses this while an earlier run's watchdog is active; the value read back decides.
                    Ok(()) | Err(Fault::Exception(_)) => {}
                    Err(fault) => return Err(Stop::Fault(fault)),
                }
                [found] = self.read_registers(link, register)?;
            }
            if found != expected {
                return Err(register_refused(register, expected, found));
            }
        }
        if let Some(register) = watchdog.count {
            [self.fallbacks] = self.read_registers(link, register)?;
        }
        Ok(())
    }
}

const fn register_refused(address: u16, expected: u16, found: u16) -> Stop {
    Stop::Refused(Refusal::Register(RegisterFault { address, expected, found }))
}
