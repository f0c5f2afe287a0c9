//! Any radar and what it sees: targets and disturbances in, `plots` messages out, no cells.
//!
//! Everything scales with the radar: cells, errors, speeds and distances.

use std::f64::consts::TAU;

use common::angle;
use common::config::TrackerConfig;
use common::geometry::{Polar, range_rate_mps};
use common::message::END_OF_SCAN;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot, PlotsHeader};
use common::random::{Purpose, generator};
use common::tracks::Track;
use nalgebra::Vector3;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp1, Poisson, StandardNormal};
use tracker::Tracker;

/// Start of measurement time, ns.
pub(crate) const EPOCH_NS: u64 = 1_700_000_000_000_000_000;
/// Largest elevation looked at, rad.
const ELEVATIONS_RAD: f64 = 0.4;

/// A radar that turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Radar {
    /// Seconds a turn.
    pub period_s: f64,
    /// Sectors a turn.
    pub sectors: u32,
    /// Sizes of a resolution cell in (r, β, ε, ṙ); 0 of what is not measured.
    pub cell: [f64; 4],
    /// Farthest range, m.
    pub range_m: f64,
    /// F; 0 where plots have no power.
    pub pfa: f64,
    /// Standard errors in cells.
    pub error_cells: f64,
    /// Unambiguous interval of range rates, m/s; 0 without ambiguity.
    pub interval_mps: f64,
}

/// Something that flies straight and its mean power over noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    pub from_m: Vector3<f64>,
    pub velocity_mps: Vector3<f64>,
    pub snr: f64,
    /// Power drawn anew each turn (Swerling I), or steady.
    pub fluctuates: bool,
}

impl Target {
    pub(crate) fn position_m(&self, time_s: f64) -> Vector3<f64> {
        self.from_m + self.velocity_mps * time_s
    }
}

/// Plots that are no target's: where they are and how strong, drawn turn by turn.
pub(crate) type Disturbance<'a> = &'a dyn Fn(&Radar, u32, &mut dyn Rng) -> Vec<(Polar, f64, f64)>;

/// The messages of `scans` turns.
pub(crate) fn observe(
    radar: &Radar,
    targets: &[Target],
    disturbance: Disturbance<'_>,
    scans: u32,
    seed: u64,
) -> Observed {
    let mut looks = vec![Vec::new(); targets.len()];
    let mut all: Vec<(PlotsHeader, Vec<Plot>)> = (0..scans)
        .flat_map(|scan| (0..radar.sectors).map(move |sector| (radar.header(scan, sector), Vec::new())))
        .collect();
    let mut passages: Vec<f64> = targets.iter().map(|target| radar.first_passage(target)).collect();
    for scan in 0..scans {
        let mut rng = generator(seed, Purpose::Test, scan, 0);
        for ((target, passage_s), looks) in targets.iter().zip(&mut passages).zip(&mut looks) {
            let time_s = *passage_s;
            *passage_s = radar.passage_near(target, time_s + radar.period_s);
            let power = if target.fluctuates { target.snr * exponential(&mut rng) } else { target.snr };
            let q = received(power, &mut rng);
            let position = target.position_m(time_s);
            let place = Polar::from_enu(&position);
            if radar.detects(q, &mut rng) {
                let range_rate = range_rate_mps(&position, &target.velocity_mps);
                looks.push(scan);
                radar.add(&mut all, time_s, place, range_rate, q, true, &mut rng);
            }
        }
        for (place, range_rate, q) in disturbance(radar, scan, &mut rng) {
            let time_s = radar.period_s * (f64::from(scan) + place.azimuth_rad / TAU);
            radar.add(&mut all, time_s, place, range_rate, q, false, &mut rng);
        }
    }
    for (_, plots) in &mut all {
        plots.sort_by(|a, b| a.azimuth_rad.total_cmp(&b.azimuth_rad));
    }
    Observed { messages: all, looks }
}

/// What a radar has seen.
#[derive(Debug)]
pub(crate) struct Observed {
    pub messages: Vec<(PlotsHeader, Vec<Plot>)>,
    /// By target, the turns in which it was detected.
    pub looks: Vec<Vec<u32>>,
}

