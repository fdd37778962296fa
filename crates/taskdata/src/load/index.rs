//! Building the indexes of the files; [`crate::files::index`] says how they are searched.
//!
//! The keys are put into buckets of three or so. The buckets get their pilots the fullest first, while most slots are free:
//! the first pilot out of 256 that sends all keys of the bucket into free slots. If none does, which for 100,000 keys
//! happens less than once in a million times, everything begins again with another seed.

use crate::files::{
    Index,
    index::{Key, Slot, bucket_of, hash_of, run_at, slot_of},
};

/// Keys in a bucket, on average.
const KEYS_A_BUCKET: usize = 3;
/// Keys that a bucket has at the most; more are spread anew.
const FULLEST: usize = 32;

/// A key of a record. Records may share a key.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub key: Key,
    /// Number of the record from 1.
    pub number: u32,
    /// What look-ups ask of the record; 0 in an index whose keys records may share.
    pub answer: u32,
}

/// An index, owned.
#[derive(Clone, Debug, Default)]
pub(super) struct OwnedIndex {
    pilots: Vec<u8>,
    slots: Vec<Slot>,
    numbers: Vec<u32>,
    seed: u64,
    keys: usize,
}

/// A key in its bucket.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    hash: u64,
    /// Position from 0 of its pair.
    pair: u32,
}

impl OwnedIndex {
    /// An index of keys in the order of their records.
    pub fn new(pairs: &[Pair]) -> Self {
        if pairs.is_empty() {
            return Self::default();
        }
        // A quarter of the slots stays free: fewer would cost time here, more would cost cache.
        let slots = pairs.len() + pairs.len() / 4 + 1;
        (0..).find_map(|seed| Self::placed(pairs, slots, seed)).unwrap_or_default()
    }

    /// The index with this seed; `None` if a bucket finds no pilot.
    fn placed(pairs: &[Pair], slots: usize, seed: u64) -> Option<Self> {
        let buckets = pairs.len() / KEYS_A_BUCKET + 1;
        let (mut spread, begins) = spread(pairs, buckets, seed);
        let mut index = Self {
            pilots: vec![0; buckets],
            slots: vec![Slot::default(); slots],
            numbers: Vec::new(),
            seed,
            keys: 0,
        };
        let mut taken = Taken::new(slots);
        for &bucket in &fullest_first(&begins) {
            let range = begins.get(long(bucket)..)?;
            let keys = spread.get_mut(long(*range.first()?)..long(*range.get(1)?))?;
            // Equal keys come together, in the order of their records.
            keys.sort_by_key(|key| key.hash);
            *index.pilots.get_mut(long(bucket))? = index.place(pairs, keys, &mut taken)?;
        }
        Some(index)
    }

    /// Put the keys of a bucket into slots; gives its pilot. Equal keys stand together.
    fn place(&mut self, pairs: &[Pair], keys: &[Spread], taken: &mut Taken) -> Option<u8> {
        let mut hashes = [0; FULLEST];
        let mut count = 0;
        for run in keys.chunk_by(|a, b| a.hash == b.hash) {
            *hashes.get_mut(count)? = run.first()?.hash;
            count += 1;
        }
        let (pilot, slots) = taken.pilot(hashes.get(..count)?)?;
        for (run, &slot) in keys.chunk_by(|a, b| a.hash == b.hash).zip(&slots) {
            let pair = |spread: &Spread| pairs.get(long(spread.pair));
            let first = run.first().and_then(pair)?;
            // Two keys with one hash go their own ways with another seed.
            if !run.iter().filter_map(pair).all(|p| p.key == first.key) {
                return None;
            }
            let mut answer = first.answer;
            if run.len() > 1 {
                self.numbers.push(short(run.len()));
                answer = short(self.numbers.len());
                self.numbers.extend(run.iter().filter_map(pair).map(|p| p.number));
            }
            *self.slots.get_mut(slot)? = Slot { key: first.key, number: first.number, answer };
            self.keys += 1;
        }
        Some(pilot)
    }

    /// For looking up.
    pub fn view(&self) -> Index<'_> {
        Index {
            pilots: &self.pilots,
            slots: &self.slots,
            numbers: &self.numbers,
            seed: self.seed,
            keys: self.keys,
        }
    }

    /// All keys, in no order.
    pub fn keys(&self) -> impl Iterator<Item = Key> + '_ {
        self.slots.iter().filter(|slot| slot.number > 0).map(|slot| slot.key)
    }

    /// The record numbers of each key that several records have.
    pub fn shared(&self) -> impl Iterator<Item = &[u32]> {
        let mut position = 1;
        std::iter::from_fn(move || {
            let run = run_at(&self.numbers, position)?;
            position += short(run.len()) + 1;
            Some(run)
        })
    }
}

/// Which slots are taken, a bit each: what is asked so often must fit into the fastest cache.
struct Taken {
    bits: Vec<u64>,
    slots: usize,
}

impl Taken {
    fn new(slots: usize) -> Self {
        Self { bits: vec![0; slots.div_ceil(64)], slots }
    }

    fn is_free(&self, slot: usize) -> bool {
        self.bits.get(slot / 64).is_some_and(|word| word & (1 << (slot % 64)) == 0)
    }

