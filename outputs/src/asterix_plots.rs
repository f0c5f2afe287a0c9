//! Plots as ASTERIX: category 048 for the plots of a sector, then category 034 for how far the antenna has come.
//!
//! Every plot before a sector message has been sent: the azimuth of the message is the one that `plots` calls covered, cut to the
//! step of the item, so sector messages of an antenna that turns counter-clockwise run downwards, and one that stands has north
//! markers alone: where its scans end. Range, azimuth, time, range rate and signal-to-noise ratio (as amplitude) go out; a height where elevation is
//! measured and the place of the radar known. Nothing says which target a plot is of.

use std::collections::HashMap;
use std::f64::consts::TAU;

use asterix::report::{Artificial, Service, ServiceMessage, TargetReport};
use asterix::tables::{CAT034_1_29, CAT048_1_32};
use asterix::{BlockWriter, cat034, cat048};
use common::plots::{ARTIFICIAL, HAS_ELEVATION, HAS_RANGE_RATE, Plot, PlotsHeader};
use common::units::NS_PER_S;

use crate::asterix_tracks::{join, time_of_day};
use crate::format::{Format, Frames, Update};
use crate::targets::Site;

/// Steps of a turn in a sector message.
const STEPS: f64 = 256.0;

/// Plots of radars on their way into datagrams.
#[derive(Debug, Default)]
pub struct AsterixPlots {
    open: Vec<u8>,
    record: Vec<u8>,
    /// Turns of the antenna by SAC and SIC, from the last message.
    turns: HashMap<u16, f64>,
    not_said: u64,
}

fn report(site: &Site, plot: &Plot) -> TargetReport {
    let (sin_azimuth, cos_azimuth) = plot.azimuth_rad.sin_cos();
    let (sin_elevation, cos_elevation) = plot.elevation_rad.sin_cos();
    let ground_m = plot.range_m * cos_elevation;
    let place = || site.place([ground_m * sin_azimuth, ground_m * cos_azimuth, plot.range_m * sin_elevation]);
    let is_artificial = plot.has(ARTIFICIAL);
    TargetReport {
        source: Some(site.source()),
        time_of_day: Some(time_of_day(plot.time_ns)),
        primary: true,
        artificial: Artificial { simulated: site.is_simulated, test: is_artificial, ..Artificial::default() },
        polar: Some((plot.range_m, plot.azimuth_rad)),
        height_m: plot.has(HAS_ELEVATION).then(place).flatten().map(|place| place.height_m),
        radial_velocity_mps: plot.has(HAS_RANGE_RATE).then_some(plot.range_rate_mps),
        amplitude_db: Some(plot.snr_db.into()),
        ..TargetReport::default()
    }
}

impl AsterixPlots {
    /// How far the antenna has come: a north marker where it has passed north, else a sector crossing; nothing if it stands.
    fn service(&mut self, site: &Site, header: &PlotsHeader) -> Option<ServiceMessage> {
        let covered_turns = f64::from(header.scan) + header.covered_to_rad / TAU;
        let turns = (covered_turns * STEPS + 1e-6).floor() / STEPS;
        let before = self.turns.insert(site.source_id, turns);
        let passes_north = before.is_none_or(|before| before.floor() < turns.floor());
        if before.is_some_and(|before| before >= turns) {
            return None;
        }
        let sector_end =
            f64::from(header.scan) + f64::from(header.sector + 1) / f64::from(header.sectors_per_scan.max(1));
        let at = if passes_north { turns.floor() } else { turns };
        let ago_s = ((sector_end - at) * header.scan_period_s).max(0.0);
        let time_ns = header.time_ns.saturating_sub((ago_s * NS_PER_S) as u64);
        Some(ServiceMessage {
            source: Some(site.source()),
            service: if passes_north { Service::North } else { Service::Sector },
            time_of_day: Some(time_of_day(time_ns)),
            azimuth_rad: (!passes_north).then(|| header.turning().turned(turns.fract() * TAU) * TAU),
            turn_s: (header.scan_period_s > 0.0).then_some(header.scan_period_s),
        })
    }
}

