//! Description of a device for its session: registers, safe values, time limits.

use std::ops::RangeInclusive;

use rcs_core::Plain;

use crate::kind::{Facts, Fallback, Kind};

/// Greatest number of words of an input image: one request reads them (function 23).
pub const MOST_IN: usize = 125;
/// Greatest number of words of an output image: one request writes them (function 23).
pub const MOST_OUT: usize = 121;

/// Words of all spans of a direction, one after the other. Bits are packed 16 per word, the first one lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct InWords {
    /// The words.
    pub words: [u16; MOST_IN],
}

/// Words of all spans of outputs, in the form of [`InWords`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct OutWords {
    /// The words.
    pub words: [u16; MOST_OUT],
}

impl OutWords {
    /// Combines two images word by word.
    #[must_use]
    pub fn with(&self, other: &Self, combine: impl Fn(u16, u16) -> u16) -> Self {
        Self { words: std::array::from_fn(|index| combine(self.words[index], other.words[index])) }
    }

    /// The bits that are on here and off in `mask`.
    #[must_use]
    pub fn outside(&self, mask: &Self) -> Self {
        self.with(mask, |word, mask| word & !mask)
    }

    /// True if no bit is on.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        *self == Self::ZERO
    }
}

/// One of the four tables of a Modbus device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Area {
    /// Outputs of one bit.
    Coil,
    /// Inputs of one bit.
    Discrete,
    /// Input registers.
    Input,
    /// Registers that can be written.
    Holding,
}

impl Area {
    /// True for tables of bits.
    #[must_use]
    pub const fn has_bits(self) -> bool {
        matches!(self, Self::Coil | Self::Discrete)
    }

    /// True for tables that can be written.
    #[must_use]
    pub const fn is_writable(self) -> bool {
        matches!(self, Self::Coil | Self::Holding)
    }
}

/// Consecutive registers, or bits for [`Area::Coil`] and [`Area::Discrete`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Span {
    /// The table.
    pub area: Area,
    /// First address.
    pub first: u16,
    /// Number of addresses.
    pub count: u16,
}

impl Span {
    /// Number of words of the image.
    #[must_use]
    pub const fn words(&self) -> usize {
        let count = self.count as usize;
        if self.area.has_bits() { count.div_ceil(16) } else { count }
    }
}

/// Description of a device for its session.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub unit: u8,
    pub kind: Kind,
    /// Behaviour of the outputs when the watchdog fires.
    pub fallback: Fallback,
    /// Time of the watchdog, ms; not used without one. A [`Kind::Values`] has it set by hand.
    pub watchdog_ms: u16,
    /// Age at which inputs are stale, ms: the minimum over all points.
    pub stale_ms: u16,
    /// Spans to read; the input image consists of them.
    pub reads: Vec<Span>,
    /// Spans to write; the output image consists of them.
    pub writes: Vec<Span>,
    pub safe: OutWords,
    /// Bits of outputs that may be on while nothing moves.
    pub rest: OutWords,
    /// A register that the device's program increments; `None` without one.
    pub alive: Option<Span>,
}

/// Why a session cannot follow a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// An image has too many words, or too many bits for a request.
    #[error("{found} words in an image, at most {most} were expected")]
    TooLong { most: usize, found: usize },
    /// A span of outputs cannot be written.
    #[error("outputs are coils or holding registers, found {found}")]
    NotWritable { found: Area },
    /// A span is empty, or ends beyond 65535.
    #[error("{count} addresses from {first:#06x}: between 1 and the last address 0xffff were expected")]
    BadSpan { first: u16, count: u16 },
    /// Addresses are not process data of the kind.
    #[error("addresses {first:#06x} to {last:#06x} are not {direction} of kind {kind}")]
    NotProcessData {
        kind: Kind,
        /// `inputs`, `outputs` or `coils`.
        direction: &'static str,
        first: u16,
        last: u16,
    },
    /// Nothing is read, so that the device could be lost without notice.
    #[error("a device needs at least one input")]
    NoInputs,
    /// The kind cannot fall back in this way.
    #[error("kind {kind} cannot fall back to {fallback}")]
    NoFallback { kind: Kind, fallback: Fallback },
    /// The watchdog time is out of range, or not longer than the age at which data are stale.
    #[error("a watchdog of {found} ms, expected at least {least} ms")]
    BadWatchdog {
        /// Least time, ms.
        least: u16,
        /// Time found, ms.
        found: u16,
    },
    /// The device cannot be set to this time.
    #[error("a watchdog of {found} ms, expected a multiple of {step} ms")]
    UnevenWatchdog {
        /// Step of the times, ms.
        step: u16,
        /// Time found, ms.
        found: u16,
    },
    /// The kind refuses a request of this length.
    #[error(
        "{found} {what} in one request, and kind {kind} accepts at most {most}: use addresses closer together"
    )]
    LongRequest {
        kind: Kind,
        /// `output registers` or `coils`.
        what: &'static str,
        most: u16,
        found: u16,
    },
    /// The safe image differs from the outputs after the fallback.
    #[error("safe values differ from the outputs after the fallback {fallback}")]
    UnsafeFallback {
        /// Behaviour of the outputs when the watchdog fires.
        fallback: Fallback,
    },
    /// A device without a fallback has an output that may not be on at rest.
    #[error("without a fallback, all outputs must be permitted at rest")]
    NotAtRest,
}

