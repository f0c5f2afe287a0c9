//! What is wrong with a site, said by its name: once when it begins, and once when it is over.

use common::units::seconds_between;

use crate::engine::Fusion;
use crate::settings::Counts;

/// Measurement time between two looks at a site, s.
const LOOK_S: f64 = 10.0;
/// Fewest reports in that time that it is judged by.
const FEWEST: u64 = 20;
/// Share of reports that must be wrong.
const SHARE: f64 = 0.1;
/// How much more often than once a scan tracks may come.
const OFTEN: f64 = 3.0;

/// What can be wrong with a site.
const KINDS: usize = 4;
const SAYS_WHAT: [&str; KINDS] = [
    "its tracks match no other site's",
    "it sends old tracks again",
    "its tracks come far more often than once a scan",
    "nothing comes in time",
];

/// A site as its messages come.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heard<'a> {
    pub(crate) name: &'a str,
    pub(crate) scan_period_s: f64,
    /// Whether everything up to now is there, or nothing more is to come.
    pub(crate) is_in_time: bool,
}

/// One line about a site.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Remark {
    /// Something is wrong.
    Wrong(String),
    /// Something is right again.
    Over(String),
}

/// What has been said of the sites.
#[derive(Debug, Default)]
pub(crate) struct Remarks {
    looked_ns: Option<u64>,
    sites: Vec<Said>,
}

#[derive(Debug, Default, Clone, Copy)]
struct Said {
    before: Counts,
    is_wrong: [bool; KINDS],
    /// Since the last look: cycles, those of them in which not everything was there, and local tracks summed over them.
    cycles: u32,
    late: u32,
    tracks: usize,
}

impl Said {
    fn note(&mut self, tracks: usize, is_in_time: bool) {
        self.cycles += 1;
        self.late += u32::from(!is_in_time);
        self.tracks += tracks;
    }
}

