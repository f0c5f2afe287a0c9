//! What each component of a group expects to see, and its gate: (T5), (T9).
//!
//! H P* Hᵀ and P* Hᵀ share their first three rows and columns with P*; only what concerns the range rate is computed:
//! ```text
//! c = P* H₄ᵀ,  H₄ = [g_p  e_r  0],  g_p = (v − ṙ e_r)/ρ;   H₄ P* H₄ᵀ = H₄ c
//! p*_r = e_rᵀ P* e_r,  p*_β = e_βᵀ P* e_β/(ρ cos ε)²,  p*_ε = e_εᵀ P* e_ε/ρ²,  p*_ṙ = H₄ c
//! h_i = α √(p*_i + σ_i²)                                                                       (T9)
//! ```

use std::f64::consts::FRAC_PI_2;

use common::tracks::STATE;
use pulp::{Simd, WithSimd};

use super::gaussian::at;
use super::group::{Component, Group, for_known};
use super::lanes::{Lanes, Row, V, dot};
use super::machine::Machine;
use crate::plots::measurement::{COORDINATES, LineOfSight, NEAREST_M};
use crate::plots::radar::Radar;

/// Ranges below this are taken for it where motion across the line of sight is turned into an angle, m.
const NEAREST_DRIFT_M: f64 = 1.0;

/// What one component expects.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Expectation {
    /// h(u*) in (r, β, ε, ṙ): centre of the gate.
    pub centre: [Row; COORDINATES],
    /// p*, predicted variances of the four.
    pub variance: [Row; COORDINATES],
    /// How fast the four change along the mean motion, per s.
    pub drift: [Row; COORDINATES],
    /// h, half widths of the gate for a plot of nominal errors.
    pub half: [Row; COORDINATES],
    /// cos ε.
    pub cos_elevation: Row,
    /// e_r.
    pub radial: [Row; 3],
    /// g_p: ∂ṙ/∂position, 1/s.
    pub gradient: [Row; 3],
    /// e_β; its height is 0.
    pub along_azimuth: [Row; 2],
    /// e_ε.
    pub along_elevation: [Row; 3],
    /// ρ cos ε and ρ, squared, m².
    pub square: [Row; 2],
    /// c = P* H₄ᵀ, of the states that the component knows.
    pub cross: [Row; STATE],
}

impl Expectation {
    /// Evaluates R in `lane` at a place instead of the prediction, as for (T6).
    pub fn place_errors(&mut self, lane: usize, at: &LineOfSight) {
        let across = at.range_m * at.cos_elevation;
        for i in 0..3 {
            self.radial[i].0[lane] = at.radial[i];
            self.along_elevation[i].0[lane] = at.along_elevation[i];
        }
        for i in 0..2 {
            self.along_azimuth[i].0[lane] = at.along_azimuth[i];
        }
        self.square[0].0[lane] = across * across;
        self.square[1].0[lane] = at.range_m * at.range_m;
    }
}

/// Expected measurements and gates of half width `alpha` of all components in `lanes` lanes.
pub fn expect(
    machine: Machine,
    lanes: usize,
    radar: &Radar,
    alpha: f64,
    prediction: &Group,
    expected: &mut Vec<Expectation>,
) {
    expected.resize(prediction.layout().len(), Expectation::default());
    machine.arch(lanes).dispatch(Expect { lanes, radar, alpha, prediction, expected });
}

struct Expect<'a> {
    lanes: usize,
    radar: &'a Radar,
    alpha: f64,
    prediction: &'a Group,
    expected: &'a mut [Expectation],
}

impl WithSimd for Expect<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { radar, alpha, prediction, expected, .. } = self;
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            for (j, out) in expected.iter_mut().enumerate() {
                for_known!(prediction.layout().known(j), expect_component(lanes, prediction, j, radar, alpha, out));
            }
        }
    }
}

