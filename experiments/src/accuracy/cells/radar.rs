//! Trajectory B through simulated cells and the plot extractor.
//!
//! Only the cells about the target are simulated: 24 dwells to either side, all Doppler cells, and the beams and ranges of the flight
//! with a margin; elsewhere the tracker gets turns without plots.

use std::convert::Infallible;
use std::f64::consts::TAU;

use anyhow::Context;
use common::config::{ChainConfig, MotionConfig, Swerling, TargetConfig};
use common::geometry::Polar;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{Plot, PlotsHeader};
use common::random::{Purpose, generator};
use common::units::NS_PER_S;
use plot_extractor::PlotExtractor;
use radar_sim::DwellSimulator;
use radar_sim::motion::Segments;
use rand::Rng;

use crate::trajectory::SCANS;
use crate::world::{offset, place};

use super::SNR_DB;

/// Dwells simulated on each side of the target.
const DWELLS: u32 = 24;
/// Beams simulated beyond the flight on each side.
const BEAMS: f64 = 12.0;
/// Range cells likewise: so many that near the target the CFAR has all the reference cells that the whole radar would have.
const RANGES: f64 = 32.0;
/// False plots are near the target within this distance in range, cells.
const NEAR_RANGES: f64 = 4.0;
/// A plot is the target's within this distance on every axis, cells.
const NEAR_CELLS: f64 = 1.5;

/// One turn over the target.
#[derive(Debug, Clone)]
pub(super) struct Look {
    /// When the beam passed, s since k = −1.
    pub(super) time_s: f64,
    /// All plots of the cells about the target.
    pub(super) plots: Vec<Plot>,
    /// Which of them is the target's: the strongest within 1.5 cells.
    pub(super) own: Option<usize>,
}

/// A flight of trajectory B past the radar.
pub(super) struct Flight {
    chain: ChainConfig,
    /// The header of a turn's first dwell, for what the cells are like.
    cells: [f64; 4],
    /// Scan 0 is k = −1.
    pub(super) looks: Vec<Look>,
}

impl Flight {
    /// Simulates a run.
    ///
    /// # Errors
    /// If the simulator refuses the scenario.
    pub(super) fn simulate(
        motion: &Segments,
        seed: u64,
        run: u32,
        swerling: Swerling,
        pfa: f64,
    ) -> anyhow::Result<Self> {
        let mut chain = radar_about(motion);
        chain.extractor.pfa = pfa;
        chain.run.seed = generator(seed, Purpose::Trajectory, run, 1).next_u64();
        chain.sim.targets = vec![TargetConfig {
            name: "b".into(),
            motion: MotionConfig::Trajectory { trajectory: "b".into(), shift_m: [0.0; 3] },
            rcs_m2: None,
            snr_db: Some(SNR_DB),
            swerling,
            first_scan: 0,
        }];
        let mut simulator = DwellSimulator::new(&chain).context("making a scenario of trajectory B")?;
        let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
        let mut amplitudes = vec![0.0; simulator.cells()];
        let mut truth = Vec::new();
        let header = simulator.header(0, 0);
        let cells =
            [header.range_step_m, header.azimuth_step_rad, header.elevation_step_rad, header.range_rate_step_mps];
        let mut flight = Self { chain, cells, looks: Vec::new() };
        for scan in 0..SCANS + 2 {
            simulator.truth(scan, &mut truth);
            let passed = truth.first().context("the target exists in every scan")?;
            let time_s = flight.seconds(passed.time_ns);
            let at = Polar::from_enu(&passed.position_m().into());
            let plots = detect(&mut simulator, &mut extractor, scan, &at, &mut amplitudes);
            let own = flight.own(&plots, &place(&motion.at(time_s)));
            flight.looks.push(Look { time_s, plots, own });
        }
        Ok(flight)
    }

    /// Standard errors of a place that is uniform in its cell (C1).
    pub(super) fn nominal_sigma(&self) -> [f64; 4] {
        self.cells.map(|cell| cell / 12.0_f64.sqrt())
    }

    /// Time since k = −1, s.
    pub(super) fn seconds(&self, time_ns: u64) -> f64 {
        time_ns.saturating_sub(self.chain.run.epoch_s * 1_000_000_000) as f64 / NS_PER_S
    }

    /// Time of one turn, s.
    pub(super) fn period_s(&self) -> f64 {
        self.chain.radar.scan_period_s
    }

