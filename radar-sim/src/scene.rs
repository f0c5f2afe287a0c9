//! The targets: where they are, how strong they are, and what the radar gets of them.

use std::f64::consts::TAU;

use common::angle;
use common::config::{ChainConfig, RadarConfig, Swerling};
use common::geodesy::FrameChange;
use common::geometry::{Polar, range_rate_mps};
use common::truth::{TruthTarget, VISIBLE};
use common::units::{from_db, to_db};

use crate::echo::Echoes;
use crate::motion::{Kinematics, Motion};
use crate::response::Response;
use crate::{SimError, fluctuation};

/// One target of the scenario.
#[derive(Debug)]
struct Target {
    id: u32,
    motion: Motion,
    /// To the antenna's frame, where the scenario has another.
    to_antenna: Option<FrameChange>,
    /// SNR at the beam's centre at 1 km, dB, falling with range⁻⁴; or fixed.
    snr_1km_db: Option<f64>,
    fixed_snr_db: f64,
    swerling: Swerling,
    first_scan: u32,
}

/// All targets and the responses of the radar.
#[derive(Debug)]
pub struct Scene {
    targets: Vec<Target>,
    radar: RadarConfig,
    seed: u64,
    pulse: Response,
    doppler: Response,
    azimuth: Response,
    elevation: Response,
    gains: Gains,
}

/// Cells along each axis that a target reaches, and their amplitude gains.
#[derive(Debug, Default)]
struct Gains {
    elevation: Vec<(usize, f64)>,
    doppler: Vec<(usize, f64)>,
    range: Vec<(usize, f64)>,
}

impl Scene {
    /// The targets of `chain`; reads the files of recorded flights.
    ///
    /// # Errors
    /// [`SimError`].
    pub fn new(chain: &ChainConfig) -> Result<Self, SimError> {
        let radar = chain.radar.clone();
        let to_antenna = match (chain.sim.origin, chain.site.position) {
            (Some(origin), Some(site)) if origin != site => Some(FrameChange::new(&origin, &site)),
            _ => None,
        };
        let mut targets = Vec::with_capacity(chain.sim.targets.len());
        for (index, config) in chain.sim.targets.iter().enumerate() {
            targets.push(Target {
                id: index as u32 + 1,
                motion: Motion::of(config)?,
                to_antenna,
                snr_1km_db: config.rcs_m2.map(|rcs| radar.snr_1m2_1km_db + to_db(rcs)),
                fixed_snr_db: config.snr_db.unwrap_or(0.0),
                swerling: config.swerling,
                first_scan: config.first_scan,
            });
        }
        Ok(Self {
            targets,
            seed: chain.run.seed,
            pulse: Response::new(radar.pulse_width_m),
            doppler: Response::new(radar.doppler_width_mps),
            azimuth: Response::new(radar.beamwidth_azimuth_deg.to_radians()),
            elevation: Response::new(radar.beamwidth_elevation_deg.to_radians()),
            gains: Gains::default(),
            radar,
        })
    }

    /// What was left out of the files of flights, in words, by number of the target from 1.
    pub fn dropped(&self) -> impl Iterator<Item = (u32, String)> {
        self.targets.iter().filter_map(|target| Some((target.id, target.motion.dropped()?)))
    }

    /// Adds the echoes of all targets to one dwell at `time_s` since the start of the run
    /// with the beam at `azimuth_rad`.
    pub fn add(&mut self, scan: u32, dwell: u32, time_s: f64, azimuth_rad: f64, echoes: &mut Echoes) {
        let grid = self.radar.grid();
        for target in &self.targets {
            let Some(state) = target.at(time_s, &self.radar) else { continue };
            let place = Polar::from_enu(&state.position_m);
            let snr_db = target.snr_db(place.range_m);
            let place = seen_at(&self.radar, &place);
            let offset = angle::difference(azimuth_rad, place.azimuth_rad);
            if offset.abs() > self.azimuth.reach(snr_db) {
                continue;
            }
            // A target that begins to exist within the beam has no passage before that.
            let passed = target.passed_near(time_s, &self.radar);
            let passage = passed.map_or(scan, |(passed_s, _)| scan_at(passed_s, &self.radar));
            let power = fluctuation::power(target.swerling, self.seed, passage, target.id);
            let peak = (from_db(snr_db) * power).sqrt() * self.azimuth.amplitude(offset);
            let (sin, cos) = fluctuation::phase(self.seed, scan, dwell, target.id).sin_cos();
            self.gains.of(axes(&self.radar), &place, &state, snr_db, [self.elevation, self.doppler, self.pulse]);
            for &(beam, elevation_gain) in &self.gains.elevation {
                for &(filter, doppler_gain) in &self.gains.doppler {
                    let row = (beam * grid.dopplers + filter) * grid.ranges;
                    let amplitude = peak * elevation_gain * doppler_gain;
                    for &(cell, range_gain) in &self.gains.range {
                        echoes.add(row + cell, amplitude * range_gain * cos, amplitude * range_gain * sin);
                    }
                }
            }
        }
    }

