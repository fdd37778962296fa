//! Indexes: a look-up other than by record number reads one pilot and one slot, for any number of records.
//!
//! A key is three integers: usually a name, and a grip and a location packed into one. The index is a perfect hash
//! table: a hash selects one of many small buckets. The bucket's *pilot*, one byte, is mixed into the hash; the result
//! selects the slot. The loader chooses pilots so that no two keys share a slot. The pilots of 100,000 keys (33 kB)
//! stay in the processor's cache; the slot is one read of half a cache line. It contains the record number and, where
//! look-ups need only one field, that field.
//!
//! An entry valid at a location is looked up at the location point, the array on it, the owners, and the wild card in
//! turn. All such entries of one name and grip share a slot of a [`PlaceIndex`], so one cache line shows the locations
//! with an entry.

use interfaces::record_number::ObjectId;
use rcs_core::name::Name;

use super::{
    records::Direction,
    reference::{RefType, Reference},
};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// A name, or one or two references. One integer of 128 bits would double the size of a [`Slot`] by its alignment.
    pub(crate) main: [u64; 2],
    pub(crate) rest: u64, // grip, location or direction, or 0
}

/// A key and its answer: 32 bytes, aligned so that no slot lies across two cache lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(align(32))]
pub struct Slot {
    pub(crate) key: Key,
    pub(crate) number: u32, // first record with the key; 0: no key
    /// The field that look-ups need, or 0; for several records their position, from 1, in [`Index::numbers`].
    pub(crate) answer: u32,
}

const _: () = assert!(size_of::<Slot>() == 32);

#[derive(Clone, Copy, Debug, Default)]
pub struct Index<'a> {
    pub(crate) pilots: &'a [u8],
    pub(crate) slots: &'a [Slot], // some of them empty
    /// For each key of several records: their count, then their numbers in the order of entry.
    pub(crate) numbers: &'a [u32],
    pub(crate) seed: u64,
    pub(crate) keys: usize,
}

fn product(a: u64, b: u64) -> (u64, u64) {
    let product = u128::from(a).wrapping_mul(u128::from(b));
    (low(product >> 64), low(product))
}

fn low(value: u128) -> u64 {
    u64::try_from(value & u128::from(u64::MAX)).unwrap_or(0)
}

fn scaled(value: u64, end: usize) -> usize {
    usize::try_from(product(value, u64::try_from(end).unwrap_or(0)).0).unwrap_or(0)
}

/// Hashes by folded multiplications: each takes the exclusive or of the two halves of a product.
pub(crate) fn hash_of(key: Key, seed: u64) -> u64 {
    let fold = |(high, low): (u64, u64)| high ^ low;
    let [upper, lower] = key.main;
    let mixed = fold(product(lower ^ seed ^ 0x9E37_79B9_7F4A_7C15, upper ^ 0xD1B5_4A32_D192_ED03));
    fold(product(mixed ^ seed, key.rest ^ 0x2127_599B_F432_5C37))
}

pub(crate) fn bucket_of(hash: u64, buckets: usize) -> usize {
    scaled(hash, buckets)
}

pub(crate) fn slot_of(hash: u64, pilot: u8, slots: usize) -> usize {
    let turned = hash ^ u64::from(pilot).wrapping_mul(0xA076_1D64_78BD_642F);
    // The hashes of a bucket have equal upper bits, so the product moves the lower bits up.
    scaled(turned.wrapping_mul(0xE703_7ED1_A0B4_28DB), slots)
}

fn slot_at<'a, S>(pilots: &[u8], slots: &'a [S], seed: u64, key: Key) -> Option<&'a S> {
    let hash = hash_of(key, seed);
    let pilot = *pilots.get(bucket_of(hash, pilots.len()))?;
    slots.get(slot_of(hash, pilot, slots.len()))
}

impl<'a> Index<'a> {
    fn slot(&self, key: Key) -> Option<&'a Slot> {
        slot_at(self.pilots, self.slots, self.seed, key).filter(|slot| slot.key == key && slot.number > 0)
    }

    /// The record number of a key; the first, if several records share the key.
    #[must_use]
    pub fn find(&self, key: Key) -> Option<u32> {
        self.slot(key).map(|slot| slot.number)
    }

    /// The answer for a key, in an index with answers ([`super::data::Indexes`]).
    #[must_use]
    pub fn answer(&self, key: Key) -> Option<u32> {
        self.slot(key).map(|slot| slot.answer)
    }

    /// All record numbers in the order of entry, in an index without answers.
    #[must_use]
    pub fn all(&self, key: Key) -> &'a [u32] {
        match self.slot(key) {
            None => &[],
            Some(Slot { number, answer: 0, .. }) => core::slice::from_ref(number),
            Some(slot) => run_at(self.numbers, slot.answer).unwrap_or_default(),
        }
    }

    #[must_use]
    pub const fn len(&self) -> usize {
        self.keys
    }

    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.keys == 0
    }
}

