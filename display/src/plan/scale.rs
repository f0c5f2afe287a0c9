//! From metres to px, and round numbers for range rings.

/// The plan on its sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Middle of the plan, m east and north.
    pub(super) middle_m: [f64; 2],
    /// Middle of the plan, px.
    pub(super) middle: [f64; 2],
    /// px in a metre.
    pub(super) per_m: f64,
}

impl Scale {
    /// A position east and north on the sheet.
    pub(super) fn place(&self, [x, y, _]: [f64; 3]) -> [f64; 2] {
        [self.middle[0] + (x - self.middle_m[0]) * self.per_m, self.middle[1] - (y - self.middle_m[1]) * self.per_m]
    }
}

/// A round step, 1, 2 or 5 times a power of ten, that fits at most `most` times into `range`.
pub(super) fn round_step(range: f64, most: f64) -> f64 {
    let least = (range / most).max(f64::MIN_POSITIVE);
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|&step| step >= least * 0.999_999)
        .unwrap_or(10.0 * power)
}

/// A distance as people say it.
pub(super) fn distance(metres: f64) -> String {
    if metres >= 1000.0 { format!("{} km", metres / 1000.0) } else { format!("{metres} m") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_round_and_few() {
        for (range, step) in
            [(5_000.0, 1_000.0), (200.0, 50.0), (37_000.0, 10_000.0), (470_000.0, 100_000.0), (1.0, 0.2)]
        {
            assert!((round_step(range, 5.0) / step - 1.0).abs() < 1e-9, "{range}: {}", round_step(range, 5.0));
        }
        assert_eq!((distance(200.0), distance(2500.0)), ("200 m".into(), "2.5 km".into()));
    }

    #[test]
    fn north_is_up() {
        let scale = Scale { middle_m: [100.0, 0.0], middle: [50.0, 50.0], per_m: 0.1 };
        let [x, y] = scale.place([200.0, 100.0, 7.0]);
        assert!((x - 60.0).abs() < 1e-9 && (y - 40.0).abs() < 1e-9, "{x} {y}");
    }
}
