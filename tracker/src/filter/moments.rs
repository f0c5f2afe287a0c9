//! Mean and covariance of each lane of a group, all components together (T16).

use std::f64::consts::PI;

use common::tracks::{PACKED, STATE};
use pulp::{Simd, WithSimd};

use super::gaussian::{Gaussian, at};
use super::group::{Component, Group, for_known};
use super::lanes::{Lanes, Row, V};
use super::machine::Machine;
use crate::plots::measurement::NEAREST_M;
use crate::plots::radar::Radar;
use crate::tracks::bounds::Spread;

/// Moments of up to eight tracks.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    /// u; m, m/s, m/s².
    pub mean: [Row; STATE],
    /// Packed triangle of P.
    pub covariance: [Row; PACKED],
}

impl Default for Moments {
    fn default() -> Self {
        Self { mean: [Row::ZERO; STATE], covariance: [Row::ZERO; PACKED] }
    }
}

impl Moments {
    /// Those of `lanes` lanes of a group.
    ///
    /// ```text
    /// ū = Σ_j W_j u_j,   P̄ = Σ_j W_j [P_j + (u_j − ū)(u_j − ū)ᵀ]                    (T16)
    /// ```
    ///
    /// What a component does not know is 0 in it.
    pub fn evaluate(&mut self, machine: Machine, lanes: usize, group: &Group) {
        machine.arch(lanes).dispatch(Evaluate { lanes, group, moments: self });
    }

    /// The moments of one lane.
    pub fn gaussian(&self, lane: usize) -> Gaussian {
        Gaussian {
            mean: std::array::from_fn(|i| self.mean[i].0[lane]),
            covariance: std::array::from_fn(|k| self.covariance[k].0[lane]),
        }
    }

    /// How well the target in a lane is known, in what the radar measures.
    pub fn spread(&self, lane: usize, radar: &Radar) -> Spread {
        let p = |row: usize, column: usize| self.covariance[at(row, column)].0[lane];
        let u = |i: usize| self.mean[i].0[lane];
        let axes = if radar.measured[2] { 3 } else { 2 };
        let norm = |first: usize| (0..axes).map(|axis| u(first + axis).powi(2)).sum::<f64>().sqrt();
        let deviation = |first: usize| (0..axes).map(|axis| p(first + axis, first + axis)).sum::<f64>().max(0.0).sqrt();
        let plane = p(0, 0) * p(1, 1) - p(0, 1) * p(0, 1);
        // Of two deviations: an ellipse, or an ellipsoid.
        let mut volume = if axes == 2 {
            4.0 * PI * plane.max(0.0).sqrt()
        } else {
            let first = p(0, 2) * p(1, 1) - p(1, 2) * p(0, 1);
            let second = p(0, 2) * p(0, 1) - p(1, 2) * p(0, 0);
            let determinant = p(2, 2) * plane - p(0, 2) * first + p(1, 2) * second;
            32.0 / 3.0 * PI * determinant.max(0.0).sqrt()
        };
        if radar.measured[3] {
            let mut along = 0.0;
            for i in 0..axes {
                for j in 0..axes {
                    along += u(i) * u(j) * p(3 + i, 3 + j);
                }
            }
            volume *= 4.0 * along.max(0.0).sqrt() / norm(0).max(NEAREST_M);
        }
        Spread { volume, position_m: deviation(0), speed_mps: norm(3), velocity_mps: deviation(3) }
    }

    /// Sets the moments of one lane.
    pub fn set(&mut self, lane: usize, gaussian: &Gaussian) {
        for (row, value) in self.mean.iter_mut().zip(gaussian.mean) {
            row.0[lane] = value;
        }
        for (row, value) in self.covariance.iter_mut().zip(gaussian.covariance) {
            row.0[lane] = value;
        }
    }
}

struct Evaluate<'a> {
    lanes: usize,
    group: &'a Group,
    moments: &'a mut Moments,
}

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { group, moments, .. } = self;
        let layout = group.layout();
        for part in 0..Lanes::<S>::parts(self.lanes) {
            let lanes = Lanes::of(simd, part);
            let mut mean = [lanes.splat(0.0); STATE];
            for j in 0..layout.len() {
                for_known!(layout.known(j), add_mean(lanes, group, j, &mut mean));
            }
            for (row, mean) in moments.mean.iter_mut().zip(mean) {
                lanes.put(row, mean);
            }
            moments.covariance.iter_mut().for_each(|row| lanes.put(row, lanes.splat(0.0)));
            for j in 0..layout.len() {
                for_known!(layout.known(j), add_covariance(lanes, group, j, &mean, moments));
            }
        }
    }
}

#[inline(always)]
fn add_mean<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    group: &Group,
    j: usize,
    mean: &mut [V<S>; STATE],
) {
    let component: Component<'_, N, P> = group.component(j);
    let weight = lanes.get(&group.rows()[j]);
    for i in 0..N {
        mean[i] += weight * lanes.get(&component.mean[i]);
    }
}

#[inline(always)]
fn add_covariance<S: Simd, const N: usize, const P: usize>(
    lanes: Lanes<S>,
    group: &Group,
    j: usize,
    mean: &[V<S>; STATE],
    moments: &mut Moments,
) {
    let component: Component<'_, N, P> = group.component(j);
    let weight = lanes.get(&group.rows()[j]);
    let mut d = [lanes.splat(0.0); STATE];
    for i in 0..STATE {
        d[i] = if i < N { lanes.get(&component.mean[i]) - mean[i] } else { -mean[i] };
    }
    for b in 0..STATE {
        let scaled = (weight * d[b]).rounded();
        for a in 0..=b {
            let k = at(a, b);
            let mut sum = lanes.get(&moments.covariance[k]) + scaled * d[a];
            if k < P {
                sum += weight * lanes.get(&component.covariance[k]);
            }
            lanes.put(&mut moments.covariance[k], sum);
        }
    }
}
