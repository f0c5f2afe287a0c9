//! The filters that are compared, and how one of them follows an aircraft.

use common::config::BandwidthConfig;
use serde_json::Value;
use tracker::association::one_track::OneTrack;
use tracker::filter::bank::{AdaptiveBandwidth, MultiAlternative, Rule};
use tracker::filter::{Filter, TwoPlots};
use tracker::plots::measurement::Measurement;

use super::flights::{GREATEST_MPS2, Motion, STEP_S};
use crate::{Case, Options};

/// τ of the source, s.
const TAU_S: f64 = 3.0;

/// A form of the single hypothesis (M4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Naive,
    Hold,
    Tuned,
}

/// Which filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Setting {
    /// Hypotheses on the mean acceleration.
    Bank { rule: Rule, hypotheses: usize, window: usize, tau_s: f64 },
    /// One hypothesis of adaptive bandwidth.
    Single(Form),
}

impl Setting {
    /// A bank with the source's correlation time.
    pub(super) const fn bank(rule: Rule, hypotheses: usize, window: usize) -> Self {
        Self::Bank { rule, hypotheses, window, tau_s: TAU_S }
    }

    /// The baselines, the published banks, and the sweeps.
    pub(super) fn all(options: &Options) -> Vec<Self> {
        let mut all = [Form::Hold, Form::Tuned, Form::Naive].map(Self::Single).to_vec();
        for (hypotheses, window) in PUBLISHED {
            let rules = [Rule::Bayes, Rule::Standard, Rule::Sliding, Rule::SlidingBayes];
            all.extend(rules.map(|rule| Self::bank(rule, hypotheses, window)));
        }
        if !options.quick {
            let sliding = |hypotheses, window| Self::bank(Rule::SlidingBayes, hypotheses, window);
            all.extend([1, 2, 6, 8, 12, 16].map(|window| sliding(5, window)));
            all.extend([sliding(1, 4), sliding(7, 4), sliding(9, 4)]);
            all.extend([0.5, 1.0, 2.0, 5.0, 10.0, 20.0].map(|tau_s| Self::Bank {
                rule: Rule::SlidingBayes,
                hypotheses: 5,
                window: 4,
                tau_s,
            }));
        }
        all
    }

    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Bank { rule: Rule::Bayes, .. } => "Bayes",
            Self::Bank { rule: Rule::Standard, .. } => "standard",
            Self::Bank { rule: Rule::Sliding, .. } => "sliding",
            Self::Bank { rule: Rule::SlidingBayes, .. } => "sliding Bayes",
            Self::Single(Form::Naive) => "naive",
            Self::Single(Form::Hold) => "hold",
            Self::Single(Form::Tuned) => "tuned",
        }
    }

    /// Its parameters.
    pub(super) fn describe(&self, case: Case) -> Case {
        let [q, n, tau_s] = match *self {
            Self::Bank { hypotheses, window, tau_s, .. } => [hypotheses.into(), window.into(), tau_s.into()],
            Self::Single(_) => [Value::Null, Value::Null, Value::Null],
        };
        case.with("filter", self.name()).with("q", q).with("n", n).with("tau_s", tau_s)
    }

    pub(super) fn filter(&self) -> Box<dyn Filter> {
        match *self {
            Self::Bank { rule, hypotheses, window, tau_s } => {
                Box::new(MultiAlternative::new(hypotheses, GREATEST_MPS2, tau_s, window, rule, 2))
            }
            Self::Single(form) => {
                let of =
                    |correlation_time_s, narrow_mps2, wide_mps2, threshold, calm_scans, hold_scans| BandwidthConfig {
                        correlation_time_s,
                        greatest_acceleration_mps2: GREATEST_MPS2,
                        narrow_mps2,
                        wide_mps2,
                        threshold,
                        calm_scans,
                        hold_scans,
                    };
                let config = match form {
                    Form::Naive => of(TAU_S, 1.0, GREATEST_MPS2, 2.8, 4, 0),
                    Form::Hold => of(TAU_S, 1.0, GREATEST_MPS2, 2.8, 4, 10),
                    Form::Tuned => of(10.0, 3.0, 0.5 * GREATEST_MPS2, 2.0, 10, 20),
                };
                Box::new(AdaptiveBandwidth::configured(&config, 2))
            }
        }
    }
}

/// Hypotheses and windows of the source.
pub(super) const PUBLISHED: [(usize, usize); 2] = [(3, 3), (5, 4)];

/// The estimates of one run, from the third scan on, handed to `take` with the scan's number.
pub(super) fn follow(setting: &Setting, plots: &[Measurement], mut take: impl FnMut(usize, &Motion)) {
    let mut track = OneTrack::new(setting.filter());
    track.start(&TwoPlots { previous: &plots[0], last: &plots[1], step_s: STEP_S });
    for (scan, plot) in plots.iter().enumerate().skip(2) {
        track.predict(STEP_S);
        track.take(plot);
        let mean = track.state().mean(0);
        take(scan, &[0, 3, 6].map(|first| [mean[first], mean[first + 1]]));
    }
}