pub(crate) const ENTRIES: usize = 3; // in a `Group`
pub(crate) const CROWDED: u32 = u32::MAX; // the entries do not fit: see `PlaceIndex::crowded`

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EntryAt {
    pub(crate) at: u32, // packed location; 0: no entry
    pub(crate) number: u32,
    pub(crate) answer: u32, // the field that look-ups need
}

/// The entries of a key at all its locations, in one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub struct Group {
    pub(crate) key: Key,
    pub(crate) entries: [EntryAt; ENTRIES], // in no particular order
    pub(crate) count: u32,                  // or `CROWDED`; 0: no key
}

const _: () = assert!(size_of::<Group>() == 64);

impl Group {
    fn entry(&self, at: Reference) -> Option<&EntryAt> {
        let at = packed(at)?;
        self.entries.iter().find(|entry| entry.at == at)
    }

    fn names(&self, kind: RefType) -> bool {
        self.entries.iter().any(|entry| entry.at >> 28 == u32::from(kind.code()))
    }
}

/// Packs a reference into 32 bits, never 0; `None` for no reference, or a record number beyond the files.
pub(crate) fn packed(at: Reference) -> Option<u32> {
    let kind = u32::from(at.kind.code());
    let known = kind > 0 && kind < 16 && at.number < 1 << 28 && (at.number > 0 || at.kind == RefType::Any);
    known.then_some((kind << 28) | at.number)
}

/// Entries that are valid at locations, by a key without the location. Built by the loader.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaceIndex<'a> {
    pub(crate) pilots: &'a [u8],
    pub(crate) groups: &'a [Group], // some of them empty
    pub(crate) seed: u64,
    pub(crate) crowded: Index<'a>, // entries that do not fit into a group, by key and location
}

impl<'a> PlaceIndex<'a> {
    /// The entry of the first location with one, in the order `exact`, `owners`, wild card. Ignores the key's location.
    pub(crate) fn first(
        &self,
        key: Key,
        exact: [Reference; 2],
        mut owners: impl Iterator<Item = Reference>,
    ) -> Option<EntryAt> {
        let key = key.without_place();
        let group = slot_at(self.pilots, self.groups, self.seed, key)?;
        if group.key != key || group.count == 0 {
            return None;
        }
        if group.count == CROWDED {
            let any = core::iter::once(Reference::ANY);
            return exact.into_iter().chain(owners).chain(any).find_map(|at| self.crowded.entry(key.at(at)));
        }
        for at in exact {
            if let Some(entry) = group.entry(at) {
                return Some(*entry);
            }
        }
        // Most entries name a location point or the wild card, so the owners need not be read.
        if group.names(RefType::Owner)
            && let Some(entry) = owners.find_map(|at| group.entry(at))
        {
            return Some(*entry);
        }
        group.entry(Reference::ANY).copied()
    }
}

impl Index<'_> {
    fn entry(&self, key: Key) -> Option<EntryAt> {
        self.slot(key).map(|slot| EntryAt { at: 0, number: slot.number, answer: slot.answer })
    }
}

/// The bits of the location in [`Key::rest`], in the keys of a [`PlaceIndex`].
const PLACE_BITS: u64 = (1 << 40) - 1;

impl Key {
    pub(crate) const fn without_place(self) -> Self {
        Self { rest: self.rest & !PLACE_BITS, ..self }
    }

    fn at(self, at: Reference) -> Self {
        Self { rest: (self.rest & !PLACE_BITS) | reference_bits(at), ..self }
    }

    #[must_use]
    pub fn place(self) -> Option<u32> {
        let kind = u8::try_from((self.rest & PLACE_BITS) >> 32).ok().and_then(RefType::from_code)?;
        packed(Reference { kind, number: u32::try_from(self.rest & u64::from(u32::MAX)).ok()? })
    }
}

/// Record numbers of a key of several records, at a position in [`Index::numbers`].
pub(crate) fn run_at(numbers: &[u32], position: u32) -> Option<&[u32]> {
    let position = usize::try_from(position).ok()?;
    let count = *numbers.get(position.checked_sub(1)?)?;
    numbers.get(position..)?.get(..usize::try_from(count).ok()?)
}

/// The bits of a name do not depend on its width, so a 16-character field finds a 10-character name.
fn name_bits<const N: usize>(name: &Name<N>) -> [u64; 2] {
    let mut bytes = [[0_u8; 8]; 2];
    for (slot, byte) in bytes.as_flattened_mut().iter_mut().zip(name.bytes()) {
        *slot = *byte;
    }
    bytes.map(u64::from_be_bytes)
}

fn reference_bits(reference: Reference) -> u64 {
    (u64::from(reference.kind.code()) << 32) | u64::from(reference.number)
}

/// Packs a grip into 8 bits; `None` beyond -128 to 127.
fn grip_bits(grip: i32) -> Option<u64> {
    Some(u64::from(i8::try_from(grip).ok()?.cast_unsigned()))
}

#[must_use]
pub fn name_key<const N: usize>(name: &Name<N>) -> Key {
    Key { main: name_bits(name), rest: 0 }
}

