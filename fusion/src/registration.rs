//! Systematic errors of radars, from targets that several of them see (F7).
//!
//! ```text
//! x_i = t + J_i b_i + noise,  noise ~ N(0, W_i⁻¹),  b ~ N(0, prior)
//! t eliminated:  N_ij = δ_ij J_iᵀ W_i J_i − J_iᵀ W_i (Σ W)⁻¹ W_j J_j,  g_i = J_iᵀ W_i (x_i − x̄)
//! b = (N + prior⁻¹)⁻¹ g
//! ```
//!
//! x_i is the place that radar i measures, J_i how it moves with the radar's bias of range, azimuth, elevation and time. What
//! targets say is remembered for a while only, so biases may drift.

use common::angle;
use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3};

/// Biases of a radar: range, azimuth, elevation, time.
pub const BIASES: usize = 4;
/// A bias: m, rad, rad, s.
pub type Bias = SVector<f64, BIASES>;
/// How a position moves with a bias.
pub type BiasJacobian = SMatrix<f64, 3, BIASES>;

/// (x_i − t) of the most deviating set that still counts fully, as χ² per degree of freedom.
const PLAUSIBLE: f64 = 4.0;

/// Change of a position in the radar's own ENU with its biases; m per m, rad, rad, s.
pub fn jacobian(position_m: &Vector3<f64>, velocity_mps: &Vector3<f64>) -> BiasJacobian {
    let ground = position_m.x.hypot(position_m.y).max(1e-3);
    let range = ground.hypot(position_m.z);
    let (sin_a, cos_a) = (position_m.x / ground, position_m.y / ground);
    BiasJacobian::from_columns(&[
        position_m / range,
        Vector3::new(position_m.y, -position_m.x, 0.0),
        Vector3::new(-position_m.z * sin_a, -position_m.z * cos_a, ground),
        *velocity_mps,
    ])
}

/// What one radar says of a target at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Number of the radar.
    pub site: usize,
    /// Where it sees the target, without the bias that is taken for known, in the axes of the centre; m.
    pub position_m: Vector3<f64>,
    /// W: inverse covariance of that; 1/m².
    pub weight: Matrix3<f64>,
    /// J in the axes of the centre.
    pub jacobian: BiasJacobian,
}

