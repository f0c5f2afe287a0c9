//! The filters that are compared, and how one of them follows a ship.

use serde_json::Value;
use tracker::association::one_track::OneTrack;
use tracker::filter::TwoPlots;
use tracker::filter::turn::{AdaptiveGrid, Carry, Grid, SwitchingGrid, Turn};
use tracker::plots::measurement::Measurement;

use super::examples::{Example, STEP_S, Truth};
use crate::{Case, Options};

/// σ_a, which the source does not state, m/s².
const NOISE_MPS2: f64 = 0.1;
/// Probability of staying in a model over a scan.
const STAY: f64 = 0.9;

/// Which filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Five known rates.
    Imm5,
    /// The grid that follows the target, with t₁ and r (°/s).
    Adaptive { recentre: f64, spacing_deg_per_s: f64 },
    /// The window that steps, with t.
    Switching { threshold: f64, variant: Variant },
    /// One model that is told the true rate and where the ship is as far as R goes: a bound. With the noise of the others, or with none.
    Clairvoyant { has_noise: bool },
}

/// How the window steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Variant {
    /// (V4).
    Corrected,
    /// To the right whenever no model exceeds t, as printed.
    Printed,
    /// (V4), states carried with their rates.
    ByRate,
}

/// One filter on one example.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Setting {
    pub(super) example: Example,
    pub(super) kind: Kind,
}

impl Setting {
    /// The filters of one example: the published ones first, then the sweeps.
    pub(super) fn all(example: Example, options: &Options) -> Vec<Self> {
        let [recentre, _, _, _, spacing_deg_per_s] = example.adaptive;
        let switching = |threshold, variant| Kind::Switching { threshold, variant };
        let mut kinds = vec![
            Kind::Imm5,
            Kind::Adaptive { recentre, spacing_deg_per_s },
            switching(0.7, Variant::Corrected),
            switching(0.5, Variant::Corrected),
            switching(0.7, Variant::Printed),
            switching(0.7, Variant::ByRate),
            switching(0.5, Variant::ByRate),
            Kind::Clairvoyant { has_noise: false },
            Kind::Clairvoyant { has_noise: true },
        ];
        if !options.quick {
            kinds.extend([0.35, 0.4, 0.6, 0.8, 0.9].map(|threshold| switching(threshold, Variant::Corrected)));
            kinds.extend([0.1, 0.2, 0.4, 0.5].map(|recentre| Kind::Adaptive { recentre, spacing_deg_per_s }));
            let spacings = [1.0, 2.0, 3.0, 4.0].into_iter().filter(|spacing| (spacing - spacing_deg_per_s).abs() > 0.1);
            kinds.extend(spacings.map(|spacing_deg_per_s| Kind::Adaptive { recentre, spacing_deg_per_s }));
        }
        kinds.into_iter().map(|kind| Self { example, kind }).collect()
    }

    /// Whether an independent program has run it too.
    pub(super) fn is_published(&self) -> bool {
        self.reference()[0].is_some()
    }