fn check_process_data(
    kind: Kind,
    span: &Span,
    direction: &'static str,
    addresses: &RangeInclusive<u16>,
) -> Result<(), PlanError> {
    let (first, last) = (span.first, span.first.saturating_add(span.count - 1));
    if addresses.contains(&first) && addresses.contains(&last) {
        Ok(())
    } else {
        Err(PlanError::NotProcessData { kind, direction, first, last })
    }
}

/// Number of bits from the beginning of the process data to the end of the last span in them.
fn needed(spans: &[Span], first_register: u16, first_coil: u16) -> u32 {
    let end = |span: &Span| {
        let (start, bits) = match span.area {
            Area::Coil => (first_coil, 1),
            Area::Discrete => (0, 1),
            Area::Input | Area::Holding => (first_register, 16),
        };
        (u32::from(span.first.saturating_sub(start)) + u32::from(span.count)) * bits
    };
    spans.iter().map(end).max().unwrap_or(0)
}

impl Plan {
    /// Checks the plan.
    ///
    /// # Errors
    /// [`PlanError`], the first one found.
    pub fn check(&self) -> Result<(), PlanError> {
        if self.reads.is_empty() {
            return Err(PlanError::NoInputs);
        }
        for (spans, most) in [(&self.reads, MOST_IN), (&self.writes, MOST_OUT)] {
            let found = spans.iter().map(Span::words).sum();
            if found > most {
                return Err(PlanError::TooLong { most, found });
            }
        }
        for &Span { first, count, .. } in self.reads.iter().chain(&self.writes).chain(&self.alive) {
            if count == 0 || first.checked_add(count - 1).is_none() {
                return Err(PlanError::BadSpan { first, count });
            }
        }
        if let Some(span) = self.writes.iter().find(|span| !span.area.is_writable()) {
            return Err(PlanError::NotWritable { found: span.area });
        }
        let facts = self.kind.facts();
        for span in self.reads.iter().filter(|span| !span.area.has_bits()) {
            check_process_data(self.kind, span, "inputs", &facts.inputs)?;
        }
        for span in &self.writes {
            self.check_written(span, facts)?;
        }
        self.check_fallback(facts)
    }

    fn check_written(&self, span: &Span, facts: &Facts) -> Result<(), PlanError> {
        let (addresses, most, direction, what) = if span.area.has_bits() {
            (&facts.coils, facts.most_written.1, "coils", "coils")
        } else {
            (&facts.outputs, facts.most_written.0, "outputs", "output registers")
        };
        check_process_data(self.kind, span, direction, addresses)?;
        if span.count > most {
            return Err(PlanError::LongRequest { kind: self.kind, what, most, found: span.count });
        }
        Ok(())
    }

    fn check_fallback(&self, facts: &Facts) -> Result<(), PlanError> {
        let (kind, fallback) = (self.kind, self.fallback);
        if !facts.fallbacks.contains(&fallback) {
            return Err(PlanError::NoFallback { kind, fallback });
        }
        if let Some(watchdog) = &facts.watchdog {
            let (found, step) = (self.watchdog_ms, watchdog.step_ms);
            let least = *watchdog.times_ms.start().max(&self.stale_ms.saturating_add(1));
            if !(least..=*watchdog.times_ms.end()).contains(&found) {
                return Err(PlanError::BadWatchdog { least, found });
            }
            if found % step != 0 {
                return Err(PlanError::UnevenWatchdog { step, found });
            }
        }
        if fallback == Fallback::Zero && !self.safe.is_zero() {
            return Err(PlanError::UnsafeFallback { fallback });
        }
        let all = self.written();
        if fallback == Fallback::Hold && !all.outside(&self.rest).is_zero() {
            return Err(PlanError::NotAtRest);
        }
        Ok(())
    }

