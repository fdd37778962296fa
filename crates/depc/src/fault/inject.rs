//! The injector: applies the faults of a plan to the transmitted bytes.
//!
//! Each direction has its own random numbers and its own line, so its faults are independent of the other. A line
//! holds bytes with their due ticks, and releases them in order, at most [`LinkBytes`] per tick.

use rcs_core::{Plain, tick::Tick};

use super::{ALWAYS, Direction, FaultKind, KINDS, Numbers, Plan, Rule};
use crate::link::LinkBytes;

/// Capacity of a delayed or stalled line, bytes; further bytes are lost.
pub const LINE_BYTES: usize = 256;

/// Counts of one direction, or the sum of both.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Counts {
    /// Bytes sent.
    pub sent: u64,
    /// Bytes that arrived.
    pub arrived: u64,
    /// Bytes lost because a delayed line was full.
    pub overflowed: u64,
    by_kind: [u64; KINDS],
}

impl Counts {
    /// Faults of a kind. An extension of a stall or a loss of the signal is a new fault.
    #[must_use]
    pub fn of(&self, kind: FaultKind) -> u64 {
        self.by_kind.get(usize::from(kind.code())).copied().unwrap_or_default()
    }

    /// Number of faults of all kinds.
    #[must_use]
    pub fn faults(&self) -> u64 {
        self.by_kind.iter().fold(0, |sum, count| sum.saturating_add(*count))
    }

    /// The sum of two counts.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        self.sent = self.sent.saturating_add(other.sent);
        self.arrived = self.arrived.saturating_add(other.arrived);
        self.overflowed = self.overflowed.saturating_add(other.overflowed);
        for (count, more) in self.by_kind.iter_mut().zip(other.by_kind) {
            *count = count.saturating_add(more);
        }
        self
    }

    fn note(&mut self, kind: FaultKind) {
        if let Some(count) = self.by_kind.get_mut(usize::from(kind.code())) {
            *count = count.saturating_add(1);
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
struct OneWay {
    numbers: Numbers,
    bytes: [u8; LINE_BYTES],
    due: [u64; LINE_BYTES],
    held: u16,
    /// No byte arrives before this tick.
    stalled_until: u64,
    /// The signal is off before this tick.
    low_until: u64,
    counts: Counts,
}

/// The line between the two ends, with the faults of a plan. Call [`Injector::carry`] once per tick and direction.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Injector {
    plan: Plan,
    to_controller: OneWay,
    to_host: OneWay,
}

impl Injector {
    /// A line before its first tick.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        let line = |direction: Direction| OneWay {
            numbers: Numbers::new(plan.seed(), u64::from(direction.code())),
            ..OneWay::default()
        };
        Self { plan: *plan, to_controller: line(Direction::ToController), to_host: line(Direction::ToHost) }
    }

    /// Carries the bytes that one end sends in `tick`, and its DTR. Returns what the other end receives.
    pub fn carry(
        &mut self,
        direction: Direction,
        tick: Tick,
        sent: &LinkBytes,
        ready: bool,
    ) -> (LinkBytes, bool) {
        let line = match direction {
            Direction::ToController => &mut self.to_controller,
            Direction::ToHost => &mut self.to_host,
        };
        let most = if self.plan.most_per_tick == 0 { u8::MAX } else { self.plan.most_per_tick };
        let mut work = Work { rules: self.plan.rules(), direction, tick: tick.0, line, most, struck: 0 };
        work.send(sent.as_slice());
        (work.arrive(), ready && !work.is_low())
    }

    /// True if the line is fault-free after `tick`: all rules are past, and it holds no bytes.
    #[must_use]
    pub fn is_over(&self, tick: Tick) -> bool {
        let past = |rule: &Rule| rule.until != 0 && rule.until <= tick.0.saturating_add(1);
        let clear =
            |line: &OneWay| line.held == 0 && line.stalled_until <= tick.0 && line.low_until <= tick.0;
        self.plan.rules().iter().all(past) && clear(&self.to_controller) && clear(&self.to_host)
    }

    /// Counts of one direction.
    #[must_use]
    pub const fn counts(&self, direction: Direction) -> &Counts {
        match direction {
            Direction::ToController => &self.to_controller.counts,
            Direction::ToHost => &self.to_host.counts,
        }
    }

    /// Counts of both directions.
    #[must_use]
    pub fn total(&self) -> Counts {
        self.to_controller.counts.plus(&self.to_host.counts)
    }
}

