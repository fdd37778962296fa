//! A simulated serial line: bytes arrive one byte time apart. All times are us of one monotonic clock, which this
//! module does not read.

use std::collections::VecDeque;

use depc::wire::{FRAME_BYTES, START};
use interfaces::device::LinkBytes;

/// Capacity of the line, bytes; if a host sends more, the pseudo-terminal fills up.
const MOST_WAITING: usize = 1024;
const BITS: u64 = 10; // bits per byte: start, eight data, stop
const PAUSE_BYTES: u64 = 2; // a burst of bytes is over after a gap of this many byte times (ASSUMED)
const LATE_BYTES: u64 = 20; // longest delay of a step for a frame that is just arriving, byte times

/// Both directions of the line: arrival time in us, and byte.
#[derive(Debug)]
pub struct SerialLine {
    byte_us: u64,
    rx: VecDeque<(u64, u8)>,
    tx: VecDeque<(u64, u8)>,
    rx_end: u64,
    tx_end: u64,
}

impl SerialLine {
    #[must_use]
    pub fn new(baud: u32) -> Self {
        // The time is rounded up, so that the line is never too fast.
        let byte_us = (BITS * 1_000_000).div_ceil(u64::from(baud.max(1)));
        Self { byte_us, rx: VecDeque::new(), tx: VecDeque::new(), rx_end: 0, tx_end: 0 }
    }

    #[must_use]
    pub fn room(&self) -> usize {
        MOST_WAITING.saturating_sub(self.rx.len())
    }

    /// Puts bytes of the host on the line at `now`, us.
    pub fn host_sent(&mut self, now: u64, bytes: &[u8]) {
        for byte in bytes.iter().take(self.room()) {
            self.rx_end = self.rx_end.max(now) + self.byte_us;
            self.rx.push_back((self.rx_end, *byte));
        }
    }

    /// Takes the bytes that have arrived by `now`, us, at most as many as a step accepts.
    pub fn arrived(&mut self, now: u64) -> LinkBytes {
        let mut bytes = LinkBytes::default();
        while let Some(&(at, byte)) = self.rx.front() {
            if at > now || !bytes.push(byte) {
                break;
            }
            self.rx.pop_front();
        }
        bytes
    }

    /// Puts bytes of the controller on the line at `now`, us.
    pub fn send(&mut self, now: u64, bytes: &[u8]) {
        for byte in bytes {
            self.tx_end = self.tx_end.max(now) + self.byte_us;
            self.tx.push_back((self.tx_end, *byte));
        }
    }

    /// Takes the next byte that has reached the host by `now`, us.
    pub fn delivered(&mut self, now: u64) -> Option<u8> {
        let (at, _) = self.tx.front()?;
        if *at > now {
            return None;
        }
        self.tx.pop_front().map(|(_, byte)| byte)
    }

    /// Time at which the next byte reaches the host, us.
    #[must_use]
    pub fn next_delivery(&self) -> Option<u64> {
        self.tx.front().map(|(at, _)| *at)
    }

    /// Removes all bytes from the line, as when the cable is pulled.
    pub fn clear(&mut self) {
        self.rx.clear();
        self.tx.clear();
    }
}

/// Schedule of the controller's steps. A move takes one period. An idle controller takes a command as soon as it has
/// arrived (A 2.3). Otherwise a host with the same period would lose every second period when its frames straddle the
/// controller's steps.
#[derive(Debug)]
pub struct Cadence {
    period_us: u64,
    last: u64,
    busy: bool,
}

impl Cadence {
    /// A schedule whose first step is due one period after `now`, us.
    #[must_use]
    pub fn new(period_us: u32, now: u64) -> Self {
        Self { period_us: u64::from(period_us), last: now, busy: true }
    }

    /// Time at which the next step is due, us. It depends on the bytes now on the line.
    #[must_use]
    pub fn next(&self, line: &SerialLine) -> u64 {
        let regular = self.last + self.period_us;
        let Some(&(end, _)) = line.rx.back() else { return regular };
        let over = end + PAUSE_BYTES * line.byte_us;
        if over > regular {
            return over.min(regular + LATE_BYTES * line.byte_us);
        }
        let complete =
            line.rx.len() >= FRAME_BYTES || line.rx.front().is_some_and(|(_, byte)| *byte != START);
        if complete && !self.busy { over.max(self.last) } else { regular }
    }

    /// Records a step at `now`, us; `busy` if it began a move or an answer.
    pub fn stepped(&mut self, now: u64, busy: bool) {
        self.last = now;
        self.busy = busy;
    }

    /// Time of the last step, us.
    #[must_use]
    pub fn last(&self) -> u64 {
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_arrive_one_byte_time_apart() {
        let mut line = SerialLine::new(9600);
        line.host_sent(1000, &[7; 16]);
        assert_eq!(line.arrived(2041).as_slice(), &[0_u8; 0]);
        assert_eq!(line.arrived(2042).as_slice(), &[7]);
        assert_eq!(line.arrived(1000 + 16 * 1042).as_slice(), &[7; 15]);
        line.send(50_000, &[6, 5]);
        assert_eq!(line.delivered(51_041), None);
        assert_eq!((line.delivered(51_042), line.delivered(51_042)), (Some(6), None));
        assert_eq!(line.next_delivery(), Some(52_084));
    }

    #[test]
    fn no_more_than_38_bytes_pass_in_40_ms() {
        let mut line = SerialLine::new(9600);
        line.host_sent(0, &[1; 500]);
        assert_eq!(line.arrived(40_000).length, 38);
        line.host_sent(0, &[1; 1000]);
        assert_eq!(line.room(), 0);
    }

    /// With equal periods, host and controller exchange one command per period for every phase between their clocks.
    #[test]
    fn every_phase_passes_one_command_per_period() {
        for phase in (0..40_000).step_by(500) {
            let (mut line, mut cadence) = (SerialLine::new(9600), Cadence::new(40_000, phase));
            let (mut sent, mut taken, mut acknowledged) = (0, 0, true);
            for tick in 0..100 {
                let (now, end) = (tick * 40_000, (tick + 1) * 40_000);
                acknowledged |= line.delivered(now).is_some();
                if acknowledged {
                    line.host_sent(now, &[START; FRAME_BYTES]);
                    sent += 1;
                    acknowledged = false;
                }
                while cadence.next(&line) < end {
                    let at = cadence.next(&line);
                    let frame = line.arrived(at).length == 16;
                    if frame {
                        taken += 1;
                        line.send(at, &[6]);
                    }
                    cadence.stepped(at, frame);
                }
            }
            assert!(sent >= 98 && taken >= 98, "phase {phase}: {sent} sent, {taken} taken");
        }
    }

    #[test]
    fn a_frame_without_end_does_not_stop_the_steps() {
        let (mut line, mut cadence) = (SerialLine::new(9600), Cadence::new(40_000, 0));
        for now in (0..1_000_000).step_by(1000) {
            line.host_sent(now, &[1, 2]);
            if cadence.next(&line) <= now {
                assert!(now - cadence.last() <= 62_000);
                line.arrived(now);
                cadence.stepped(now, true);
            }
        }
        assert!(cadence.last() > 900_000);
    }
}
