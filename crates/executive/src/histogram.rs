//! Times of ticks in a fixed number of buckets, so that a run of any length needs no allocation.

const PER_OCTAVE: u64 = 32; // buckets per octave: a percentile is accurate to 1/32, about 3 %
const OCTAVES: usize = 30; // number of octaves above the linear part: up to 2^5 * 2^30 ns, half a minute
const BUCKETS: usize = (OCTAVES + 1) * 32;

/// Durations in ns: exact below 32 ns, then 32 buckets per octave; the last bucket has those over half a minute.
#[derive(Clone)]
pub struct Histogram {
    counts: [u64; BUCKETS],
    total: u64,
    max: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Half of the values are at most this.
    pub p50: f64,
    /// 99 of 100 values are at most this.
    pub p99: f64,
    pub max: f64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: [0; BUCKETS], total: 0, max: 0 }
    }
}

impl Histogram {
    pub fn add(&mut self, nanoseconds: u64) {
        self.counts[bucket(nanoseconds)] += 1;
        self.total += 1;
        self.max = self.max.max(nanoseconds);
    }

    #[must_use]
    pub const fn count(&self) -> u64 {
        self.total
    }

    /// The value, ns, that `permille` of 1000 values do not exceed: the upper edge of its bucket. 0 without values.
    #[must_use]
    pub fn quantile(&self, permille: u64) -> u64 {
        let wanted = (self.total * permille.min(1000)).div_ceil(1000);
        let mut seen = 0;
        for (index, count) in self.counts.iter().enumerate() {
            seen += count;
            if seen >= wanted && seen > 0 {
                return upper_edge(index).min(self.max);
            }
        }
        self.max
    }

    #[must_use]
    pub fn summary(&self) -> Summary {
        let microseconds = |nanoseconds: u64| nanoseconds as f64 / 1000.0;
        Summary {
            p50: microseconds(self.quantile(500)),
            p99: microseconds(self.quantile(990)),
            max: microseconds(self.max),
        }
    }
}

fn bucket(value: u64) -> usize {
    if value < PER_OCTAVE {
        return value as usize;
    }
    let octave = value.ilog2() - PER_OCTAVE.ilog2();
    let within = (value >> octave) - PER_OCTAVE;
    ((u64::from(octave) + 1) * PER_OCTAVE + within).min(BUCKETS as u64 - 1) as usize
}

fn upper_edge(index: usize) -> u64 {
    let index = index as u64;
    if index < PER_OCTAVE {
        return index;
    }
    let (octave, within) = (index / PER_OCTAVE - 1, index % PER_OCTAVE);
    ((within + PER_OCTAVE + 1) << octave) - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn empty_histogram_is_zero() {
        assert_eq!(Histogram::default().summary(), Summary::default());
    }

    #[test]
    fn one_value_is_all_quantiles() {
        let mut histogram = Histogram::default();
        histogram.add(12_345);
        assert_eq!(
            (histogram.quantile(0), histogram.quantile(500), histogram.quantile(1000)),
            (12_345, 12_345, 12_345)
        );
    }

    proptest! {
        #[test]
        fn a_quantile_is_right_to_a_32nd(
            mut values in prop::collection::vec(0_u64..30_000_000_000, 1..400),
            permille in 1_u64..=1000,
        ) {
            let mut histogram = Histogram::default();
            values.iter().for_each(|&value| histogram.add(value));
            values.sort_unstable();
            let rank = (values.len() as u64 * permille).div_ceil(1000) as usize;
            let exact = values[rank - 1];
            let found = histogram.quantile(permille);
            prop_assert!(found >= exact, "{found} < {exact}");
            prop_assert!(found <= exact + exact / 32 + 1, "{found} is too far above {exact}");
        }
    }
}
