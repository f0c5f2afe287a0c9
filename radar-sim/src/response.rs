//! How the power of a point target spreads over neighbouring cells.

/// Gaussian response of pulse, Doppler filter or two-way beam along one axis:
/// power gain g(Δ) = exp(−4 ln 2 (Δ/w)²), half power at Δ = ±w/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Half-power width w, in the unit of the axis.
    width: f64,
}

/// Echoes this far below the noise are left out, dB: together less than 1 % of the noise in a cell.
const FLOOR_DB: f64 = -20.0;

impl Response {
    /// A response of half-power width `width`, in the unit of its axis.
    pub fn new(width: f64) -> Self {
        Self { width }
    }

    /// Amplitude gain at distance `offset` from the centre.
    pub fn amplitude(self, offset: f64) -> f64 {
        let u = offset / self.width;
        (-2.0 * std::f64::consts::LN_2 * u * u).exp()
    }

    /// Distance at which a target of `snr_db` has sunk to 20 dB below the noise; 0 if it nowhere exceeds that.
    pub fn reach(self, snr_db: f64) -> f64 {
        let above_db = (snr_db - FLOOR_DB).max(0.0);
        self.width * (above_db / (40.0 * std::f64::consts::LN_2 / std::f64::consts::LN_10)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_power_at_half_width_and_floor_at_reach() {
        let response = Response::new(90.0);
        assert!((response.amplitude(45.0).powi(2) - 0.5).abs() < 1e-12);
        let reach = response.reach(30.0);
        assert!((20.0 * response.amplitude(reach).log10() - (FLOOR_DB - 30.0)).abs() < 1e-9);
    }
}
