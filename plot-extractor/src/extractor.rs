//! The stages in order: dwell by dwell from amplitudes to the plots of a sector.

use common::amplitude::NoiseEstimate;
use common::angle;
use common::config::{ExtractorConfig, RadarConfig};
use common::dwell::DwellHeader;
use common::health::Reject;
use common::message::{END_OF_SCAN, END_OF_SECTOR, END_OF_STREAM, Lineage, Stamps, TRUNCATED};
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, MAX_PLOTS, Plot, PlotsHeader};
use common::units::{NS_PER_S, to_db};

use crate::centroid::{Offset, curvature, interpolate};
use crate::cfar::{Detector, Hit};
use crate::clustering::{CellGrid, Cluster, Clustering};
use crate::extent::{self, Axis};
use crate::jamming;

/// Turns dwells into plots. Allocates nothing per dwell once running.
#[derive(Debug)]
pub struct PlotExtractor {
    config: ExtractorConfig,
    radar: RadarConfig,
    /// Cells whose mean would vary as the estimate of the noise does.
    noise_cells: u32,
    stages: Option<Stages>,
    hits: Vec<Hit>,
    closed: Vec<Cluster>,
    plots: Vec<Plot>,
    /// The dwell before, whatever sector or session it was of.
    previous: Option<DwellHeader>,
    sector: Sector,
    /// Dwells taken, and messages published, so far.
    taken: u64,
    published: u64,
}

/// Everything that depends on the cells of the radar.
#[derive(Debug)]
struct Stages {
    /// The last dwell that has these cells.
    last: DwellHeader,
    cfar: Detector,
    clustering: Clustering,
    powers: Vec<f32>,
    powers_before: Vec<f32>,
}

/// What has come in of the sector that is being worked on.
#[derive(Debug, Default)]
struct Sector {
    last: Option<DwellHeader>,
    lineage: Lineage,
    extractor_in_ns: u64,
    cells: u64,
    detections: u64,
    rejected: u32,
    covered_to_dwell: u64,
}

impl PlotExtractor {
    /// An extractor for a radar with the responses of `radar`; cells come with the dwells.
    pub fn new(config: &ExtractorConfig, radar: &RadarConfig) -> Self {
        let noise = NoiseEstimate::new(config.cfar, 2 * config.reference_cells);
        Self {
            config: config.clone(),
            radar: radar.clone(),
            noise_cells: noise.equivalent_cells().round() as u32,
            stages: None,
            hits: Vec::new(),
            closed: Vec::new(),
            plots: Vec::with_capacity(MAX_PLOTS),
            previous: None,
            sector: Sector::default(),
            taken: 0,
            published: 0,
        }
    }

    /// Takes one dwell, received at `received_ns` (CLOCK_MONOTONIC). Calls `publish` with
    /// the plots of each sector that is complete: at its last dwell, or, when that one is lost, at the next one to come.
    ///
    /// # Errors
    /// Why the dwell was not used; processing goes on with the next.
    pub fn take<E>(
        &mut self,
        header: &DwellHeader,
        amplitudes: &[f32],
        received_ns: u64,
        mut publish: impl FnMut(&PlotsHeader, &[Plot]) -> Result<(), E>,
    ) -> Result<Option<Reject>, E> {
        let reject = check(header, amplitudes.len());
        if reject == Some(Reject::BadHeader) {
            self.sector.rejected += 1;
            return Ok(reject); // not even its place in the stream can be trusted
        }
        self.end_clusters_before_gap(header);
        if self.sector.last.is_some_and(|last| (last.scan, last.sector) != (header.scan, header.sector)) {
            self.finish_sector(0, &mut publish)?;
        }
        if self.sector.last.is_some_and(|last| last.session != header.session) || self.sector.lineage.taken == 0 {
            let first_seq = if self.sector.lineage.taken == 0 { header.seq } else { self.sector.lineage.first_seq };
            self.sector.lineage = Lineage { session: header.session, first_seq, ..self.sector.lineage };
        }
        self.sector.lineage.last_seq = header.seq;
        self.sector.lineage.taken += 1;
        self.taken += 1;
        self.sector.extractor_in_ns = received_ns;
        self.sector.last = Some(*header);
        self.previous = Some(*header);
        let reject = reject.or_else(|| self.detect(header, amplitudes));
        if reject.is_some() {
            self.sector.rejected += 1;
        }
        if header.has(END_OF_SECTOR) || header.has(END_OF_STREAM) {
            self.finish_sector(header.flags & (END_OF_SCAN | END_OF_STREAM), &mut publish)?;
        }
        Ok(reject)
    }

