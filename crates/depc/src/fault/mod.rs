//! Faults on the line between the two ends, to test a host on a bad line. An [`Injector`] applies the [`Rule`]s of a
//! [`Plan`], by tick and direction, to bytes and modem signal. The same plan and traffic give the same faults.
//!
//! | kind | acts on | effect | `ticks` |
//! |---|---|---|---|
//! | `drop` | each byte | the byte is lost | |
//! | `flip` | each byte | one bit of it is inverted | |
//! | `duplicate` | each byte | the byte arrives twice | |
//! | `delay` | each byte | the byte, and all bytes after it, are late | the delay |
//! | `insert` | each tick | an additional byte arrives, a given one or a random one | |
//! | `truncate` | each tick with bytes | the last bytes of the tick are lost, at least one | |
//! | `stall` | each tick | no byte arrives; the bytes follow later, in order | the duration |
//! | `cts-low` | each tick | the receiving end sees the other's DTR off | the duration |
//!
//! A rule acts with a *rate*, the probability per byte or tick; in a *window* of ticks; or both. In a window without a
//! rate it acts on every byte or tick. Bytes keep their order. Order within a tick: truncate; for each byte drop,
//! flip, delay, duplicate; insert; stall.

mod inject;
mod numbers;

use core::fmt;

use rcs_core::Plain;

pub use inject::{Counts, Injector, LINE_BYTES};
pub use numbers::Numbers;

/// Maximum number of rules in a plan.
pub const RULES: usize = 16;
/// Number of kinds of faults.
pub const KINDS: usize = FaultKind::ALL.len();
/// Rate of a fault that always occurs; rates are in millionths.
pub const ALWAYS: u32 = 1_000_000;
/// The longest delay, stall or loss of the signal that one event causes, ticks.
pub const MOST_TICKS: u16 = 1000;

/// Kinds of faults on a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FaultKind {
    /// A byte is lost.
    Drop,
    /// A bit of a byte is inverted.
    Flip,
    /// A byte arrives twice.
    Duplicate,
    /// A byte and all bytes after it arrive later.
    Delay,
    /// An additional byte arrives.
    Insert,
    /// The last bytes of a tick are lost.
    Truncate,
    /// No byte arrives for some ticks.
    Stall,
    /// The modem signal is off for some ticks.
    CtsLow,
}

/// A direction of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Direction {
    /// From the host.
    ToController,
    /// From the controller.
    ToHost,
}

impl FaultKind {
    /// True if the rate is the probability per byte, false if it is that per tick.
    #[must_use]
    pub const fn is_per_byte(self) -> bool {
        matches!(self, Self::Drop | Self::Flip | Self::Duplicate | Self::Delay)
    }

    /// True if the fault has a duration in ticks.
    #[must_use]
    pub const fn has_ticks(self) -> bool {
        matches!(self, Self::Delay | Self::Stall | Self::CtsLow)
    }

    const fn needs_bytes(self) -> bool {
        self.is_per_byte() || matches!(self, Self::Truncate | Self::Stall)
    }
}

/// One kind of fault, with direction, time and rate. Zero means unspecified.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Rule {
    /// The kind.
    pub kind: FaultKind,
    /// True if it acts on bytes of the host.
    pub to_controller: bool,
    /// True if it acts on bytes of the controller.
    pub to_host: bool,
    /// Probability per byte or tick, millionths; 0: unspecified.
    pub rate: u32,
    /// First tick of the window.
    pub from: u64,
    /// First tick after the window; 0: unspecified, no window.
    pub until: u64,
    /// Duration of a delay, a stall or a loss of the signal, ticks; 0: unspecified, one tick.
    pub ticks: u16,
    /// `insert`: true to insert `byte`, false for a random byte.
    pub fixed: bool,
    /// The byte to insert.
    pub byte: u8,
}

impl Rule {
    /// A rule for both directions, without time and rate.
    #[must_use]
    pub fn new(kind: FaultKind) -> Self {
        Self { kind, to_controller: true, to_host: true, ..Self::default() }
    }

