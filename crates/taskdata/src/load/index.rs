//! Builds the indexes of [`crate::files::index`]. Keys are put into buckets of about three. Each bucket, the fullest
//! first, gets the first of 256 pilots that maps its keys to free slots. If there is none, which for 100,000 keys
//! happens less than once in a million times, the build starts again with another seed.

use crate::files::{
    Index,
    index::{CROWDED, ENTRIES, EntryAt, Group, Key, PlaceIndex, Slot, bucket_of, hash_of, run_at, slot_of},
};

const KEYS_A_BUCKET: usize = 3; // average
const FULLEST: usize = 32; // keys per bucket; with more, another seed is used

/// Records may share a key.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub key: Key,
    pub number: u32, // from 1
    pub answer: u32, // the field that look-ups need; 0 with shared keys
}

trait Cells: Default {
    fn empty(slots: usize) -> Self;

    fn key(pair: &Pair) -> Key {
        pair.key
    }

    fn put<'p>(&mut self, slot: usize, pairs: impl Iterator<Item = &'p Pair> + Clone);
}

#[derive(Clone, Debug, Default)]
struct Table<C> {
    pilots: Vec<u8>,
    seed: u64,
    cells: C,
}

#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    hash: u64,
    pair: u32, // of its pair, from 0
}

impl<C: Cells> Table<C> {
    fn new(pairs: &[Pair]) -> Self {
        if pairs.is_empty() {
            return Self::default();
        }
        // One fifth of the slots stays free. Fewer free slots would slow down the build, more would fill the cache.
        let slots = pairs.len() + pairs.len() / 4 + 1;
        (0..).find_map(|seed| Self::placed(pairs, slots, seed)).unwrap_or_default()
    }

    fn placed(pairs: &[Pair], slots: usize, seed: u64) -> Option<Self> {
        let buckets = pairs.len() / KEYS_A_BUCKET + 1;
        let hashes: Vec<u64> = pairs.iter().map(|pair| hash_of(C::key(pair), seed)).collect();
        let (mut spread, begins) = spread(&hashes, buckets);
        let mut table = Self { pilots: vec![0; buckets], seed, cells: C::empty(slots) };
        let mut taken = Taken::new(slots);
        for &bucket in &fullest_first(&begins) {
            let range = begins.get(long(bucket)..)?;
            let keys = spread.get_mut(long(*range.first()?)..long(*range.get(1)?))?;
            keys.sort_by_key(|key| key.hash); // equal keys become neighbours, in the order of their records
            *table.pilots.get_mut(long(bucket))? = table.place(pairs, keys, &mut taken)?;
        }
        Some(table)
    }

    /// Puts the keys of a bucket into slots; equal keys are neighbours. Returns the pilot.
    fn place(&mut self, pairs: &[Pair], keys: &[Spread], taken: &mut Taken) -> Option<u8> {
        let mut places = [Place::default(); FULLEST];
        let mut count = 0;
        for run in keys.chunk_by(|a, b| a.hash == b.hash) {
            places.get_mut(count)?.hash = run.first()?.hash;
            count += 1;
        }
        let pilot = taken.pilot(places.get_mut(..count)?)?;
        for (run, &Place { slot, .. }) in keys.chunk_by(|a, b| a.hash == b.hash).zip(&places) {
            let run = run.iter().filter_map(|spread| pairs.get(long(spread.pair)));
            let key = C::key(run.clone().next()?);
            // Another seed separates different keys with the same hash.
            if !run.clone().all(|pair| C::key(pair) == key) {
                return None;
            }
            self.cells.put(slot, run);
        }
        Some(pilot)
    }
}

#[derive(Clone, Debug, Default)]
struct Numbered {
    slots: Vec<Slot>,
    numbers: Vec<u32>,
    keys: usize,
}

impl Cells for Numbered {
    fn empty(slots: usize) -> Self {
        Self { slots: vec![Slot::default(); slots], numbers: Vec::new(), keys: 0 }
    }

