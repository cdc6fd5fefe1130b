//! Many pieces of work on all processors.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// As many workers as there are processors.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Does each piece of `work`, by so many workers at once; results in the order of the work. `told` hears how many
/// pieces are done.
pub fn all<T: Sync, R: Send>(
    work: &[T],
    workers: usize,
    done: impl Fn(&T) -> R + Sync,
    told: impl Fn(usize) + Sync,
) -> Vec<R> {
    let (next, count) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let results: Mutex<Vec<Option<R>>> = Mutex::new(work.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..workers.clamp(1, work.len().max(1)) {
            scope.spawn(|| {
                while let Some((index, piece)) = take(&next, work) {
                    let result = done(piece);
                    if let Ok(mut results) = results.lock() {
                        results[index] = Some(result);
                    }
                    told(count.fetch_add(1, Ordering::Relaxed) + 1);
                }
            });
        }
    });
    results.into_inner().unwrap_or_default().into_iter().flatten().collect()
}

/// The next piece that nobody has taken.
fn take<'a, T>(next: &AtomicUsize, work: &'a [T]) -> Option<(usize, &'a T)> {
    let index = next.fetch_add(1, Ordering::Relaxed);
    Some((index, work.get(index)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_work_whoever_did_it() {
        let work: Vec<u64> = (0..1000).collect();
        for workers in [0, 1, 3, 2000] {
            let told = AtomicUsize::new(0);
            let squares = all(
                &work,
                workers,
                |n| n * n,
                |_| {
                    told.fetch_add(1, Ordering::Relaxed);
                },
            );
            assert!(squares.iter().zip(&work).all(|(square, n)| *square == n * n));
            assert_eq!((squares.len(), told.into_inner()), (1000, 1000));
        }
        assert!(all(&[] as &[u64], 4, |n| *n, |_| ()).is_empty());
    }
}
