//! Work on all processors with results in a fixed order, independent of the number of processors.

use std::{
    iter::Flatten,
    num::NonZero,
    ops::Range,
    sync::atomic::{AtomicUsize, Ordering},
    thread, vec,
};

/// Results of `work` on `0..count`, in order. A single piece runs in the caller's thread. Panics if `work` does.
pub fn map<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get).min(count);
    if threads <= 1 {
        return (0..count).map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let take = || {
        let mut done = Vec::new();
        loop {
            let piece = next.fetch_add(1, Ordering::Relaxed);
            if piece >= count {
                return done;
            }
            done.push((piece, work(piece)));
        }
    };
    let mut done = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(take)).collect();
        let mut done = take();
        for other in others {
            match other.join() {
                Ok(more) => done.extend(more),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        done
    });
    done.sort_unstable_by_key(|(piece, _)| *piece);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Like [`map`], in pieces of at most `size`; `work` receives the positions of a piece.
pub(super) fn map_pieces<T: Send>(
    count: usize,
    size: usize,
    work: impl Fn(Range<usize>) -> T + Sync,
) -> Vec<T> {
    map(count.div_ceil(size), |piece| {
        let first = piece.saturating_mul(size);
        work(first..first.saturating_add(size).min(count))
    })
}

const ITEMS_AT_A_TIME: usize = 2048; // for one processor in `map_each`

pub(super) fn map_each<'i, I: Sync, T: Send>(
    items: &'i [I],
    work: impl Fn(&'i I) -> T + Sync,
) -> Flatten<vec::IntoIter<Vec<T>>> {
    let piece =
        |range: Range<usize>| items.get(range).unwrap_or_default().iter().map(&work).collect::<Vec<T>>();
    map_pieces(items.len(), ITEMS_AT_A_TIME, piece).into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order() {
        assert_eq!(map(1000, |i| i * i), (0..1000).map(|i| i * i).collect::<Vec<_>>());
        assert_eq!(map_pieces(10, 4, |range| range), [0..4, 4..8, 8..10]);
        assert_eq!(map_pieces(0, 4, |range| range), []);
        let items: Vec<usize> = (0..5000).collect();
        assert!(map_each(&items, |i| i + 1).eq(1..5001));
    }
}