    /// CFAR and clustering of one dwell.
    fn detect(&mut self, header: &DwellHeader, amplitudes: &[f32]) -> Option<Reject> {
        let grid = CellGrid {
            elevations: header.elevations as usize,
            dopplers: header.dopplers as usize,
            ranges: header.ranges as usize,
        };
        self.end_other_cells(header);
        if self.stages.is_none() {
            self.stages = Some(Stages {
                last: *header,
                cfar: Detector::new(&self.config, grid.ranges),
                clustering: Clustering::new(grid, self.config.max_dwells),
                powers: vec![0.0; grid.cells()],
                powers_before: vec![0.0; grid.cells()],
            });
        }
        let stages = self.stages.as_mut()?;
        stages.last = *header;
        // Before a detector learns from it.
        if jamming::is_saturated(amplitudes, header.full_scale) {
            return Some(Reject::Saturated);
        }
        std::mem::swap(&mut stages.powers, &mut stages.powers_before);
        self.hits.clear();
        if !stages.cfar.detect(header.dwell, amplitudes, &mut stages.powers, &mut self.hits) {
            return Some(Reject::BadAmplitude);
        }
        if jamming::is_jammed(&self.hits, amplitudes.len(), grid.ranges, self.config.pfa) {
            return Some(Reject::Jammed);
        }
        stages.clustering.add(header.seq, &self.hits, &stages.powers, &stages.powers_before, &mut self.closed);
        self.plot_closed(header);
        self.sector.cells += amplitudes.len() as u64;
        self.sector.detections += self.hits.len() as u64;
        None
    }

    /// Where dwells are missing or the stream goes back, no cluster can grow any more; its
    /// place in time and its cells follow from the last dwell that was used before the gap.
    fn end_clusters_before_gap(&mut self, header: &DwellHeader) {
        if self.previous.is_none_or(|previous| header.seq == previous.seq.saturating_add(1)) {
            return;
        }
        if let Some(stages) = &mut self.stages {
            stages.clustering.close_all(&mut self.closed);
            let last = stages.last;
            self.plot_closed(&last);
        }
    }

    /// Where a radar changes its cells, the scale of its range for example, its clusters end with the last dwell of the cells before,
    /// and all begins anew.
    fn end_other_cells(&mut self, header: &DwellHeader) {
        if let Some(mut stages) = self.stages.take_if(|stages| cells_of(&stages.last) != cells_of(header)) {
            stages.clustering.close_all(&mut self.closed);
            self.plot_closed(&stages.last);
        }
    }

    /// Makes plots of the clusters that have closed; see [`plot_of`].
    fn plot_closed(&mut self, near: &DwellHeader) {
        let Self { closed, plots, radar, noise_cells, .. } = self;
        plots.extend(closed.drain(..).map(|cluster| plot_of(&cluster, near, radar, *noise_cells)));
    }

