//! Radar video: the strongest cell over elevation and Doppler of each azimuth and range.

use common::dwell::DwellHeader;
use common::message::{END_OF_SCAN, END_OF_SECTOR};
use common::units::{NS_PER_S, to_db};

/// Level 0, dB over the mean noise power.
pub const DB_FIRST: f32 = -10.0;
/// Between two levels, dB.
pub const DB_STEP: f32 = 0.25;

/// Every so many cells of a dwell are looked at for the noise: enough for its median, and no work.
const NOISE_STRIDE: usize = 97;
/// Share of a new dwell in the estimate of the noise.
const NOISE_SHARE: f64 = 0.05;

/// Levels of a sector, line by line.
#[derive(Debug, Clone)]
pub struct SectorVideo {
    /// Scan number from 0.
    pub scan: u32,
    /// Number of the sector in its scan.
    pub sector: u32,
    /// When the beam passed the last line, s UTC.
    pub time_s: f64,
    /// Azimuth of the first line, rad.
    pub azimuth_first_rad: f64,
    /// Between lines, rad.
    pub azimuth_step_rad: f64,
    /// Range of the first cell, m.
    pub range_first_m: f64,
    /// Between cells, m.
    pub range_step_m: f64,
    /// Cells in a line.
    pub ranges: usize,
    /// [`DB_FIRST`] + level · [`DB_STEP`], dB.
    pub levels: Vec<u8>,
}

impl SectorVideo {
    /// Lines of the sector.
    pub fn lines(&self) -> usize {
        self.levels.len() / self.ranges.max(1)
    }
}

/// Gathers the dwells of a sector.
#[derive(Debug, Default)]
pub struct Gatherer {
    sector: Option<SectorVideo>,
    /// Position of the dwell that is expected next.
    next_seq: u64,
    /// Strongest amplitude at each range of the dwell at hand.
    strongest: Vec<f32>,
    sample: Vec<f32>,
    /// Mean noise power, from the median of the cells; 0 before the first dwell.
    noise: f64,
}

impl Gatherer {
    /// Takes a dwell; the sector, if it is complete with it or by it. Dwells that are missing begin a new piece of their
    /// sector, so that no line is drawn where there was none.
    pub fn take(&mut self, header: &DwellHeader, cells: &[f32]) -> Option<SectorVideo> {
        let ranges = header.ranges as usize;
        if ranges == 0 || cells.len() != header.cells() {
            return None;
        }
        let goes_on = |of: &SectorVideo| (of.scan, of.sector, of.ranges) == (header.scan, header.sector, ranges);
        let follows = header.seq == self.next_seq && self.sector.as_ref().is_some_and(goes_on);
        let broken = if follows { None } else { self.sector.take() };
        self.next_seq = header.seq + 1;
        self.note_noise(cells);
        self.note_strongest(cells, ranges);
        let sector = self.sector.get_or_insert_with(|| SectorVideo {
            scan: header.scan,
            sector: header.sector,
            time_s: 0.0,
            azimuth_first_rad: header.azimuth_rad,
            azimuth_step_rad: header.azimuth_step_rad,
            range_first_m: header.range_first_m,
            range_step_m: header.range_step_m,
            ranges,
            levels: Vec::new(),
        });
        sector.time_s = header.time_ns as f64 / NS_PER_S;
        let noise = self.noise;
        sector.levels.extend(self.strongest.iter().map(|&amplitude| level(amplitude, noise)));
        if header.has(END_OF_SECTOR | END_OF_SCAN) {
            return self.sector.take(); // a piece that was broken off before it is as good as late
        }
        broken
    }

    /// The strongest amplitude at each range. Cells lie with range fastest, so each row is compared as a whole.
    fn note_strongest(&mut self, cells: &[f32], ranges: usize) {
        self.strongest.clear();
        self.strongest.resize(ranges, 0.0);
        for row in cells.chunks_exact(ranges) {
            for (strongest, &amplitude) in self.strongest.iter_mut().zip(row) {
                *strongest = if amplitude > *strongest { amplitude } else { *strongest };
            }
        }
    }