impl Radar {
    /// t₀.
    pub(crate) fn threshold(&self) -> f64 {
        if self.pfa > 0.0 { -self.pfa.ln() } else { 0.0 }
    }

    /// Resolution cells in a turn.
    pub(crate) fn cells(&self) -> f64 {
        let elevations = if self.cell[2] > 0.0 { ELEVATIONS_RAD / self.cell[2] } else { 1.0 };
        let dopplers = if self.cell[3] > 0.0 { 16.0 } else { 1.0 };
        self.range_m / self.cell[0] * TAU / self.cell[1] * elevations * dopplers
    }

    /// A place of equal probability in every cell, with a range rate.
    pub(crate) fn anywhere(&self, rng: &mut dyn Rng) -> (Polar, f64) {
        let place = Polar {
            range_m: rng.random_range(0.01 * self.range_m..self.range_m),
            azimuth_rad: rng.random_range(0.0..TAU),
            elevation_rad: if self.cell[2] > 0.0 { rng.random_range(0.0..ELEVATIONS_RAD) } else { 0.0 },
        };
        (place, 8.0 * self.cell[3] * rng.random_range(-1.0..1.0))
    }

    /// False alarms of noise, as many as its cells give, up to `most`.
    pub(crate) fn false_alarms(&self, most: f64, rng: &mut dyn Rng) -> Vec<(Polar, f64, f64)> {
        let mean = (self.pfa.max(1e-7) * self.cells()).min(most);
        let count = Poisson::new(mean).expect("positive").sample(rng) as usize;
        (0..count)
            .map(|_| {
                let (place, range_rate) = self.anywhere(rng);
                (place, range_rate, self.threshold() + exponential(rng))
            })
            .collect()
    }

    fn detects(&self, q: f64, rng: &mut dyn Rng) -> bool {
        // Without a threshold: as many radars' plots come.
        if self.pfa > 0.0 { q > self.threshold() } else { rng.random::<f64>() < 0.95 }
    }

    /// Standard errors of a plot.
    pub(crate) fn sigma(&self) -> [f64; 4] {
        self.cell.map(|cell| cell * self.error_cells)
    }

    /// Errors of a target's position in each direction of its place: along, across and up, m.
    pub(crate) fn position_error_m(&self, range_m: f64) -> f64 {
        let sigma = self.sigma();
        sigma[0].hypot(range_m * sigma[1]).hypot(range_m * sigma[2])
    }

    /// How far a track may be from a target that it follows, m.
    pub(crate) fn near_m(&self, target: &Target, time_s: f64) -> f64 {
        let travel_m = target.velocity_mps.norm() * self.period_s;
        6.0 * self.position_error_m(target.position_m(time_s).norm()) + 0.5 * travel_m
    }

    /// Error of a track's position in what the radar measures, m.
    pub(crate) fn error(&self, track: &Track, target: &Target, time_s: f64) -> Vector3<f64> {
        let mut error = Vector3::from(track.position_m()) - target.position_m(time_s);
        if self.cell[2] <= 0.0 {
            error.z = 0.0;
        }
        error
    }

    fn first_passage(&self, target: &Target) -> f64 {
        let azimuth = Polar::from_enu(&target.from_m).azimuth_rad;
        self.passage_near(target, azimuth / TAU * self.period_s).max(0.0)
    }

    /// When the beam meets a target, near `time_s`.
    fn passage_near(&self, target: &Target, mut time_s: f64) -> f64 {
        let rate = TAU / self.period_s;
        for _ in 0..12 {
            let azimuth = Polar::from_enu(&target.position_m(time_s)).azimuth_rad;
            time_s += angle::difference(azimuth, angle::wrap(time_s * rate)) / rate;
        }
        time_s
    }

