//! Tracks as systems outside want them: where on the earth, how long known, when last seen.

use std::collections::HashMap;

use common::angle::wrap;
use common::config::{ChainConfig, OutputConfig, Source};
use common::geodesy::{LocalFrame, Position};
use common::tracks::{COASTING, CONFIRMED, TENTATIVE, TERMINATED, Track, pack};
use common::units::NS_PER_S;

/// A standard error of the height above this says that there is no height, m.
const NO_HEIGHT_M: f64 = 2000.0;
/// A track without news for so long has ended, though no message has said so, ns.
const FORGOTTEN_NS: u64 = 600_000_000_000;

/// Where tracks are from.
#[derive(Debug, Clone)]
pub struct Site {
    /// Its name.
    pub name: String,
    /// SAC (high byte) and SIC (low byte).
    pub source_id: u16,
    /// Where it stands, if that is known.
    pub position: Option<Position>,
    /// Its tracks are those of several radars.
    pub is_fused: bool,
    /// Its targets are simulated.
    pub is_simulated: bool,
    frame: Option<LocalFrame>,
}

impl Site {
    /// That of the chain `chain`, whose SIC is `unit`; a site with fused tracks may have its targets from others.
    pub fn new(chain: &ChainConfig, unit: u8, is_simulated: bool) -> Self {
        Self {
            name: chain.site.name.clone(),
            source_id: u16::from_be_bytes([chain.site.sac.unwrap_or(0), unit]),
            position: chain.site.position,
            is_fused: chain.run.source == Source::Fusion,
            is_simulated,
            frame: chain.site.position.as_ref().map(LocalFrame::new),
        }
    }

    /// SAC and SIC.
    pub fn source(&self) -> asterix::report::SourceId {
        let [sac, sic] = self.source_id.to_be_bytes();
        asterix::report::SourceId { sac, sic }
    }

    /// The place of a position east, north and up of the site, m.
    pub fn place(&self, position_m: [f64; 3]) -> Option<Position> {
        self.frame.map(|frame| frame.place(position_m))
    }
}

/// The SIC of each site. One that is not configured is the lowest from 1 that no other site has.
pub fn units(sites: &[ChainConfig]) -> Vec<u8> {
    let mut free = (1..=u8::MAX).filter(|unit| sites.iter().all(|site| site.site.sic != Some(*unit)));
    sites.iter().map(|site| site.site.sic.or_else(|| free.next()).unwrap_or(0)).collect()
}

/// A track and what is remembered of it.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// The track.
    pub track: &'a Track,
    /// Session of the numbers ([`TracksHeader::numbering`](common::tracks::TracksHeader::numbering)): with it, a number is of one track only.
    pub session: u64,
    /// Time of the state, ns UTC, shifted where times are.
    pub time_ns: u64,
    /// Time since it was first reported, s.
    pub age_s: f64,
    /// Time since its last plot, s.
    pub since_plot_s: f64,
    /// It has not been reported before.
    pub is_first: bool,
    /// Where it is, if its site's place is known.
    pub place: Option<Position>,
}

impl Target<'_> {
    /// What is known of the target, in one word.
    pub fn state(&self) -> &'static str {
        match self.track.state_code {
            TENTATIVE => "tentative",
            CONFIRMED => "confirmed",
            COASTING => "coasting",
            _ => "ended",
        }
    }

    /// This is its last report.
    pub fn has_ended(&self) -> bool {
        self.track.state_code == TERMINATED
    }

    /// Standard error of a component of the state.
    pub fn sigma(&self, component: usize) -> f64 {
        self.track.covariance[pack(component, component)].max(0.0).sqrt()
    }

    /// Whether its height is known.
    pub fn has_height(&self) -> bool {
        self.sigma(6) > 0.0 && self.sigma(6) < NO_HEIGHT_M
    }

    /// Horizontal speed, m/s.
    pub fn speed_mps(&self) -> f64 {
        let [east, north, _] = self.track.velocity_mps();
        east.hypot(north)
    }

    /// Where it goes, clockwise from north, degrees in [0, 360).
    pub fn course_deg(&self) -> f64 {
        let [east, north, _] = self.track.velocity_mps();
        degrees_of_turn(east.atan2(north))
    }

    /// Radius that holds the same area as its ellipse of one standard error, m.
    pub fn circular_error_m(&self) -> f64 {
        let [xx, xy, yy] = [pack(0, 0), pack(0, 3), pack(3, 3)].map(|index| self.track.covariance[index]);
        (xx * yy - xy * xy).max(0.0).sqrt().sqrt()
    }
}

