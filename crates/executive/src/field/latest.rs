//! The newest value from one thread to another: a sequence lock of atomics. Neither thread waits or allocates. A reader
//! that finds an odd sequence, or another one after its copy, tries again a few times, then keeps its value.

use std::{
    marker::PhantomData,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering, fence},
    },
};

use rcs_core::{
    Plain,
    plain::{Reader as ImageReader, Writer as ImageWriter},
};

/// Attempts of a reader. A write takes less than a microsecond; only a writer that lost its processor makes them fail.
const ATTEMPTS: usize = 4;
const WORD: usize = 8;

struct Shared {
    sequence: AtomicU64,
    words: Box<[AtomicU64]>,
}

pub struct Writer<T> {
    shared: Arc<Shared>,
    image: Box<[u8]>,
    holds: PhantomData<T>,
}

pub struct Reader<T> {
    shared: Arc<Shared>,
    image: Box<[u8]>,
    sequence: u64,
    value: T,
}

/// Makes both ends. The reader has the value `first` until the writer writes one.
#[must_use]
pub fn latest<T: Plain>(first: T) -> (Writer<T>, Reader<T>) {
    let count = T::SIZE.div_ceil(WORD);
    let words = (0..count).map(|_| AtomicU64::new(0)).collect();
    let shared = Arc::new(Shared { sequence: AtomicU64::new(0), words });
    let image = || vec![0; count * WORD].into_boxed_slice();
    let writer = Writer { shared: Arc::clone(&shared), image: image(), holds: PhantomData };
    (writer, Reader { shared, image: image(), sequence: 0, value: first })
}

impl<T: Plain> Writer<T> {
    pub fn write(&mut self, value: &T) {
        value.encode(&mut ImageWriter::new(&mut self.image));
        let sequence = self.shared.sequence.load(Ordering::Relaxed);
        self.shared.sequence.store(sequence.wrapping_add(1), Ordering::Relaxed);
        fence(Ordering::Release);
        for (word, bytes) in self.shared.words.iter().zip(self.image.as_chunks::<WORD>().0) {
            word.store(u64::from_le_bytes(*bytes), Ordering::Relaxed);
        }
        self.shared.sequence.store(sequence.wrapping_add(2), Ordering::Release);
    }
}

impl<T: Plain> Reader<T> {
    pub fn read(&mut self) -> &T {
        for _ in 0..ATTEMPTS {
            let before = self.shared.sequence.load(Ordering::Acquire);
            if before == self.sequence {
                break;
            }
            for (word, bytes) in self.shared.words.iter().zip(self.image.as_chunks_mut::<WORD>().0) {
                *bytes = word.load(Ordering::Relaxed).to_le_bytes();
            }
            fence(Ordering::Acquire);
            let after = self.shared.sequence.load(Ordering::Relaxed);
            if before % 2 == 1 || before != after {
                continue;
            }
            if let Ok(value) = T::decode(&mut ImageReader::new(&self.image)) {
                (self.sequence, self.value) = (before, value);
            }
            break;
        }
        &self.value
    }

    #[must_use]
    pub const fn last(&self) -> &T {
        &self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reader_has_the_first_value_until_one_is_written() {
        let (mut writer, mut reader) = latest([7_u64; 3]);
        assert_eq!(*reader.read(), [7; 3]);
        writer.write(&[1, 2, 3]);
        writer.write(&[4, 5, 6]);
        assert_eq!(*reader.last(), [7; 3]);
        assert_eq!(*reader.read(), [4, 5, 6]);
        assert_eq!(*reader.read(), [4, 5, 6]);
    }

    #[test]
    fn values_are_whole_and_in_order_while_they_are_written() {
        const COUNT: u64 = 200_000;
        let (mut writer, mut reader) = latest([0_u64; 40]);
        let thread = std::thread::spawn(move || (1..=COUNT).for_each(|number| writer.write(&[number; 40])));
        let mut before = 0;
        while before < COUNT {
            let value = *reader.read();
            assert!(value.iter().all(|word| *word == value[0]), "a torn value: {value:?}");
            assert!(value[0] >= before);
            before = value[0];
        }
        thread.join().expect("the writer does not panic");
    }
}
