//! What radars on a line say of themselves, for someone who has to configure a site: rates, categories, turns, gaps, clocks, and the
//! tables that fit.

use std::collections::BTreeMap;
use std::fmt::Write;

use asterix::editions::Editions;
use asterix::recovery::records;
use asterix::report::{Message, Service, ServiceMessage, SourceId, TargetReport, TimeOfDay};
use common::network::Endpoint;
use common::turning::Turning;
use common::units::NS_PER_S;

use crate::radar::Report;
use crate::turning::{Learnt, learn};

/// Values that are kept of one radar to take a median of; of a longer hearing the first.
const KEPT: usize = 1 << 16;
/// Sector messages that tell how an antenna turns.
const FEWEST_STEPS: u64 = 3;
/// A turn of which nothing is known, s: the search goes from a quarter to 16 times of it.
const PROBABLE_TURN_S: f64 = 4.0;
/// The coverage that is proposed is a whole number of these, m.
const RANGE_STEP_M: f64 = 10_000.0;

/// What has been heard so far.
#[derive(Debug, Default)]
pub struct Hearing {
    datagrams: u64,
    octets: u64,
    began_s: Option<f64>,
    last_s: f64,
    longest_gap_s: f64,
    by_category: BTreeMap<u8, u64>,
    unreadable: u64,
    radars: BTreeMap<SourceId, Radar>,
}

/// What one radar has said.
#[derive(Debug, Default)]
struct Radar {
    reports: u64,
    primary: u64,
    simulated: u64,
    artificial: u64,
    heights: u64,
    range_rates: u64,
    amplitudes: u64,
    farthest_m: f64,
    sectors: u64,
    /// Sector messages that came before half a turn after the one before them: clockwise, counter-clockwise.
    steps: [u64; 2],
    last_sector: Option<f64>,
    /// Times and azimuths of reports.
    seen: Vec<Report>,
    /// Times of north passages, s of the day.
    norths: Vec<f64>,
    /// Time of a turn as the radar says it, s.
    turn_s: Option<f64>,
    /// Time of receipt less the time in the message, s.
    delays_s: Vec<f64>,
}

/// The value in the middle; `None` of none.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

/// How much later `time_of_day_s` is than `said`, s; negative where the radar's clock is ahead.
fn delay_s(time_of_day_s: f64, said: TimeOfDay) -> f64 {
    let steps_per_s = f64::from(TimeOfDay::STEPS_PER_S);
    let (said_s, period_s) = (f64::from(said.steps) / steps_per_s, f64::from(said.period) / steps_per_s);
    (time_of_day_s - said_s + period_s / 2.0).rem_euclid(period_s) - period_s / 2.0
}

impl Radar {
    fn hear(&mut self, message: &Message, time_of_day_s: f64) {
        let said = match message {
            Message::Target(report) => {
                self.hear_target(report);
                report.time_of_day
            }
            Message::Service(service) => {
                self.hear_service(service);
                service.time_of_day
            }
        };
        if let Some(said) = said.filter(|_| self.delays_s.len() < KEPT) {
            self.delays_s.push(delay_s(time_of_day_s, said));
        }
    }

    fn hear_target(&mut self, report: &TargetReport) {
        self.reports += 1;
        self.primary += u64::from(report.primary);
        let of = report.artificial;
        self.simulated += u64::from(of.simulated);
        self.artificial += u64::from(of.simulated || of.test || of.monitor);
        self.heights += u64::from(report.height_m.or(report.pressure_height_m).is_some());
        self.range_rates += u64::from(report.radial_velocity_mps.is_some());
        self.amplitudes += u64::from(report.amplitude_db.is_some());
        if let (Some(time), Some((range_m, azimuth_rad))) = (report.time_of_day, report.polar)
            && self.seen.len() < KEPT
        {
            let clock_ns = Some((f64::from(time.steps) / f64::from(TimeOfDay::STEPS_PER_S) * NS_PER_S) as i64);
            self.seen.push(Report { clock_ns, range_m, azimuth_rad, ..Report::default() });
        }
        self.farthest_m = report.polar.map_or(self.farthest_m, |(range_m, _)| self.farthest_m.max(range_m));
    }

