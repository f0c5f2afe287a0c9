//! What is learnt by likelihood, and how it is searched: as logarithms, so that steps are shares of a value.

use common::config::{Estimator, TrackerConfig};

/// Farthest that a search goes from the configuration, as a natural logarithm: a factor of about 150.
pub(super) const FARTHEST: f64 = 5.0;
/// Least probability of staying that the configuration takes.
const LEAST_STAY: f64 = 0.34;

/// The errors of plots that are learnt: range, azimuth, elevation.
pub const ERRORS: usize = 3;

/// One parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Errors of range, azimuth or elevation over those that plots state.
    Error(usize),
    /// `cv_noise_mps2`.
    CvNoise,
    /// `hover_noise_mps`.
    HoverNoise,
    /// `velocity_noise_mps2`.
    VelocityNoise,
    /// `manoeuvre_noise_mps3`.
    ManoeuvreNoise,
    /// `stay_probability`.
    Stay,
    /// `turn.noise_mps2`.
    TurnNoise,
    /// `turn.stay_probability`.
    TurnStay,
    /// Greatest of `turn.rates_deg_per_s`; the others keep their proportions.
    TurnRates,
    /// `turn.greatest_rate_deg_per_s`.
    GreatestRate,
    /// `bank.greatest_acceleration_mps2`.
    BankAcceleration,
    /// `bank.correlation_time_s`.
    BankCorrelation,
    /// `bandwidth.narrow_mps2`.
    Narrow,
    /// `bandwidth.wide_mps2`.
    Wide,
    /// `bandwidth.correlation_time_s`.
    BandwidthCorrelation,
}

/// The parameters of a configuration's estimator, after the errors of plots.
pub(super) fn of(config: &TrackerConfig, has_elevation: bool) -> Vec<Parameter> {
    let errors = if has_elevation { ERRORS } else { ERRORS - 1 };
    let motion: &[Parameter] = match config.estimator {
        Estimator::Cv => &[Parameter::CvNoise],
        Estimator::ImmUav => {
            &[Parameter::HoverNoise, Parameter::VelocityNoise, Parameter::ManoeuvreNoise, Parameter::Stay]
        }
        Estimator::ImmTurn | Estimator::SwitchingGrid => {
            &[Parameter::TurnNoise, Parameter::TurnStay, Parameter::TurnRates]
        }
        Estimator::AdaptiveGrid => &[Parameter::TurnNoise, Parameter::TurnStay, Parameter::GreatestRate],
        Estimator::MultiAlternative => &[Parameter::BankAcceleration, Parameter::BankCorrelation],
        Estimator::AdaptiveBandwidth => &[Parameter::Narrow, Parameter::Wide, Parameter::BandwidthCorrelation],
    };
    (0..errors).map(Parameter::Error).chain(motion.iter().copied()).collect()
}

/// Whether turn rates are slow enough to be told from jumps: up to an eighth of a turn in a scan, or as fast as those of the
/// configuration that the search begins with.
pub(super) fn is_told_apart(config: &TrackerConfig, begin: &TrackerConfig, period_s: f64) -> bool {
    fastest_deg_per_s(config) * period_s <= (fastest_deg_per_s(begin) * period_s).max(45.0)
}

fn fastest_deg_per_s(config: &TrackerConfig) -> f64 {
    match config.estimator {
        Estimator::ImmTurn | Estimator::SwitchingGrid => greatest(&config.turn.rates_deg_per_s),
        Estimator::AdaptiveGrid => config.turn.greatest_rate_deg_per_s,
        _ => 0.0,
    }
}

/// The configuration at a point of the search.
pub(super) fn with(config: &TrackerConfig, parameters: &[Parameter], point: &[f64]) -> TrackerConfig {
    let mut config = config.clone();
    for (parameter, &at) in parameters.iter().zip(point) {
        parameter.set(&mut config, parameter.value_at(at));
    }
    config
}

/// Factors on the errors that plots state, at a point of the search.
pub(super) fn scales(parameters: &[Parameter], point: &[f64]) -> [f64; ERRORS] {
    let mut scales = [1.0; ERRORS];
    for (parameter, &at) in parameters.iter().zip(point) {
        if let Parameter::Error(axis) = *parameter {
            scales[axis] = parameter.value_at(at);
        }
    }
    scales
}

impl Parameter {
    fn is_stay(self) -> bool {
        matches!(self, Self::Stay | Self::TurnStay)
    }

    /// The value in a configuration; 1 for the errors of plots.
    pub fn value(self, config: &TrackerConfig) -> f64 {
        match self {
            Self::Error(_) => 1.0,
            Self::TurnRates => greatest(&config.turn.rates_deg_per_s),
            _ => self.place(&mut config.clone()).map_or(1.0, |value| *value),
        }
    }