    /// The plots of a turn that are not the target's, within four range cells of its place (r, β, ε, ṙ).
    pub(super) fn false_plots<'a>(&self, look: &'a Look, place: &[f64; 4]) -> impl Iterator<Item = &'a Plot> {
        let (range_m, near_m) = (place[0], NEAR_RANGES * self.cells[0]);
        let others = look.plots.iter().enumerate().filter(|&(index, _)| Some(index) != look.own);
        others.map(|(_, plot)| plot).filter(move |plot| (plot.range_m - range_m).abs() <= near_m)
    }

    fn own(&self, plots: &[Plot], truth: &[f64; 4]) -> Option<usize> {
        let span_mps = self.cells[3] * f64::from(self.chain.radar.dopplers);
        let is_near = |plot: &Plot| {
            let mut error = errors(plot, truth);
            error[3] -= span_mps * (error[3] / span_mps).round();
            error.iter().zip(self.cells).all(|(error, cell)| error.abs() <= NEAR_CELLS * cell)
        };
        let near = plots.iter().enumerate().filter(|(_, plot)| is_near(plot));
        near.max_by(|(_, a), (_, b)| a.statistic.total_cmp(&b.statistic)).map(|(index, _)| index)
    }

    /// The sectors of a turn with those of some plots that lie in them.
    pub(super) fn messages(&self, scan: u32, plots: &[Plot]) -> Vec<(PlotsHeader, Vec<Plot>)> {
        let Self { chain, cells, .. } = self;
        let sectors = chain.radar.sectors_per_scan;
        let at = |sector: u32| TAU * f64::from(sector) / f64::from(sectors);
        let end_ns = |sector: u32| {
            let seconds = (f64::from(scan) + f64::from(sector + 1) / f64::from(sectors)) * chain.radar.scan_period_s;
            chain.run.epoch_s * 1_000_000_000 + (seconds * NS_PER_S) as u64
        };
        (0..sectors)
            .map(|sector| {
                let header = PlotsHeader {
                    seq: u64::from(scan) * u64::from(sectors) + u64::from(sector),
                    session: 1,
                    time_ns: end_ns(sector),
                    covered_from_rad: at(sector),
                    covered_to_rad: at(sector + 1),
                    scan_period_s: chain.radar.scan_period_s,
                    pfa: chain.extractor.pfa,
                    cell_range_m: cells[0],
                    cell_azimuth_rad: cells[1],
                    cell_elevation_rad: cells[2],
                    cell_range_rate_mps: cells[3],
                    reference_cells: 2 * chain.extractor.reference_cells,
                    scan,
                    sector,
                    sectors_per_scan: sectors,
                    flags: if sector + 1 == sectors { END_OF_SCAN } else { 0 },
                    ..PlotsHeader::default()
                };
                let inside = |plot: &&Plot| (at(sector)..at(sector + 1)).contains(&plot.azimuth_rad);
                (header, plots.iter().filter(inside).copied().collect())
            })
            .collect()
    }
}

/// r, β, ε, ṙ of a plot.
fn polar(plot: &Plot) -> [f64; 4] {
    [plot.range_m, plot.azimuth_rad, plot.elevation_rad, plot.range_rate_mps]
}

/// A plot minus the truth in r, β, ε, ṙ.
pub(super) fn errors(plot: &Plot, truth: &[f64; 4]) -> [f64; 4] {
    let polar = polar(plot);
    std::array::from_fn(|i| offset(polar[i], truth[i], i))
}

/// The standard errors that a plot states.
pub(super) fn stated_sigma(plot: &Plot) -> [f64; 4] {
    [plot.sigma_range_m, plot.sigma_azimuth_rad, plot.sigma_elevation_rad, plot.sigma_range_rate_mps].map(f64::from)
}

/// The default radar, with no more beams and ranges than the flight needs.
fn radar_about(motion: &Segments) -> ChainConfig {
    let mut chain = ChainConfig::default();
    let places: Vec<Polar> =
        (0..=4 * (SCANS + 2)).map(|i| Polar::from_enu(&motion.at(0.25 * f64::from(i)).position_m)).collect();
    let ends = |of: fn(&Polar) -> f64| {
        places.iter().map(of).fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
    };
    // Whole cells of the default radar.
    let cut = |[lo, hi]: [f64; 2], margin: f64, first: f64, step: f64, cells: u32| {
        let from = ((lo - first) / step - margin).floor().max(0.0);
        let to = ((hi - first) / step + margin).ceil().min(f64::from(cells - 1));
        (first + from * step, (to - from) as u32 + 1)
    };
    let radar = &mut chain.radar;
    let elevations_deg = ends(|place| place.elevation_rad.to_degrees());
    (radar.elevation_first_deg, radar.elevations) =
        cut(elevations_deg, BEAMS, radar.elevation_first_deg, radar.elevation_step_deg, radar.elevations);
    (radar.range_first_m, radar.ranges) =
        cut(ends(|place| place.range_m), RANGES, radar.range_first_m, radar.range_step_m, radar.ranges);
    chain.sim.clutter.range_m = 0.0;
    chain
}

/// Plots of the dwells about the target in one scan.
fn detect(
    simulator: &mut DwellSimulator,
    extractor: &mut PlotExtractor,
    scan: u32,
    place: &Polar,
    amplitudes: &mut [f32],
) -> Vec<Plot> {
    let dwells_per_scan = simulator.header(scan, 0).dwells_per_scan;
    let nearest = (place.azimuth_rad / TAU * f64::from(dwells_per_scan)) as u32;
    let last = nearest + DWELLS;
    let mut plots = Vec::new();
    for dwell in nearest - DWELLS..=last {
        simulator.fill(scan, dwell, amplitudes);
        let mut header = simulator.header(scan, dwell);
        if dwell == last {
            header.flags |= END_OF_STREAM; // Closes all clusters.
        }
        let taken = extractor.take(&header, amplitudes, 0, |_, found| {
            plots.extend_from_slice(found);
            Ok::<(), Infallible>(())
        });
        assert_eq!(taken, Ok(None), "a simulated dwell is accepted");
    }
    plots
}
