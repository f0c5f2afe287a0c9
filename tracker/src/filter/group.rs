//! States of up to eight tracks side by side: word k of all of them is one [`Row`].
//!
//! What a family's states consist of is its [`Layout`]; each track has a lane. States are stored track by track and loaded into lanes when
//! the beam has passed their tracks: which tracks meet in a group is known only then.

use pulp::{Simd, WithSimd};

use super::gaussian::at;
use super::lanes::{LANES, Lanes, Row};
use super::layout::Layout;
use super::machine::Machine;

/// Up to eight states.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    layout: Layout,
    rows: Vec<Row>,
}

/// Mean and covariance of a component of N states, P = N (N + 1)/2, of all lanes.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) struct Component<'a, const N: usize, const P: usize> {
    /// u; m, m/s, m/s².
    pub(in crate::filter) mean: &'a [Row; N],
    /// Packed triangle of P.
    pub(in crate::filter) covariance: &'a [Row; P],
}

/// The same, to be written.
#[derive(Debug)]
pub(in crate::filter) struct ComponentMut<'a, const N: usize, const P: usize> {
    pub(in crate::filter) mean: &'a mut [Row; N],
    pub(in crate::filter) covariance: &'a mut [Row; P],
}

impl Group {
    /// Of no form, to stand in for one that is lent out.
    pub const EMPTY: Self = Self { layout: Layout::new(&[3], 0, 0, 0), rows: Vec::new() };

    /// Tracks at the antenna with unit covariance and equal weights: what an empty lane computes with.
    pub fn new(layout: &Layout) -> Self {
        let mut rows = vec![Row::ZERO; layout.words()];
        rows[..layout.len()].fill(Row::splat(1.0 / layout.len() as f64));
        for j in 0..layout.len() {
            let n = layout.known(j);
            for i in 0..n {
                rows[layout.start(j) + n + at(i, i)] = Row::splat(1.0);
            }
        }
        Self { layout: *layout, rows }
    }

    /// The form of the states.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Puts a state into `lane`.
    pub fn load(&mut self, lane: usize, words: &[f64]) {
        assert!(lane < LANES, "lane {lane} of {LANES}");
        for (row, word) in self.rows.iter_mut().zip(words) {
            row.0[lane] = *word;
        }
    }

    /// Writes the state in `lane` out.
    pub fn store(&self, lane: usize, words: &mut [f64]) {
        assert!(lane < LANES, "lane {lane} of {LANES}");
        for (row, word) in self.rows.iter().zip(words) {
            *word = row.0[lane];
        }
    }

    /// Makes `lane` that of `other`.
    pub fn copy_lane(&mut self, lane: usize, other: &Self) {
        for (row, from) in self.rows.iter_mut().zip(&other.rows) {
            row.0[lane] = from.0[lane];
        }
    }

    /// W by component.
    pub fn weights(&self) -> &[Row] {
        &self.rows[..self.layout.len()]
    }

    /// W of component `j` in `lane`.
    pub fn weight(&self, j: usize, lane: usize) -> f64 {
        self.rows[j].0[lane]
    }

    /// Mean of component `j` in `lane`, state `i`, which it must know.
    pub fn mean(&self, j: usize, i: usize, lane: usize) -> f64 {
        self.rows[self.layout.start(j) + i].0[lane]
    }

    /// Index of the most probable component in `lane` (the first of equals).
    pub fn most_probable(&self, lane: usize) -> usize {
        (1..self.layout.len()).fold(0, |best, j| if self.weight(j, lane) > self.weight(best, lane) { j } else { best })
    }

    /// 1 in each of `lanes` lanes whose numbers are finite and whose variances are not negative, else 0.
    pub fn soundness(&self, machine: Machine, lanes: usize) -> Row {
        machine.arch(lanes).dispatch(Soundness { lanes, group: self })
    }

    /// All words.
    pub(in crate::filter) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// All words, to be written.
    pub(in crate::filter) fn rows_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    /// Component `j`, which must know N states.
    #[inline(always)]
    pub(in crate::filter) fn component<const N: usize, const P: usize>(&self, j: usize) -> Component<'_, N, P> {
        let (mean, rest) = self.rows[self.layout.start(j)..].split_first_chunk().expect("a component's mean");
        Component { mean, covariance: rest.first_chunk().expect("a component's covariance") }
    }

    /// Component `j`, which must know N states, to be written.
    #[inline(always)]
    pub(in crate::filter) fn component_mut<const N: usize, const P: usize>(
        &mut self,
        j: usize,
    ) -> ComponentMut<'_, N, P> {
        let start = self.layout.start(j);
        let (mean, rest) = self.rows[start..].split_first_chunk_mut().expect("a component's mean");
        ComponentMut { mean, covariance: rest.first_chunk_mut().expect("a component's covariance") }
    }
}

struct Soundness<'a> {
    lanes: usize,
    group: &'a Group,
}

impl WithSimd for Soundness<'_> {
    type Output = Row;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Row {
        let (Group { layout, rows }, mut sound) = (self.group, Row::ZERO);
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
            // x · 0 is NaN where x is not finite.
            let (mut nothing, mut least) = (zero, one);
            for row in rows {
                nothing += lanes.get(row) * zero;
            }
            for j in 0..layout.len() {
                let covariance = layout.start(j) + layout.known(j);
                for i in 0..layout.known(j) {
                    least = least.min(lanes.get(&rows[covariance + at(i, i)]));
                }
            }
            let is_sound = nothing.less(one).and((-least).less(lanes.splat(f64::MIN_POSITIVE)));
            lanes.put(&mut sound, is_sound.pick(one, zero));
        }
        sound
    }
}

/// Calls a function for the number of states that a component knows.
macro_rules! for_known {
    ($known:expr, $function:ident($($argument:expr),* $(,)?)) => {
        match $known {
            3 => $function::<_, 3, 6>($($argument),*),
            6 => $function::<_, 6, 21>($($argument),*),
            _ => $function::<_, 9, 45>($($argument),*),
        }
    };
}
pub(in crate::filter) use for_known;