impl Remarks {
    /// Notes how the sites are in the cycle that ends at `now_ns`, measurement time, and looks at what has become of their reports; what has
    /// changed since the last look, if that was some time ago.
    pub(crate) fn look<'a>(
        &mut self,
        now_ns: u64,
        fusion: &Fusion,
        sites: impl Iterator<Item = Heard<'a>>,
    ) -> Vec<Remark> {
        let mut remarks = Vec::new();
        let passed_s = seconds_between(*self.looked_ns.get_or_insert(now_ns), now_ns);
        let is_time = passed_s >= LOOK_S;
        if is_time {
            self.looked_ns = Some(now_ns);
        }
        for (number, site) in sites.enumerate() {
            if self.sites.len() <= number {
                self.sites.push(Said::default());
            }
            self.sites[number].note(fusion.local_tracks(number), site.is_in_time);
            if !is_time {
                continue;
            }
            let (said, name) = (&mut self.sites[number], site.name);
            let (counts, before) = (fusion.counts(number), said.before);
            if counts.realigned > before.realigned {
                let bias = fusion.registration().bias(number);
                remarks.push(Remark::Wrong(format!(
                    "site {name} measures {:+.0} m of range, {:+.2}° of azimuth, {:+.2}° of elevation too much, its clock is {:+.2} s ahead; that is beyond what [fusion] expects, and is corrected",
                    bias[0],
                    bias[1].to_degrees(),
                    bias[2].to_degrees(),
                    -bias[3],
                )));
            }
            let taken = counts.taken() - before.taken();
            let many = |of: u64| taken >= FEWEST && of as f64 > SHARE * taken as f64;
            let expected = said.tracks as f64 / f64::from(said.cycles) * passed_s / site.scan_period_s;
            let is_wrong = [
                fusion.matches_nobody(number) || many(counts.kept_out - before.kept_out),
                many(counts.repeated - before.repeated),
                // What was late comes all at once.
                said.late == 0 && taken >= FEWEST && taken as f64 > OFTEN * expected,
                2 * said.late > said.cycles,
            ];
            for (kind, what) in SAYS_WHAT.iter().enumerate() {
                match (said.is_wrong[kind], is_wrong[kind]) {
                    (false, true) => remarks.push(Remark::Wrong(format!("site {name}: {what}"))),
                    (true, false) => remarks.push(Remark::Over(format!("site {name}: over: {what}"))),
                    _ => {}
                }
            }
            *said = Said { before: counts, is_wrong, ..Said::default() };
        }
        remarks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;
    use crate::registration::Bias;
    use crate::simulation::scenarios::EQUAL;
    use crate::simulation::{Scenario, World};

    /// What is said of three sites in some minutes, of which from 100 to 200 s site 1 does something wrong.
    fn said(wrong: impl Fn(&mut World, &mut Fusion, bool)) -> Vec<Remark> {
        let mut world = World::new(Scenario::circle(&EQUAL[..3], 60, 1), 2);
        let mut fusion = world.fusion(Bias::zeros(), Settings::default());
        let (mut remarks, mut said) = (Remarks::default(), Vec::new());
        while world.time_s() < 400.0 {
            let is_wrong = (100.0..200.0).contains(&world.time_s());
            wrong(&mut world, &mut fusion, is_wrong);
            fusion.cycle(world.time_ns());
            let sites = ["west", "east", "south"].map(|name| Heard { name, scan_period_s: 5.0, is_in_time: true });
            said.extend(remarks.look(world.time_ns(), &fusion, sites.into_iter()));
        }
        said
    }

    fn once(what: &str) -> Vec<Remark> {
        vec![Remark::Wrong(format!("site east: {what}")), Remark::Over(format!("site east: over: {what}"))]
    }

    #[test]
    fn nothing_is_said_of_sites_that_are_right() {
        let quiet = said(|world, fusion, _| world.advance(|site, report| fusion.take(site, &report, report.time_ns)));
        assert_eq!(quiet, []);
    }

    #[test]
    fn tracks_sent_again_or_too_often_are_said_once_with_their_site() {
        let again = said(|world, fusion, is_wrong| {
            world.advance(|site, report| {
                for _ in 0..if is_wrong && site == 1 { 2 } else { 1 } {
                    fusion.take(site, &report, report.time_ns);
                }
            });
        });
        assert_eq!(again, once(SAYS_WHAT[1]));
        let often = said(|world, fusion, is_wrong| {
            world.advance(|site, report| {
                fusion.take(site, &report, report.time_ns);
                for tenth in 1..if is_wrong && site == 1 { 10 } else { 1 } {
                    let mut later = report;
                    later.posterior = report.posterior.predicted(0.3 * f64::from(tenth), 0.5);
                    later.prediction = Some(later.posterior);
                    later.time_ns += 300_000_000 * tenth as u64;
                    fusion.take(site, &later, later.time_ns);
                }
            });
        });
        assert_eq!(often, once(SAYS_WHAT[2]));
    }

    #[test]
    fn a_site_that_is_brought_back_is_named_with_its_bias() {
        let told = said(|world, fusion, is_wrong| {
            world.spoil(1, Bias::zeros(), if is_wrong { 2.0 } else { 0.0 });
            world.advance(|site, report| fusion.take(site, &report, report.time_ns));
        });
        let starts =
            |remark: &&Remark| matches!(remark, Remark::Wrong(text) if text.starts_with("site east measures "));
        let texts: Vec<_> = told.iter().filter(starts).collect();
        assert!(
            matches!(texts[..], [Remark::Wrong(there), Remark::Wrong(back)]
            if (there.contains("clock is +2.0") || there.contains("clock is +1.9")) && back.contains("0.0")),
            "{told:?}"
        );
        let others = |remark: &Remark| matches!(remark, Remark::Wrong(text) | Remark::Over(text) if !text.starts_with("site east"));
        assert!(!told.iter().any(others), "{told:?}");
    }

    #[test]
    fn a_site_that_says_nothing_in_time_is_named() {
        let fusion = World::new(Scenario::circle(&EQUAL[..1], 1, 1), 2).fusion(Bias::zeros(), Settings::default());
        let mut remarks = Remarks::default();
        let mut look = |at_s: u64, is_in_time| {
            remarks.look(
                at_s * 1_000_000_000,
                &fusion,
                std::iter::once(Heard { name: "east", scan_period_s: 5.0, is_in_time }),
            )
        };
        assert_eq!([look(100, true), look(110, false), look(120, false), look(130, true)].concat(), once(SAYS_WHAT[3]));
    }

    /// What is said of site 1 of three with 60 targets in some minutes of cycles of 1 s, with turns of 5 s; `speaks` says in which of them what
    /// it has reported comes, `is_in_time` in which everything is there.
    fn said_of_late(speaks: impl Fn(u32) -> bool, is_in_time: impl Fn(u32) -> bool) -> Vec<Remark> {
        let mut world = World::new(Scenario { cycle_s: 1.0, ..Scenario::circle(&EQUAL[..3], 60, 1) }, 2);
        let mut fusion = world.fusion(Bias::zeros(), Settings::default());
        let (mut remarks, mut said, mut held_back) = (Remarks::default(), Vec::new(), Vec::new());
        for cycle in 0..200 {
            world.advance(|site, report| {
                if site == 1 {
                    held_back.push(report);
                } else {
                    fusion.take(site, &report, report.time_ns);
                }
            });
            if speaks(cycle) {
                held_back.drain(..).for_each(|report| fusion.take(1, &report, report.time_ns));
            }
            fusion.cycle(world.time_ns());
            let sites = [("west", true), ("east", is_in_time(cycle)), ("south", true)];
            let heard = sites.map(|(name, is_in_time)| Heard { name, scan_period_s: 5.0, is_in_time });
            said.extend(remarks.look(world.time_ns(), &fusion, heard.into_iter()));
        }
        said
    }

    #[test]
    fn a_site_that_was_silent_is_not_said_to_report_too_often() {
        let is_silent = |cycle: u32| (60..103).contains(&cycle);
        assert_eq!(said_of_late(|cycle| !is_silent(cycle), |cycle| !is_silent(cycle)), once(SAYS_WHAT[3]));
    }

    #[test]
    fn a_late_cycle_now_and_then_is_nothing_to_speak_of() {
        assert_eq!(said_of_late(|_| true, |cycle| cycle % 5 > 1), []);
    }
}
