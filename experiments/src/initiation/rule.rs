//! The rules that confirm a track, each value of a threshold a point of a receiver curve.

use common::config::{Logic, TrackerConfig};
use serde_json::Value;

use crate::Options;

/// Thresholds of existence.
const EXISTENCE: [f64; 4] = [0.05, 0.5, 0.99, 0.9999];
/// New targets expected per cell and scan (usually 10⁻⁷), with the usual threshold of existence.
const START_DENSITY: [f64; 3] = [1e-5, 1e-3, 1e-1];
/// M-of-N: hits that confirm and the scans in which they must come.
const M_OF_N: [[u32; 2]; 4] = [[2, 2], [3, 4], [3, 5], [4, 6]];

/// A logic with its threshold.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rule {
    Existence(f64),
    StartDensity(f64),
    MOfN([u32; 2]),
}

/// All that are compared.
pub(super) fn all(options: &Options) -> Vec<Rule> {
    let existence = options.some_of(&EXISTENCE).into_iter().map(Rule::Existence);
    let start_density = options.some_of(&START_DENSITY).into_iter().map(Rule::StartDensity);
    let m_of_n = options.some_of(&M_OF_N).into_iter().map(Rule::MOfN);
    existence.chain(start_density).chain(m_of_n).collect()
}

impl Rule {
    /// The usual rule, and the plain one beside it in the page.
    pub(super) const USUAL: [Self; 2] = [Self::Existence(0.99), Self::MOfN([3, 5])];

    pub(super) fn config(self) -> TrackerConfig {
        let config = TrackerConfig::default();
        match self {
            Self::Existence(threshold) => TrackerConfig { confirm_existence: threshold, ..config },
            Self::StartDensity(density) => TrackerConfig { start_density: density, ..config },
            Self::MOfN([hits, scans]) => {
                TrackerConfig { logic: Logic::MOfN, confirm_hits: hits, confirm_scans: scans, ..config }
            }
        }
    }

    /// As in the JSON.
    pub(super) fn logic(self) -> &'static str {
        match self {
            Self::Existence(_) => "existence",
            Self::StartDensity(_) => "start-density",
            Self::MOfN(_) => "m-of-n",
        }
    }

    /// Its threshold, as in the JSON.
    pub(super) fn parameter(self) -> Value {
        match self {
            Self::Existence(value) | Self::StartDensity(value) => value.into(),
            Self::MOfN([hits, scans]) => format!("{hits}/{scans}").into(),
        }
    }

    /// Whether it hardly ever confirms noise, so that its rate needs long runs.
    pub(super) fn is_strict(self) -> bool {
        matches!(self, Self::Existence(threshold) if threshold >= 0.5)
    }
}