    fn put<'p>(&mut self, slot: usize, pairs: impl Iterator<Item = &'p Pair> + Clone) {
        let mut all = pairs.clone();
        let (Some(first), Some(slot)) = (all.next(), self.slots.get_mut(slot)) else { return };
        *slot = Slot { key: first.key, number: first.number, answer: first.answer };
        self.keys += 1;
        if all.next().is_some() {
            self.numbers.push(short(pairs.clone().count()));
            slot.answer = short(self.numbers.len());
            self.numbers.extend(pairs.map(|pair| pair.number));
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct OwnedIndex(Table<Numbered>);

impl OwnedIndex {
    pub fn new(pairs: &[Pair]) -> Self {
        Self(Table::new(pairs))
    }

    pub fn view(&self) -> Index<'_> {
        let Table { pilots, seed, cells } = &self.0;
        Index { pilots, slots: &cells.slots, numbers: &cells.numbers, seed: *seed, keys: cells.keys }
    }

    pub fn keys(&self) -> impl Iterator<Item = Key> + '_ {
        self.0.cells.slots.iter().filter(|slot| slot.number > 0).map(|slot| slot.key)
    }

    pub fn shared(&self) -> impl Iterator<Item = &[u32]> {
        let mut position = 1;
        std::iter::from_fn(move || {
            let run = run_at(&self.0.cells.numbers, position)?;
            position += short(run.len()) + 1;
            Some(run)
        })
    }
}

#[derive(Clone, Debug, Default)]
struct Grouped {
    groups: Vec<Group>,
    crowded: Vec<Pair>, // keys with too many locations for a group
}

impl Cells for Grouped {
    fn empty(slots: usize) -> Self {
        Self { groups: vec![Group::default(); slots], crowded: Vec::new() }
    }

    fn key(pair: &Pair) -> Key {
        pair.key.without_place()
    }

    fn put<'p>(&mut self, slot: usize, pairs: impl Iterator<Item = &'p Pair> + Clone) {
        let (Some(first), Some(group)) = (pairs.clone().next(), self.groups.get_mut(slot)) else { return };
        let mut entries = [EntryAt::default(); ENTRIES];
        let mut free = entries.iter_mut();
        let mut known = [0; ENTRIES]; // the index of `crowded` keys finds two records for one location
        let fits = pairs.clone().zip(0..).all(|(pair, i)| {
            let at = pair.key.place().filter(|at| !known.contains(at));
            let (Some(at), Some(entry), Some(known)) = (at, free.next(), known.get_mut(i)) else {
                return false;
            };
            *known = at;
            *entry = EntryAt { at, number: pair.number, answer: pair.answer };
            true
        });
        if !fits {
            entries = Default::default();
            self.crowded.extend(pairs.clone());
        }
        let count = if fits { short(pairs.count()) } else { CROWDED };
        *group = Group { key: Self::key(first), entries, count };
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct OwnedPlaceIndex {
    table: Table<Grouped>,
    crowded: OwnedIndex,
}

impl OwnedPlaceIndex {
    pub fn new(pairs: &[Pair]) -> Self {
        let mut table: Table<Grouped> = Table::new(pairs);
        let crowded = OwnedIndex::new(&std::mem::take(&mut table.cells.crowded));
        Self { table, crowded }
    }

    pub fn view(&self) -> PlaceIndex<'_> {
        let Table { pilots, seed, cells } = &self.table;
        PlaceIndex { pilots, groups: &cells.groups, seed: *seed, crowded: self.crowded.view() }
    }

    pub fn shared(&self) -> impl Iterator<Item = &[u32]> {
        self.crowded.shared()
    }
}

#[derive(Clone, Copy, Default)]
struct Place {
    hash: u64,
    slot: usize,
}

/// Occupied slots, one bit each, so that they fit into the fastest cache.
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

    /// The first pilot that maps each hash to a free slot. Marks the slots and stores them in `hashes`.
    fn pilot(&mut self, hashes: &mut [Place]) -> Option<u8> {
        let mut fits = |pilot: &u8| {
            (0..hashes.len()).all(|count| {
                let Some((place, before)) = hashes.get_mut(..=count).and_then(<[Place]>::split_last_mut)
                else {
                    return false;
                };
                place.slot = slot_of(place.hash, *pilot, self.slots);
                self.is_free(place.slot) && !before.iter().any(|other| other.slot == place.slot)
            })
        };
        let pilot = (0..=u8::MAX).find(&mut fits)?;
        for place in hashes.iter() {
            *self.bits.get_mut(place.slot / 64)? |= 1 << (place.slot % 64);
        }
        Some(pilot)
    }
}

