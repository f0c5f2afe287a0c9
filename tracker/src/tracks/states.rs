//! States of the tracks: of each its posterior, what was expected of its last scan and what is expected of the next.
//!
//! They lie track by track, as their [`Layout`] says, and are loaded into lanes for the tracks that the beam has passed: which tracks meet
//! in a group is known only then, and a track's state is a dozen cache lines in a row.

use crate::filter::{Layout, Mixture};

/// Words of a cache line.
const LINE: usize = 8;
/// Posterior and two predictions.
const STATES: usize = 3;

/// Which prediction of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// Of the scan that it was updated with.
    LastScan,
    /// Of the scan to come.
    NextScan,
}

/// States by place.
#[derive(Debug)]
pub struct States {
    layout: Layout,
    words: Vec<f64>,
    /// By place: whether the second prediction is that of the next scan.
    second_is_next: Vec<bool>,
}

impl States {
    /// None, of a form.
    pub fn new(layout: &Layout) -> Self {
        Self { layout: *layout, words: Vec::new(), second_is_next: Vec::new() }
    }

    /// The form of the states.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Makes room for one place more.
    pub fn add_place(&mut self) {
        self.words.resize(self.words.len() + STATES * self.stride(), 0.0);
        self.second_is_next.push(false);
    }

    /// û, P̂, W.
    pub fn posterior(&self, place: usize) -> Mixture<'_> {
        Mixture::new(&self.layout, self.state(place, 0))
    }

    /// û, P̂, W as words.
    pub fn posterior_words(&self, place: usize) -> &[f64] {
        self.state(place, 0)
    }

    /// û, P̂, W to be written.
    pub fn posterior_mut(&mut self, place: usize) -> &mut [f64] {
        self.state_mut(place, 0)
    }

    /// u*, P*, W*.
    pub fn prediction(&self, place: usize, of: Of) -> Mixture<'_> {
        Mixture::new(&self.layout, self.prediction_words(place, of))
    }

    /// u*, P*, W* as words.
    pub fn prediction_words(&self, place: usize, of: Of) -> &[f64] {
        self.state(place, self.index(place, of))
    }

    /// u*, P*, W* to be written.
    pub fn prediction_mut(&mut self, place: usize, of: Of) -> &mut [f64] {
        let index = self.index(place, of);
        self.state_mut(place, index)
    }

    /// Makes the prediction of the next scan that of the last: the scan has been.
    pub fn turn_over(&mut self, place: usize) {
        self.second_is_next[place] ^= true;
    }

    /// Makes the prediction the posterior: nothing was learnt in the scan.
    pub fn keep_prediction(&mut self, place: usize) {
        let (from, words) = (self.start(place, self.index(place, Of::NextScan)), self.layout.words());
        let into = self.start(place, 0);
        self.words.copy_within(from..from + words, into);
    }

    /// Makes the posterior the prediction of the last scan, as of a track that starts.
    pub fn begin(&mut self, place: usize) {
        let (from, words) = (self.start(place, 0), self.layout.words());
        let into = self.start(place, self.index(place, Of::LastScan));
        self.words.copy_within(from..from + words, into);
    }

    fn index(&self, place: usize, of: Of) -> usize {
        1 + usize::from(self.second_is_next[place] == (of == Of::NextScan))
    }

    fn stride(&self) -> usize {
        self.layout.words().next_multiple_of(LINE)
    }

    fn start(&self, place: usize, index: usize) -> usize {
        (STATES * place + index) * self.stride()
    }

    fn state(&self, place: usize, index: usize) -> &[f64] {
        &self.words[self.start(place, index)..][..self.layout.words()]
    }

    fn state_mut(&mut self, place: usize, index: usize) -> &mut [f64] {
        let start = self.start(place, index);
        &mut self.words[start..][..self.layout.words()]
    }
}