    /// The power of noise has its median at ln 2 of its mean; targets and clutter in few cells do not move a median.
    fn note_noise(&mut self, cells: &[f32]) {
        self.sample.clear();
        self.sample.extend(cells.iter().step_by(NOISE_STRIDE).filter(|amplitude| amplitude.is_finite()));
        if self.sample.is_empty() {
            return;
        }
        let middle = self.sample.len() / 2;
        let (_, median, _) = self.sample.select_nth_unstable_by(middle, f32::total_cmp);
        let mean = f64::from(*median).powi(2) / std::f64::consts::LN_2;
        self.noise = if self.noise > 0.0 { self.noise + NOISE_SHARE * (mean - self.noise) } else { mean };
    }
}

/// The level of an amplitude over noise of this mean power.
fn level(amplitude: f32, noise: f64) -> u8 {
    let db = to_db(f64::from(amplitude).powi(2) / noise.max(f64::MIN_POSITIVE));
    // What is below the first level, or no number, is 0; what is above the last, 255.
    ((db - f64::from(DB_FIRST)) / f64::from(DB_STEP)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use chacha20::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn header(dwell: u32) -> DwellHeader {
        DwellHeader {
            seq: dwell.into(),
            dwell,
            sector: dwell / 4,
            azimuth_rad: f64::from(dwell) * 0.1,
            azimuth_step_rad: 0.1,
            dwells_per_scan: 64,
            elevations: 5,
            dopplers: 4,
            ranges: 50,
            flags: if dwell % 4 == 3 { END_OF_SECTOR } else { 0 },
            ..DwellHeader::default()
        }
    }

    /// Amplitudes of noise of power 9, that is 9.5 dB over that of the simulator.
    fn cells(rng: &mut ChaCha8Rng) -> Vec<f32> {
        (0..1000).map(|_| 3.0 * (-(1.0 - rng.random::<f32>()).ln()).sqrt()).collect()
    }

    #[test]
    fn an_echo_stands_at_its_place_with_its_level_over_the_noise() {
        let (mut gatherer, mut rng) = (Gatherer::default(), ChaCha8Rng::seed_from_u64(1));
        let mut sectors = Vec::new();
        for dwell in 0..64 {
            let mut cells = cells(&mut rng);
            // 30 dB over the noise, at one elevation and Doppler.
            cells[13 * 50 + 17] = 3.0 * 1000.0_f32.sqrt();
            sectors.extend(gatherer.take(&header(dwell), &cells));
        }
        assert_eq!(sectors.len(), 16);
        let last = &sectors[15];
        assert_eq!((last.lines(), last.sector, last.ranges), (4, 15, 50));
        assert!((last.azimuth_first_rad - 6.0).abs() < 1e-9);
        let db = |level: u8| f64::from(DB_FIRST) + f64::from(level) * f64::from(DB_STEP);
        for line in last.levels.chunks(50) {
            assert!((db(line[17]) - 30.0).abs() < 1.5, "{}", db(line[17]));
            // The strongest of 20 cells of noise: 5.6 dB over the mean, give or take.
            let mean = line.iter().map(|&level| db(level)).sum::<f64>() / 50.0;
            assert!((4.0..8.0).contains(&mean), "{mean}");
        }
    }

    #[test]
    fn what_follows_missing_dwells_is_a_piece_of_its_own() {
        let (mut gatherer, mut rng) = (Gatherer::default(), ChaCha8Rng::seed_from_u64(2));
        let mut take = |dwell| gatherer.take(&header(dwell), &cells(&mut rng)).map(|of| (of.sector, of.lines()));
        assert_eq!([take(0), take(1), take(4)], [None, None, Some((0, 2))]);
        assert_eq!([take(5), take(6), take(7)], [None, None, Some((1, 4))]);
        // Of a message that is not what its header says, nothing is drawn.
        assert!(gatherer.take(&header(8), &[0.0; 3]).is_none());
    }

    #[test]
    fn amplitudes_that_are_no_numbers_are_no_echoes() {
        assert_eq!(level(f32::NAN, 1.0), 0);
        assert_eq!([level(0.0, 1.0), level(1.0, 1.0), level(f32::INFINITY, 1.0)], [0, 40, 255]);
    }
}