    /// The targets that exist, each whenever the beam passes it in `scan`: once as a rule, not at all in the scan after it has
    /// crossed north with the beam, and perhaps twice when it crosses north against the beam.
    pub fn truth(&self, scan: u32, epoch_ns: u64, truth: &mut Vec<TruthTarget>) {
        truth.clear();
        for target in &self.targets {
            for (time_s, state) in target.passages(scan, &self.radar) {
                let place = Polar::from_enu(&state.position_m);
                let (p, v, a) = (state.position_m, state.velocity_mps, state.acceleration_mps2);
                truth.push(TruthTarget {
                    time_ns: epoch_ns + (time_s * common::units::NS_PER_S) as u64,
                    target_id: target.id,
                    mode: state.mode,
                    state: [p.x, v.x, a.x, p.y, v.y, a.y, p.z, v.z, a.z],
                    snr_db: target.snr_db(place.range_m) as f32,
                    flags: if covers(&self.radar, &place) { VISIBLE } else { 0 },
                });
            }
        }
    }
}

impl Target {
    /// State `time_s` after the start of the run, once the target exists.
    fn at(&self, time_s: f64, radar: &RadarConfig) -> Option<Kinematics> {
        let age_s = time_s - f64::from(self.first_scan) * radar.scan_period_s;
        let state = (age_s >= 0.0).then(|| self.motion.at(age_s))?;
        Some(self.to_antenna.as_ref().map_or(state, |frame| state.in_frame(frame)))
    }

    fn snr_db(&self, range_m: f64) -> f64 {
        let at_1km = |snr_db: f64| snr_db - 40.0 * (range_m.max(1.0) / 1000.0).log10();
        self.snr_1km_db.map_or(self.fixed_snr_db, at_1km)
    }

    /// When the beam passes the target in `scan`, s since the start, and its states then.
    fn passages(&self, scan: u32, radar: &RadarConfig) -> Vec<(f64, Kinematics)> {
        let period_s = radar.scan_period_s;
        let start_s = f64::from(scan) * period_s;
        let mut passages: Vec<(f64, Kinematics)> = Vec::with_capacity(2);
        for near_s in [start_s, start_s + 0.5 * period_s, start_s + period_s] {
            let Some((time_s, state)) = self.passed_near(near_s, radar) else { continue };
            let is_known = passages.last().is_some_and(|&(known_s, _)| time_s - known_s < 0.5 * period_s);
            if scan_at(time_s, radar) == scan && !is_known {
                passages.push((time_s, state));
            }
        }
        passages
    }

    /// When the beam passes the target nearest to `time_s`, s since the start, and its state then.
    fn passed_near(&self, time_s: f64, radar: &RadarConfig) -> Option<(f64, Kinematics)> {
        let turn_rate = TAU / radar.scan_period_s;
        let mut time_s = time_s;
        // The beam is far faster than any target: each step gains more than a digit.
        for _ in 0..6 {
            let place = Polar::from_enu(&self.at(time_s, radar)?.position_m);
            time_s = (time_s + angle::difference(place.azimuth_rad, turn_rate * time_s) / turn_rate).max(0.0);
        }
        let state = self.at(time_s, radar)?;
        // Where the beam would have passed before the start it has not.
        let beside_rad = angle::difference(Polar::from_enu(&state.position_m).azimuth_rad, turn_rate * time_s);
        (beside_rad.abs() < BESIDE_RAD).then_some((time_s, state))
    }
}

/// Where a radar with systematic errors sees a place.
fn seen_at(radar: &RadarConfig, place: &Polar) -> Polar {
    Polar {
        range_m: place.range_m + radar.range_bias_m,
        azimuth_rad: place.azimuth_rad + radar.azimuth_bias_deg.to_radians(),
        elevation_rad: place.elevation_rad + radar.elevation_bias_deg.to_radians(),
    }
}

/// How far beside a target the beam may be when it passes it, rad: what the search leaves.
const BESIDE_RAD: f64 = 1e-3;

/// The scan of a passage, also of a target that stands exactly in the north, where scans meet.
fn scan_at(time_s: f64, radar: &RadarConfig) -> u32 {
    (time_s / radar.scan_period_s + 1e-9) as u32
}

