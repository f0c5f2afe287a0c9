//! A figure and how sure it is.

/// A measured figure with its confidence interval, all in the unit of the figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The figure; NaN if nothing was measured.
    pub value: f64,
    /// Lower end of the interval.
    pub lo: f64,
    /// Upper end of the interval.
    pub hi: f64,
    /// Samples behind it.
    pub n: u64,
}

impl Estimate {
    /// What is known without a sample: nothing.
    pub const UNKNOWN: Self = Self { value: f64::NAN, lo: f64::NAN, hi: f64::NAN, n: 0 };

    /// Whether `x` lies in the interval; false if there is none.
    pub fn contains(&self, x: f64) -> bool {
        (self.lo..=self.hi).contains(&x)
    }

    /// The figure in a unit `factor` times smaller.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let (a, b) = (self.lo * factor, self.hi * factor);
        Self { value: self.value * factor, lo: a.min(b), hi: a.max(b), n: self.n }
    }

    /// The square root of a figure that is never negative, as from a mean square to an rms.
    #[must_use]
    pub fn square_root(self) -> Self {
        let root = |value: f64| value.max(0.0).sqrt();
        Self { value: self.value.sqrt(), lo: root(self.lo), hi: root(self.hi), n: self.n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_lies_in_an_unknown_interval() {
        assert!(!Estimate::UNKNOWN.contains(0.0));
        let known = Estimate { value: 4.0, lo: -1.0, hi: 9.0, n: 3 };
        assert!(known.contains(9.0) && !known.contains(9.1));
        assert_eq!(known.scaled(-1.0), Estimate { value: -4.0, lo: -9.0, hi: 1.0, n: 3 });
        assert_eq!(known.square_root(), Estimate { value: 2.0, lo: 0.0, hi: 3.0, n: 3 });
    }
}