impl Format for AsterixPlots {
    fn tracks(&mut self, _: &Update<'_>, _: &mut Frames) {}

    fn plots(&mut self, site: &Site, header: &PlotsHeader, plots: &[Plot], out: &mut Frames) {
        for plot in plots {
            self.record.clear();
            let mut block = BlockWriter::new(CAT048_1_32, &mut self.record);
            match block.record(|writer| cat048::write(&report(site, plot), writer)) {
                Ok(()) => join(&mut self.open, &self.record, out),
                Err(_) => self.not_said += 1,
            }
        }
        if !self.open.is_empty() {
            out.push(&self.open);
            self.open.clear();
        }
        if let Some(message) = self.service(site, header) {
            let write = |octets: &mut Vec<u8>| {
                BlockWriter::new(CAT034_1_29, octets).record(|writer| cat034::write(&message, writer))
            };
            self.not_said += u64::from(out.frame(write).is_err());
        }
    }

    fn not_said(&self) -> u64 {
        self.not_said
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::targets::tests::{NOON_NS, site};
    use asterix::block::Blocks;
    use asterix::editions::Editions;
    use asterix::record::Records;
    use asterix::report::Message;
    use common::turning::Turning;

    fn header(scan: u32, sector: u32, covered_turns: f64) -> PlotsHeader {
        PlotsHeader {
            scan,
            sector,
            sectors_per_scan: 8,
            scan_period_s: 4.0,
            covered_to_rad: covered_turns * TAU,
            time_ns: NOON_NS + (f64::from(scan * 8 + sector + 1) / 8.0 * 4.0 * NS_PER_S) as u64,
            ..PlotsHeader::default()
        }
    }

    fn read(frames: &Frames) -> Vec<Message> {
        let editions = Editions::default();
        let mut messages = Vec::new();
        for block in frames.iter().flat_map(Blocks::new).map(|block| block.expect("it can be read")) {
            let edition = editions.of(block.category).expect("a known category");
            let records = Records::new(edition, block.records, 0).map(|record| record.expect("it can be read"));
            messages.extend(records.filter_map(|record| Message::of(&record)));
        }
        messages
    }

    /// Azimuths of the sector messages of a scan, 256ths of a turn; `None` for a north marker.
    fn sectors(turning: Turning, covered: impl Fn(u32) -> f64) -> Vec<Option<u32>> {
        let (mut format, mut frames) = (AsterixPlots::default(), Frames::default());
        for sector in 0..16 {
            let header = header(sector / 8, sector % 8, covered(sector));
            format.plots(&site(), &PlotsHeader { flags: turning.flags(), ..header }, &[], &mut frames);
        }
        let azimuth = |message| match message {
            Message::Service(message) => {
                message.azimuth_rad.map(|azimuth_rad| (azimuth_rad / TAU * STEPS).round() as u32)
            }
            Message::Target(_) => unreachable!("no plots"),
        };
        read(&frames).into_iter().map(azimuth).collect()
    }

    #[test]
    fn sector_messages_run_as_the_antenna_does() {
        let turned = |sector: u32| f64::from(sector % 8 + 1) / 8.0;
        let up = sectors(Turning::Clockwise, turned);
        let down = sectors(Turning::CounterClockwise, turned);
        assert_eq!(up[8..], [Some(32), Some(64), Some(96), Some(128), Some(160), Some(192), Some(224), None]);
        assert_eq!(down[8..], [Some(224), Some(192), Some(160), Some(128), Some(96), Some(64), Some(32), None]);
        let standing = sectors(Turning::Standing, |sector| if sector % 8 == 7 { 1.0 } else { 0.0 });
        assert!(standing.len() >= 2 && standing.iter().all(Option::is_none), "{standing:?}");
    }

    #[test]
    fn plots_come_back_within_the_steps_of_the_format() {
        let plot = Plot {
            time_ns: NOON_NS,
            range_m: 43_210.0,
            azimuth_rad: 2.0,
            elevation_rad: 0.05,
            range_rate_mps: -123.4,
            snr_db: 17.2,
            flags: HAS_ELEVATION | HAS_RANGE_RATE,
            ..Plot::default()
        };
        let far = Plot { range_m: 1e9, ..plot };
        let mut frames = Frames::default();
        let mut out = AsterixPlots::default();
        out.plots(&site(), &header(0, 2, 0.375), &[plot, far, plot], &mut frames);
        assert_eq!(out.not_said(), 1);
        let messages = read(&frames);
        assert_eq!(messages.len(), 3);
        let Message::Target(read) = messages[0] else { panic!("{:?}", messages[0]) };
        let (range_m, azimuth_rad) = read.polar.expect("a position");
        assert!((range_m - plot.range_m).abs() <= 1852.0 / 512.0 && (azimuth_rad - 2.0).abs() <= TAU / 65_536.0 / 2.0);
        assert!(read.primary && read.artificial.simulated && !read.artificial.test);
        assert!((read.radial_velocity_mps.expect("a range rate") + 123.4).abs() <= 0.5);
        assert_eq!((read.amplitude_db, read.time_of_day), (Some(17.0), Some(time_of_day(NOON_NS))));
        let height_m = 43_210.0 * 0.05_f64.sin() + 120.0;
        assert!((read.height_m.expect("a height") - height_m).abs() < 200.0, "and the bend of the earth");
    }

    #[test]
    fn the_antenna_is_where_all_plots_have_been_sent() {
        let mut out = AsterixPlots::default();
        let mut said = |scan, sector, covered| {
            let mut frames = Frames::default();
            out.plots(&site(), &header(scan, sector, covered), &[], &mut frames);
            let messages = read(&frames);
            messages.first().map(|message| match message {
                Message::Service(of) => (of.service, of.azimuth_rad.map(|rad| (rad / TAU * STEPS).round()), of.turn_s),
                Message::Target(_) => panic!("no plots"),
            })
        };
        assert_eq!(said(0, 0, 0.1), Some((Service::North, None, Some(4.0))));
        assert_eq!(said(0, 1, 0.25), Some((Service::Sector, Some(64.0), Some(4.0))));
        assert_eq!(said(0, 2, 0.25), None, "a cluster is open");
        assert_eq!(said(0, 7, 0.9), Some((Service::Sector, Some(230.0), Some(4.0))));
        assert_eq!(said(1, 0, -0.05), Some((Service::Sector, Some(243.0), Some(4.0))));
        assert_eq!(said(1, 1, 0.25), Some((Service::North, None, Some(4.0))));
    }
}
