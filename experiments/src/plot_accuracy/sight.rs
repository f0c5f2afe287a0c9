//! One target between the cells, and what the extractor makes of it.

use std::convert::Infallible;

use anyhow::Context;
use common::amplitude::Detector;
use common::angle;
use common::config::{ChainConfig, MotionConfig, RadarConfig, Swerling, TargetConfig};
use common::geometry::{Polar, range_rate_mps};
use common::message::END_OF_STREAM;
use common::plots::Plot;
use common::random::{Purpose, generator};
use common::units::from_db;
use plot_extractor::PlotExtractor;
use radar_sim::{DwellSimulator, fluctuation as simulated};
use rand::{Rng, RngExt};

/// Elevation beams that are simulated.
const BEAMS: u32 = 8;
/// Dwells simulated on each side of the target: an echo of 40 dB has sunk into the noise after four.
const DWELLS: u32 = 8;
/// A plot is the target's if it is not farther than this on any axis, cells.
const GATE_CELLS: f64 = 1.5;

/// What became of one target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    /// Errors of its plot and the plot's standard errors, if there is one.
    pub(super) plot: Option<([f64; 4], [f64; 4])>,
    /// The signal-to-noise ratio that it states, dB.
    pub(super) stated_db: f64,
    /// Plots that are not its own, or more than one of it.
    pub(super) others: u32,
    /// Probability that a cell near it exceeds the threshold, given the power drawn (C4).
    pub(super) expected: f64,
    /// Noise cells expected over the threshold.
    pub(super) expected_others: f64,
}

fn radar() -> ChainConfig {
    let mut chain = ChainConfig::default();
    chain.radar.elevations = BEAMS;
    chain.sim.clutter.range_m = 0.0;
    chain
}

/// One target, somewhere between the cells, and its plots.
pub(super) fn sight(seed: u64, run: u32, swerling: Swerling, snr_db: f64) -> anyhow::Result<Sight> {
    let mut chain = radar();
    chain.run.seed = seed;
    let mut rng = generator(seed, Purpose::Trajectory, run, 0);
    chain.sim.targets = vec![target(&chain.radar, run, swerling, snr_db, &mut rng)];
    let mut simulator = DwellSimulator::new(&chain).context("making a scenario of one target")?;
    let mut truth = Vec::new();
    simulator.truth(run, &mut truth);
    let truth = truth.first().context("the target exists in its scan")?;
    let place = Polar::from_enu(&truth.position_m().into());
    let rate_mps = range_rate_mps(&truth.position_m().into(), &truth.velocity_mps().into());

    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut amplitudes = vec![0.0; simulator.cells()];
    let mut plots: Vec<Plot> = Vec::new();
    let step_rad = std::f64::consts::TAU / f64::from(chain.radar.dwells_per_scan);
    let nearest = (place.azimuth_rad / step_rad) as u32;
    for dwell in nearest - DWELLS..=nearest + DWELLS {
        simulator.fill(run, dwell, &mut amplitudes);
        let mut header = simulator.header(run, dwell);
        if dwell == nearest + DWELLS {
            header.flags |= END_OF_STREAM;
        }
        let taken = extractor.take(&header, &amplitudes, 0, |_, found| {
            plots.extend_from_slice(found);
            Ok::<(), Infallible>(())
        });
        assert_eq!(taken, Ok(None), "a simulated dwell is accepted");
    }

    let power = simulated::power(swerling, seed, run, truth.target_id);
    let cells = cell_sizes(&chain.radar);
    let span_mps = cells[3] * f64::from(chain.radar.dopplers);
    let error = |plot: &Plot| {
        let rate = plot.range_rate_mps - rate_mps;
        [
            plot.range_m - place.range_m,
            angle::difference(plot.azimuth_rad, place.azimuth_rad),
            plot.elevation_rad - place.elevation_rad,
            rate - span_mps * (rate / span_mps).round(),
        ]
    };
    let near = |plot: &&Plot| error(plot).iter().zip(cells).all(|(error, cell)| error.abs() <= GATE_CELLS * cell);
    let strongest = plots.iter().filter(near).max_by(|a, b| a.statistic.total_cmp(&b.statistic));
    let sigma = |plot: &Plot| {
        [plot.sigma_range_m, plot.sigma_azimuth_rad, plot.sigma_elevation_rad, plot.sigma_range_rate_mps].map(f64::from)
    };
    Ok(Sight {
        plot: strongest.map(|plot| (error(plot), sigma(plot))),
        stated_db: strongest.map_or(f64::NAN, |plot| f64::from(plot.snr_db)),
        others: (plots.len() - usize::from(strongest.is_some())) as u32,
        expected: detection_probability(&chain, &place, rate_mps, snr_db, power),
        expected_others: chain.extractor.pfa * f64::from(2 * DWELLS + 1) * simulator.cells() as f64,
    })
}