#[must_use]
pub fn reference_key(reference: Reference) -> Key {
    Key { main: [0, reference_bits(reference)], rest: 0 }
}

#[must_use]
pub fn pair_key(start: Reference, end: Reference) -> Key {
    Key { main: [0, reference_bits(start)], rest: reference_bits(end) }
}

#[must_use]
pub fn object_key(object: ObjectId) -> Key {
    Key { main: [0, u64::from(object.number())], rest: 0 }
}

/// Returns `None` for a grip beyond -128 to 127, which forms cannot have.
#[must_use]
pub fn grip_key<const N: usize>(object: &Name<N>, grip: i32) -> Option<Key> {
    Some(Key { main: name_bits(object), rest: grip_bits(grip)? })
}

#[must_use]
pub fn grip_at_key<const N: usize>(object: &Name<N>, grip: i32, at: Reference) -> Option<Key> {
    Some(Key { main: name_bits(object), rest: (grip_bits(grip)? << 40) | reference_bits(at) })
}

/// The key of a view, by the object's name, or of a relative move, by its name.
#[must_use]
pub fn name_at_key<const N: usize>(name: &Name<N>, at: Reference) -> Key {
    Key { main: name_bits(name), rest: reference_bits(at) }
}

/// The key of an approach or depart at an object or its view; returns `None` like [`grip_key`].
#[must_use]
pub fn approach_key<const N: usize>(
    direction: Direction,
    kind: RefType,
    object: &Name<N>,
    grip: i32,
    at: Reference,
) -> Option<Key> {
    let from = (u64::from(direction.code()) << 8) | u64::from(kind.code());
    let key = grip_at_key(object, grip, at)?;
    Some(Key { rest: (from << 48) | key.rest, ..key })
}

/// The key of an approach or depart at a location itself, which contains no name.
#[must_use]
pub fn plain_key(direction: Direction, at: Reference) -> Key {
    Key { main: [0; 2], rest: (u64::from(direction.code()) << 56) | reference_bits(at) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rcs_core::name::{Name10, Name16};

    proptest! {
        #[test]
        fn key_does_not_depend_on_the_name_width(a in "[!-~]{1,10}", b in "[!-~]{1,10}") {
            let key = |t: &str| name_key(&Name10::new(t).unwrap());
            prop_assert_eq!(key(&a) == key(&b), a == b);
            prop_assert_eq!(key(&a), name_key(&Name16::new(&a).unwrap()));
        }

        #[test]
        fn different_approaches_have_different_keys(
            d in 0_usize..2, s in (0_u8..9, "[AB]{1,2}"), g in -128..128, p in (0_u8..9, 0_u32..2),
            e in 0_usize..2, t in (0_u8..9, "[AB]{1,2}"), h in -128..128, q in (0_u8..9, 0_u32..2),
        ) {
            let key = |d: usize, (kind, name): &(u8, String), grip, at| {
                let kind = RefType::from_code(*kind).unwrap();
                approach_key(Direction::ALL[d], kind, &Name16::new(name).unwrap(), grip, at).unwrap()
            };
            let (at, other_at) = (reference(p), reference(q));
            let (one, two) = (key(d, &s, g, at), key(e, &t, h, other_at));
            prop_assert_eq!((d, &s, g, p) == (e, &t, h, q), one == two);
            prop_assert_ne!(one, plain_key(Direction::ALL[e], other_at));
            prop_assert_eq!(
                (d, p) == (e, q),
                plain_key(Direction::ALL[d], at) == plain_key(Direction::ALL[e], other_at)
            );
        }

        #[test]
        fn different_grips_at_locations_have_different_keys(
            a in "[AB]{1,10}", s in (0_u8..9, any::<u32>()), g in -128..128,
            b in "[AB]{1,10}", t in (0_u8..9, any::<u32>()), h in -128..128,
        ) {
            let name = |text: &str| Name16::new(text).unwrap();
            let (at, other_at) = (reference(s), reference(t));
            prop_assert_eq!((&a, s) == (&b, t), name_at_key(&name(&a), at) == name_at_key(&name(&b), other_at));
            let (one, two) = (grip_at_key(&name(&a), g, at), grip_at_key(&name(&b), h, other_at));
            prop_assert_eq!((&a, g, s) == (&b, h, t), one == two);
            prop_assert_eq!((&a, g) == (&b, h), grip_key(&name(&a), g) == grip_key(&name(&b), h));
            prop_assert_eq!((s, t) == (t, s), pair_key(at, other_at) == pair_key(other_at, at));
        }
    }

    fn reference((code, number): (u8, u32)) -> Reference {
        Reference { kind: RefType::from_code(code).unwrap(), number }
    }

    #[test]
    fn grip_of_three_digits_has_no_key() {
        let name = Name10::new("BAR").unwrap();
        assert_eq!((grip_key(&name, 128), grip_at_key(&name, -129, Reference::ANY)), (None, None));
        assert!(grip_key(&name, -128).is_some());
    }
}
