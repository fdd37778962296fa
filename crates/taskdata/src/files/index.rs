//! Indexes: every look-up that is not by record number takes a bounded number of steps, however many records there are.
//!
//! A key is one 128-bit integer: a name, or an object, a grip and a location packed side by side. Keys are spread over
//! buckets by a hash, the keys of a bucket lie side by side, and no bucket has more than [`LONGEST_BUCKET`] of them: the
//! loader tries seeds of the hash until that holds. So a look-up reads one place in the table of buckets and at most eight
//! keys after one another, which is both faster than a binary search and as easy to plan a 40 ms tick with. The mean is
//! one key.

use rcs_core::name::Name;

use super::{
    ids::ObjectId,
    records::{Direction, Reference},
};

/// Keys that a bucket has at the most.
pub const LONGEST_BUCKET: usize = 8;

/// A key, and where its record numbers stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slot {
    /// The key.
    pub(crate) key: u128,
    /// Record number of the first record that has it.
    pub(crate) number: u32,
    /// Position from 0 of that number among all numbers.
    pub(crate) first: u32,
    /// Records that have it.
    pub(crate) count: u32,
}

/// Keys in buckets, and the record numbers of each key. Built by the loader.
#[derive(Clone, Copy, Debug, Default)]
pub struct Index<'a> {
    /// Where the slots of each bucket begin, and after the last bucket where they end.
    pub(crate) buckets: &'a [u32],
    /// The keys, bucket after bucket.
    pub(crate) slots: &'a [Slot],
    /// Record numbers, those of a key together and in the order in which they were entered.
    pub(crate) numbers: &'a [u32],
    /// Seed of the hash.
    pub(crate) seed: u64,
}

/// The bucket of a key out of `buckets`.
pub(crate) fn bucket_of(key: u128, seed: u64, buckets: usize) -> usize {
    // Two folded multiplications: each result is the exclusive or of the two halves of a product of 128 bits.
    let fold = |a: u64, b: u64| {
        let product = u128::from(a).wrapping_mul(u128::from(b));
        low(product) ^ low(product >> 64)
    };
    let mixed = fold(low(key) ^ seed ^ 0x9E37_79B9_7F4A_7C15, low(key >> 64) ^ 0xD1B5_4A32_D192_ED03);
    let mixed = fold(mixed ^ seed, 0x2127_599B_F432_5C37);
    let buckets = u128::try_from(buckets).unwrap_or(0);
    usize::try_from(u128::from(mixed).wrapping_mul(buckets) >> 64).unwrap_or(0)
}

/// The lower half.
fn low(value: u128) -> u64 {
    u64::try_from(value & u128::from(u64::MAX)).unwrap_or(0)
}

impl<'a> Index<'a> {
    fn slot(&self, key: u128) -> Option<&'a Slot> {
        let bucket = bucket_of(key, self.seed, self.buckets.len().checked_sub(1)?);
        let first = usize::try_from(*self.buckets.get(bucket)?).ok()?;
        let end = usize::try_from(*self.buckets.get(bucket.checked_add(1)?)?).ok()?;
        self.slots.get(first..end)?.iter().find(|slot| slot.key == key)
    }

    /// The record number of a key; of the first, if several records have it.
    #[must_use]
    pub fn find(&self, key: u128) -> Option<u32> {
        self.slot(key).map(|slot| slot.number)
    }

    /// The record numbers of all records with a key, in the order in which they were entered.
    #[must_use]
    pub fn all(&self, key: u128) -> &'a [u32] {
        let numbers = self.numbers;
        self.slot(key)
            .and_then(|slot| {
                let first = usize::try_from(slot.first).ok()?;
                numbers.get(first..)?.get(..usize::try_from(slot.count).ok()?)
            })
            .unwrap_or_default()
    }

    /// Number of keys.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.slots.len()
    }

    /// True if there is no key.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }
}

/// The key of a name. The same text has the same key in every width, so that a 16-character field of a command finds a
/// 10-character name.
#[must_use]
pub fn name_key<const N: usize>(name: &Name<N>) -> u128 {
    let mut bytes = [0_u8; 16];
    for (slot, byte) in bytes.iter_mut().zip(name.bytes()) {
        *slot = *byte;
    }
    u128::from_be_bytes(bytes)
}

