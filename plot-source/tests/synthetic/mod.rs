//! A radar of five targets that writes ASTERIX category 010, with a clock and a turn of its own.

#![allow(dead_code, reason = "each test uses a part")]

use std::f64::consts::TAU;
use std::path::Path;

use common::config::ChainConfig;
use common::plots::{Plot, PlotsHeader};
use plot_source::{Source, SourceError};

/// Midnight of the day on which every recording begins, ns since 1970.
pub(crate) const MIDNIGHT_NS: u64 = 1_714_867_200_000_000_000;
/// SAC and SIC of the radar.
pub(crate) const SOURCE: [u8; 2] = [0, 7];

/// Targets: east and north at the start, m, and velocities, m/s.
pub(crate) const TARGETS: [[f64; 4]; 5] = [
    [900.0, 1200.0, -12.0, 9.0],
    [1500.0, -600.0, -30.0, 4.0],
    [-800.0, -1400.0, 6.0, 18.0],
    [-1700.0, 500.0, 25.0, -14.0],
    [-300.0, 1900.0, 3.0, -40.0],
];

/// What makes a recording differ from that of a radar without faults.
#[derive(Clone, Copy)]
pub(crate) struct Recorder<'a> {
    /// Time of turn k, s.
    pub(crate) turn_s: &'a dyn Fn(u32) -> f64,
    /// What the clock shows at a true time since the start, s of the day.
    pub(crate) clock_s: &'a dyn Fn(f64) -> f64,
    /// Whether a report has a time.
    pub(crate) has_times: bool,
    /// Turns that are recorded at all.
    pub(crate) recorded: &'a dyn Fn(u32) -> bool,
    /// SAC and SIC in every record.
    pub(crate) source: [u8; 2],
    /// Categories in which the radar speaks.
    pub(crate) dialect: Dialect,
    /// Whether there are messages of the antenna.
    pub(crate) has_service: bool,
    /// Sectors of a turn whose beginning is told, of category 034; 0 for none.
    pub(crate) sector_messages: u32,
}

/// Categories of reports and of messages of the antenna.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Dialect {
    /// 010.
    Surface,
    /// 048 and 034, with sector messages.
    Monoradar,
    /// 001 and 002, whose reports have truncated times.
    Old,
}

impl Default for Recorder<'_> {
    fn default() -> Self {
        Self {
            turn_s: &|_| 1.0,
            clock_s: &|true_s| 36_000.0 + true_s,
            has_times: true,
            recorded: &|_| true,
            source: SOURCE,
            dialect: Dialect::Surface,
            has_service: true,
            sector_messages: 0,
        }
    }
}