    fn hear_service(&mut self, service: &ServiceMessage) {
        self.turn_s = service.turn_s.or(self.turn_s);
        match (service.service, service.time_of_day) {
            (Service::North, Some(time)) if self.norths.len() < KEPT => {
                self.norths.push(f64::from(time.steps) / f64::from(TimeOfDay::STEPS_PER_S));
            }
            (Service::Sector, _) => {
                self.sectors += 1;
                let turned = service.azimuth_rad.map(|azimuth_rad| Turning::Clockwise.turned(azimuth_rad));
                if let (Some(last), Some(turned)) = (self.last_sector, turned) {
                    match (turned - last).rem_euclid(1.0) {
                        step if step > 0.0 && step < 0.5 => self.steps[0] += 1,
                        step if step > 0.5 => self.steps[1] += 1,
                        _ => {}
                    }
                }
                self.last_sector = turned;
            }
            _ => {}
        }
    }

    /// Time of a turn, s: the median between north passages, else as the radar says it, else by its reports.
    fn turn(&self) -> Option<f64> {
        self.said_turn()
            .or_else(|| Some(self.learnt()?.last_turn_ns(0) as f64 / NS_PER_S))
            .filter(|&turn_s| turn_s > 0.0)
    }

    fn said_turn(&self) -> Option<f64> {
        let turns: Vec<f64> =
            self.norths.windows(2).map(|pair| pair[1] - pair[0]).filter(|&turn_s| turn_s > 0.0).collect();
        median(&turns).or(self.turn_s)
    }

    /// How its antenna turns, by its sector messages, else by the times and azimuths of its reports; `None` if they do not tell.
    fn turning(&self) -> Option<Turning> {
        let [clockwise, other] = self.steps;
        if clockwise + other >= FEWEST_STEPS {
            return Some(if clockwise >= other { Turning::Clockwise } else { Turning::CounterClockwise });
        }
        Some(self.learnt()?.turning)
    }

    /// What times and azimuths of its reports tell.
    fn learnt(&self) -> Option<Learnt> {
        let turn_s = self.said_turn().unwrap_or(PROBABLE_TURN_S);
        learn(&self.seen, (turn_s * NS_PER_S) as i64, None)
    }

    /// Range that is proposed as coverage, m.
    fn coverage_m(&self) -> f64 {
        ((self.farthest_m / RANGE_STEP_M).ceil() * RANGE_STEP_M).max(RANGE_STEP_M)
    }

    fn describe(&self, text: &mut String) {
        let share = |count: u64| 100.0 * count as f64 / (self.reports.max(1)) as f64;
        let Self { reports, farthest_m, .. } = self;
        let _ = writeln!(text, "  reports         {reports}, farthest {:.1} km", farthest_m / 1000.0);
        let _ = writeln!(
            text,
            "  of them         {:.0} % primary, {:.0} % with height, {:.0} % with range rate, {:.0} % with amplitude, {:.0} % artificial",
            share(self.primary),
            share(self.heights),
            share(self.range_rates),
            share(self.amplitudes),
            share(self.artificial),
        );
        let turn = self.turn().map_or("not known".into(), |turn_s| format!("{turn_s:.2} s"));
        let turning = self.turning().map_or(String::new(), |turning| format!(", {}", turning.name()));
        let _ = writeln!(
            text,
            "  turn            {turn}{turning}; {} north marks, {} sector messages",
            self.norths.len(),
            self.sectors
        );
        if let Some(median_s) = median(&self.delays_s) {
            let least = self.delays_s.iter().copied().fold(f64::INFINITY, f64::min);
            let most = self.delays_s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let _ = writeln!(
                text,
                "  received        {median_s:+.3} s after its time (median), {least:+.3} to {most:+.3} s"
            );
        }
    }
}

impl Hearing {
    /// Takes a datagram that came `at_s` after any beginning, at this time of the day.
    pub fn take(&mut self, datagram: &[u8], editions: &Editions, at_s: f64, time_of_day_s: f64) {
        self.datagrams += 1;
        self.octets += datagram.len() as u64;
        match self.began_s {
            None => self.began_s = Some(at_s),
            Some(_) => self.longest_gap_s = self.longest_gap_s.max(at_s - self.last_s),
        }
        self.last_s = at_s;
        for record in records(editions, datagram, 0) {
            let Ok(record) = record else {
                self.unreadable += 1;
                continue;
            };
            *self.by_category.entry(record.edition.category).or_default() += 1;
            if let Some(message) = Message::of(&record)
                && let Some(source) = message.source()
            {
                self.radars.entry(source).or_default().hear(&message, time_of_day_s);
            }
        }
    }