fn reference_bits(reference: Reference) -> u128 {
    (u128::from(reference.kind.code()) << 32) | u128::from(reference.number)
}

/// The key of a reference: members by what they are, trajectories by their ends.
#[must_use]
pub fn reference_key(reference: Reference) -> u128 {
    reference_bits(reference)
}

/// The key of a start and an end.
#[must_use]
pub fn pair_key(start: Reference, end: Reference) -> u128 {
    (reference_bits(start) << 64) | reference_bits(end)
}

/// The key of an object.
#[must_use]
pub fn object_key(object: ObjectId) -> u128 {
    u128::from(object.number())
}

/// The key of an object and a grip.
#[must_use]
pub fn grip_key(object: ObjectId, grip: i32) -> u128 {
    (u128::from(object.number()) << 32) | u128::from(grip.cast_unsigned())
}

/// The key of an object, a grip and a location.
#[must_use]
pub fn grip_at_key(object: ObjectId, grip: i32, at: Reference) -> u128 {
    (grip_key(object, grip) << 64) | reference_bits(at)
}

/// The key of an object and a location.
#[must_use]
pub fn object_at_key(object: ObjectId, at: Reference) -> u128 {
    (object_key(object) << 64) | reference_bits(at)
}

/// The key of an approach or depart: its subject, grip and location.
#[must_use]
pub fn approach_key(direction: Direction, subject: Reference, grip: i32, at: Reference) -> u128 {
    (u128::from(direction.code()) << 120)
        | (u128::from(subject.kind.code()) << 112)
        | (u128::from(at.kind.code()) << 104)
        | (u128::from(subject.number) << 64)
        | (u128::from(grip.cast_unsigned()) << 32)
        | u128::from(at.number)
}

/// The key of a relative move: its name and location. `None` for a name of more than ten characters, which no relative move
/// has.
#[must_use]
pub fn relative_key<const N: usize>(name: &Name<N>, at: Reference) -> Option<u128> {
    // Ten characters leave the 48 bits free in which a reference lies.
    let name = name_key(name);
    (name & ((1 << 48) - 1) == 0).then(|| name | reference_bits(at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::records::RefType;
    use proptest::prelude::*;
    use rcs_core::name::{Name10, Name16};

    proptest! {
        #[test]
        fn the_same_text_has_the_same_key_in_every_width(a in "[!-~]{1,10}", b in "[!-~]{1,10}") {
            let key = |t: &str| name_key(&Name10::new(t).unwrap());
            prop_assert_eq!(key(&a) == key(&b), a == b);
            prop_assert_eq!(key(&a), name_key(&Name16::new(&a).unwrap()));
        }

        #[test]
        fn approaches_that_differ_have_keys_that_differ(
            d in 0_usize..2, s in (0_u8..9, any::<u32>()), g in any::<i32>(), p in (0_u8..9, any::<u32>()),
            e in 0_usize..2, t in (0_u8..9, any::<u32>()), h in any::<i32>(), q in (0_u8..9, any::<u32>()),
        ) {
            let reference = |(code, number)| Reference { kind: RefType::from_code(code).unwrap(), number };
            let one = (Direction::ALL[d], reference(s), g, reference(p));
            let two = (Direction::ALL[e], reference(t), h, reference(q));
            let key = |(d, s, g, p)| approach_key(d, s, g, p);
            prop_assert_eq!(one == two, key(one) == key(two));
        }

        #[test]
        fn relative_moves_that_differ_have_keys_that_differ(
            a in "[AB]{1,10}", s in (0_u8..9, any::<u32>()), b in "[AB]{1,10}", t in (0_u8..9, any::<u32>()),
        ) {
            let reference = |(code, number)| Reference { kind: RefType::from_code(code).unwrap(), number };
            let key = |name: &str, at| relative_key(&Name16::new(name).unwrap(), reference(at)).unwrap();
            prop_assert_eq!((&a, s) == (&b, t), key(&a, s) == key(&b, t));
        }
    }

    #[test]
    fn no_relative_move_has_a_name_of_eleven_characters() {
        assert_eq!(relative_key(&Name16::new("ABCDEFGHIJK").unwrap(), Reference::ANY), None);
    }
}