    pub(super) fn set(self, config: &mut TrackerConfig, value: f64) {
        if self == Self::TurnRates {
            let scale = value / greatest(&config.turn.rates_deg_per_s);
            config.turn.rates_deg_per_s.iter_mut().for_each(|rate| *rate *= scale);
        } else if let Some(place) = self.place(config) {
            *place = value;
        }
    }

    fn place(self, config: &mut TrackerConfig) -> Option<&mut f64> {
        Some(match self {
            Self::Error(_) | Self::TurnRates => return None,
            Self::CvNoise => &mut config.cv_noise_mps2,
            Self::HoverNoise => &mut config.hover_noise_mps,
            Self::VelocityNoise => &mut config.velocity_noise_mps2,
            Self::ManoeuvreNoise => &mut config.manoeuvre_noise_mps3,
            Self::Stay => &mut config.stay_probability,
            Self::TurnNoise => &mut config.turn.noise_mps2,
            Self::TurnStay => &mut config.turn.stay_probability,
            Self::GreatestRate => &mut config.turn.greatest_rate_deg_per_s,
            Self::BankAcceleration => &mut config.bank.greatest_acceleration_mps2,
            Self::BankCorrelation => &mut config.bank.correlation_time_s,
            Self::Narrow => &mut config.bandwidth.narrow_mps2,
            Self::Wide => &mut config.bandwidth.wide_mps2,
            Self::BandwidthCorrelation => &mut config.bandwidth.correlation_time_s,
        })
    }

    /// ln of a value; of a probability of staying, ln of what its odds are above the least one.
    pub(super) fn place_of(self, value: f64) -> f64 {
        if self.is_stay() { ((value - LEAST_STAY) / (1.0 - value)).ln() } else { value.ln() }
    }

    pub(super) fn value_at(self, at: f64) -> f64 {
        if self.is_stay() { (LEAST_STAY + at.exp()) / (1.0 + at.exp()) } else { at.exp() }
    }

    /// Change of the value over that of the point.
    pub(super) fn slope(self, at: f64) -> f64 {
        if self.is_stay() { (1.0 - LEAST_STAY) * at.exp() / (1.0 + at.exp()).powi(2) } else { at.exp() }
    }

    /// Its key in `[tracker]`; of the errors of plots, that in `[plot_source]`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Error(0) => "sigma_range_m",
            Self::Error(1) => "sigma_azimuth_deg",
            Self::Error(_) => "sigma_height_m",
            Self::CvNoise => "cv_noise_mps2",
            Self::HoverNoise => "hover_noise_mps",
            Self::VelocityNoise => "velocity_noise_mps2",
            Self::ManoeuvreNoise => "manoeuvre_noise_mps3",
            Self::Stay => "stay_probability",
            Self::TurnNoise => "turn.noise_mps2",
            Self::TurnStay => "turn.stay_probability",
            Self::TurnRates => "turn.rates_deg_per_s",
            Self::GreatestRate => "turn.greatest_rate_deg_per_s",
            Self::BankAcceleration => "bank.greatest_acceleration_mps2",
            Self::BankCorrelation => "bank.correlation_time_s",
            Self::Narrow => "bandwidth.narrow_mps2",
            Self::Wide => "bandwidth.wide_mps2",
            Self::BandwidthCorrelation => "bandwidth.correlation_time_s",
        }
    }
}

fn greatest(rates: &[f64]) -> f64 {
    rates.iter().map(|rate| rate.abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_is_set_and_read_again() {
        for estimator in Estimator::ALL {
            let config = TrackerConfig { estimator, ..TrackerConfig::default() };
            let parameters = of(&config, true);
            let point: Vec<f64> =
                parameters.iter().map(|parameter| parameter.place_of(parameter.value(&config)) + 0.5).collect();
            let changed = with(&config, &parameters, &point);
            changed.check().expect("valid");
            for (parameter, &at) in parameters.iter().zip(&point).skip(ERRORS) {
                let value = parameter.value(&changed);
                assert!((parameter.place_of(value) - at).abs() < 1e-9, "{parameter:?}: {value}");
                let slope = (parameter.value_at(at + 1e-5) - parameter.value_at(at - 1e-5)) / 2e-5;
                assert!((slope / parameter.slope(at) - 1.0).abs() < 1e-6, "{parameter:?}");
            }
            assert!(scales(&parameters, &point).iter().all(|scale| (scale - 0.5_f64.exp()).abs() < 1e-12));
        }
    }
}
