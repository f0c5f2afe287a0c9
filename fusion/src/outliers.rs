//! Outliers among the measurements of one radar (F4).
//!
//! ```text
//! classic    |ΔQ| ≤ V_max Δt + k σ_D                          of the whole vector, from the last one that was kept
//! channels   |D − D̂| ≤ V_max Δt + k σ_D                        of each coordinate alone, from its own cluster
//!            |A − Â| ≤ V_max Δt / (D cos E) + k σ_A
//!            |E − Ê| ≤ V_max Δt / D + k σ_E
//! ```
//!
//! The extrapolation of a cluster is quadratic of four points or more, linear of two or three, constant of one. The cluster
//! with the most points is the target's: a bad elevation does not throw away range and azimuth.

use common::angle;
use nalgebra::Vector3;

/// Standard deviations that a measurement may be away from its target (k).
const SIGMAS: f64 = 3.0;
/// Points that a cluster is extrapolated from.
const WINDOW: usize = 8;
/// Most clusters of a channel; the emptiest makes room.
const CLUSTERS: usize = 8;

/// Range D (m), azimuth A and elevation E (rad), as measured.
pub type Coordinates = [f64; 3];

/// What is known of targets and radar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Speed that no target exceeds, m/s.
    pub speed_mps: f64,
    /// Standard deviations of D, A, E; m, rad, rad.
    pub sigma: Coordinates,
    /// Time after which a cluster without new points is forgotten, s.
    pub forget_s: f64,
}

/// The rule for whole vectors.
#[derive(Debug, Clone)]
pub struct Classic {
    limits: Limits,
    last: Option<(f64, Vector3<f64>)>,
}

impl Classic {
    /// Before the first measurement.
    pub fn new(limits: Limits) -> Self {
        Self { limits, last: None }
    }

    /// Whether a measurement at `time_s` is kept.
    pub fn keeps(&mut self, time_s: f64, [range, azimuth, elevation]: Coordinates) -> bool {
        let (sin_a, cos_a) = azimuth.sin_cos();
        let (sin_e, cos_e) = elevation.sin_cos();
        let place = Vector3::new(cos_e * sin_a, cos_e * cos_a, sin_e) * range;
        let margin_m = SIGMAS * self.limits.sigma[0];
        let kept = self
            .last
            .is_none_or(|(last_s, last)| (place - last).norm() <= self.limits.speed_mps * (time_s - last_s) + margin_m);
        if kept {
            self.last = Some((time_s, place));
        }
        kept
    }
}

/// The rule for each channel.
#[derive(Debug, Clone)]
pub struct Channels {
    limits: Limits,
    channels: [Channel; 3],
}

impl Channels {
    /// Before the first measurement.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            channels: [Channel::default(), Channel { is_angle: true, ..Channel::default() }, Channel::default()],
        }
    }

    /// Which of D, A, E of a measurement at `time_s` are kept.
    pub fn keeps(&mut self, time_s: f64, coordinates: Coordinates) -> [bool; 3] {
        let [range, _, elevation] = coordinates;
        let speed = self.limits.speed_mps;
        let speeds = [speed, speed / (range * elevation.cos()), speed / range];
        let Limits { sigma, forget_s, .. } = self.limits;
        let mut kept = [true; 3];
        for (axis, channel) in self.channels.iter_mut().enumerate() {
            kept[axis] = channel.keeps(time_s, coordinates[axis], speeds[axis], SIGMAS * sigma[axis], forget_s);
        }
        kept
    }
}

#[derive(Debug, Clone, Default)]
struct Channel {
    /// Whether its values are angles of a full circle.
    is_angle: bool,
    clusters: Vec<Cluster>,
}

impl Channel {
    fn keeps(&mut self, time_s: f64, value: f64, speed: f64, margin: f64, forget_s: f64) -> bool {
        self.clusters.retain(|cluster| time_s - cluster.last().0 <= forget_s);
        let near = |(index, cluster): (usize, &Cluster)| {
            let expected = cluster.extrapolated(time_s);
            let away = if self.is_angle { angle::difference(value, expected) } else { value - expected };
            let share = away.abs() / (speed * (time_s - cluster.last().0) + margin);
            (share <= 1.0).then_some((index, share, expected + away))
        };
        let nearest = self.clusters.iter().enumerate().filter_map(near).min_by(|a, b| a.1.total_cmp(&b.1));
        let own = if let Some((index, _, value)) = nearest {
            self.clusters[index].push(time_s, value);
            index
        } else {
            if self.clusters.len() == CLUSTERS {
                let emptiest = (0..CLUSTERS).min_by_key(|&index| self.clusters[index].count).unwrap_or(0);
                self.clusters.remove(emptiest);
            }
            self.clusters.push(Cluster::new(time_s, value));
            self.clusters.len() - 1
        };
        // Of equals the older one.
        let count = self.clusters[own].count;
        self.clusters.iter().enumerate().all(|(index, other)| (other.count, own) < (count, index) || index == own)
    }
}

/// Points that follow one another: the last of them, oldest first.
#[derive(Debug, Clone)]
struct Cluster {
    points: [(f64, f64); WINDOW],
    held: usize,
    count: u32,
}

impl Cluster {
    fn new(time_s: f64, value: f64) -> Self {
        let mut cluster = Self { points: [(0.0, 0.0); WINDOW], held: 0, count: 0 };
        cluster.push(time_s, value);
        cluster
    }

    fn push(&mut self, time_s: f64, value: f64) {
        if self.held == WINDOW {
            self.points.rotate_left(1);
            self.held -= 1;
        }
        self.points[self.held] = (time_s, value);
        self.held += 1;
        self.count += 1;
    }

    fn last(&self) -> (f64, f64) {
        self.points[self.held - 1]
    }

    /// Least squares by polynomials that are orthogonal over the points.
    fn extrapolated(&self, time_s: f64) -> f64 {
        let points = &self.points[..self.held];
        let degree = match self.held {
            0 | 1 => 0,
            2 | 3 => 1,
            _ => 2,
        };
        let n = points.len() as f64;
        let (mean_t, mean_v) = points.iter().fold((0.0, 0.0), |(t, v), point| (t + point.0 / n, v + point.1 / n));
        let mut value = mean_v;
        if degree == 0 {
            return value;
        }
        let sum =
            |term: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(t, v)| term(t - mean_t, v - mean_v)).sum::<f64>();
        let second = sum(&|t, _| t * t);
        if second <= 0.0 {
            return value;
        }
        let at = time_s - mean_t;
        value += sum(&|t, v| t * v) / second * at;
        if degree == 2 {
            // t² without its parts along 1 and t.
            let (skew, level) = (sum(&|t, _| t * t * t) / second, second / n);
            let quadratic = |t: f64| t * t - skew * t - level;
            let norm = sum(&|t, _| quadratic(t).powi(2));
            if norm > 0.0 {
                value += sum(&|t, v| quadratic(t) * v) / norm * quadratic(at);
            }
        }
        value
    }
}
