//! Faults of a UDP network, random with a seed: loss, duplication, delay, and reordering of datagrams.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    pub loss: f64,     // datagrams lost, percent
    pub double: f64,   // datagrams that arrive twice, percent
    pub reorder: f64,  // datagrams delayed by 10 ms more, so that others overtake them, percent
    pub delay_ms: f64, // ms
    /// Jitter, ms: up to this much random extra delay per datagram; datagrams can overtake each other.
    pub jitter_ms: f64,
    pub silent_at_s: f64, // start of a time in which every datagram is lost, s
    pub silent_for_s: f64,
}

const OVERTAKEN_MS: f64 = 10.0; // extra delay of a datagram that is to be overtaken, ms
/// Greatest number of datagrams in transit; the network loses any beyond it.
const MOST_UNDER_WAY: usize = 256;

#[derive(Debug)]
pub struct Network {
    quality: Quality,
    dice: ChaCha8Rng,
    under_way: Vec<(u64, Vec<u8>)>, // arrival time, ns, and datagram, in the order of sending
}

fn nanoseconds(ms: f64) -> u64 {
    std::time::Duration::try_from_secs_f64(ms / 1e3)
        .map_or(0, |time| u64::try_from(time.as_nanos()).unwrap_or(0))
}

impl Network {
    #[must_use]
    pub fn new(quality: Quality, seed: u64) -> Self {
        Self { quality, dice: ChaCha8Rng::seed_from_u64(seed), under_way: Vec::new() }
    }

    pub fn send(&mut self, now: u64, datagram: &[u8]) {
        let from = nanoseconds(self.quality.silent_at_s * 1e3);
        let silent = from..from.saturating_add(nanoseconds(self.quality.silent_for_s * 1e3));
        // Every datagram draws the same number of random numbers: a change of one rate does not affect the others.
        let [lost, double, overtaken] = [self.quality.loss, self.quality.double, self.quality.reorder]
            .map(|percent| self.chance(percent));
        let delays = [self.delay(overtaken), self.delay(overtaken)];
        if lost || silent.contains(&now) {
            return;
        }
        for delay in delays.into_iter().take(if double { 2 } else { 1 }) {
            if self.under_way.len() < MOST_UNDER_WAY {
                self.under_way.push((now.saturating_add(delay), datagram.to_vec()));
            }
        }
    }

    /// Arrival time of the next datagram, ns.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        self.under_way.iter().map(|(at, _)| *at).min()
    }

    /// Takes the next datagram that has arrived by `now`, with its arrival time, ns.
    pub fn arrived(&mut self, now: u64) -> Option<(u64, Vec<u8>)> {
        let next = self.next().filter(|at| *at <= now)?;
        let place = self.under_way.iter().position(|(at, _)| *at == next)?;
        Some(self.under_way.remove(place))
    }

    fn delay(&mut self, overtaken: bool) -> u64 {
        let jitter = self.part() * self.quality.jitter_ms;
        nanoseconds(self.quality.delay_ms + jitter + if overtaken { OVERTAKEN_MS } else { 0.0 })
    }

    fn chance(&mut self, percent: f64) -> bool {
        self.part() * 100.0 < percent
    }

    /// A random number in [0, 1).
    fn part(&mut self) -> f64 {
        (self.dice.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn arrivals(quality: Quality, seed: u64) -> Vec<(u64, u8)> {
        let mut network = Network::new(quality, seed);
        let mut all = Vec::new();
        for number in 0..200_u8 {
            let now = u64::from(number) * 4 * MS;
            network.send(now, &[number]);
            while let Some((at, datagram)) = network.arrived(now + 4 * MS - 1) {
                all.push((at, datagram[0]));
            }
        }
        all
    }

    #[test]
    fn network_without_faults_delivers_all_datagrams() {
        let all = arrivals(Quality::default(), 1);
        assert!(all.iter().zip(0..).all(|(found, number)| *found == (u64::from(number) * 4 * MS, number)));
        assert_eq!(all.len(), 200);
    }

    #[test]
    fn network_faults_follow_from_the_seed() {
        let quality =
            Quality { loss: 20.0, double: 10.0, jitter_ms: 20.0, delay_ms: 1.0, ..Default::default() };
        let all = arrivals(quality, 7);
        assert_eq!(all, arrivals(quality, 7));
        assert_ne!(all, arrivals(quality, 8));
        let mut numbers: Vec<u8> = all.iter().map(|(_, number)| *number).collect();
        assert!(!numbers.is_sorted(), "some overtake others");
        assert!(all.iter().all(|(at, number)| (1..21).contains(&((at - u64::from(*number) * 4 * MS) / MS))));
        numbers.sort_unstable();
        let count = numbers.len();
        numbers.dedup();
        assert!(count > numbers.len() && (130..180).contains(&numbers.len()), "{count}, {}", numbers.len());
    }

    #[test]
    fn silence_has_its_duration() {
        let all = arrivals(Quality { silent_at_s: 0.1, silent_for_s: 0.2, ..Default::default() }, 1);
        assert!(all.iter().all(|(at, _)| !(100 * MS..300 * MS).contains(at)));
        assert_eq!(all.len(), 150);
    }
}