/// A target that moves straight from the antenna, in the middle of the simulated cells.
fn target(radar: &RadarConfig, run: u32, swerling: Swerling, snr_db: f64, rng: &mut impl Rng) -> TargetConfig {
    let uniform = |rng: &mut _, from: f64, to: f64| from + (to - from) * RngExt::random::<f64>(rng);
    let [range_m, azimuth_rad, elevation_rad, rate_mps] = cell_sizes(radar);
    let place = Polar {
        // Where all reference cells exist.
        range_m: radar.range_first_m + range_m * uniform(rng, 20.0, 49.0),
        // Away from north, so that all dwells are of one scan.
        azimuth_rad: azimuth_rad * uniform(rng, 20.0, f64::from(radar.dwells_per_scan) - 20.0),
        elevation_rad: radar.elevation_first_deg.to_radians() + elevation_rad * uniform(rng, 2.5, 4.5),
    };
    let span_mps = rate_mps * f64::from(radar.dopplers);
    let velocity = place.to_enu().normalize() * uniform(rng, -0.5 * span_mps, 0.5 * span_mps);
    TargetConfig {
        name: "one".into(),
        motion: MotionConfig::Straight { position_m: place.to_enu().into(), velocity_mps: velocity.into() },
        rcs_m2: None,
        snr_db: Some(snr_db),
        swerling,
        first_scan: run,
    }
}

/// Range, azimuth, elevation, range rate; m, rad, rad, m/s.
fn cell_sizes(radar: &RadarConfig) -> [f64; 4] {
    [
        radar.range_step_m,
        std::f64::consts::TAU / f64::from(radar.dwells_per_scan),
        radar.elevation_step_deg.to_radians(),
        radar.range_rate_step_mps,
    ]
}

/// Probability that one of the 3⁴ cells about a target exceeds the threshold if its power is `power` times the mean:
/// 1 − Π (1 − D), D of a steady target with the straddling loss of each cell. Cells that share reference windows are taken
/// as independent.
fn detection_probability(chain: &ChainConfig, place: &Polar, rate_mps: f64, snr_db: f64, power: f64) -> f64 {
    let radar = &chain.radar;
    let cells = cell_sizes(radar);
    let first =
        [radar.range_first_m, 0.5 * cells[1], radar.elevation_first_deg.to_radians(), radar.range_rate_first_mps()];
    let widths = [
        radar.pulse_width_m,
        radar.beamwidth_azimuth_deg.to_radians(),
        radar.beamwidth_elevation_deg.to_radians(),
        radar.doppler_width_mps,
    ];
    let at = [place.range_m, place.azimuth_rad, place.elevation_rad, rate_mps];
    // Power gains of the nearest cell and its two neighbours on each axis.
    let gains: [[f64; 3]; 4] = std::array::from_fn(|axis| {
        let cell = (at[axis] - first[axis]) / cells[axis];
        [-1.0, 0.0, 1.0].map(|k| {
            let offset = (cell - cell.round() - k) * cells[axis] / widths[axis];
            (-4.0 * std::f64::consts::LN_2 * offset * offset).exp()
        })
    });
    let detector = Detector::new(chain.extractor.pfa, 2 * chain.extractor.reference_cells);
    let mut missed = 1.0;
    for cell in 0..81 {
        let gain: f64 = (0..4).map(|axis| gains[axis][cell / [1, 3, 9, 27][axis] % 3]).product();
        let snr = from_db(snr_db) * power * gain;
        // Far above the threshold nothing is missed, and the sum for D would be long; far below it is noise.
        if snr > 10.0 * detector.threshold {
            return 1.0;
        }
        if snr > 0.1 {
            missed *= 1.0 - detector.target(Swerling::Zero, snr).detection_probability;
        }
    }
    1.0 - missed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strong steady target is found, near where it is; where it is, the nearest cell is expected to see it.
    #[test]
    fn a_strong_target_is_found() {
        for run in 0..20 {
            let sight = sight(3, run, Swerling::Zero, 30.0).expect("a scenario");
            let (error, sigma) = sight.plot.expect("a plot");
            assert!(error.iter().zip(sigma).all(|(error, sigma)| error.abs() < 6.0 * sigma), "{sight:?}");
            assert!(sight.expected > 0.99, "{sight:?}");
        }
    }
}
