//! What is learnt from drawn plots is what they were drawn with, to within the errors that are stated; nothing of it is told to the tracker.

use std::f64::consts::TAU;

use common::config::{Estimator, TrackerConfig, TurnConfig};
use common::message::END_OF_SCAN;
use common::plots::{Plot, PlotsHeader};
use common::random::{Purpose, generator};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Poisson, StandardNormal};
use tracker::tuning::{Learnt, Lesson, Parameter, TuneError, learn};

const EPOCH_NS: u64 = 1_700_000_000_000_000_000;
const PERIOD_S: f64 = 2.0;
const SECTORS: u32 = 8;
const CELL_M: f64 = 30.0;
const CELL_RAD: f64 = 0.02;
const RANGE_M: f64 = 10_000.0;
const TARGETS: usize = 12;
/// Largest (estimate − truth)/error of one estimate of all, and bound of the mean of their squares: far in the tails for estimates whose
/// errors are as stated, and well within reach of one that is biased by two of its errors, or states half of them.
const FARTHEST: f64 = 4.5;
const MEAN_SQUARE: f64 = 2.2;

/// What plots are drawn with.
struct World {
    sigma_range_m: f64,
    sigma_azimuth_rad: f64,
    noise_mps2: f64,
    /// Turn rates, rad/s, and the probability of keeping one for a second.
    rates: Vec<f64>,
    stay: f64,
    detection_probability: f64,
    false_plots: f64,
    /// What plots state over their errors.
    stated: [f64; 2],
}

fn normal(rng: &mut dyn Rng) -> f64 {
    StandardNormal.sample(rng)
}

impl World {
    /// Targets in straight flight, among false plots.
    fn straight() -> Self {
        Self {
            sigma_range_m: 8.0,
            sigma_azimuth_rad: 2.5e-3,
            noise_mps2: 0.5,
            rates: vec![0.0],
            stay: 1.0,
            detection_probability: 0.85,
            false_plots: 15.0,
            stated: [1.0, 1.0],
        }
    }

    fn draw(&self, scans: u32, seed: u64) -> Vec<(PlotsHeader, Vec<Plot>)> {
        let mut all: Vec<(PlotsHeader, Vec<Plot>)> =
            (0..scans).flat_map(|scan| (0..SECTORS).map(move |sector| (header(scan, sector), Vec::new()))).collect();
        let mut rng = generator(seed, Purpose::Test, 0, 0);
        for target in 0..TARGETS {
            let from = TAU * target as f64 / TARGETS as f64;
            let radius_m = 3000.0 + 200.0 * target as f64;
            let mut place = [radius_m * from.sin(), radius_m * from.cos()];
            let mut velocity = [12.0 * (from + 1.3).sin(), 12.0 * (from + 1.3).cos()];
            let mut model = self.rates.len() / 2;
            let mut time_s = PERIOD_S * from / TAU;
            while time_s < PERIOD_S * f64::from(scans - 1) {
                if rng.random::<f64>() < self.detection_probability {
                    let range_m = place[0].hypot(place[1]) + self.sigma_range_m * normal(&mut rng);
                    let azimuth_rad = place[0].atan2(place[1]) + self.sigma_azimuth_rad * normal(&mut rng);
                    self.add(&mut all, time_s, range_m, azimuth_rad.rem_euclid(TAU));
                }
                // The beam meets it again after a turn, and as much more as it goes on in azimuth.
                let azimuth_rate =
                    (velocity[0] * place[1] - velocity[1] * place[0]) / (place[0].powi(2) + place[1].powi(2));
                let step_s = PERIOD_S / (1.0 - PERIOD_S * azimuth_rate / TAU);
                if self.rates.len() > 1 {
                    let models = self.rates.len() as f64;
                    let decay = ((models * self.stay - 1.0) / (models - 1.0)).powf(step_s);
                    if rng.random::<f64>() > (1.0 + (models - 1.0) * decay) / models {
                        model = (model + rng.random_range(1..self.rates.len())) % self.rates.len();
                    }
                }
                // (V1)
                let rate = self.rates[model];
                let (sin, cos) = (rate * step_s).sin_cos();
                let [a, b] = if rate.abs() < 1e-9 { [step_s, 0.0] } else { [sin / rate, (1.0 - cos) / rate] };
                let acceleration = [0, 1].map(|_| self.noise_mps2 * normal(&mut rng));
                let [vx, vy] = velocity;
                place[0] += a * vx - b * vy + 0.5 * acceleration[0] * step_s * step_s;
                place[1] += b * vx + a * vy + 0.5 * acceleration[1] * step_s * step_s;
                velocity =
                    [cos * vx - sin * vy + acceleration[0] * step_s, sin * vx + cos * vy + acceleration[1] * step_s];
                time_s += step_s;
            }
        }
        for scan in 0..scans {
            let count = if self.false_plots > 0.0 {
                Poisson::new(self.false_plots).expect("positive").sample(&mut rng)
            } else {
                0.0
            };
            for _ in 0..count as u32 {
                let (range_m, azimuth_rad) = (rng.random_range(0.0..RANGE_M), rng.random_range(0.0..TAU));
                let time_s = PERIOD_S * (f64::from(scan) + azimuth_rad / TAU);
                self.add(&mut all, time_s, range_m, azimuth_rad);
            }
        }
        for (_, plots) in &mut all {
            plots.sort_by(|a, b| a.azimuth_rad.total_cmp(&b.azimuth_rad));
        }
        all
    }

