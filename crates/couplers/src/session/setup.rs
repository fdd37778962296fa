//! Setting a device up, and recognizing one that was set up before.

use super::{MOST_GAP_MS, Session, Stop};
use crate::{
    MS,
    kind::{Kind, bk9000},
    link::{Fault, Link},
    plan::{Area, Span},
    report::{Lengths, Mode, Orders, Refusal, RegisterFault, State, Trip},
};

impl Session {
    /// Sets the device up. Its outputs must be permitted, its images long enough, and its watchdog as planned.
    pub(super) fn set_up(&mut self, link: &mut impl Link, orders: &Orders) -> Result<(), Stop> {
        let outputs = self.read_outputs(link)?;
        self.report.acknowledged = outputs;
        let is_at_rest = outputs.outside(&self.plan.rest).is_zero();
        if self.report.state == State::Starting && orders.mode != Mode::Safe && !is_at_rest {
            return Err(Stop::Refused(Refusal::OutputsOn));
        }
        match self.plan.kind {
            Kind::Bk9000 => self.set_up_bk9000(link),
            Kind::Plain => Ok(()),
        }
    }

    /// After a lost connection, checks that the device was not away too long and is as the session left it.
    pub(super) fn come_back(&mut self, link: &mut impl Link) -> Result<(), Stop> {
        if self.written_at.is_some() {
            let outputs = self.read_outputs(link)?;
            self.check_gap(link.now())?;
            // The last image may have been carried out although its answer was lost.
            let left = self.report.acknowledged.words.iter().zip(&self.sent.words);
            if !outputs.words.iter().zip(left).all(|(found, (known, sent))| found == known || found == sent) {
                return Err(Stop::Trip(Trip::Outputs));
            }
        }
        if !self.is_set_up(link)? {
            return Err(Stop::Trip(Trip::Settings));
        }
        self.report.counters.returns = self.report.counters.returns.wrapping_add(1);
        Ok(())
    }

    /// Checks the time since the last write. After a long gap the watchdog has fired, or an operator must look.
    pub(super) fn check_gap(&self, now: u64) -> Result<(), Stop> {
        let limit = match self.plan.kind.facts().watchdog_ms {
            Some(_) => u64::from(self.plan.watchdog_ms).min(MOST_GAP_MS),
            None => MOST_GAP_MS,
        };
        let gap = self.written_at.map_or(0, |written_at| now.saturating_sub(written_at) / MS);
        if gap < limit { Ok(()) } else { Err(Stop::Trip(Trip::Gap(u32::try_from(gap).unwrap_or(u32::MAX)))) }
    }

    /// True if the settings of the device are those of the plan.
    pub(super) fn is_set_up(&mut self, link: &mut impl Link) -> Result<bool, Fault> {
        match self.plan.kind {
            Kind::Bk9000 => {
                let settings = self.bk9000_settings(link)?;
                Ok(settings.iter().all(|setting| setting.found == setting.expected))
            }
            Kind::Plain => Ok(true),
        }
    }

    /// The status of the device's terminals; `None` if the kind has none.
    pub(super) fn read_status(&mut self, link: &mut impl Link) -> Result<Option<u16>, Fault> {
        match self.plan.kind {
            Kind::Bk9000 => {
                let [status] = self.read_registers(link, bk9000::STATUS)?;
                Ok(Some(status))
            }
            Kind::Plain => Ok(None),
        }
    }

    fn set_up_bk9000(&mut self, link: &mut impl Link) -> Result<(), Stop> {
        let [analog_out, analog_in, digital_out, digital_in] = self.read_registers(link, bk9000::LENGTHS)?;
        let bits = |analog: u16, digital: u16| u32::from(analog) + u32::from(digital);
        let lengths = Lengths {
            inputs_expected: needed(&self.plan.reads, 0),
            inputs_found: bits(analog_in, digital_in),
            outputs_expected: needed(&self.plan.writes, *self.plan.kind.facts().outputs.start()),
            outputs_found: bits(analog_out, digital_out),
        };
        if lengths.inputs_expected > lengths.inputs_found || lengths.outputs_expected > lengths.outputs_found
        {
            return Err(Stop::Refused(Refusal::Lengths(lengths)));
        }
        // A device whose watchdog fired in an earlier run refuses outputs and settings until the watchdog is reset.
        for word in bk9000::RESET {
            self.write_register(link, bk9000::WATCHDOG_RESET, word)?;
        }
        for setting in self.bk9000_settings(link)? {
            if setting.found == setting.expected {
                continue;
            }
            match self.write_register(link, setting.address, setting.expected) {
                // The coupler refuses this while an earlier run's watchdog is active, so the value read back decides.
                Ok(()) | Err(Fault::Exception(_)) => {}
                Err(fault) => return Err(Stop::Fault(fault)),
            }
        }
        match self.bk9000_settings(link)?.into_iter().find(|setting| setting.found != setting.expected) {
            Some(setting) => Err(Stop::Refused(Refusal::Register(setting))),
            None => Ok(()),
        }
    }

    /// Time and type of the watchdog, as found and as planned.
    fn bk9000_settings(&mut self, link: &mut impl Link) -> Result<[RegisterFault; 2], Fault> {
        let [time, _, kind] = self.read_registers(link, bk9000::WATCHDOG_MS)?;
        Ok([
            RegisterFault { address: bk9000::WATCHDOG_MS, expected: self.plan.watchdog_ms, found: time },
            RegisterFault { address: bk9000::WATCHDOG_TYPE, expected: bk9000::WRITE_TELEGRAMS, found: kind },
        ])
    }
}

/// Number of bits from the beginning of the process data to the end of the last span in them.
fn needed(spans: &[Span], start: u16) -> u32 {
    let end = |span: &Span| {
        let offset =
            if matches!(span.area, Area::Coil | Area::Discrete) { span.first } else { span.first - start };
        let bits = if span.area.has_bits() { 1 } else { 16 };
        (u32::from(offset) + u32::from(span.count)) * bits
    };
    spans.iter().map(end).max().unwrap_or(0)
}
