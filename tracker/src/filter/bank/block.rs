//! Where the numbers of one coordinate stand in the memory of a state.

use crate::filter::layout::Layout;

/// The block of a coordinate, of q hypotheses and a window of n scans:
/// ```text
/// [ P of [w v m], packed | w, v, m of each hypothesis | L_i(∞) | log-densities of the last scan, by hypothesis | … of the n-th last ]
/// ```
/// Log-densities are those of the likeliest hypothesis and below: only differences count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    first: usize,
    hypotheses: usize,
    window: usize,
}

impl Block {
    pub(super) fn words(hypotheses: usize, window: usize) -> usize {
        6 + (4 + window) * hypotheses
    }

    pub(super) fn new(layout: &Layout, axis: usize, hypotheses: usize, window: usize) -> Self {
        Self { first: layout.memory_start() + axis * Self::words(hypotheses, window), hypotheses, window }
    }

    /// Element `k` of P: ww, wv, vv, wm, vm, mm.
    pub fn covariance(&self, k: usize) -> usize {
        self.first + k
    }

    /// w, v and m of hypothesis `i`, from here on.
    pub fn hypothesis(&self, i: usize) -> usize {
        self.first + 6 + 3 * i
    }

    /// L(∞) of hypothesis `i`.
    pub fn total(&self, i: usize) -> usize {
        self.first + 6 + 3 * self.hypotheses + i
    }

    /// Log-density of hypothesis `i`, `back` scans before the last.
    pub fn recent(&self, i: usize, back: usize) -> usize {
        debug_assert!(back < self.window, "{back} scans back of {}", self.window);
        self.first + 6 + (4 + back) * self.hypotheses + i
    }
}
