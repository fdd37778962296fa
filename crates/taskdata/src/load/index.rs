//! Building the indexes of the files; [`crate::files::index`] says how they are searched.

use crate::files::{
    Index,
    index::{LONGEST_BUCKET, Slot, bucket_of},
};

/// An index, owned.
#[derive(Clone, Debug, Default)]
pub(super) struct OwnedIndex {
    buckets: Vec<u32>,
    slots: Vec<Slot>,
    numbers: Vec<u32>,
    seed: u64,
}

impl OwnedIndex {
    /// An index of keys, each with its record number, in the order of the records. Records may share a key.
    pub fn new(pairs: &[(u128, u32)]) -> Self {
        if pairs.is_empty() {
            return Self::default();
        }
        let mut buckets = pairs.len().next_power_of_two();
        let mut seed = 0;
        loop {
            let index = Self::spread(pairs, buckets, seed);
            if index.longest() <= LONGEST_BUCKET {
                return index;
            }
            // One key in a hundred million or so has to be tried twice; the other buckets are against keys made for it.
            seed += 1;
            if seed % 8 == 0 {
                buckets *= 2;
            }
        }
    }

    fn spread(pairs: &[(u128, u32)], buckets: usize, seed: u64) -> Self {
        let places: Vec<u32> = pairs.iter().map(|pair| short(bucket_of(pair.0, seed, buckets))).collect();
        let mut begins = vec![0_u32; buckets + 1];
        for &place in &places {
            if let Some(begin) = begins.get_mut(long(place) + 1) {
                *begin += 1;
            }
        }
        let mut sum = 0;
        for begin in &mut begins {
            sum += *begin;
            *begin = sum;
        }
        let mut next = begins.clone();
        let mut spread = vec![(0_u128, 0_u32); pairs.len()];
        for (&place, &pair) in places.iter().zip(pairs) {
            if let Some(next) = next.get_mut(long(place))
                && let Some(slot) = spread.get_mut(long(*next))
            {
                *slot = pair;
                *next += 1;
            }
        }
        Self::from_spread(&mut spread, &begins, seed)
    }

    /// Put equal keys of each bucket together; `begins` says where the pairs of each bucket begin.
    fn from_spread(spread: &mut [(u128, u32)], begins: &[u32], seed: u64) -> Self {
        let mut index =
            Self { buckets: Vec::with_capacity(begins.len()), slots: Vec::new(), numbers: Vec::new(), seed };
        index.slots.reserve(spread.len());
        index.numbers.reserve(spread.len());
        index.buckets.push(0);
        for range in begins.windows(2) {
            let [begin, end] = *range else { continue };
            let bucket = spread.get_mut(long(begin)..long(end)).unwrap_or_default();
            bucket.sort_by_key(|pair| pair.0);
            for run in bucket.chunk_by(|a, b| a.0 == b.0) {
                if let Some(&(key, number)) = run.first() {
                    let first = short(index.numbers.len());
                    index.slots.push(Slot { key, number, first, count: short(run.len()) });
                    index.numbers.extend(run.iter().map(|pair| pair.1));
                }
            }
            index.buckets.push(short(index.slots.len()));
        }
        index
    }

    /// Keys of the fullest bucket.
    fn longest(&self) -> usize {
        let lengths = self.buckets.windows(2).map(|range| match *range {
            [begin, end] => long(end.saturating_sub(begin)),
            _ => 0,
        });
        lengths.max().unwrap_or(0)
    }

    /// For looking up.
    pub fn view(&self) -> Index<'_> {
        Index { buckets: &self.buckets, slots: &self.slots, numbers: &self.numbers, seed: self.seed }
    }

    /// All keys, in no order.
    pub fn keys(&self) -> impl Iterator<Item = u128> + '_ {
        self.slots.iter().map(|slot| slot.key)
    }

    /// The record numbers of each key that several records have.
    pub fn shared(&self) -> impl Iterator<Item = &[u32]> {
        self.slots.iter().filter(|slot| slot.count > 1).map(|slot| {
            self.numbers.get(long(slot.first)..).and_then(|n| n.get(..long(slot.count))).unwrap_or_default()
        })
    }
}

fn long(value: u32) -> usize {
    usize::try_from(value).unwrap_or(usize::MAX)
}

fn short(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn finds_what_a_map_finds(keys in prop::collection::vec(0_u128..500, 0..600), probe in 0_u128..500) {
            let pairs: Vec<(u128, u32)> = keys.iter().copied().zip(1..).collect();
            let index = OwnedIndex::new(&pairs);
            let mut map: BTreeMap<u128, Vec<u32>> = BTreeMap::new();
            for (key, number) in pairs {
                map.entry(key).or_default().push(number);
            }
            let found = map.get(&probe).cloned().unwrap_or_default();
            prop_assert_eq!(index.view().all(probe), found.as_slice());
            prop_assert_eq!(index.view().find(probe), found.first().copied());
            prop_assert_eq!(index.view().len(), map.len());
            prop_assert_eq!(index.shared().count(), map.values().filter(|n| n.len() > 1).count());
            prop_assert!(index.longest() <= LONGEST_BUCKET);
        }
    }

    #[test]
    fn an_empty_index_finds_nothing() {
        let index = OwnedIndex::new(&[]);
        assert_eq!((index.view().find(0), index.view().len(), index.view().is_empty()), (None, 0, true));
        assert!(index.view().all(0).is_empty());
    }

    #[test]
    fn a_hundred_thousand_names_fill_no_bucket() {
        for stem in ["PART", "M", "A-LONG-ONE"] {
            let key = |i: u32| {
                crate::files::index::name_key(&rcs_core::name::Name16::clipped(&format!("{stem}{i}")))
            };
            let pairs: Vec<(u128, u32)> = (1..=100_000).map(|i| (key(i), i)).collect();
            let index = OwnedIndex::new(&pairs);
            assert!(index.longest() <= LONGEST_BUCKET);
            assert!((1..=100_000).all(|i| index.view().find(key(i)) == Some(i)));
        }
    }
}