    /// Bits from the beginning of the kind's inputs to the last one that is read.
    pub(crate) fn input_bits(&self) -> u32 {
        needed(&self.reads, *self.kind.facts().inputs.start(), 0)
    }

    /// Bits from the beginning of the kind's outputs to the last one that is written.
    pub(crate) fn output_bits(&self) -> u32 {
        let facts = self.kind.facts();
        needed(&self.writes, *facts.outputs.start(), *facts.coils.start())
    }

    /// All bits of the output image.
    #[must_use]
    pub fn written(&self) -> OutWords {
        let mut all = OutWords::ZERO;
        let mut start = 0;
        for span in &self.writes {
            for (index, word) in all.words.iter_mut().skip(start).take(span.words()).enumerate() {
                let bits = if span.area.has_bits() { usize::from(span.count) - 16 * index } else { 16 };
                *word = if bits >= 16 { u16::MAX } else { (1 << bits) - 1 };
            }
            start += span.words();
        }
        all
    }

    /// The outputs at the end of a run: those that may be on at rest keep their value.
    #[must_use]
    pub fn at_end(&self, outputs: &OutWords) -> OutWords {
        let kept = outputs.with(&self.rest, |word, rest| word & rest);
        kept.with(&self.safe.outside(&self.rest), |kept, safe| kept | safe)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(first: u16) -> OutWords {
        let mut image = OutWords::ZERO;
        image.words[0] = first;
        image
    }

    fn plan() -> Plan {
        Plan {
            unit: 1,
            kind: Kind::Bk9000,
            fallback: Fallback::Zero,
            watchdog_ms: 500,
            stale_ms: 100,
            reads: vec![Span { area: Area::Input, first: 0, count: 4 }],
            writes: vec![Span { area: Area::Holding, first: 0x800, count: 2 }],
            safe: OutWords::ZERO,
            rest: words(2),
            alive: None,
        }
    }

    fn changed(change: impl FnOnce(&mut Plan)) -> Result<(), PlanError> {
        let mut plan = plan();
        change(&mut plan);
        plan.check()
    }

    #[test]
    fn plans_without_a_safe_fallback_are_refused() {
        assert_eq!(plan().check(), Ok(()));
        let fallback = Fallback::Zero;
        assert_eq!(changed(|plan| plan.safe = words(1)), Err(PlanError::UnsafeFallback { fallback }));
        let (kind, fallback) = (Kind::Bk9000, Fallback::Hold);
        assert_eq!(changed(|plan| plan.fallback = fallback), Err(PlanError::NoFallback { kind, fallback }));
        let plain = |plan: &mut Plan| (plan.kind, plan.fallback) = (Kind::Plain, Fallback::Hold);
        assert_eq!(changed(plain), Err(PlanError::NotAtRest));
        let at_rest = |plan: &mut Plan| {
            plain(plan);
            plan.rest = plan.written();
        };
        assert_eq!(changed(at_rest), Ok(()));
    }

    #[test]
    fn watchdog_below_the_time_of_stale_inputs_is_refused() {
        let expected = Err(PlanError::BadWatchdog { least: 101, found: 100 });
        assert_eq!(changed(|plan| plan.watchdog_ms = 100), expected);
        assert_eq!(changed(|plan| plan.watchdog_ms = 101), Ok(()));
    }

    #[test]
    fn impossible_spans_are_refused() {
        assert_eq!(changed(|plan| plan.reads.clear()), Err(PlanError::NoInputs));
        assert_eq!(
            changed(|plan| plan.reads[0].count = 126),
            Err(PlanError::TooLong { most: 125, found: 126 })
        );
        assert_eq!(
            changed(|plan| plan.writes[0].count = 122),
            Err(PlanError::TooLong { most: 121, found: 122 })
        );
        assert_eq!(changed(|plan| plan.reads[0].count = 0), Err(PlanError::BadSpan { first: 0, count: 0 }));
        let found = Area::Input;
        assert_eq!(changed(|plan| plan.writes[0].area = found), Err(PlanError::NotWritable { found }));
        let outside = changed(|plan| plan.writes[0].first = 0x900);
        let expected =
            PlanError::NotProcessData { kind: Kind::Bk9000, direction: "outputs", first: 0x900, last: 0x901 };
        assert_eq!(outside, Err(expected));
    }

    #[test]
    fn outputs_of_the_end_keep_what_may_be_on_at_rest() {
        assert_eq!(plan().at_end(&words(7)), words(2));
    }
}
