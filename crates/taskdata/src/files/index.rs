//! Sorted indexes: one binary search answers every look-up that is not by record number.
//!
//! A key is one 128-bit integer: a name, or an object, a grip and a location packed side by side. Integers compare in one
//! step and lie close together, so that 17 steps through 100,000 keys stay in the cache; a hash table would be faster in
//! the mean but has no worst case that a 40 ms tick could be planned with.

use rcs_core::name::Name;

use super::{
    ids::ObjectId,
    records::{Direction, Reference},
};

/// Keys in ascending order, and the record number of each.
#[derive(Clone, Copy, Debug, Default)]
pub struct Index<'a> {
    keys: &'a [u128],
    numbers: &'a [u32],
}

impl<'a> Index<'a> {
    /// An index over `keys` in ascending order and the record number of each.
    ///
    /// `None` if the two differ in length or the keys are not in order.
    #[must_use]
    pub fn new(keys: &'a [u128], numbers: &'a [u32]) -> Option<Self> {
        (keys.len() == numbers.len() && keys.is_sorted()).then_some(Self { keys, numbers })
    }

    /// An index over what was sorted before; [`Index::new`] without its check of every key.
    #[cfg(feature = "load")]
    pub(crate) const fn sorted(keys: &'a [u128], numbers: &'a [u32]) -> Self {
        Self { keys, numbers }
    }

    /// The record number of a key; of the first, if several records have it.
    #[must_use]
    pub fn find(&self, key: u128) -> Option<u32> {
        let position = self.keys.partition_point(|&k| k < key);
        if *self.keys.get(position)? == key { self.numbers.get(position).copied() } else { None }
    }

    /// The record numbers of all records with a key, in the order in which they were entered.
    #[must_use]
    pub fn all(&self, key: u128) -> &'a [u32] {
        let first = self.keys.partition_point(|&k| k < key);
        let rest = self.keys.get(first..).unwrap_or_default();
        let count = rest.partition_point(|&k| k == key);
        self.numbers.get(first..).and_then(|n| n.get(..count)).unwrap_or_default()
    }

    /// Number of keys.
    #[must_use]
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// True if there is no key.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
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
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn finds_what_a_map_finds(entries in prop::collection::btree_map(0_u128..500, 1_u32..1000, 0..300), probe in 0_u128..500) {
            let keys: Vec<u128> = entries.keys().copied().collect();
            let numbers: Vec<u32> = entries.values().copied().collect();
            let index = Index::new(&keys, &numbers).unwrap();
            let map: BTreeMap<u128, u32> = entries;
            prop_assert_eq!(index.find(probe), map.get(&probe).copied());
            prop_assert_eq!(index.all(probe).first().copied(), map.get(&probe).copied());
        }

        #[test]
        fn names_sort_as_texts_do(a in "[!-~]{1,10}", b in "[!-~]{1,10}") {
            let key = |t: &str| name_key(&Name10::new(t).unwrap());
            prop_assert_eq!(key(&a).cmp(&key(&b)), a.as_bytes().cmp(b.as_bytes()));
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
    }

    #[test]
    fn several_records_with_a_key_come_in_order() {
        let index = Index::new(&[1, 5, 5, 5, 9], &[7, 3, 1, 2, 4]).unwrap();
        assert_eq!(index.all(5), [3, 1, 2]);
        assert_eq!(index.find(5), Some(3));
        assert!(index.all(6).is_empty());
        assert!(Index::new(&[2, 1], &[1, 2]).is_none());
        assert!(Index::new(&[1], &[]).is_none());
    }
}