/// Whether a place lies inside the outermost cells; a single beam covers its half-power width.
fn covers(radar: &RadarConfig, place: &Polar) -> bool {
    let last_range_m = radar.range_first_m + radar.range_step_m * f64::from(radar.ranges - 1);
    let height_deg = radar.elevation_step_deg * f64::from(radar.elevations - 1);
    let beside_deg = if radar.elevations == 1 { 0.5 * radar.beamwidth_elevation_deg } else { 0.0 };
    let above_deg = place.elevation_rad.to_degrees() - radar.elevation_first_deg;
    (radar.range_first_m..=last_range_m).contains(&place.range_m)
        && (-beside_deg..=height_deg + beside_deg).contains(&above_deg)
}

/// First centre, step and number of cells of one axis, in its own unit.
#[derive(Debug, Clone, Copy)]
struct Axis {
    first: f64,
    step: f64,
    cells: usize,
}

/// Elevation (rad), Doppler (m/s) and range (m).
type Axes = [Axis; 3];

/// The axes of the radar's cells.
fn axes(radar: &RadarConfig) -> Axes {
    let grid = radar.grid();
    [
        Axis {
            first: radar.elevation_first_deg.to_radians(),
            step: radar.elevation_step_deg.to_radians(),
            cells: grid.elevations,
        },
        Axis { first: radar.range_rate_first_mps(), step: radar.range_rate_step_mps, cells: grid.dopplers },
        Axis { first: radar.range_first_m, step: radar.range_step_m, cells: grid.ranges },
    ]
}

impl Gains {
    /// Finds the cells that a target reaches. Doppler is ambiguous: cells lie on a circle.
    fn of(&mut self, axes: Axes, place: &Polar, state: &Kinematics, snr_db: f64, responses: [Response; 3]) {
        let [elevation, doppler, range] = axes;
        along(elevation, place.elevation_rad, responses[0], snr_db, &mut self.elevation);
        along(range, place.range_m, responses[2], snr_db, &mut self.range);
        let rate = range_rate_mps(&state.position_m, &state.velocity_mps);
        let span = doppler.step * doppler.cells as f64;
        self.doppler.clear();
        for cell in 0..doppler.cells {
            let offset = doppler.first + doppler.step * cell as f64 - rate;
            let nearest = offset - span * (offset / span).round();
            if nearest.abs() <= responses[1].reach(snr_db) {
                self.doppler.push((cell, responses[1].amplitude(nearest)));
            }
        }
    }
}

