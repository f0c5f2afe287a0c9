//! Runs spread over threads, with results that do not depend on how many there are.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::Progress;

/// The results of `work` for the runs 0 … `runs` − 1, in that order.
///
/// A run draws its numbers from a generator made of (seed, purpose, run, …) with [`common::random::generator`], and
/// of nothing else; then neither order nor thread matters. Each thread takes the next run that is free, so runs may
/// last differently long.
///
/// # Panics
/// If `work` panics.
pub fn runs<T: Send>(threads: usize, runs: u32, progress: &Progress, work: impl Fn(u32) -> T + Sync) -> Vec<T> {
    runs_with(threads, runs, progress, || (), |(), run| work(run))
}

/// Like [`runs`], with scratch that each thread makes once by `scratch` and lends to its runs. What is left in it by
/// one run must not change the results of the next.
///
/// # Panics
/// If `scratch` or `work` panics.
pub fn runs_with<S, T: Send>(
    threads: usize,
    runs: u32,
    progress: &Progress,
    scratch: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, u32) -> T + Sync,
) -> Vec<T> {
    let next = AtomicU32::new(0);
    let worker = || {
        let mut scratch = scratch();
        let mut done = Vec::new();
        loop {
            let run = next.fetch_add(1, Ordering::Relaxed);
            if run >= runs {
                return done;
            }
            done.push((run, work(&mut scratch, run)));
            progress.step();
        }
    };
    let mut all: Vec<(u32, T)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, runs.max(1) as usize)).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a run panicked")).collect()
    });
    all.sort_unstable_by_key(|&(run, _)| run);
    all.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};
    use rand::RngExt;

    #[test]
    fn results_are_in_order_and_the_same_on_any_number_of_threads() {
        let draw = |run: u32| (run, generator(3, Purpose::Test, run, 0).random::<u64>());
        let alone = runs(1, 100, &Progress::hidden(), draw);
        assert!(alone.iter().zip(0..).all(|(&(run, _), expected)| run == expected));
        for threads in [2, 5, 1000] {
            assert_eq!(alone, runs(threads, 100, &Progress::hidden(), draw));
        }
        assert!(runs(4, 0, &Progress::hidden(), draw).is_empty());
    }

    #[test]
    fn each_thread_makes_its_scratch_once() {
        let made = AtomicU32::new(0);
        let scratch = || made.fetch_add(1, Ordering::Relaxed);
        runs_with(3, 50, &Progress::hidden(), scratch, |_, run| run);
        assert_eq!(made.load(Ordering::Relaxed), 3);
    }
}
