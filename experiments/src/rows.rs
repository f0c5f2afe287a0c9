//! One measured figure: of which case, how sure, and what it should be.

use evaluation::Estimate;
use evaluation::gospa::MeanGospa;
use evaluation::mean::Moments;
use serde::{Serialize, Serializer};
use serde_json::Value;

/// Coverage of every interval.
pub const LEVEL: f64 = 0.95;

/// Parameters of a case, in the order in which they were given. Names stay once published.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Case(Vec<(&'static str, Value)>);

impl Case {
    /// No parameters yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The same case with one parameter more: `Case::new().with("pfa", 1e-3).with("swerling", "I")`.
    #[must_use]
    pub fn with(mut self, key: &'static str, value: impl Into<Value>) -> Self {
        self.0.push((key, value.into()));
        self
    }

    /// The same case with a parameter in front.
    #[must_use]
    pub(crate) fn within(mut self, key: &'static str, value: impl Into<Value>) -> Self {
        self.0.insert(0, (key, value.into()));
        self
    }

    /// A parameter.
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.0.iter().find(|(name, _)| *name == key).map(|(_, value)| value)
    }

    /// All parameters.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.0.iter().map(|(name, value)| (*name, value))
    }
}

impl Serialize for Case {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

/// One row of the results. What is not finite is `null` in JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Parameters of the case.
    pub case: Case,
    /// What was measured; the name carries its unit. Names stay once published.
    pub metric: &'static str,
    /// The figure.
    pub value: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// Samples behind it.
    pub n: u64,
    /// Published or independent value.
    pub reference: Option<f64>,
    /// Where the reference comes from.
    pub source: Option<String>,
}

impl Row {
    /// A figure with its interval, from any function of `evaluation` at [`LEVEL`].
    pub fn new(case: &Case, metric: &'static str, estimate: Estimate) -> Self {
        let Estimate { value, lo, hi, n } = estimate;
        Self { case: case.clone(), metric, value, lo, hi, n, reference: None, source: None }
    }

    /// A proportion with Wilson's interval.
    pub fn proportion(case: &Case, metric: &'static str, successes: u64, trials: u64) -> Self {
        Self::new(case, metric, evaluation::proportion::wilson(successes, trials, LEVEL))
    }

    /// A proportion whose trials come in independent clusters [successes, trials], one a run.
    pub fn clustered(case: &Case, metric: &'static str, clusters: &[[u64; 2]]) -> Self {
        Self::new(case, metric, evaluation::proportion::clustered(clusters, LEVEL))
    }

    /// The mean of independent samples, with Student's interval.
    pub fn mean(case: &Case, metric: &'static str, samples: impl IntoIterator<Item = f64>) -> Self {
        Self::new(case, metric, evaluation::mean::mean(samples, LEVEL))
    }

    /// The rms of independent errors.
    pub fn rms(case: &Case, metric: &'static str, errors: impl IntoIterator<Item = f64>) -> Self {
        Self::new(case, metric, evaluation::rms::estimate(errors, LEVEL))
    }

    /// Events per hour, with the exact Poisson interval.
    pub fn per_hour(case: &Case, metric: &'static str, events: u64, seconds: f64) -> Self {
        Self::new(case, metric, evaluation::poisson::per_hour(events, seconds, LEVEL))
    }

    /// The means of GOSPA and its parts over runs, of each of which they are the means over scans.
    pub fn gospa(case: &Case, runs: &[&MeanGospa]) -> [Self; 4] {
        let mean =
            |metric, of: fn(&MeanGospa) -> &Moments| Self::mean(case, metric, runs.iter().map(|run| of(run).mean()));
        [
            mean("gospa_m", |run| &run.distance),
            mean("gospa_localisation_m", |run| &run.localisation),
            mean("gospa_missed_m", |run| &run.missed),
            mean("gospa_false_m", |run| &run.spurious),
        ]
    }

    /// The figure with its interval.
    pub fn estimate(&self) -> Estimate {
        Estimate { value: self.value, lo: self.lo, hi: self.hi, n: self.n }
    }

    /// The same row with the value it should have, and where that comes from.
    #[must_use]
    pub fn against(mut self, reference: f64, source: impl Into<String>) -> Self {
        self.reference = Some(reference);
        self.source = Some(source.into());
        self
    }

    /// Whether the reference lies in the interval; `None` without a reference.
    pub fn agrees(&self) -> Option<bool> {
        self.reference.map(|reference| (self.lo..=self.hi).contains(&reference))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_keeps_the_order_and_has_null_for_what_is_not_finite() {
        let case = Case::new().with("snr_db", 12.5).with("logic", "existence");
        let row = Row::mean(&case, "bias", [2.0]);
        assert_eq!(
            serde_json::to_string(&row).expect("JSON"),
            r#"{"case":{"snr_db":12.5,"logic":"existence"},"metric":"bias","value":2.0,"lo":null,"hi":null,"n":1,"reference":null,"source":null}"#
        );
        assert_eq!(case.get("logic"), Some(&Value::from("existence")));
    }

    #[test]
    fn a_reference_agrees_if_it_lies_in_the_interval() {
        let row = Row::proportion(&Case::new(), "pfa", 10, 1000);
        assert_eq!(row.agrees(), None);
        assert_eq!(row.clone().against(0.012, "theory").agrees(), Some(true));
        assert_eq!(row.against(0.05, "theory").agrees(), Some(false));
    }
}