/// The keys, sorted by bucket, and the start of each bucket, followed by the end of the last.
fn spread(hashes: &[u64], buckets: usize) -> (Vec<Spread>, Vec<u32>) {
    let mut begins = vec![0_u32; buckets + 1];
    for &hash in hashes {
        if let Some(count) = begins.get_mut(bucket_of(hash, buckets) + 1) {
            *count += 1;
        }
    }
    add_up(&mut begins);
    let mut next = begins.clone();
    let mut spread = vec![Spread::default(); hashes.len()];
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

/// Buckets, the fullest first; `begins` has their starts.
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

    fn numbered(keys: &[Key]) -> Vec<Pair> {
        keys.iter().zip(1..).map(|(&key, number)| Pair { key, number, answer: 0 }).collect()
    }

    const fn key(main: u64, rest: u64) -> Key {
        Key { main: [0, main], rest }
    }

    proptest! {
        #[test]
        fn index_agrees_with_a_map(
            keys in prop::collection::vec((0_u64..50, 0_u64..10), 0..600), probe in (0_u64..50, 0_u64..10)
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
        fn first_location_with_an_entry_is_found(
            entries in prop::collection::btree_set((0_u64..6, 0_u64..3, 0_usize..9), 0..60),
            object in 0_u64..6, grip in 0_u64..3, at in 0_usize..3, owners in prop::collection::vec(3_usize..8, 0..3),
        ) {
            use crate::files::{ArrayId, LocptId, OwnerId, Reference, index::name_at_key};
            let places: Vec<Reference> = (1..3).map(|n| Reference::location_point(LocptId::new(n)))
                .chain([Reference::array(ArrayId::new(1))])
                .chain((1..6).map(|n| Reference::owner(OwnerId::new(n))))
                .chain([Reference::ANY]).collect();
            let key = |object: u64, grip: u64, place: usize| {
                let name = rcs_core::name::Name10::clipped(&format!("P{object}"));
                let key = name_at_key(&name, places[place]);
                Key { rest: key.rest | (grip << 40), ..key }
            };
            let entries: Vec<_> = entries.into_iter().collect();
            let pairs = entries.iter().zip(1..).map(|(&(o, g, p), number)| {
                Pair { key: key(o, g, p), number, answer: number + 7 }
            });
            let index = OwnedPlaceIndex::new(&pairs.collect::<Vec<_>>());
            let mut asked = std::iter::once(at).chain(owners.iter().copied()).chain([8]);
            let expected = asked.find_map(|place| entries.iter().position(|e| *e == (object, grip, place)));
            let owners = owners.iter().map(|place| places[*place]);
            let found = index.view().first(key(object, grip, 8), [places[at], Reference::array(ArrayId::NULL)], owners);
            prop_assert_eq!(found.map(|e| e.number), expected.map(|i| short(i) + 1));
            prop_assert_eq!(found.map(|e| e.answer), expected.map(|i| short(i) + 8));
            prop_assert_eq!(index.shared().count(), 0);
        }

        #[test]
        fn key_of_one_record_has_an_answer(keys in prop::collection::btree_set(0_u64..500, 0..300)) {
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
    fn key_of_many_records_needs_one_slot() {
        let index = OwnedIndex::new(&numbered(&[key(5, 1); 1000]));
        let view = index.view();
        assert_eq!((view.len(), view.all(key(5, 1)).len(), view.find(key(5, 0))), (1, 1000, None));
    }

    #[test]
    fn two_records_for_one_location_are_found() {
        use crate::files::{Reference, index::name_at_key};
        let key = name_at_key(&rcs_core::name::Name10::clipped("PART"), Reference::ANY);
        let index = OwnedPlaceIndex::new(&numbered(&[key, key]));
        assert_eq!(index.shared().collect::<Vec<_>>(), [[1, 2]]);
        assert!(OwnedPlaceIndex::new(&[]).view().first(key, [Reference::NONE; 2], [].into_iter()).is_none());
    }

    #[test]
    fn empty_index_finds_no_record() {
        let index = OwnedIndex::new(&[]);
        assert_eq!(
            (index.view().find(key(0, 0)), index.view().len(), index.view().is_empty()),
            (None, 0, true)
        );
        assert!(index.view().all(key(0, 0)).is_empty());
    }

    #[test]
    fn hundred_thousand_names_need_one_seed() {
        for stem in ["PART", "M", "A-LONG-ONE"] {
            let key = |i: u32| {
                crate::files::index::name_key(&rcs_core::name::Name16::clipped(&format!("{stem}{i}")))
            };
            let keys: Vec<Key> = (1..=100_000).map(key).collect();
            let index = OwnedIndex::new(&numbered(&keys));
            assert_eq!(index.0.seed, 0);
            assert!((1..=100_000).all(|i| index.view().find(key(i)) == Some(i)));
        }
    }
}