/// Cells of an axis within reach of `centre`, with their amplitude gains.
fn along(axis: Axis, centre: f64, response: Response, snr_db: f64, gains: &mut Vec<(usize, f64)>) {
    gains.clear();
    let reach = response.reach(snr_db);
    let first = ((centre - reach - axis.first) / axis.step).ceil().max(0.0) as usize;
    for cell in first..axis.cells {
        let offset = axis.first + axis.step * cell as f64 - centre;
        if offset > reach {
            break;
        }
        gains.push((cell, response.amplitude(offset)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::config::{MotionConfig, TargetConfig};

    fn scene(position_m: [f64; 3], velocity_mps: [f64; 3]) -> Scene {
        let mut chain = ChainConfig::default();
        chain.sim.targets.push(TargetConfig {
            name: "one".into(),
            motion: MotionConfig::Straight { position_m, velocity_mps },
            rcs_m2: Some(0.1),
            snr_db: None,
            swerling: Swerling::Zero,
            first_scan: 2,
        });
        Scene::new(&chain).expect("valid scenario")
    }

    #[test]
    fn snr_follows_the_radar_equation() {
        let scene = scene([0.0, 1000.0, 100.0], [0.0, 0.0, 0.0]);
        let (near, far) = (scene.targets[0].snr_db(1000.0), scene.targets[0].snr_db(2000.0));
        assert!((near - 52.0).abs() < 1e-9);
        assert!((near - far - 12.041).abs() < 1e-3);
    }

    #[test]
    fn truth_is_taken_when_the_beam_passes() {
        let scene = scene([-1000.0, 0.0, 100.0], [0.0, 30.0, 0.0]); // west: three quarters of a turn
        let mut truth = Vec::new();
        scene.truth(1, 0, &mut truth);
        assert!(truth.is_empty(), "not yet there");
        scene.truth(4, 0, &mut truth);
        let azimuth = Polar::from_enu(&truth[0].position_m().into()).azimuth_rad;
        let time_s = truth[0].time_ns as f64 * 1e-9;
        assert!((time_s - 4.0 - azimuth / TAU).abs() < 1e-6);
        assert!((truth[0].state[3] - 30.0 * (time_s - 2.0)).abs() < 1e-3);
        assert_eq!(truth[0].flags, VISIBLE);
    }

    /// Passages of a target that crosses north, with the beam and against it: one turn of the beam after the other.
    #[test]
    fn a_target_that_crosses_north_is_passed_once_a_turn() {
        for (velocity_mps, passages) in [(20.0, 27), (0.0, 28), (-20.0, 29)] {
            let scene = scene([-8.0 * velocity_mps, 1500.0, 100.0], [velocity_mps, 0.0, 0.0]);
            let mut times_s = Vec::new();
            for scan in 2..30 {
                let mut truth = Vec::new();
                scene.truth(scan, 0, &mut truth);
                times_s.extend(truth.iter().map(|target| target.time_ns as f64 * 1e-9));
            }
            assert_eq!(times_s.len(), passages, "{times_s:?}");
            for pair in times_s.windows(2) {
                assert!((pair[1] - pair[0] - 1.0).abs() < 0.005, "{pair:?}");
            }
        }
    }

    /// The draw of a fluctuating target stays the same while the beam passes it, wherever the count of scans goes on.
    /// The beam starts in the north: what lies to the west of it is first passed late in the first turn, and once.
    #[test]
    fn a_target_in_the_west_is_not_passed_at_the_start() {
        let mut chain = ChainConfig::default();
        chain.sim.targets.push(TargetConfig {
            name: "west".into(),
            motion: MotionConfig::Straight { position_m: [-1500.0, 600.0, 200.0], velocity_mps: [0.0, 10.0, 0.0] },
            rcs_m2: None,
            snr_db: Some(20.0),
            swerling: Swerling::Zero,
            first_scan: 0,
        });
        let scene = Scene::new(&chain).expect("valid scenario");
        for scan in 0..3 {
            let mut truth = Vec::new();
            scene.truth(scan, 0, &mut truth);
            assert_eq!(truth.len(), 1, "scan {scan}");
            let turned = truth[0].time_ns as f64 / 1e9 - f64::from(scan);
            assert!((0.75..1.0).contains(&turned), "scan {scan}: {turned}");
        }
    }

    #[test]
    fn one_passage_is_one_draw_also_across_north() {
        let mut scene = scene([0.0, 1500.0, 100.0], [0.0; 3]);
        scene.targets[0].swerling = Swerling::One;
        let dwells = scene.radar.dwells_per_scan;
        let step_rad = TAU / f64::from(dwells);
        let mut powers = Vec::new();
        for (scan, dwell) in [(4, dwells - 1), (5, 0)] {
            let mut echoes = Echoes::default();
            let time_s = f64::from(scan) + (f64::from(dwell) + 0.5) / f64::from(dwells);
            let azimuth_rad = (f64::from(dwell) + 0.5) * step_rad;
            scene.add(scan, dwell, time_s, azimuth_rad, &mut echoes);
            let mut cells = vec![0.0; scene.radar.grid().cells()];
            echoes.apply(&mut cells, || 0.0);
            powers.push(cells.iter().copied().fold(0.0_f32, f32::max));
        }
        assert!((powers[0] / powers[1] - 1.0).abs() < 0.01, "{powers:?}"); // half a step to either side of the target
    }

    #[test]
    fn a_radar_without_elevation_covers_the_width_of_its_beam() {
        let mut radar = ChainConfig::default().radar;
        (radar.elevations, radar.elevation_first_deg, radar.beamwidth_elevation_deg) = (1, 5.0, 8.0);
        let covered = |elevation_deg: f64| {
            covers(&radar, &Polar { range_m: 2000.0, azimuth_rad: 1.0, elevation_rad: elevation_deg.to_radians() })
        };
        assert_eq!([0.9, 1.1, 8.9, 9.1].map(covered), [false, true, true, false]);
    }

    /// A target in the middle of a cell gives the cell its whole power.
    #[test]
    fn the_peak_cell_holds_the_set_snr() {
        let radar = ChainConfig::default().radar;
        let range_m = radar.range_first_m + 20.0 * radar.range_step_m;
        let elevation_rad = (radar.elevation_first_deg + 5.0 * radar.elevation_step_deg).to_radians();
        let step_rad = TAU / f64::from(radar.dwells_per_scan);
        let place = Polar { range_m, azimuth_rad: 100.5 * step_rad, elevation_rad };
        let position = place.to_enu();
        let mut scene = scene(position.into(), [0.0; 3]);
        let mut echoes = Echoes::default();
        scene.add(3, 100, 3.1, place.azimuth_rad, &mut echoes);
        let mut cells = vec![0.0; radar.grid().cells()];
        echoes.apply(&mut cells, || 0.0);
        let (peak_cell, peak) = cells.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).expect("cells");
        assert_eq!(peak_cell, (5 * 6 + 3) * 70 + 20);
        let snr_db = scene.targets[0].snr_db(range_m);
        assert!((20.0 * f64::from(*peak).log10() - snr_db).abs() < 1e-3);
    }
}