    /// The rule for one direction only.
    #[must_use]
    pub const fn only(mut self, direction: Direction) -> Self {
        self.to_controller = matches!(direction, Direction::ToController);
        self.to_host = matches!(direction, Direction::ToHost);
        self
    }

    /// The rule with a rate in millionths.
    #[must_use]
    pub const fn rate(mut self, millionths: u32) -> Self {
        self.rate = millionths;
        self
    }

    /// The rule with a window: the ticks `from` to `until` - 1.
    #[must_use]
    pub const fn window(mut self, from: u64, until: u64) -> Self {
        self.from = from;
        self.until = until;
        self
    }

    /// The rule with a window of one tick.
    #[must_use]
    pub const fn at(self, tick: u64) -> Self {
        self.window(tick, tick.saturating_add(1))
    }

    /// The rule with a duration in ticks.
    #[must_use]
    pub const fn ticks(mut self, ticks: u16) -> Self {
        self.ticks = ticks;
        self
    }

    /// The rule with the byte to insert.
    #[must_use]
    pub const fn byte(mut self, byte: u8) -> Self {
        self.fixed = true;
        self.byte = byte;
        self
    }

    const fn has_window(&self) -> bool {
        self.from != 0 || self.until != 0
    }

    const fn goes(&self, direction: Direction) -> bool {
        match direction {
            Direction::ToController => self.to_controller,
            Direction::ToHost => self.to_host,
        }
    }

    const fn covers(&self, tick: u64) -> bool {
        !self.has_window() || self.from <= tick && tick < self.until
    }

    const fn chance(&self) -> u32 {
        if self.rate == 0 { ALWAYS } else { self.rate }
    }

    fn length(&self) -> u64 {
        u64::from(self.ticks.max(1))
    }

    fn hides(&self, other: &Self) -> bool {
        let directions = (!other.to_controller || self.to_controller) && (!other.to_host || self.to_host);
        let ticks =
            !self.has_window() || other.has_window() && self.from <= other.from && other.until <= self.until;
        self.kind == FaultKind::Drop
            && self.chance() == ALWAYS
            && other.kind.needs_bytes()
            && directions
            && ticks
    }

    fn check(&self) -> Result<(), Refusal> {
        let kind = self.kind;
        if !self.to_controller && !self.to_host {
            return Err(Refusal::NoDirection);
        }
        if self.rate > ALWAYS {
            return Err(Refusal::Rate { millionths: self.rate });
        }
        if self.has_window() && self.from >= self.until {
            return Err(Refusal::EmptyWindow { from: self.from, until: self.until });
        }
        if self.rate == 0 && !self.has_window() {
            return Err(Refusal::Never);
        }
        if self.ticks > MOST_TICKS {
            return Err(Refusal::TooLong { found: self.ticks });
        }
        if self.ticks > 0 && !kind.has_ticks() {
            return Err(Refusal::NoLength { kind });
        }
        let longer = self.until.saturating_sub(self.from) > 1;
        if self.ticks > 0 && self.rate == 0 && longer && kind != FaultKind::Delay {
            return Err(Refusal::TwoLengths { kind });
        }
        if self.fixed && kind != FaultKind::Insert {
            return Err(Refusal::NoByte { kind });
        }
        Ok(())
    }
}

/// A seed and validated rules.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Plan {
    seed: u64,
    /// Maximum number of faults per tick and direction; 0: no limit.
    most_per_tick: u8,
    rules: [Rule; RULES],
    count: u8,
}

impl Plan {
    /// A plan without faults.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }

    /// At most `most` faults per tick and direction (at least 1). With one, the checksum detects every fault.
    #[must_use]
    pub const fn most_per_tick(mut self, most: u8) -> Self {
        self.most_per_tick = if most == 0 { 1 } else { most };
        self
    }

    /// Seed of the random numbers.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// The rules.
    #[must_use]
    pub fn rules(&self) -> &[Rule] {
        self.rules.get(..usize::from(self.count)).unwrap_or_default()
    }