    /// The first pilot that sends each hash into a free slot of its own, and these slots, which are then taken.
    fn pilot(&mut self, hashes: &[u64]) -> Option<(u8, [usize; FULLEST])> {
        let mut slots = [0; FULLEST];
        let mut fits = |pilot: &u8| {
            hashes.iter().enumerate().all(|(count, &hash)| {
                let slot = slot_of(hash, *pilot, self.slots);
                let (before, rest) = slots.split_at_mut(count);
                let free = self.is_free(slot) && !before.contains(&slot);
                free && rest.first_mut().map(|next| *next = slot).is_some()
            })
        };
        let pilot = (0..=u8::MAX).find(&mut fits)?;
        for &slot in slots.iter().take(hashes.len()) {
            *self.bits.get_mut(slot / 64)? |= 1 << (slot % 64);
        }
        Some((pilot, slots))
    }
}

/// The keys bucket after bucket, and where each bucket begins, the end of the last included.
fn spread(pairs: &[Pair], buckets: usize, seed: u64) -> (Vec<Spread>, Vec<u32>) {
    let hashes: Vec<u64> = pairs.iter().map(|pair| hash_of(pair.key, seed)).collect();
    let mut begins = vec![0_u32; buckets + 1];
    for &hash in &hashes {
        if let Some(count) = begins.get_mut(bucket_of(hash, buckets) + 1) {
            *count += 1;
        }
    }
    add_up(&mut begins);
    let mut next = begins.clone();
    let mut spread = vec![Spread::default(); pairs.len()];
    for (&hash, pair) in hashes.iter().zip(0..) {
        if let Some(next) = next.get_mut(bucket_of(hash, buckets))
            && let Some(key) = spread.get_mut(long(*next))
        {
            *key = Spread { hash, pair };
            *next += 1;
        }
    }
    (spread, begins)
}

/// The buckets, the fullest first; `begins` says where each begins.
fn fullest_first(begins: &[u32]) -> Vec<u32> {
    let emptiness = |range: &[u32]| match *range {
        [begin, end] => FULLEST.saturating_sub(long(end.saturating_sub(begin))),
        _ => FULLEST,
    };
    let mut next = vec![0_u32; FULLEST + 2];
    for range in begins.windows(2) {
        if let Some(count) = next.get_mut(emptiness(range) + 1) {
            *count += 1;
        }
    }
    add_up(&mut next);
    let mut order = vec![0_u32; begins.len().saturating_sub(1)];
    for (range, bucket) in begins.windows(2).zip(0..) {
        if let Some(next) = next.get_mut(emptiness(range))
            && let Some(place) = order.get_mut(long(*next))
        {
            *place = bucket;
            *next += 1;
        }
    }
    order
}

/// Replace each count by the sum of all up to it.
fn add_up(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
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

    /// Pairs of the keys with numbers from 1.
    fn numbered(keys: &[Key]) -> Vec<Pair> {
        keys.iter().zip(1..).map(|(&key, number)| Pair { key, number, answer: 0 }).collect()
    }

    const fn key(main: u128, rest: u64) -> Key {
        Key { main, rest }
    }

    proptest! {
        #[test]
        fn finds_what_a_map_finds(
            keys in prop::collection::vec((0_u128..50, 0_u64..10), 0..600), probe in (0_u128..50, 0_u64..10)
        ) {
            let keys: Vec<Key> = keys.into_iter().map(|(main, rest)| key(main, rest)).collect();
            let probe = key(probe.0, probe.1);
            let index = OwnedIndex::new(&numbered(&keys));
            let mut map: BTreeMap<Key, Vec<u32>> = BTreeMap::new();
            for (key, number) in keys.into_iter().zip(1..) {
                map.entry(key).or_default().push(number);
            }
            let found = map.get(&probe).cloned().unwrap_or_default();
            prop_assert_eq!(index.view().all(probe), found.as_slice());
            prop_assert_eq!(index.view().find(probe), found.first().copied());
            prop_assert_eq!(index.view().len(), map.len());
            prop_assert_eq!(index.shared().count(), map.values().filter(|n| n.len() > 1).count());
        }

        #[test]
        fn answers_for_a_key_of_one_record(keys in prop::collection::btree_set(0_u128..500, 0..300)) {
            let pairs = keys.iter().zip(1..).map(|(&main, number)| {
                Pair { key: key(main, 0), number, answer: number + 7 }
            });
            let index = OwnedIndex::new(&pairs.collect::<Vec<_>>());
            for main in 0..500 {
                let found = index.view().find(key(main, 0));
                prop_assert_eq!(found.is_some(), keys.contains(&main));
                prop_assert_eq!(index.view().answer(key(main, 0)), found.map(|number| number + 7));
            }
        }
    }

    #[test]
    fn a_key_of_many_records_needs_one_slot() {
        let index = OwnedIndex::new(&numbered(&[key(5, 1); 1000]));
        let view = index.view();
        assert_eq!((view.len(), view.all(key(5, 1)).len(), view.find(key(5, 0))), (1, 1000, None));
    }

    #[test]
    fn an_empty_index_finds_nothing() {
        let index = OwnedIndex::new(&[]);
        assert_eq!(
            (index.view().find(key(0, 0)), index.view().len(), index.view().is_empty()),
            (None, 0, true)
        );
        assert!(index.view().all(key(0, 0)).is_empty());
    }

    #[test]
    fn a_hundred_thousand_names_have_their_slots_at_the_first_try() {
        for stem in ["PART", "M", "A-LONG-ONE"] {
            let key = |i: u32| {
                crate::files::index::name_key(&rcs_core::name::Name16::clipped(&format!("{stem}{i}")))
            };
            let keys: Vec<Key> = (1..=100_000).map(key).collect();
            let index = OwnedIndex::new(&numbered(&keys));
            assert_eq!(index.seed, 0);
            assert!((1..=100_000).all(|i| index.view().find(key(i)) == Some(i)));
        }
    }
}