    /// Whether any radar has been heard.
    pub fn has_radars(&self) -> bool {
        !self.radars.is_empty()
    }

    /// What has been heard, in lines.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let over_s = self.last_s - self.began_s.unwrap_or(self.last_s);
        let rate = if over_s > 0.0 { self.datagrams as f64 / over_s } else { 0.0 };
        let _ = writeln!(
            text,
            "datagrams         {} in {over_s:.1} s ({rate:.1} a second, {} octets), longest pause {:.2} s",
            self.datagrams, self.octets, self.longest_gap_s
        );
        let categories: Vec<String> =
            self.by_category.iter().map(|(category, count)| format!("{category:03}: {count}")).collect();
        let _ = writeln!(text, "records           {}; {} unreadable", categories.join(", "), self.unreadable);
        for (source, radar) in &self.radars {
            let _ = writeln!(text, "{source}");
            radar.describe(&mut text);
        }
        text
    }

    /// A configuration for what has been heard at `source`, TOML; `None` without a radar.
    pub fn proposal(&self, source: &str) -> Option<String> {
        let several = self.radars.len() > 1;
        let is_group = source.parse::<Endpoint>().is_ok_and(|endpoint| endpoint.address.ip().is_multicast());
        let mut text = String::from(if several && !is_group {
            "# An own address is one site's: let the radars send to a group, or each to a port of its own, and change `listen`.\n"
        } else {
            ""
        });
        text.push_str(if several {
            "[run]\nmode = \"real-time\"\nscans = 0            # until it is stopped\n"
        } else {
            ""
        });
        for (SourceId { sac, sic }, radar) in &self.radars {
            let identity = format!("name = \"radar-{sac}-{sic}\"\nsac = {sac}\nsic = {sic}\n");
            let plots = if several {
                let _ = write!(text, "\n[[site]]\n{identity}source = \"plot-source\"\n\n[site.plot_source]\n");
                &mut text
            } else {
                let run = "[run]\nsource = \"plot-source\"\nmode = \"real-time\"\nscans = 0            # until it is stopped\n";
                let _ = write!(text, "[site]\n{identity}\n{run}\n[plot_source]\n");
                &mut text
            };
            let _ = writeln!(plots, "listen = [{source:?}]");
            if let Some(turn_s) = radar.turn() {
                let _ = writeln!(plots, "scan_period_s = {turn_s:.3}");
            }
            if let Some(turning) = radar.turning().filter(|&turning| turning != Turning::Clockwise) {
                let _ = writeln!(plots, "turning = {:?}", turning.name());
            }
            let _ = writeln!(plots, "coverage_range_m = {:.1}", radar.coverage_m());
            if radar.simulated * 2 > radar.reports {
                let _ = writeln!(plots, "use_simulated = true");
            }
        }
        self.has_radars().then_some(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asterix::BlockWriter;
    use asterix::report::Artificial;
    use asterix::tables::{CAT034_1_29, CAT048_1_32};
    use asterix::{cat034, cat048};
    use std::f64::consts::TAU;
    use std::path::Path;

    const NOON: u32 = 12 * 3600 * 128;

    fn datagram(sic: u8, turn: u32, is_simulated: bool) -> Vec<u8> {
        let source = Some(SourceId { sac: 25, sic });
        let time_of_day = Some(TimeOfDay { steps: NOON + turn * 512, period: TimeOfDay::DAY });
        let mut octets = Vec::new();
        let north =
            ServiceMessage { source, service: Service::North, time_of_day, azimuth_rad: None, turn_s: Some(4.5) };
        let mut block = BlockWriter::new(CAT034_1_29, &mut octets);
        block.record(|record| cat034::write(&north, record)).expect("it can be written");
        let polar = Some((43_210.0, 1.0));
        let artificial = Artificial { simulated: is_simulated, ..Artificial::default() };
        let report = TargetReport { source, time_of_day, primary: true, artificial, polar, ..TargetReport::default() };
        let mut block = BlockWriter::new(CAT048_1_32, &mut octets);
        block.record(|record| cat048::write(&report, record)).expect("it can be written");
        octets
    }

    fn heard(sics: &[u8]) -> Hearing {
        let (mut hearing, editions) = (Hearing::default(), Editions::default());
        for turn in 0..5 {
            for &sic in sics {
                let after_s = f64::from(turn) * 4.0;
                hearing.take(&datagram(sic, turn, sics.len() > 1), &editions, after_s, 43_200.25 + after_s);
            }
        }
        hearing.take(&[48, 0, 200, 0xf0, 1], &editions, 26.0, 43_226.0);
        hearing
    }

    #[test]
    fn turns_clocks_and_gaps_are_told() {
        let text = heard(&[7]).text();
        for part in [
            "6 in 26.0 s",
            "longest pause 10.00 s",
            "034: 5, 048: 5; 1 unreadable",
            "SAC 25 SIC 7",
            "5, farthest 43.2 km",
            "100 % primary, 0 % with height",
            "turn            4.00 s; 5 north marks, 0 sector messages",
            "+0.250 s after its time (median), +0.250 to +0.250 s",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
    }

    #[test]
    fn the_proposal_is_a_configuration() {
        for (sics, names) in [(&[7][..], &["radar-25-7"][..]), (&[7, 8], &["radar-25-7", "radar-25-8"])] {
            let source = "udp://239.192.86.68:8668?interface=lo";
            let text = heard(sics).proposal(source).expect("a radar");
            let sites = common::config::parse_sites(Path::new("proposal"), &text, &[]).expect(&text);
            assert_eq!(sites.names(), names);
            for site in sites.all() {
                assert_eq!((site.plot_source.scan_period_s, site.plot_source.use_simulated), (4.0, sics.len() > 1));
                assert_eq!(
                    (site.plot_source.listen[0].as_str(), site.plot_source.coverage_range_m),
                    (source, 50_000.0)
                );
            }
        }
        let own = heard(&[7, 8]).proposal("udp://127.0.0.1:8600").expect("two radars");
        assert!(own.starts_with("# An own address is one site's"), "{own}");
        assert_eq!(Hearing::default().proposal("udp://127.0.0.1:1"), None);
    }

    #[test]
    fn times_are_compared_across_midnight() {
        let late = TimeOfDay { steps: TimeOfDay::DAY - 128, period: TimeOfDay::DAY };
        assert_eq!((delay_s(1.0, late), delay_s(86_397.0, late)), (2.0, -2.0));
    }

    /// How an antenna turns is told by its sector messages, or by its reports.
    #[test]
    fn the_way_in_which_an_antenna_turns_is_told() {
        let service = |sector: u32, turning: Turning| ServiceMessage {
            source: Some(SourceId { sac: 25, sic: 7 }),
            service: Service::Sector,
            time_of_day: Some(TimeOfDay { steps: NOON + sector * 16, period: TimeOfDay::DAY }),
            azimuth_rad: Some(turning.turned(f64::from(sector) / 32.0 * TAU) * TAU),
            turn_s: None,
        };
        for turning in [Turning::Clockwise, Turning::CounterClockwise, Turning::Standing] {
            let (mut by_sectors, mut by_reports) = (Radar::default(), Radar::default());
            (0..64).for_each(|sector| by_sectors.hear_service(&service(sector, turning)));
            for report in 0..200_u32 {
                let (turn, target) = (report / 5, report % 5);
                let turned = [0.1, 0.25, 0.3, 0.62, 0.9][target as usize];
                let after = if turning == Turning::Standing { 0.0 } else { turning.turned(turned * TAU) };
                let steps = NOON + turn * 512 + (after * 512.0) as u32;
                by_reports.hear_target(&TargetReport {
                    time_of_day: Some(TimeOfDay { steps, period: TimeOfDay::DAY }),
                    polar: Some((9000.0, turned * TAU)),
                    ..TargetReport::default()
                });
            }
            if turning != Turning::Standing {
                assert_eq!(by_sectors.turning(), Some(turning));
            }
            assert_eq!(by_reports.turning(), Some(turning));
            assert!(by_reports.turn().is_some_and(|turn_s| (turn_s - 4.0).abs() < 0.05), "{:?}", by_reports.turn());
        }
        assert_eq!(Radar::default().turning(), None);
    }
}
