//! One dwell: header and amplitudes.

use common::config::ChainConfig;
use common::dwell::DwellHeader;
use common::message::{END_OF_SCAN, END_OF_SECTOR};
use common::random::{Purpose, generator, seed_for};
use common::truth::TruthTarget;
use common::units::NS_PER_S;
use rand::RngExt;

use crate::clutter::Clutter;
use crate::echo::Echoes;
use crate::scene::Scene;
use crate::{SimError, noise};

/// Simulates any dwell of a run; the same configuration gives the same bytes, in any order.
#[derive(Debug)]
pub struct DwellSimulator {
    chain: ChainConfig,
    scene: Scene,
    clutter: Clutter,
    echoes: Echoes,
}

impl DwellSimulator {
    /// Prepares the scenario of `chain`.
    ///
    /// # Errors
    /// [`SimError`] if the file of a recorded flight cannot be used.
    pub fn new(chain: &ChainConfig) -> Result<Self, SimError> {
        let mut chain = chain.clone();
        if chain.sim.origin.is_some() {
            // Several radars see the same targets, each through noise of its own.
            chain.run.seed = seed_for(chain.run.seed, &chain.site.name);
        }
        Ok(Self { scene: Scene::new(&chain)?, clutter: Clutter::new(&chain), echoes: Echoes::default(), chain })
    }

    /// What was left out of the files of flights, a line for each.
    pub fn notes(&self) -> Vec<String> {
        let name = |id: u32| &self.chain.sim.targets[id as usize - 1].name;
        self.scene.dropped().map(|(id, dropped)| format!("target `{}`: {dropped}", name(id))).collect()
    }

    /// Header of a dwell, without session and stamps.
    pub fn header(&self, scan: u32, dwell: u32) -> DwellHeader {
        let radar = &self.chain.radar;
        let (dwells, sectors) = (radar.dwells_per_scan, radar.sectors_per_scan);
        let sector_of = |dwell: u32| (u64::from(dwell) * u64::from(sectors) / u64::from(dwells)) as u32;
        let sector = sector_of(dwell);
        let mut flags = 0;
        if dwell + 1 == dwells {
            flags = END_OF_SECTOR | END_OF_SCAN;
        } else if sector_of(dwell + 1) != sector {
            flags = END_OF_SECTOR;
        }
        let azimuth_step_rad = std::f64::consts::TAU / f64::from(dwells);
        DwellHeader {
            seq: u64::from(scan) * u64::from(dwells) + u64::from(dwell),
            time_ns: self.epoch_ns() + (self.time_s(scan, dwell) * NS_PER_S) as u64,
            azimuth_rad: (f64::from(dwell) + 0.5) * azimuth_step_rad,
            azimuth_step_rad,
            elevation_first_rad: radar.elevation_first_deg.to_radians(),
            elevation_step_rad: radar.elevation_step_deg.to_radians(),
            range_rate_first_mps: radar.range_rate_first_mps(),
            range_rate_step_mps: radar.range_rate_step_mps,
            range_first_m: radar.range_first_m,
            range_step_m: radar.range_step_m,
            scan_period_s: radar.scan_period_s,
            scan,
            dwell,
            dwells_per_scan: dwells,
            sector,
            sectors_per_scan: sectors,
            elevations: radar.elevations,
            dopplers: radar.dopplers,
            ranges: radar.ranges,
            flags,
            source_id: self.chain.site.source_id(),
            ..DwellHeader::default()
        }
    }

    /// Writes the amplitude of every cell of a dwell, `[elevation][doppler][range]`.
    ///
    /// # Panics
    /// If `amplitudes` does not hold exactly the cells of a dwell.
    pub fn fill(&mut self, scan: u32, dwell: u32, amplitudes: &mut [f32]) {
        assert_eq!(amplitudes.len(), self.cells(), "cells of a dwell");
        let seed = self.chain.run.seed;
        let mut rng = generator(seed, Purpose::Noise, scan, dwell);
        noise::fill(amplitudes, &mut rng);
        self.echoes.clear();
        let azimuth_rad = self.header(scan, dwell).azimuth_rad;
        self.scene.add(scan, dwell, self.time_s(scan, dwell), azimuth_rad, &mut self.echoes);
        self.clutter.add(seed, scan, dwell, &mut self.echoes);
        self.echoes.apply(amplitudes, || rng.random::<f32>() * std::f32::consts::TAU);
    }

    /// Where the targets are as the beam passes them in `scan`.
    pub fn truth(&self, scan: u32, truth: &mut Vec<TruthTarget>) {
        self.scene.truth(scan, self.epoch_ns(), truth);
    }

    /// Cells of a dwell.
    pub fn cells(&self) -> usize {
        self.chain.radar.grid().cells()
    }

    fn epoch_ns(&self) -> u64 {
        self.chain.run.epoch_s * 1_000_000_000
    }

    /// Time of the centre of a dwell, s since the start of the run.
    fn time_s(&self, scan: u32, dwell: u32) -> f64 {
        let radar = &self.chain.radar;
        (f64::from(scan) + (f64::from(dwell) + 0.5) / f64::from(radar.dwells_per_scan)) * radar.scan_period_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_bytes_in_any_order() {
        let chain = ChainConfig::default();
        let mut simulator = DwellSimulator::new(&chain).expect("valid scenario");
        let cells = simulator.cells();
        let mut dwell = |scan, number| {
            let mut amplitudes = vec![0.0; cells];
            simulator.fill(scan, number, &mut amplitudes);
            amplitudes
        };
        let (first, second) = (dwell(0, 5), dwell(7, 5));
        assert_ne!(first, second);
        assert_eq!(second, dwell(7, 5));
        assert_eq!(first, dwell(0, 5));
    }

    #[test]
    fn every_sector_ends_once_and_dwells_are_counted_through() {
        let simulator = DwellSimulator::new(&ChainConfig::default()).expect("valid scenario");
        let headers: Vec<_> = (0..1040).map(|dwell| simulator.header(3, dwell)).collect();
        assert_eq!(headers.iter().filter(|header| header.has(END_OF_SECTOR)).count(), 32);
        assert_eq!(headers.iter().filter(|header| header.has(END_OF_SCAN)).count(), 1);
        for pair in headers.windows(2) {
            assert_eq!(pair[1].seq, pair[0].seq + 1);
            assert_eq!(pair[1].sector, pair[0].sector + u32::from(pair[0].has(END_OF_SECTOR)));
        }
    }
}
