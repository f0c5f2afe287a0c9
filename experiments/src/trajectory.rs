//! Trajectories that experiments fly: those of \[L22\], and random ones that no setting was tuned on.

use common::random::{Purpose, generator};
use nalgebra::Vector3;
use radar_sim::motion::{Kinematics, Segments};
use rand::RngExt;

/// Scans after the two of the start: k = 1…50.
pub const SCANS: u32 = 50;

/// A kind of trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trajectory {
    /// No manoeuvre.
    Cv,
    /// Three manoeuvres, at the last of which the target flies faster and faster.
    A,
    /// Turn, stop, hover, start.
    B,
    /// Another for every run: straight flight, hover and manoeuvres of random length and direction.
    Random,
}

/// All kinds.
pub const ALL: [Trajectory; 4] = [Trajectory::B, Trajectory::A, Trajectory::Cv, Trajectory::Random];

/// Scans `first` to `last`, both included, of one kind of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Segment {
    /// As in the JSON.
    pub name: &'static str,
    /// First scan k.
    pub first: u32,
    /// Last scan k.
    pub last: u32,
}

impl Segment {
    /// The whole run.
    pub const ALL: Self = Self::new("all", 1, SCANS);

    /// The scans in which a track has been confirmed long since, from the first manoeuvre of B on.
    pub const SETTLED: Self = Self::new("settled", 10, SCANS);

    const fn new(name: &'static str, first: u32, last: u32) -> Self {
        Self { name, first, last }
    }

    /// Whether scan k belongs to it.
    pub fn holds(&self, k: u32) -> bool {
        (self.first..=self.last).contains(&k)
    }
}

/// Of B; A has them but for `brake` and `hover`.
const SEGMENTS: [Segment; 7] = [
    Segment::new("cv1", 1, 9),
    Segment::new("turn", 10, 15),
    Segment::new("cv2", 16, 20),
    Segment::new("brake", 21, 25),
    Segment::new("hover", 26, 33),
    Segment::new("accelerate", 34, 39),
    Segment::new("cv3", 40, 50),
];

impl Trajectory {
    /// The segments that have a name, the whole run first.
    pub fn segments(self) -> Vec<Segment> {
        let named = SEGMENTS.into_iter().filter(|segment| match self {
            Self::B => true,
            Self::A => !matches!(segment.name, "brake" | "hover"),
            Self::Cv | Self::Random => false,
        });
        std::iter::once(Segment::ALL).chain(named).collect()
    }

    /// As in the JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cv => "CV",
            Self::A => "A",
            Self::B => "B",
            Self::Random => "random",
        }
    }

    /// The motion in one run; time 0 is k = −1.
    pub fn motion(self, seed: u64, run: u32) -> Segments {
        match self {
            Self::Cv => Segments::published("cv", Vector3::zeros()),
            Self::A => Segments::published("a", Vector3::zeros()),
            Self::B => Segments::published("b", Vector3::zeros()),
            Self::Random => random(seed, run),
        }
    }
}

/// Pieces of 4 to 12 s: unaccelerated, or with up to 8 m/s²; the speed stays below 45 m/s and the place between 300 m and 4 km from
/// the antenna.
fn random(seed: u64, run: u32) -> Segments {
    let mut rng = generator(seed, Purpose::Trajectory, run, 0);
    loop {
        let range_m = rng.random_range(600.0..3000.0);
        let (bearing, heading) =
            (rng.random_range(0.0..std::f64::consts::TAU), rng.random_range(0.0..std::f64::consts::TAU));
        let speed_mps = rng.random_range(0.0..30.0);
        let at = |angle: f64, length: f64| Vector3::new(length * angle.sin(), length * angle.cos(), 0.0);
        let start = at(bearing, range_m) + Vector3::new(0.0, 0.0, rng.random_range(60.0..300.0));
        let mut velocity = at(heading, speed_mps);
        let first = velocity;
        let mut steps = Vec::new();
        let mut left = SCANS as i32 + 1;
        let mut accelerates = false;
        while left > 0 {
            let seconds = rng.random_range(4..=12).min(left);
            let mut acceleration = Vector3::zeros();
            if accelerates {
                let stops = rng.random_range(0.0..1.0) < 0.3;
                acceleration = if stops {
                    -velocity / f64::from(seconds)
                } else {
                    at(rng.random_range(0.0..std::f64::consts::TAU), rng.random_range(1.0..8.0))
                };
            }
            velocity += acceleration * f64::from(seconds);
            steps.push((acceleration.y, acceleration.x, seconds as u32));
            left -= seconds;
            accelerates = !accelerates;
        }
        let motion = Segments::new(start, first, &steps);
        let allowed = |state: Kinematics| {
            let ground_m = state.position_m.xy().norm();
            (300.0..4000.0).contains(&ground_m) && state.velocity_mps.norm() < 45.0
        };
        if (0..=SCANS + 1).all(|k| allowed(motion.at(f64::from(k)))) {
            return motion;
        }
    }
}