    /// As published names say it.
    pub(super) fn name(&self) -> &'static str {
        match self.kind {
            Kind::Imm5 => "IMM5",
            Kind::Adaptive { .. } => "AGMM",
            Kind::Switching { variant: Variant::Corrected, .. } => "SGMM",
            Kind::Switching { variant: Variant::Printed, .. } => "SGMM as printed",
            Kind::Switching { variant: Variant::ByRate, .. } => "SGMM by rate",
            Kind::Clairvoyant { has_noise: false } => "clairvoyant",
            Kind::Clairvoyant { has_noise: true } => "clairvoyant, same noise",
        }
    }

    pub(super) fn case(&self) -> Case {
        let [t, t1, r] = match self.kind {
            Kind::Adaptive { recentre, spacing_deg_per_s } => [Value::Null, recentre.into(), spacing_deg_per_s.into()],
            Kind::Switching { threshold, .. } => [threshold.into(), Value::Null, Value::Null],
            Kind::Imm5 | Kind::Clairvoyant { .. } => [Value::Null, Value::Null, Value::Null],
        };
        let case = Case::new().with("example", self.example.number).with("filter", self.name());
        case.with("t", t).with("t1", t1).with("r_deg_per_s", r)
    }

    /// Mean position (m) and velocity (m/s) errors of an independent program, where it has run.
    pub(super) fn reference(&self) -> [Option<f64>; 2] {
        let [recentre, _, _, _, spacing_deg_per_s] = self.example.adaptive;
        let switching = |threshold| Kind::Switching { threshold, variant: Variant::Corrected };
        let of_examples = [
            (Kind::Imm5, [[28.48, 1.941], [30.23, 2.876]]),
            (Kind::Adaptive { recentre, spacing_deg_per_s }, [[29.92, 2.604], [36.07, 4.066]]),
            (switching(0.7), [[28.33, 1.807], [48.99, 4.192]]),
            (switching(0.5), [[f64::NAN, f64::NAN], [36.92, 3.581]]),
            (Kind::Clairvoyant { has_noise: false }, [[10.18, f64::NAN], [12.86, f64::NAN]]),
        ];
        let of_kind = of_examples.into_iter().find(|(kind, _)| *kind == self.kind);
        let known = |reference: f64| (!reference.is_nan()).then_some(reference);
        of_kind.map_or([None; 2], |(_, of_examples)| of_examples[self.example.number as usize - 1].map(known))
    }

    /// The filter.
    pub(super) fn filter(&self) -> Turn {
        let radians = |rates: &[f64]| rates.iter().map(|rate| rate.to_radians()).collect();
        let mut noise_mps2 = NOISE_MPS2;
        let grid = match self.kind {
            Kind::Imm5 => Grid::Known(radians(&self.example.rates)),
            Kind::Adaptive { recentre, spacing_deg_per_s } => {
                let [_, narrow, widen, greatest, _] = self.example.adaptive;
                let spacing = spacing_deg_per_s.to_radians();
                let greatest = greatest.to_radians();
                Grid::Adaptive(AdaptiveGrid {
                    first: [-spacing, 0.0, spacing],
                    greatest,
                    spacing,
                    recentre,
                    narrow,
                    widen,
                })
            }
            Kind::Switching { threshold, variant } => Grid::Switching(SwitchingGrid {
                rates: radians(&self.example.rates),
                threshold,
                carry: if variant == Variant::ByRate { Carry::ByRate } else { Carry::ByPlace },
                undecided_steps_right: variant == Variant::Printed,
            }),
            Kind::Clairvoyant { has_noise } => {
                noise_mps2 = if has_noise { NOISE_MPS2 } else { 0.0 };
                Grid::Known(vec![0.0])
            }
        };
        Turn::new(grid, noise_mps2, 2, 60.0, STAY, STEP_S)
    }
}

/// What a filter says of one scan.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Estimate {
    pub(super) position_m: [f64; 2],
    pub(super) velocity_mps: [f64; 2],
    /// Of its models.
    pub(super) rates_rad_per_s: Vec<f64>,
    pub(super) probabilities: Vec<f64>,
}

/// The estimates of one run, from the third scan on, handed to `take` with the scan's number.
pub(super) fn follow(setting: &Setting, truth: &[Truth], plots: &[Measurement], mut take: impl FnMut(usize, Estimate)) {
    let is_told = matches!(setting.kind, Kind::Clairvoyant { .. });
    let mut plots = plots.to_vec();
    if is_told {
        for (plot, ship) in plots.iter_mut().zip(truth) {
            plot.polar[..2].copy_from_slice(&ship.polar());
        }
    }
    let filter = setting.filter();
    let models = filter.grid.models();
    let mut track = OneTrack::new(Box::new(filter));
    track.start(&TwoPlots { previous: &plots[0], last: &plots[1], step_s: STEP_S });
    for scan in 2..plots.len() {
        if is_told {
            let mut words = track.words().to_vec();
            let memory = words.len() - 2;
            words[memory] = truth[scan].rate_rad_per_s;
            track.set(&words);
        }
        track.predict(STEP_S);
        track.take(&plots[scan]);
        let state = track.state();
        take(
            scan,
            Estimate {
                position_m: [state.mean_of(0), state.mean_of(1)],
                velocity_mps: [state.mean_of(3), state.mean_of(4)],
                rates_rad_per_s: state.memory()[..models].to_vec(),
                probabilities: state.weights().to_vec(),
            },
        );
    }
}