    /// Publishes what the sector has brought.
    fn finish_sector<E>(
        &mut self,
        flags: u32,
        publish: &mut impl FnMut(&PlotsHeader, &[Plot]) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(last) = self.sector.last.take() else { return Ok(()) };
        let mut covered_to_dwell = last.seq + 1;
        if let Some(stages) = &mut self.stages {
            if flags & END_OF_STREAM != 0 {
                stages.clustering.close_all(&mut self.closed);
            }
            covered_to_dwell =
                stages.clustering.oldest_open().map_or(covered_to_dwell, |dwell| dwell.min(covered_to_dwell));
        }
        let used = self.stages.as_ref().map_or(last, |stages| stages.last);
        self.plot_closed(&used);
        let mut flags = flags;
        let left_out = self.plots.len().saturating_sub(MAX_PLOTS) as u32;
        if left_out > 0 {
            flags |= TRUNCATED;
            self.plots.sort_by(|a, b| b.statistic.total_cmp(&a.statistic));
            self.plots.truncate(MAX_PLOTS);
        }
        self.plots.sort_by(|a, b| a.time_ns.cmp(&b.time_ns).then(a.range_m.total_cmp(&b.range_m)));

        let scan_start = i128::from(last.scan) * i128::from(last.dwells_per_scan);
        let azimuth = |dwell: u64| (i128::from(dwell) - scan_start) as f64 * last.azimuth_step_rad;
        let covered_from_dwell = self.sector.covered_to_dwell.min(covered_to_dwell);
        let from_another_turn = covered_to_dwell - covered_from_dwell > u64::from(last.dwells_per_scan);
        let first = if from_another_turn { self.sector.lineage.first_seq } else { covered_from_dwell };
        let header = PlotsHeader {
            seq: u64::from(last.scan) * u64::from(last.sectors_per_scan) + u64::from(last.sector),
            time_ns: last.time_ns,
            lineage: Lineage { taken_in_session: self.taken, published_before: self.published, ..self.sector.lineage },
            stamps: Stamps {
                source_out_ns: last.source_out_ns,
                extractor_in_ns: self.sector.extractor_in_ns,
                ..Stamps::default()
            },
            covered_from_rad: azimuth(first.min(covered_to_dwell)),
            covered_to_rad: azimuth(covered_to_dwell),
            scan_period_s: last.scan_period_s,
            pfa: self.config.pfa,
            cells: self.sector.cells,
            detections: self.sector.detections,
            cell_range_m: last.range_step_m,
            cell_azimuth_rad: last.azimuth_step_rad,
            cell_elevation_rad: if last.elevations > 1 { last.elevation_step_rad } else { 0.0 },
            cell_range_rate_mps: if last.dopplers > 1 { last.range_rate_step_mps } else { 0.0 },
            range_rate_interval_mps: if last.dopplers > 1 {
                last.range_rate_step_mps * f64::from(last.dopplers)
            } else {
                0.0
            },
            reference_cells: 2 * self.config.reference_cells,
            cfar: self.config.cfar as u32,
            scan: last.scan,
            sector: last.sector,
            sectors_per_scan: last.sectors_per_scan,
            flags,
            rejected: self.sector.rejected,
            left_out,
            source_id: last.source_id,
            ..PlotsHeader::default()
        };
        self.sector = Sector { covered_to_dwell, ..Sector::default() };
        self.published += 1;
        let published = publish(&header, &self.plots);
        self.plots.clear();
        published
    }
}

/// Which cells a dwell has: how many, and where they begin and how large they are along range.
fn cells_of(header: &DwellHeader) -> ([u32; 3], [f64; 2]) {
    ([header.elevations, header.dopplers, header.ranges], [header.range_first_m, header.range_step_m])
}

/// Why a dwell cannot be used, from its header and length.
fn check(header: &DwellHeader, length: usize) -> Option<Reject> {
    let numbers = [header.azimuth_rad, header.elevation_first_rad, header.range_rate_first_mps, header.range_first_m];
    let steps = [
        header.azimuth_step_rad,
        header.elevation_step_rad,
        header.range_rate_step_mps,
        header.range_step_m,
        header.scan_period_s,
    ];
    let counts = [header.elevations, header.dopplers, header.ranges, header.dwells_per_scan, header.sectors_per_scan];
    let valid = numbers.iter().all(|number| number.is_finite())
        && steps.iter().all(|step| step.is_finite() && *step > 0.0)
        && counts.iter().all(|&count| count > 0)
        && header.dwell < header.dwells_per_scan
        && header.sector < header.sectors_per_scan
        && header.seq == u64::from(header.scan) * u64::from(header.dwells_per_scan) + u64::from(header.dwell);
    if !valid {
        Some(Reject::BadHeader)
    } else if header.cells() == length {
        None
    } else {
        Some(Reject::LengthMismatch)
    }
}

