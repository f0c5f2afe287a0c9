//! What the user asked of an experiment.

use std::path::PathBuf;

/// How an experiment is to be run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Runs of each case; the experiment's own number if `None`.
    pub runs: Option<u32>,
    /// Seed of every random draw.
    pub seed: u64,
    /// Threads to spread the runs over, at least 1. Results do not depend on it.
    pub threads: usize,
    /// A few runs of a few cases: whether it works, not what comes out.
    pub quick: bool,
    /// `accuracy` only: through cells and the plot extractor, not from drawn plots.
    pub cells: bool,
    /// `real-recordings` only: the folder of the recordings that the project may not pass on.
    pub recordings: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self { runs: None, seed: 1, threads: 1, quick: false, cells: false, recordings: None }
    }
}

impl Options {
    /// Runs of each case: what was asked for, else `usual`, or `quick` with `--quick`.
    pub fn runs_or(&self, usual: u32, quick: u32) -> u32 {
        self.runs.unwrap_or(if self.quick { quick } else { usual }).max(1)
    }

    /// `all`, or with `--quick` only the first and the last of them.
    pub fn some_of<T: Copy>(&self, all: &[T]) -> Vec<T> {
        match all {
            [first, .., last] if self.quick => vec![*first, *last],
            _ => all.to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_asked_for_comes_first() {
        let usual = Options::default();
        let quick = Options { quick: true, ..Options::default() };
        let asked = Options { runs: Some(7), quick: true, ..Options::default() };
        assert_eq!([&usual, &quick, &asked].map(|options| options.runs_or(1000, 20)), [1000, 20, 7]);
        assert_eq!(quick.some_of(&[1, 2, 3]), [1, 3]);
        assert_eq!(usual.some_of(&[1, 2, 3]), [1, 2, 3]);
        assert_eq!(quick.some_of(&[5]), [5]);
    }
}