    /// Appends a rule. Refuses a rule that is invalid by itself, or that conflicts with an earlier rule.
    pub fn add(&mut self, rule: Rule) -> Result<(), Refusal> {
        rule.check()?;
        for (number, other) in (1_u8..).zip(self.rules()) {
            if other.hides(&rule) {
                return Err(Refusal::Hidden { kind: rule.kind, by: number });
            }
            if rule.hides(other) {
                return Err(Refusal::Hides { kind: other.kind, number });
            }
        }
        let slot = self.rules.get_mut(usize::from(self.count)).ok_or(Refusal::TooMany)?;
        *slot = rule;
        self.count = self.count.saturating_add(1);
        Ok(())
    }
}

/// Reasons for which a plan refuses a rule. Rules are counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The rule has no direction.
    NoDirection,
    /// The rule has neither a rate nor a window.
    Never,
    /// The rate is above 1.
    Rate {
        /// The rate found.
        millionths: u32,
    },
    /// The window contains no tick.
    EmptyWindow {
        /// Its first tick.
        from: u64,
        /// First tick after it.
        until: u64,
    },
    /// `ticks` is given for a fault without a duration.
    NoLength {
        /// The fault.
        kind: FaultKind,
    },
    /// `ticks` is given with a window that determines the duration.
    TwoLengths {
        /// The fault.
        kind: FaultKind,
    },
    /// The duration is longer than [`MOST_TICKS`].
    TooLong {
        /// The duration found, ticks.
        found: u16,
    },
    /// A byte is given for a fault that does not insert one.
    NoByte {
        /// The fault.
        kind: FaultKind,
    },
    /// An earlier rule drops every byte on which this one could act.
    Hidden {
        /// The fault that can never occur.
        kind: FaultKind,
        /// Number of the rule that drops.
        by: u8,
    },
    /// This rule drops every byte on which an earlier one could act.
    Hides {
        /// The fault that can never occur.
        kind: FaultKind,
        /// Number of its rule.
        number: u8,
    },
    /// The plan already has [`RULES`] rules.
    TooMany,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDirection => f.write_str("expected at least one direction, found none"),
            Self::Never => f.write_str(
                "expected a rate, a tick or a range of ticks, found none of them: the fault would never occur",
            ),
            Self::Rate { millionths } => {
                write!(f, "expected a rate of 0.000001 to 1, found {millionths} millionths")
            }
            Self::EmptyWindow { from, until } => {
                write!(f, "expected `until` after `from`, found {from} to {until}: there is no tick in it")
            }
            Self::NoLength { kind } => write!(
                f,
                "`ticks` is the duration of a delay, a stall or cts-low; {} has no duration",
                kind.text()
            ),
            Self::TwoLengths { kind } => write!(
                f,
                "a range of ticks without a rate already gives the duration of {}: omit `ticks`, or give a rate or a \
                 single tick",
                kind.text()
            ),
            Self::TooLong { found } => write!(f, "expected 1 to {MOST_TICKS} ticks, found {found}"),
            Self::NoByte { kind } => {
                write!(f, "`byte` is the byte to insert; {} inserts none", kind.text())
            }
            Self::Hidden { kind, by } => write!(
                f,
                "fault {by} drops every byte in these ticks, so {} can never occur: use other ticks for one of them",
                kind.text()
            ),
            Self::Hides { kind, number } => write!(
                f,
                "this drops every byte on which fault {number} ({}) could act: use other ticks for one of them",
                kind.text()
            ),
            Self::TooMany => write!(f, "expected at most {RULES} faults"),
        }
    }
}

impl core::error::Error for Refusal {}

#[cfg(test)]
mod tests {
    use super::*;
    use FaultKind::{CtsLow, Delay, Drop, Duplicate, Flip, Insert, Stall, Truncate};

    fn refusal(rule: Rule) -> Option<Refusal> {
        Plan::new(1).add(rule).err()
    }

    #[test]
    fn every_kind_takes_a_rate_and_a_window() {
        for kind in FaultKind::ALL {
            assert_eq!(refusal(Rule::new(*kind).rate(1)), None);
            assert_eq!(refusal(Rule::new(*kind).window(10, 20)), None);
            assert_eq!(refusal(Rule::new(*kind).at(10).only(Direction::ToHost)), None);
            assert_eq!(refusal(Rule::new(*kind).window(10, 20).rate(ALWAYS)), None);
            assert_eq!(refusal(Rule::new(*kind)), Some(Refusal::Never));
        }
    }