/// The biases of all radars, and how well they are known.
#[derive(Debug, Clone)]
pub struct Registration {
    /// Standard deviations of the prior; 0 for what is known to have no bias.
    scale: DVector<f64>,
    /// Biases taken for known (F7a); what is estimated comes on top.
    known: DVector<f64>,
    normal: DMatrix<f64>,
    right: DVector<f64>,
    estimate: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Registration {
    /// Radars of which only the standard deviations of their biases are known.
    pub fn new(priors: &[Bias]) -> Self {
        let size = BIASES * priors.len();
        let scale = DVector::from_iterator(size, priors.iter().flat_map(|prior| prior.iter().copied()));
        Self {
            covariance: DMatrix::from_diagonal(&scale.component_mul(&scale)),
            scale,
            known: DVector::zeros(size),
            normal: DMatrix::zeros(size, size),
            right: DVector::zeros(size),
            estimate: DVector::zeros(size),
        }
    }

    /// Number of radars.
    pub fn sites(&self) -> usize {
        self.scale.len() / BIASES
    }

    /// Bias of a radar as known now.
    pub fn bias(&self, site: usize) -> Bias {
        self.known_bias(site) + self.estimate.fixed_rows::<BIASES>(site * BIASES)
    }

    /// The part of it that is taken for known.
    pub fn known_bias(&self, site: usize) -> Bias {
        self.known.fixed_rows::<BIASES>(site * BIASES).into_owned()
    }

    /// Takes what a radar measures more than its [`bias`](Self::bias) says for known, and forgets what targets have said of it before.
    pub fn begin_anew(&mut self, site: usize, more: &Bias) {
        let known = self.bias(site) + more;
        let at = site * BIASES;
        self.known.fixed_rows_mut::<BIASES>(at).copy_from(&known);
        // What the others owe to what was estimated of it stays with them.
        let pull = self.normal.columns(at, BIASES) * self.estimate.rows(at, BIASES);
        self.right -= pull;
        for sum in [&mut self.right, &mut self.estimate] {
            sum.fixed_rows_mut::<BIASES>(at).fill(0.0);
        }
        for matrix in [&mut self.normal, &mut self.covariance] {
            matrix.rows_mut(at, BIASES).fill(0.0);
            matrix.columns_mut(at, BIASES).fill(0.0);
        }
        for row in at..at + BIASES {
            self.covariance[(row, row)] = self.scale[row] * self.scale[row];
        }
    }

    /// Covariance of the errors of two radars' biases.
    pub fn covariance(&self, row: usize, column: usize) -> SMatrix<f64, BIASES, BIASES> {
        self.covariance.fixed_view::<BIASES, BIASES>(row * BIASES, column * BIASES).into_owned()
    }

    /// Takes what several radars say of one target; `share` of it counts, so that errors which repeat are not taken for
    /// independent ones. Of a set that is unlikely with the biases known now, less counts.
    pub fn observe(&mut self, observations: &[Observation], share: f64) {
        let Some(spread) = observations.iter().map(|of| of.weight).sum::<Matrix3<f64>>().try_inverse() else { return };
        let mean_of = |place: &dyn Fn(&Observation) -> Vector3<f64>| {
            spread * observations.iter().map(|of| of.weight * place(of)).sum::<Vector3<f64>>()
        };
        let estimate = |site: usize| self.estimate.fixed_rows::<BIASES>(site * BIASES).into_owned();
        let corrected = |of: &Observation| of.position_m - of.jacobian * estimate(of.site);
        let mean = mean_of(&corrected);
        let deviation: f64 = observations.iter().map(|of| deviation(of, &(corrected(of) - mean), self)).sum();
        let freedom = 3.0 * (observations.len() as f64 - 1.0);
        let share = share * (PLAUSIBLE * freedom / deviation.max(1e-9)).min(1.0);
        let mean = mean_of(&|of: &Observation| of.position_m);
        for of in observations {
            let at = of.site * BIASES;
            let pulled = of.jacobian.transpose() * of.weight;
            let mut right = self.right.fixed_rows_mut::<BIASES>(at);
            right += share * pulled * (of.position_m - mean);
            for other in observations {
                let weight = if other.site == of.site { Matrix3::identity() } else { Matrix3::zeros() };
                let block = pulled * (weight - spread * other.weight) * other.jacobian;
                let mut normal = self.normal.fixed_view_mut::<BIASES, BIASES>(at, other.site * BIASES);
                normal += share * block;
            }
        }
    }

    /// Estimates the biases from all that counts.
    pub fn solve(&mut self) {
        // In units of the prior, so that its information is 1.
        let scaled = DMatrix::from_fn(self.scale.len(), self.scale.len(), |row, column| {
            self.scale[row] * self.normal[(row, column)] * self.scale[column] + if row == column { 1.0 } else { 0.0 }
        });
        let Some(root) = scaled.cholesky() else { return };
        let right = self.scale.component_mul(&self.right);
        self.estimate = self.scale.component_mul(&root.solve(&right));
        let mut covariance = root.inverse();
        for (row, mut column) in covariance.column_iter_mut().enumerate() {
            column.component_mul_assign(&self.scale);
            column *= self.scale[row];
        }
        self.covariance = covariance;
    }

    /// Forgets a share of what counts.
    pub fn forget(&mut self, share: f64) {
        self.normal *= 1.0 - share;
        self.right *= 1.0 - share;
    }
}

/// χ² of a deviation where the bias itself is uncertain.
fn deviation(of: &Observation, deviation: &Vector3<f64>, registration: &Registration) -> f64 {
    let bias = of.jacobian * registration.covariance(of.site, of.site) * of.jacobian.transpose();
    let spread = of.weight.try_inverse().map_or(bias, |noise| noise + bias);
    crate::comparison::chi_squared(deviation, spread)
}

/// Position and velocity in the radar's own ENU without its bias.
pub fn corrected(position_m: &Vector3<f64>, velocity_mps: &Vector3<f64>, bias: &Bias) -> (Vector3<f64>, Vector3<f64>) {
    let ground = position_m.x.hypot(position_m.y);
    let range = ground.hypot(position_m.z).max(1e-3);
    let azimuth = angle::wrap(position_m.x.atan2(position_m.y) - bias[1]);
    let elevation = position_m.z.atan2(ground) - bias[2];
    let (sin_a, cos_a) = azimuth.sin_cos();
    let (sin_e, cos_e) = elevation.sin_cos();
    let place = Vector3::new(cos_e * sin_a, cos_e * cos_a, sin_e) * (range - bias[0]);
    // Biases of angles turn the velocity with the position.
    let turn = Vector3::new(cos_a, -sin_a, 0.0) * -bias[2] + Vector3::new(0.0, 0.0, bias[1]);
    let velocity = velocity_mps + turn.cross(velocity_mps);
    (place - velocity * bias[3], velocity)
}