    fn add(&self, all: &mut [(PlotsHeader, Vec<Plot>)], time_s: f64, range_m: f64, azimuth_rad: f64) {
        if range_m > RANGE_M {
            return;
        }
        let turned = azimuth_rad / TAU;
        let scan = (time_s / PERIOD_S - turned).round().max(0.0);
        let sector = ((turned * f64::from(SECTORS)) as usize).min(SECTORS as usize - 1);
        let Some((_, plots)) = all.get_mut(scan as usize * SECTORS as usize + sector) else { return };
        plots.push(Plot {
            time_ns: EPOCH_NS + (time_s * 1e9) as u64,
            range_m: range_m.max(1.0),
            azimuth_rad,
            sigma_range_m: (self.sigma_range_m * self.stated[0]) as f32,
            sigma_azimuth_rad: (self.sigma_azimuth_rad * self.stated[1]) as f32,
            cell_count: 1,
            ..Plot::default()
        });
    }
}

fn header(scan: u32, sector: u32) -> PlotsHeader {
    let at = |sectors: u32| TAU * f64::from(sectors) / f64::from(SECTORS);
    let turned = f64::from(scan) + f64::from(sector + 1) / f64::from(SECTORS);
    PlotsHeader {
        seq: u64::from(scan * SECTORS + sector),
        session: 1,
        time_ns: EPOCH_NS + (turned * PERIOD_S * 1e9) as u64,
        covered_from_rad: at(sector),
        covered_to_rad: at(sector + 1),
        scan_period_s: PERIOD_S,
        cell_range_m: CELL_M,
        cell_azimuth_rad: CELL_RAD,
        scan,
        sector,
        sectors_per_scan: SECTORS,
        flags: if sector + 1 == SECTORS { END_OF_SCAN } else { 0 },
        ..PlotsHeader::default()
    }
}

fn found(lesson: &Lesson, parameter: Parameter) -> Learnt {
    let found = lesson.found.iter().find(|found| found.parameter == parameter).expect("a parameter of the estimator");
    found.learnt.unwrap_or_else(|| panic!("{parameter:?} is not told by the recording"))
}

/// Estimates against what they should be, in their errors.
#[derive(Default)]
struct Deviations(Vec<f64>);

impl Deviations {
    fn compare(&mut self, name: &str, estimate: Learnt, truth: f64) {
        let deviation = (estimate.value - truth) / estimate.error;
        assert!(deviation.abs() < FARTHEST, "{name}: {estimate:?}, not {truth}");
        self.0.push(deviation);
    }