/// The plot of a cluster (C6), (C7). `near` is a dwell not long after its peak, without a gap between.
fn plot_of(cluster: &Cluster, near: &DwellHeader, radar: &RadarConfig, noise_cells: u32) -> Plot {
    let grid = CellGrid {
        elevations: near.elevations as usize,
        dopplers: near.dopplers as usize,
        ranges: near.ranges as usize,
    };
    let (elevation, doppler, range) = grid.place(cluster.peak.cell);
    let azimuth_width = radar.beamwidth_azimuth_deg.to_radians();
    let elevation_width = radar.beamwidth_elevation_deg.to_radians();
    let curvatures = [
        curvature(near.range_step_m, radar.pulse_width_m),
        curvature(near.azimuth_step_rad, azimuth_width),
        curvature(near.elevation_step_rad, elevation_width),
        curvature(near.range_rate_step_mps, radar.doppler_width_mps),
    ];
    let has_elevation = near.elevations > 1;
    let has_range_rate = near.dopplers > 1;
    let cuts = [cluster.range, cluster.azimuth, cluster.elevation, cluster.doppler];
    let points: [Offset; 4] = std::array::from_fn(|axis| interpolate(cuts[axis], curvatures[axis], noise_cells));
    let peaks = [range as u64, cluster.peak_dwell, elevation as u64];
    let axes = std::array::from_fn(|axis| Axis {
        reach: cluster.reaches[axis].over(cluster.peak.noise.into()),
        peak: peaks[axis],
        cut: cuts[axis],
        point: points[axis],
        curvature: curvatures[axis],
    });
    // With elevation or Doppler, clusters that no point explains are mostly two targets that touch: the plot stays with the
    // stronger one, as the tracker expects.
    let middle = if has_elevation || has_range_rate { None } else { extent::middle(cluster, &axes) };
    let [range_offset, azimuth_offset, elevation_offset] = middle.unwrap_or([points[0], points[1], points[2]]);
    let doppler_offset = points[3];

    let dwells_ago = near.seq as f64 - cluster.peak_dwell as f64 - azimuth_offset.cells;
    let dwell_ns = near.scan_period_s / f64::from(near.dwells_per_scan) * NS_PER_S;
    let doppler_span = near.range_rate_step_mps * f64::from(near.dopplers);
    let range_rate = near.range_rate_first_mps + near.range_rate_step_mps * (doppler as f64 + doppler_offset.cells);
    let lowest_rate = near.range_rate_first_mps - near.range_rate_step_mps / 2.0;

    let ratio = f64::from(cluster.peak.power) / f64::from(cluster.peak.noise);
    let straddling: f64 = points.iter().zip(curvatures).map(|(offset, kappa)| kappa * offset.cells.powi(2)).sum();
    let snr = (ratio - 1.0).max(0.1) * straddling.exp();
    Plot {
        time_ns: near.time_ns.saturating_add_signed(-(dwells_ago * dwell_ns).round() as i64),
        range_m: near.range_first_m + near.range_step_m * (range as f64 + range_offset.cells),
        azimuth_rad: angle::wrap(near.azimuth_rad - dwells_ago * near.azimuth_step_rad),
        elevation_rad: if has_elevation {
            near.elevation_first_rad + near.elevation_step_rad * (elevation as f64 + elevation_offset.cells)
        } else {
            0.0
        },
        range_rate_mps: if has_range_rate {
            lowest_rate + (range_rate - lowest_rate).rem_euclid(doppler_span)
        } else {
            0.0
        },
        sigma_range_m: (range_offset.sigma * near.range_step_m) as f32,
        sigma_azimuth_rad: (azimuth_offset.sigma * near.azimuth_step_rad) as f32,
        sigma_elevation_rad: (elevation_offset.sigma * near.elevation_step_rad) as f32,
        sigma_range_rate_mps: (doppler_offset.sigma * near.range_rate_step_mps) as f32,
        statistic: ratio.sqrt() as f32,
        snr_db: to_db(snr) as f32,
        cell_count: cluster.hits,
        flags: HAS_STATISTIC
            | if has_elevation { HAS_ELEVATION } else { 0 }
            | if has_range_rate { HAS_RANGE_RATE } else { 0 },
        source_id: near.source_id,
        target_id: 0,
    }
}