impl Recorder<'_> {
    /// The blocks of `turns` turns, one record each.
    pub(crate) fn blocks(&self, turns: u32) -> Vec<Vec<u8>> {
        self.timed_blocks(turns).into_iter().map(|(_, block)| block).collect()
    }

    /// The same, with the true times since the start at which they are sent, s.
    pub(crate) fn timed_blocks(&self, turns: u32) -> Vec<(f64, Vec<u8>)> {
        let mut blocks = Vec::new();
        let mut north_s = 0.0;
        for turn in 0..turns {
            let turn_s = (self.turn_s)(turn);
            if (self.recorded)(turn) {
                if self.has_service {
                    blocks.push((north_s, self.cycle(north_s)));
                }
                let first = blocks.len();
                for target in &TARGETS {
                    let (time_s, place) = meet(target, north_s, turn_s);
                    blocks.push((time_s, self.report(time_s, place)));
                }
                for sector in 1..self.sector_messages {
                    let turned = f64::from(sector) / f64::from(self.sector_messages);
                    let time_s = north_s + turn_s * turned;
                    blocks.push((time_s, self.sector(time_s, turned)));
                }
                blocks[first..].sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            north_s += turn_s;
        }
        blocks
    }

    /// Blocks of an antenna that stands: the reports of all targets at once, 0.3 turns after the beginning of each turn.
    pub(crate) fn bursts(&self, turns: u32) -> Vec<(f64, Vec<u8>)> {
        let burst = |turn: u32| {
            let time_s = (f64::from(turn) + 0.3) * (self.turn_s)(turn);
            TARGETS.iter().map(move |[x, y, vx, vy]| {
                let (east, north) = (x + vx * time_s, y + vy * time_s);
                let place = [east.hypot(north), east.atan2(north).rem_euclid(TAU)];
                (time_s, self.report(time_s, place))
            })
        };
        (0..turns).flat_map(burst).collect()
    }

    fn sector(&self, true_s: f64, turned: f64) -> Vec<u8> {
        let azimuth = [(turned * 256.0).round() as u8];
        block(34, &[&[0xf0], &self.source[..], &[2], &self.time_of_day(true_s), &azimuth].concat())
    }

    fn cycle(&self, true_s: f64) -> Vec<u8> {
        let time = self.time_of_day(true_s);
        match self.dialect {
            Dialect::Surface => block(10, &[&[0xd0], &self.source[..], &[2], &time].concat()),
            Dialect::Monoradar => block(34, &[&[0xe0], &self.source[..], &[1], &time].concat()),
            Dialect::Old => block(2, &[&[0xd0], &self.source[..], &[1], &time].concat()),
        }
    }

    fn report(&self, true_s: f64, [range_m, azimuth_rad]: [f64; 2]) -> Vec<u8> {
        if self.dialect != Dialect::Surface {
            return self.monoradar_report(true_s, range_m, azimuth_rad);
        }
        let range = (range_m.round() as u16).to_be_bytes();
        let azimuth = ((azimuth_rad / TAU * 65_536.0).round() as u32 as u16).to_be_bytes();
        let primary = [0x60];
        let time = if self.has_times { self.time_of_day(true_s).to_vec() } else { Vec::new() };
        let fspec = if self.has_times { [0xf4] } else { [0xe4] };
        block(10, &[&fspec, &self.source[..], &[1], &primary, &time, &range, &azimuth].concat())
    }

    fn monoradar_report(&self, true_s: f64, range_m: f64, azimuth_rad: f64) -> Vec<u8> {
        let steps_per_m = if self.dialect == Dialect::Old { 128.0 } else { 256.0 } / 1852.0;
        let range = ((range_m * steps_per_m).round() as u16).to_be_bytes();
        let azimuth = ((azimuth_rad / TAU * 65_536.0).round() as u32 as u16).to_be_bytes();
        let [high, middle, low] = self.time_of_day(true_s);
        if self.dialect == Dialect::Old {
            // 010, 020 (a plot of the primary radar), 040, 141
            return block(1, &[&[0xe2], &self.source[..], &[0x10], &range, &azimuth, &[middle, low]].concat());
        }
        // 010, 140, 020 (a plot of the primary radar), 040
        block(48, &[&[0xf0], &self.source[..], &[high, middle, low], &[0x20], &range, &azimuth].concat())
    }

    fn time_of_day(&self, true_s: f64) -> [u8; 3] {
        let [_, a, b, c] = (((self.clock_s)(true_s) * 128.0).round() as u32).to_be_bytes();
        [a, b, c]
    }
}

/// When and where (m, rad) the beam meets a target in the turn that begins at `north_s`.
fn meet([x, y, vx, vy]: &[f64; 4], north_s: f64, turn_s: f64) -> (f64, [f64; 2]) {
    let mut time_s = north_s;
    let mut azimuth_rad = 0.0;
    let mut range_m = 0.0;
    for _ in 0..4 {
        let (east, north) = (x + vx * time_s, y + vy * time_s);
        azimuth_rad = east.atan2(north).rem_euclid(TAU);
        range_m = east.hypot(north);
        time_s = north_s + turn_s * azimuth_rad / TAU;
    }
    (time_s, [range_m, azimuth_rad])
}

/// A data block.
pub(crate) fn block(category: u8, records: &[u8]) -> Vec<u8> {
    let [high, low] = (records.len() as u16 + 3).to_be_bytes();
    [&[category, high, low], records].concat()
}

/// The configuration that fits the radar; a turn is said to take 1 s.
pub(crate) fn chain() -> ChainConfig {
    let mut chain = ChainConfig::default();
    (chain.site.sac, chain.site.sic) = (Some(SOURCE[0]), Some(SOURCE[1]));
    chain.plot_source.date = "2024-05-05".into();
    chain.plot_source.sigma_range_m = 2.0;
    chain.run.scans = 0;
    chain
}

/// The source of a recording.
pub(crate) fn open(chain: &ChainConfig, bytes: &[u8]) -> Result<Source, SourceError> {
    Source::decode(chain, (Path::new("radar.ast"), bytes), None)
}

/// All messages of a recording.
pub(crate) fn messages(source: Source) -> impl Iterator<Item = (PlotsHeader, Vec<Plot>)> {
    source.flat_map(|scan| scan.plots)
}