    fn assert_as_stated(&self) {
        let mean = self.0.iter().map(|deviation| deviation * deviation).sum::<f64>() / self.0.len() as f64;
        assert!(mean < MEAN_SQUARE, "mean square {mean} of {:?}", self.0);
    }
}

#[test]
fn errors_motion_detection_and_clutter_are_recovered() {
    let mut deviations = Deviations::default();
    for (seed, stated) in [(1, [2.0, 0.6]), (2, [0.6, 2.0]), (3, [1.5, 1.5]), (4, [1.0, 1.0]), (5, [0.7, 0.7])] {
        let world = World { stated, ..World::straight() };
        let plots = world.draw(150, seed);
        let noise_mps2 = if seed % 2 == 0 { 1.5 } else { 0.25 };
        let config = TrackerConfig {
            estimator: Estimator::Cv,
            cv_noise_mps2: noise_mps2,
            clutter_floor: 1e-4,
            start_speed_mps: 40.0,
            ..TrackerConfig::default()
        };
        let lesson = learn(&[&plots], &config, |_| {}).expect("learnt");
        assert!(lesson.rounds.is_some(), "parameters stay");
        deviations.compare("range", found(&lesson, Parameter::Error(0)), 1.0 / stated[0]);
        deviations.compare("azimuth", found(&lesson, Parameter::Error(1)), 1.0 / stated[1]);
        deviations.compare("noise", found(&lesson, Parameter::CvNoise), 0.5);
        deviations.compare("detection", lesson.detection_probability.expect("counted"), 0.85);
        let clutter = lesson.clutter.expect("counted");
        deviations.compare("clutter", clutter, world.false_plots / lesson.counts.cells);
        // Plots of targets before their tracks are counted too, and lie where the targets are.
        let dispersion = lesson.clutter_dispersion.expect("counted");
        assert!((0.5..3.0).contains(&dispersion), "false plots lie evenly, not {dispersion} times as Poisson's");
    }
    deviations.assert_as_stated();
}

#[test]
fn turn_rates_are_recovered() {
    let mut deviations = Deviations::default();
    for seed in 1..=3 {
        let rates: Vec<f64> = [-4.0_f64, 0.0, 4.0].map(f64::to_radians).to_vec();
        let world = World {
            sigma_range_m: 3.0,
            sigma_azimuth_rad: 8e-4,
            noise_mps2: 0.15,
            rates,
            stay: 0.95,
            detection_probability: 0.95,
            false_plots: 2.0,
            stated: [1.0, 1.0],
        };
        let turn = TurnConfig {
            noise_mps2: 0.3,
            stay_probability: 0.9,
            rates_deg_per_s: vec![-2.5, 0.0, 2.5],
            ..TurnConfig::default()
        };
        let config =
            TrackerConfig { estimator: Estimator::ImmTurn, turn, start_speed_mps: 40.0, ..TrackerConfig::default() };
        let lesson = learn(&[&world.draw(150, seed)], &config, |_| {}).expect("learnt");
        deviations.compare("range", found(&lesson, Parameter::Error(0)), 1.0);
        deviations.compare("rates", found(&lesson, Parameter::TurnRates), 4.0);
        deviations.compare("noise", found(&lesson, Parameter::TurnNoise), 0.15);
        deviations.compare("stay", found(&lesson, Parameter::TurnStay), 0.95);
    }
    deviations.assert_as_stated();
}

#[test]
fn recordings_without_targets_teach_nothing() {
    let world = World { detection_probability: 0.0, false_plots: 3.0, ..World::straight() };
    let error = learn(&[&world.draw(20, 1)], &TrackerConfig::default(), |_| {}).expect_err("no tracks");
    assert!(matches!(error, TuneError::TooFew { .. }) && error.to_string().lines().count() == 1, "{error}");
}