#[inline(always)]
fn expect_component<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    prediction: &Group,
    j: usize,
    radar: &Radar,
    alpha: f64,
    out: &mut Expectation,
) {
    let component: Component<'_, N, P> = prediction.component(j);
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    let u = lanes.all(component.mean);
    let (mut velocity, mut acceleration) = ([zero; 3], [zero; 3]);
    for i in 0..3 {
        if N > 3 {
            velocity[i] = u[3 + i];
        }
        if N > 6 {
            acceleration[i] = u[6 + i];
        }
    }

    // Directions.
    let ground_square = u[0] * u[0] + u[1] * u[1];
    let ground = ground_square.sqrt();
    let range = (u[2] * u[2] + ground_square).sqrt();
    let (off_axis, off_antenna) = (zero.less(ground), zero.less(range));
    let (per_ground, per_range) = (ground.inverse(), range.inverse());
    let sin_b = off_axis.pick(u[0] * per_ground, zero);
    let cos_b = off_axis.pick(u[1] * per_ground, one);
    let sin_e = off_antenna.pick(u[2] * per_range, zero);
    let cos_e = off_antenna.pick(ground * per_range, one);
    let rho = range.max(lanes.splat(NEAREST_M));
    let radial = [(cos_e * sin_b).rounded(), (cos_e * cos_b).rounded(), sin_e];
    let along_azimuth = [cos_b, -sin_b];
    let along_elevation = [-(sin_e * sin_b).rounded(), -(sin_e * cos_b).rounded(), cos_e];

    // Range rate: h₄, g_p, c.
    let range_rate = dot(&velocity, &radial);
    let per_rho = rho.inverse();
    let mut gradient = [zero; 3];
    for i in 0..3 {
        gradient[i] = ((velocity[i] - range_rate * radial[i]) * per_rho).rounded();
    }
    let mut rate_variance = zero;
    for i in 0..N {
        let mut c = zero;
        if N > 3 {
            for k in 0..3 {
                c += lanes.get(&component.covariance[at(i, k)]) * gradient[k];
                c += lanes.get(&component.covariance[at(i, 3 + k)]) * radial[k];
            }
            if i < 3 {
                rate_variance += gradient[i] * c;
            } else if i < 6 {
                rate_variance += radial[i - 3] * c;
            }
        }
        lanes.put(&mut out.cross[i], c);
    }

    // Gate.
    let across = (rho * cos_e).rounded();
    let gated_across = across.max(lanes.splat(NEAREST_M));
    let centre = [rho, u[0].azimuth(u[1]), u[2].elevation(ground), range_rate];
    let azimuth_direction = [along_azimuth[0], along_azimuth[1], zero];
    // Rounding can take a variance below zero.
    let variance = [
        along(lanes, component, &radial),
        along(lanes, component, &azimuth_direction) / (gated_across * gated_across).rounded(),
        along(lanes, component, &along_elevation) / (rho * rho).rounded(),
        rate_variance,
    ]
    .map(|variance| variance.max(zero));
    let nearest = lanes.splat(NEAREST_DRIFT_M);
    let turning = dot(&velocity, &velocity) - range_rate * range_rate;
    let drift = [
        range_rate,
        dot(&velocity, &azimuth_direction) / across.max(nearest),
        dot(&velocity, &along_elevation) / rho.max(nearest),
        dot(&acceleration, &radial) + turning / rho.max(nearest),
    ];
    for i in 0..COORDINATES {
        let mut half = (lanes.splat(alpha) * (variance[i] + lanes.splat(radar.variance[i])).sqrt()).rounded();
        // Azimuth is bounded to a quarter turn either way, so that a track above the antenna does not wait for the beam for ever.
        if i == 1 || i == 2 {
            half = half.min(lanes.splat(FRAC_PI_2));
        }
        lanes.put(&mut out.half[i], half);
        lanes.put(&mut out.centre[i], centre[i]);
        lanes.put(&mut out.variance[i], variance[i]);
        lanes.put(&mut out.drift[i], drift[i]);
    }
    for i in 0..3 {
        lanes.put(&mut out.radial[i], radial[i]);
        lanes.put(&mut out.gradient[i], gradient[i]);
        lanes.put(&mut out.along_elevation[i], along_elevation[i]);
    }
    for i in 0..2 {
        lanes.put(&mut out.along_azimuth[i], along_azimuth[i]);
    }
    lanes.put(&mut out.cos_elevation, cos_e);
    lanes.put(&mut out.square[0], across * across);
    lanes.put(&mut out.square[1], rho * rho);
}

/// eᵀ P* e over the position.
#[inline(always)]
fn along<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    component: Component<'_, N, P>,
    e: &[V<S>; 3],
) -> V<S> {
    let mut sum = lanes.splat(0.0);
    for b in 0..3 {
        let mut row = lanes.splat(0.0);
        for a in 0..3 {
            row += lanes.get(&component.covariance[at(a, b)]) * e[a];
        }
        sum += row * e[b];
    }
    sum
}