/// An angle in degrees in [0, 360).
pub fn degrees_of_turn(angle_rad: f64) -> f64 {
    let degrees = wrap(angle_rad).to_degrees();
    if degrees < 360.0 { degrees } else { 0.0 }
}

/// Times of a track, ns UTC.
#[derive(Debug, Clone, Copy)]
struct Known {
    first: u64,
    last_plot: u64,
    news: u64,
    report: Option<u64>,
}

/// The tracks of a site that one output reports.
#[derive(Debug)]
pub struct Roster {
    confirmed_only: bool,
    interval_ns: u64,
    known: HashMap<u64, Known>,
    session: u64,
    not_finite: u64,
}

impl Roster {
    /// Of nothing so far.
    pub fn new(config: &OutputConfig) -> Self {
        Self {
            confirmed_only: config.confirmed_only,
            interval_ns: (config.interval_s * NS_PER_S) as u64,
            known: HashMap::new(),
            session: 0,
            not_finite: 0,
        }
    }

    /// Tracks so far whose numbers are none.
    pub fn not_finite(&self) -> u64 {
        self.not_finite
    }

    /// Puts the tracks of a message that are to be reported into `targets`. `shift_ns` is added to their times.
    pub fn targets<'a>(
        &mut self,
        site: &Site,
        session: u64,
        tracks: &'a [Track],
        shift_ns: i64,
        targets: &mut Vec<Target<'a>>,
    ) {
        if std::mem::replace(&mut self.session, session) != session {
            self.known.clear(); // its numbers are of other tracks
        }
        targets.clear();
        for track in tracks {
            let finite = track.position_m().iter().chain(&track.velocity_mps()).all(|value| value.is_finite());
            self.not_finite += u64::from(!finite);
            if finite && let Some(known) = self.report(track) {
                let since_s = |time_ns: u64| track.time_ns.saturating_sub(time_ns) as f64 / NS_PER_S;
                targets.push(Target {
                    track,
                    session,
                    time_ns: track.time_ns.saturating_add_signed(shift_ns),
                    age_s: since_s(known.first),
                    since_plot_s: since_s(known.last_plot),
                    is_first: known.report.is_none(),
                    place: site.place(track.position_m()),
                });
            }
        }
    }

    /// What was known of a track that is to be reported now.
    fn report(&mut self, track: &Track) -> Option<Known> {
        let time_ns = track.time_ns;
        if track.state_code == TERMINATED {
            let known = self.known.remove(&track.id);
            return known.filter(|known| known.report.is_some()); // of others nobody knows
        }
        if track.state_code == TENTATIVE && self.confirmed_only {
            return None;
        }
        let begun = Known { first: time_ns, last_plot: time_ns, news: time_ns, report: None };
        let known = self.known.entry(track.id).or_insert(begun);
        known.news = time_ns;
        if track.misses == 0 {
            known.last_plot = time_ns;
        }
        let before = *known;
        let is_due = before.report.is_none_or(|last| time_ns.saturating_sub(last) >= self.interval_ns);
        if is_due {
            known.report = Some(time_ns);
        }
        is_due.then_some(before)
    }

    /// Forgets tracks whose end was missed.
    pub fn forget(&mut self, time_ns: u64) {
        self.known.retain(|_, known| time_ns.saturating_sub(known.news) < FORGOTTEN_NS);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::format::Update;
    use crate::origins::Origins;

    /// Noon of a day, ns.
    pub(crate) const NOON_NS: u64 = 20_000 * common::units::DAY_NS + common::units::DAY_NS / 2;

    pub(crate) fn site() -> Site {
        let mut chain = ChainConfig::default();
        chain.site.sac = Some(25);
        chain.site.position = Some(Position { latitude_deg: 50.45, longitude_deg: 30.52, height_m: 120.0 });
        Site::new(&chain, 7, true)
    }

    /// What is sent of these targets at noon.
    pub(crate) fn update<'a>(site: &'a Site, targets: &'a [Target<'a>], origins: &'a Origins) -> Update<'a> {
        Update { site, time_ns: NOON_NS, ends_scan: false, targets, origins, latency_ns: 0 }
    }

    pub(crate) fn track(id: u64, time_ns: u64, state_code: u32) -> Track {
        let mut track = Track { id, time_ns, state_code, known: 9, ..Track::default() };
        track.state = [12_345.25, 30.0, 1.0, -6789.0, -40.0, 0.5, 900.0, 2.0, 0.0];
        for (index, sigma) in [12.0, 1.0, 0.5, 9.0, 1.5, 0.25, 40.0, 1.0, 0.5].into_iter().enumerate() {
            track.covariance[pack(index, index)] = sigma * sigma;
        }
        track
    }

    /// The targets of tracks that have not been seen before.
    pub(crate) fn targets(tracks: &[Track]) -> Vec<Target<'_>> {
        let mut targets = Vec::new();
        let config = OutputConfig { confirmed_only: false, ..OutputConfig::default() };
        Roster::new(&config).targets(&site(), 1, tracks, 0, &mut targets);
        targets
    }

    /// Number, state, age and time since the last plot of each target reported.
    fn reported(roster: &mut Roster, session: u64, tracks: &[Track]) -> Vec<(u64, &'static str, f64, f64, bool)> {
        let mut targets = Vec::new();
        roster.targets(&site(), session, tracks, 0, &mut targets);
        let of = |it: &Target<'_>| (it.track.id, it.state(), it.age_s, it.since_plot_s, it.is_first);
        targets.iter().map(of).collect()
    }

    #[test]
    fn units_are_configured_or_the_lowest_that_are_free() {
        let sites = [None, Some(1), None, Some(3)].map(|sic| {
            let mut chain = ChainConfig::default();
            chain.site.sic = sic;
            chain
        });
        assert_eq!(units(&sites), [2, 1, 4, 3]);
        assert_eq!(units(&sites[..1]), [1]);
    }

    #[test]
    fn a_track_is_reported_from_its_confirmation_to_its_end() {
        let mut roster = Roster::new(&OutputConfig::default());
        let mut say = |track: Track| reported(&mut roster, 1, &[track]);
        let s = 1_000_000_000;
        assert_eq!(say(track(7, NOON_NS, TENTATIVE)), []);
        assert_eq!(say(track(8, NOON_NS, TERMINATED)), [], "nobody has heard of it");
        assert_eq!(say(track(7, NOON_NS + s, CONFIRMED)), [(7, "confirmed", 0.0, 0.0, true)]);
        let coasting = Track { misses: 1, ..track(7, NOON_NS + 3 * s, COASTING) };
        assert_eq!(say(coasting), [(7, "coasting", 2.0, 2.0, false)]);
        assert_eq!(say(track(7, NOON_NS + 4 * s, TERMINATED)), [(7, "ended", 3.0, 3.0, false)]);
        assert_eq!(say(track(7, NOON_NS + 5 * s, TERMINATED)), []);
        assert!(roster.known.is_empty());
    }

    #[test]
    fn reports_of_a_track_keep_their_distance_but_for_the_last() {
        let mut roster = Roster::new(&OutputConfig { interval_s: 5.0, ..OutputConfig::default() });
        let s = 1_000_000_000;
        let mut times = Vec::new();
        for second in 0..12 {
            let code = if second == 11 { TERMINATED } else { CONFIRMED };
            let count = reported(&mut roster, 1, &[track(7, NOON_NS + second * s, code)]).len();
            times.extend((0..count).map(|_| second));
        }
        assert_eq!(times, [0, 5, 10, 11]);
    }

    #[test]
    fn missed_ends_and_new_trackers_leave_nothing_behind() {
        let mut roster = Roster::new(&OutputConfig::default());
        reported(&mut roster, 1, &[track(7, NOON_NS, CONFIRMED)]);
        assert!(reported(&mut roster, 2, &[track(7, NOON_NS, CONFIRMED)])[0].4, "it is another track");
        roster.forget(NOON_NS + FORGOTTEN_NS);
        assert!(roster.known.is_empty());
    }

    #[test]
    fn numbers_that_are_none_are_counted() {
        let mut roster = Roster::new(&OutputConfig::default());
        let mut bad = track(7, NOON_NS, CONFIRMED);
        bad.state[3] = f64::NAN;
        assert_eq!((reported(&mut roster, 1, &[bad]).len(), roster.not_finite()), (0, 1));
    }

    #[test]
    fn courses_are_clockwise_from_north_and_errors_of_one_area() {
        let mut tracks = [track(1, NOON_NS, CONFIRMED)];
        (tracks[0].state[1], tracks[0].state[4]) = (-3.0, 0.0);
        let targets = targets(&tracks);
        assert_eq!((targets[0].course_deg(), targets[0].speed_mps()), (270.0, 3.0));
        assert!((targets[0].circular_error_m() - (12.0_f64 * 9.0).sqrt()).abs() < 1e-9);
    }
}