struct Work<'a> {
    rules: &'a [Rule],
    direction: Direction,
    tick: u64,
    line: &'a mut OneWay,
    most: u8,
    struck: u8,
}

impl Work<'_> {
    /// The active rule of a kind. Every rule draws its own number, independent of the others.
    fn strike(&mut self, kind: FaultKind) -> Option<Rule> {
        let mut struck = None;
        for rule in self.rules {
            if rule.kind != kind || !rule.goes(self.direction) || !rule.covers(self.tick) {
                continue;
            }
            if (rule.chance() == ALWAYS || self.line.numbers.below(ALWAYS) < rule.chance())
                && struck.is_none()
            {
                struck = Some(*rule);
            }
        }
        if self.most < u8::MAX && self.struck >= self.most {
            return None;
        }
        if struck.is_some() {
            self.struck = self.struck.saturating_add(1);
            self.line.counts.note(kind);
        }
        struck
    }

    fn send(&mut self, sent: &[u8]) {
        let bytes = self.truncated(sent);
        let insert = self.strike(FaultKind::Insert).map(|rule| {
            let places = u32::try_from(bytes.len()).unwrap_or_default().saturating_add(1);
            let any = self.line.numbers.below(256);
            let byte = if rule.fixed { rule.byte } else { u8::try_from(any).unwrap_or_default() };
            (self.line.numbers.below(places), byte)
        });
        for (place, byte) in (0_u32..).zip(bytes) {
            if let Some((_, noise)) = insert.filter(|(at, _)| *at == place) {
                self.put(noise, 0);
            }
            self.send_byte(*byte);
        }
        if let Some((_, noise)) = insert.filter(|(at, _)| usize::try_from(*at) == Ok(bytes.len())) {
            self.put(noise, 0);
        }
    }

    fn truncated<'b>(&mut self, sent: &'b [u8]) -> &'b [u8] {
        self.line.counts.sent = self.line.counts.sent.saturating_add(u64::try_from(sent.len()).unwrap_or(0));
        if sent.is_empty() || self.strike(FaultKind::Truncate).is_none() {
            return sent;
        }
        let left = self.line.numbers.below(u32::try_from(sent.len()).unwrap_or_default());
        sent.get(..usize::try_from(left).unwrap_or_default()).unwrap_or_default()
    }

    fn send_byte(&mut self, byte: u8) {
        if self.strike(FaultKind::Drop).is_some() {
            return;
        }
        let flipped = match self.strike(FaultKind::Flip) {
            Some(_) => byte ^ 1_u8.wrapping_shl(self.line.numbers.below(8)),
            None => byte,
        };
        let late = self.strike(FaultKind::Delay).map_or(0, |rule| rule.length());
        self.put(flipped, late);
        if self.strike(FaultKind::Duplicate).is_some() {
            self.put(flipped, late);
        }
    }

    fn put(&mut self, byte: u8, late: u64) {
        let line = &mut *self.line;
        let place = usize::from(line.held);
        match (line.bytes.get_mut(place), line.due.get_mut(place)) {
            (Some(slot), Some(due)) => {
                *slot = byte;
                *due = self.tick.saturating_add(late);
                line.held = line.held.saturating_add(1);
            }
            _ => line.counts.overflowed = line.counts.overflowed.saturating_add(1),
        }
    }

    fn arrive(&mut self) -> LinkBytes {
        let mut arrived = LinkBytes::default();
        if let Some(rule) = self.strike(FaultKind::Stall) {
            self.line.stalled_until = self.line.stalled_until.max(self.tick.saturating_add(rule.length()));
        }
        let line = &mut *self.line;
        if self.tick < line.stalled_until {
            return arrived;
        }
        let held = line.bytes.iter().zip(line.due).take(usize::from(line.held));
        let count = held.take_while(|(byte, due)| *due <= self.tick && arrived.push(**byte)).count();
        if count > 0 {
            line.bytes.rotate_left(count);
            line.due.rotate_left(count);
            let left = usize::from(line.held).saturating_sub(count);
            line.bytes.iter_mut().skip(left).for_each(|byte| *byte = 0);
            line.due.iter_mut().skip(left).for_each(|due| *due = 0);
            line.held = u16::try_from(left).unwrap_or_default();
            line.counts.arrived = line.counts.arrived.saturating_add(u64::from(arrived.length));
        }
        arrived
    }

    fn is_low(&mut self) -> bool {
        if let Some(rule) = self.strike(FaultKind::CtsLow) {
            self.line.low_until = self.line.low_until.max(self.tick.saturating_add(rule.length()));
        }
        self.tick < self.line.low_until
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ABC: &[u8] = b"ABCDEFGH";

    #[test]
    fn line_is_over_after_its_rules_and_without_bytes() {
        let late = Rule::new(FaultKind::Delay).at(5).ticks(4).only(Direction::ToHost);
        let low = Rule::new(FaultKind::CtsLow).at(6).ticks(3);
        for rules in [&[late, low][..], &[late]] {
            let mut injector = injector(rules);
            let over: Vec<u64> = (1..12)
                .filter(|tick| {
                    injector.carry(Direction::ToHost, Tick(*tick), &bytes(ABC), true);
                    injector.carry(Direction::ToController, Tick(*tick), &bytes(ABC), true);
                    injector.is_over(Tick(*tick))
                })
                .collect();
            assert_eq!(over, [9, 10, 11]);
        }
        let mut endless = Plan::new(1);
        endless.add(Rule::new(FaultKind::Drop).rate(1)).unwrap();
        assert!(!Injector::new(&endless).is_over(Tick(100)));
    }

    fn bytes(of: &[u8]) -> LinkBytes {
        let mut link = LinkBytes::default();
        assert_eq!(link.extend(of), of.len());
        link
    }

    fn injector(rules: &[Rule]) -> Injector {
        let mut plan = Plan::new(7);
        for rule in rules {
            assert_eq!(plan.add(*rule), Ok(()));
        }
        Injector::new(&plan)
    }

    /// Bytes and signal at the host in ticks 0 to 9 if `sent` is sent in each.
    fn ten(injector: &mut Injector, sent: &[u8]) -> Vec<(Vec<u8>, bool)> {
        (0..10)
            .map(|tick| {
                let (arrived, ready) = injector.carry(Direction::ToHost, Tick(tick), &bytes(sent), true);
                (arrived.as_slice().to_vec(), ready)
            })
            .collect()
    }

    fn arrived(rule: Rule, sent: &[u8]) -> Vec<Vec<u8>> {
        ten(&mut injector(&[rule]), sent).into_iter().map(|(bytes, _)| bytes).collect()
    }

    #[test]
    fn without_rules_everything_arrives() {
        let mut line = injector(&[]);
        assert!(ten(&mut line, ABC).iter().all(|(bytes, ready)| bytes == ABC && *ready));
        let counts = line.total();
        assert_eq!((counts.sent, counts.arrived, counts.faults()), (80, 80, 0));
    }

    #[test]
    fn a_window_is_from_its_first_tick_to_before_its_last() {
        let got = arrived(Rule::new(FaultKind::Drop).window(3, 5), ABC);
        for (tick, bytes) in got.iter().enumerate() {
            assert_eq!(bytes.is_empty(), tick == 3 || tick == 4);
        }
    }

    #[test]
    fn other_direction_has_no_faults() {
        let mut line = injector(&[Rule::new(FaultKind::Drop).rate(ALWAYS).only(Direction::ToController)]);
        assert!(ten(&mut line, ABC).iter().all(|(bytes, _)| bytes == ABC));
        assert_eq!(line.carry(Direction::ToController, Tick(1), &bytes(ABC), true).0.length, 0);
        assert_eq!(line.counts(Direction::ToController).of(FaultKind::Drop), 8);
        assert_eq!(line.counts(Direction::ToHost).faults(), 0);
    }

    #[test]
    fn flip_changes_one_bit_of_each_byte() {
        for bytes in [ABC, &[0; 8], &[0xFF; 8]] {
            for (got, sent) in arrived(Rule::new(FaultKind::Flip).at(0), bytes)[0].iter().zip(bytes) {
                assert_eq!((got ^ sent).count_ones(), 1);
            }
        }
    }

    #[test]
    fn duplicate_doubles_each_byte() {
        assert_eq!(arrived(Rule::new(FaultKind::Duplicate).at(0), b"XY")[0], b"XXYY");
    }

    #[test]
    fn insert_adds_the_byte_also_to_an_idle_line() {
        assert_eq!(arrived(Rule::new(FaultKind::Insert).at(2).byte(0x06), &[])[2], [0x06]);
        let got = arrived(Rule::new(FaultKind::Insert).rate(ALWAYS).byte(b'.'), ABC);
        let places: Vec<_> = got.iter().map(|bytes| bytes.iter().position(|b| *b == b'.').unwrap()).collect();
        assert!(got.iter().all(|bytes| bytes.len() == 9));
        assert!(places.iter().any(|place| *place != places[0]), "{places:?}");
        assert!(arrived(Rule::new(FaultKind::Insert).rate(ALWAYS), &[]).iter().any(|bytes| *bytes != [0]));
    }

    #[test]
    fn truncate_leaves_the_beginning() {
        for bytes in arrived(Rule::new(FaultKind::Truncate).rate(ALWAYS), ABC) {
            assert!(bytes.len() < ABC.len() && ABC.starts_with(&bytes), "{bytes:?}");
        }
    }

    #[test]
    fn delay_moves_bytes_by_its_ticks_and_holds_back_later_bytes() {
        let got = arrived(Rule::new(FaultKind::Delay).window(1, 3).ticks(4), b"X");
        assert_eq!(got.iter().map(Vec::len).collect::<Vec<_>>(), [1, 0, 0, 0, 0, 1, 5, 1, 1, 1]);
    }

    #[test]
    fn stall_holds_all_bytes_and_releases_them_in_order() {
        let mut line = injector(&[Rule::new(FaultKind::Stall).window(2, 6)]);
        let got = ten(&mut line, ABC);
        let lengths: Vec<_> = got.iter().map(|(bytes, _)| bytes.len()).collect();
        assert_eq!(lengths, [8, 8, 0, 0, 0, 0, 40, 8, 8, 8]);
        assert_eq!(got[6].0, ABC.repeat(5));
        // Bytes that exceed the capacity of a tick arrive in the next.
        let lengths: Vec<_> =
            arrived(Rule::new(FaultKind::Stall).at(1).ticks(8), &[b'Z'; 16]).iter().map(Vec::len).collect();
        assert_eq!(lengths, [16, 0, 0, 0, 0, 0, 0, 0, 0, 64]);
    }

    #[test]
    fn bytes_beyond_the_capacity_of_a_line_are_lost_and_counted() {
        let mut line = injector(&[Rule::new(FaultKind::Stall).rate(ALWAYS)]);
        ten(&mut line, &[0x55; 64]);
        assert_eq!(line.total().overflowed, 640 - 256);
    }

    #[test]
    fn the_signal_is_low_for_its_ticks() {
        let low = |rule| {
            let ready: Vec<_> =
                ten(&mut injector(&[rule]), ABC).into_iter().map(|(_, ready)| ready).collect();
            (0..10).filter(|tick| !ready[*tick]).collect::<Vec<_>>()
        };
        assert_eq!(low(Rule::new(FaultKind::CtsLow).at(2).ticks(3)), [2, 3, 4]);
        assert_eq!(low(Rule::new(FaultKind::CtsLow).window(7, 9)), [7, 8]);
    }

    #[test]
    fn faults_follow_rate_and_seed() {
        let run = |seed| {
            let mut plan = Plan::new(seed);
            plan.add(Rule::new(FaultKind::Flip).rate(100_000)).unwrap();
            let mut line = Injector::new(&plan);
            let mut all = Vec::new();
            for tick in 0..10_000 {
                let (bytes, _) = line.carry(Direction::ToHost, Tick(tick), &bytes(ABC), true);
                all.extend_from_slice(bytes.as_slice());
            }
            (all, line.total().of(FaultKind::Flip))
        };
        let (first, faults) = run(1);
        assert!((7_600..8_400).contains(&faults), "{faults} of 80,000 bytes at a rate of 0.1");
        assert_eq!(first, run(1).0);
        assert_ne!(first, run(2).0);
    }

    #[test]
    fn at_most_one_fault_per_tick_is_injected() {
        let mut plan = Plan::new(1).most_per_tick(1);
        plan.add(Rule::new(FaultKind::Drop).rate(500_000)).unwrap();
        plan.add(Rule::new(FaultKind::Duplicate).rate(500_000)).unwrap();
        let mut line = Injector::new(&plan);
        for (bytes, _) in ten(&mut line, ABC) {
            assert!((7..=9).contains(&bytes.len()), "{bytes:?}");
        }
        assert!(line.total().faults() >= 9);
    }

    #[test]
    fn the_directions_do_not_depend_on_each_other() {
        let rules = [Rule::new(FaultKind::Drop).rate(300_000)];
        let (mut one, mut two) = (injector(&rules), injector(&rules));
        for tick in 0..50 {
            two.carry(Direction::ToController, Tick(tick), &bytes(ABC), true);
        }
        assert_eq!(ten(&mut one, ABC), ten(&mut two, ABC));
    }
}
