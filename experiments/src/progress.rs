//! How far an experiment has come, on standard error.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar with the remaining time where standard error is a terminal, else nothing.
#[derive(Debug, Clone)]
pub struct Progress(ProgressBar);

impl Progress {
    /// The bar of one experiment; its length grows with [`Progress::expect`].
    ///
    /// # Panics
    /// Never: the template is fixed.
    pub fn new(experiment: &str) -> Self {
        let style = ProgressStyle::with_template("{prefix} {bar:40} {pos}/{len} runs, {eta} left  {msg}");
        let bar = ProgressBar::new(0).with_style(style.expect("a valid template"));
        bar.set_prefix(experiment.to_string());
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    /// Shows nothing: for tests and batch jobs.
    pub fn hidden() -> Self {
        Self(ProgressBar::hidden())
    }

    /// Announces `runs` more runs. An experiment says at its start how many it has in all.
    pub fn expect(&self, runs: u64) {
        self.0.inc_length(runs);
    }

    /// What is being worked on: a case in a few words.
    pub fn say(&self, case: String) {
        self.0.set_message(case);
    }

    /// One run is done.
    pub fn step(&self) {
        self.0.inc(1);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}