    #[expect(clippy::too_many_arguments, reason = "what a plot is made of")]
    fn add(
        &self,
        all: &mut [(PlotsHeader, Vec<Plot>)],
        time_s: f64,
        place: Polar,
        range_rate: f64,
        q: f64,
        errs: bool,
        rng: &mut dyn Rng,
    ) {
        let sigma = self.sigma();
        let mut error = |i: usize| {
            if errs { sigma[i] * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng) } else { 0.0 }
        };
        let azimuth_rad = angle::wrap(place.azimuth_rad + error(1));
        let range_rate = range_rate + error(3);
        let folds = if self.interval_mps > 0.0 { (range_rate / self.interval_mps).round() } else { 0.0 };
        let plot = Plot {
            time_ns: EPOCH_NS + (time_s.max(0.0) * 1e9) as u64,
            range_m: (place.range_m + error(0)).max(0.1 * self.cell[0]),
            azimuth_rad,
            elevation_rad: if self.cell[2] > 0.0 { place.elevation_rad + error(2) } else { 0.0 },
            range_rate_mps: if self.cell[3] > 0.0 { range_rate - folds * self.interval_mps } else { 0.0 },
            sigma_range_m: sigma[0] as f32,
            sigma_azimuth_rad: sigma[1] as f32,
            sigma_elevation_rad: sigma[2] as f32,
            sigma_range_rate_mps: sigma[3] as f32,
            statistic: if self.pfa > 0.0 { q.sqrt() as f32 } else { 0.0 },
            cell_count: 1,
            flags: [
                (self.cell[2] > 0.0, HAS_ELEVATION),
                (self.cell[3] > 0.0, HAS_RANGE_RATE),
                (self.pfa > 0.0, HAS_STATISTIC),
            ]
            .iter()
            .filter(|(has, _)| *has)
            .map(|(_, flag)| flag)
            .sum(),
            ..Plot::default()
        };
        // Into the sector of its azimuth in the turn nearest to its time.
        let turned = azimuth_rad / TAU;
        let scan = (time_s / self.period_s - turned).round().max(0.0);
        let sector = ((turned * f64::from(self.sectors)) as u32).min(self.sectors - 1);
        let index = scan as usize * self.sectors as usize + sector as usize;
        if let Some((_, plots)) = all.get_mut(index) {
            plots.push(plot);
        }
    }

    fn header(&self, scan: u32, sector: u32) -> PlotsHeader {
        let at = |sectors: u32| TAU * f64::from(sectors) / f64::from(self.sectors);
        let turned = f64::from(scan) + f64::from(sector + 1) / f64::from(self.sectors);
        PlotsHeader {
            seq: u64::from(scan * self.sectors + sector),
            session: 1,
            time_ns: EPOCH_NS + (turned * self.period_s * 1e9) as u64,
            covered_from_rad: at(sector),
            covered_to_rad: at(sector + 1),
            scan_period_s: self.period_s,
            pfa: self.pfa,
            cell_range_m: self.cell[0],
            cell_azimuth_rad: self.cell[1],
            cell_elevation_rad: self.cell[2],
            cell_range_rate_mps: self.cell[3],
            range_rate_interval_mps: self.interval_mps,
            scan,
            sector,
            sectors_per_scan: self.sectors,
            flags: if sector + 1 == self.sectors { END_OF_SCAN } else { 0 },
            ..PlotsHeader::default()
        }
    }
}

/// Seconds since the start.
pub(crate) fn time_s(time_ns: u64) -> f64 {
    (time_ns - EPOCH_NS) as f64 / 1e9
}

/// All tracks that a tracker brings up to date, each with the turn in which it does.
pub(crate) fn follow(config: &TrackerConfig, messages: &[(PlotsHeader, Vec<Plot>)]) -> Vec<(u32, Track)> {
    let mut tracker = Tracker::new(config, 1).expect("valid");
    let (mut tracks, mut all) = (Vec::new(), Vec::new());
    for (header, plots) in messages {
        tracker.process_plots(header, plots, &mut tracks);
        all.extend(tracks.iter().map(|track| (header.scan, *track)));
    }
    all
}

/// |s + n|² of a target of power `power`, its phase drawn.
fn received(power: f64, rng: &mut dyn Rng) -> f64 {
    let mut part = || -> f64 { <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng) * 0.5_f64.sqrt() };
    let (real, imaginary) = (power.sqrt() + part(), part());
    real * real + imaginary * imaginary
}

pub(crate) fn exponential(rng: &mut dyn Rng) -> f64 {
    Exp1.sample(rng)
}