    #[test]
    fn senseless_values_are_refused() {
        let nowhere = Rule { to_controller: false, to_host: false, ..Rule::new(Drop).rate(1) };
        for (rule, expected) in [
            (nowhere, Refusal::NoDirection),
            (Rule::new(Flip).rate(ALWAYS + 1), Refusal::Rate { millionths: ALWAYS + 1 }),
            (Rule::new(Flip).window(20, 20), Refusal::EmptyWindow { from: 20, until: 20 }),
            (Rule::new(Flip).window(20, 0), Refusal::EmptyWindow { from: 20, until: 0 }),
            (Rule::new(Drop).rate(1).ticks(1), Refusal::NoLength { kind: Drop }),
            (Rule::new(Stall).window(10, 20).ticks(3), Refusal::TwoLengths { kind: Stall }),
            (Rule::new(CtsLow).rate(1).ticks(1001), Refusal::TooLong { found: 1001 }),
            (Rule::new(Duplicate).rate(1).byte(6), Refusal::NoByte { kind: Duplicate }),
        ] {
            assert_eq!(refusal(rule), Some(expected), "{rule:?}");
            assert!(!expected.to_string().is_empty());
        }
    }

    #[test]
    fn duration_needs_a_rate_one_tick_or_a_delay() {
        for rule in [
            Rule::new(Stall).rate(10).ticks(1000),
            Rule::new(CtsLow).at(5).ticks(7),
            Rule::new(Delay).window(10, 20).ticks(3),
            Rule::new(Stall).window(10, 20).rate(10).ticks(3),
            Rule::new(Insert).at(4).byte(6),
        ] {
            assert_eq!(refusal(rule), None);
        }
    }

    #[test]
    fn fault_of_dropped_bytes_is_refused_in_either_order() {
        let cut = Rule::new(Drop).window(10, 20);
        let flip = Rule::new(Flip).window(12, 14).only(Direction::ToHost);
        let mut plan = Plan::new(1);
        assert_eq!(plan.add(cut), Ok(()));
        assert_eq!(plan.add(flip), Err(Refusal::Hidden { kind: Flip, by: 1 }));
        assert_eq!(plan.add(Rule::new(Truncate).at(19)), Err(Refusal::Hidden { kind: Truncate, by: 1 }));
        for rule in
            [Rule::new(Flip).window(15, 21), Rule::new(Insert).at(15), Rule::new(CtsLow).window(10, 20)]
        {
            assert_eq!(plan.add(rule), Ok(()));
        }
        assert_eq!(plan.rules().len(), 4);
        let mut plan = Plan::new(1);
        assert_eq!(plan.add(flip), Ok(()));
        assert_eq!(plan.add(cut), Err(Refusal::Hides { kind: Flip, number: 1 }));
        assert_eq!(plan.add(cut.only(Direction::ToController)), Ok(()));
        for direction in [Direction::ToController, Direction::ToHost] {
            let mut plan = Plan::new(1);
            assert_eq!(plan.add(cut.only(direction)), Ok(()));
            let flip = Rule::new(Flip).at(12).only(direction);
            assert_eq!(plan.add(flip), Err(Refusal::Hidden { kind: Flip, by: 1 }));
        }
    }

    #[test]
    fn plan_permits_at_least_one_fault_per_tick() {
        let most = |most| Plan::new(1).most_per_tick(most);
        assert_eq!(most(0), most(1));
        assert_ne!(most(1), most(2));
    }

    #[test]
    fn plan_has_a_maximum_number_of_rules() {
        let mut plan = Plan::new(1);
        for _ in 0..RULES {
            assert_eq!(plan.add(Rule::new(Flip).rate(1)), Ok(()));
        }
        assert_eq!(plan.add(Rule::new(Flip).rate(1)), Err(Refusal::TooMany));
    }
}
