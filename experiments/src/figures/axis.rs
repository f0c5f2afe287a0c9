//! Axes: limits, ticks and their labels.

/// Superscript digits 0 … 9.
const SUPERSCRIPT: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// Decades of a logarithmic axis below which their halves are labelled too.
const FEW_DECADES: f64 = 2.5;

/// One axis of a panel.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// Quantity and unit: `range error / m`.
    pub label: String,
    /// Logarithmic; values that are not positive leave a gap.
    pub log: bool,
    /// Fixed limits; else those of the data.
    pub limits: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis that fits the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), log: false, limits: None }
    }

    /// A logarithmic axis that fits the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { log: true, ..Self::linear(label) }
    }

    /// The same axis from `lo` to `hi`.
    #[must_use]
    pub fn between(self, lo: f64, hi: f64) -> Self {
        Self { limits: Some([lo, hi]), ..self }
    }

    /// Place of a value along the axis: the value or its decimal logarithm; NaN where it has none.
    pub(super) fn place(&self, value: f64) -> f64 {
        match self.log {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value,
        }
    }

    /// Ends of the axis, as places, for data at some places: a little wider than these.
    pub(super) fn ends(&self, places: impl Iterator<Item = f64>) -> [f64; 2] {
        if let Some(limits) = self.limits {
            return limits.map(|value| self.place(value));
        }
        let [lo, hi] = places
            .filter(|place| place.is_finite())
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], place| [lo.min(place), hi.max(place)]);
        if lo > hi {
            return [0.0, 1.0];
        }
        let margin = if hi > lo { 0.04 * (hi - lo) } else { 0.5 };
        [lo - margin, hi + margin]
    }

    /// Places of labelled ticks between two ends.
    pub(super) fn ticks(&self, [lo, hi]: [f64; 2]) -> Vec<f64> {
        let (lo, hi) = (lo - 1e-9, hi + 1e-9);
        if self.log && hi - lo < FEW_DECADES {
            // 1, 2, 5, 10 … on a short axis, so that there are some.
            let decades = lo.floor() as i32..=hi.floor() as i32;
            let all = decades.flat_map(|decade| [1.0_f64, 2.0, 5.0].map(|digit| digit.log10() + f64::from(decade)));
            return all.filter(|place| (lo..=hi).contains(place)).collect();
        }
        let step = if self.log { ((hi - lo) / 7.0).ceil() } else { step(hi - lo) };
        ((lo / step).ceil() as i64..=(hi / step).floor() as i64).map(|n| n as f64 * step).collect()
    }

    /// Label of a tick at a place.
    pub(super) fn tick(&self, place: f64, ticks: &[f64]) -> String {
        if !self.log {
            return plain(place, ticks.get(..2).map_or(1.0, |pair| pair[1] - pair[0]));
        }
        let far = ticks.iter().any(|tick| !(-2.5..=3.5).contains(tick));
        if far && (place - place.round()).abs() < 1e-9 {
            return format!("10{}", superscript(place.round() as i32));
        }
        let value = 10.0_f64.powf(place);
        plain(value, value)
    }
}

/// A step of 1, 2 or 5 times a power of ten that divides `span` into at most seven.
fn step(span: f64) -> f64 {
    let coarse = span / 7.0;
    let decade = 10.0_f64.powf(coarse.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|factor| factor * decade).into_iter().find(|&step| step >= coarse).unwrap_or(coarse)
}

/// A number with as many decimals as steps of `step` need.
fn plain(value: f64, step: f64) -> String {
    let decimals = (-(step.abs() * 1.000_001).log10().floor()).clamp(0.0, 9.0) as usize;
    // No minus sign before a rounded zero.
    let value = if value.abs() < 1e-9 * step.abs() { 0.0 } else { value };
    format!("{value:.decimals$}").replace('-', "−")
}

fn superscript(exponent: i32) -> String {
    let sign = if exponent < 0 { "⁻" } else { "" };
    let digits = exponent.unsigned_abs().to_string();
    sign.chars().chain(digits.bytes().map(|digit| SUPERSCRIPT[usize::from(digit - b'0')])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, ends: [f64; 2]) -> Vec<String> {
        let ticks = axis.ticks(ends);
        ticks.iter().map(|&tick| axis.tick(tick, &ticks)).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let linear = Axis::linear("");
        assert_eq!(labels(&linear, [0.0, 1.0]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&linear, [-3.0, 31.0]), ["0", "5", "10", "15", "20", "25", "30"]);
        assert_eq!(labels(&linear, [-0.03, 0.011]), ["−0.03", "−0.02", "−0.01", "0.00", "0.01"]);
        let log = Axis::log("");
        assert_eq!(labels(&log, [-6.2, -0.9]), ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"]);
        assert_eq!(labels(&log, [-1.1, 2.2]), ["0.1", "1", "10", "100"]);
        assert_eq!(labels(&log, [-0.4, 1.1]), ["0.5", "1", "2", "5", "10"]);
    }

    #[test]
    fn limits_come_from_the_data_unless_they_are_fixed() {
        let data = [1.0, f64::NAN, 3.0];
        let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(Axis::linear("").ends(data.into_iter()), [0.92, 3.08]));
        assert!(close(Axis::log("").between(1e-3, 1.0).ends(data.into_iter()), [-3.0, 0.0]));
        assert!(close(Axis::linear("").ends(std::iter::empty()), [0.0, 1.0]));
    }
}
