//! A radar that is listened to: datagrams in, dwells out, as they come.
//!
//! The first scan begins with the first spoke at or after north. The azimuth of a spoke says which dwell it is, and where nothing has
//! come for half a turn or more, its time says in which turn. Dwells whose spokes have not come are missing in the schedule, as lost
//! ones, and a pause is as many scans as the radar has turned meanwhile. Times are those of receipt.

use std::borrow::Cow;

use asterix::recording::{Datagram, Form};
use common::config::ChainConfig;
use common::dwell::DwellHeader;
use common::health::{Reject, Rejected};
use common::units::NS_PER_S;

use crate::intake::Intake;
use crate::recording::{other_count, spokes_per_turn};
use crate::schedule::Schedule;
use crate::spoke::Spoke;
use crate::turning::Turning;

/// Spokes after which their number in a turn is looked at.
const COUNTED: usize = 256;
/// Share of a turn without a spoke from which on its time says how far the antenna has turned.
const PAUSE: f64 = 0.5;
/// The time of a turn differs from the last one by this share at most, or there was a pause.
const OTHER_TURN: f64 = 0.2;

/// A radar whose video is listened to.
#[derive(Debug)]
pub struct LiveVideo {
    schedule: Schedule,
    turning: Turning,
    intake: Intake,
    rejected: Rejected,
    dwells_per_scan: u32,
    first_scan: u32,
    /// Time of a turn, s.
    turn_s: f64,
    /// Position that the first scan begins with.
    begin: Option<u64>,
    /// Position and time of the last spoke, and of the first one of its turn.
    last: Option<(u64, u64)>,
    turn_began: Option<(u64, u64)>,
    /// The first azimuths; none once their spacing has been looked at.
    azimuths_rad: Option<Vec<f64>>,
    missing: u64,
    /// Of the last spoke that had a place.
    last_fingerprint: Option<u64>,
    /// Spokes of the radar, with or without a place.
    spokes: u64,
    /// Time of the last turn as measured, s, whether it was believed or not.
    measured_turn_s: Option<f64>,
}

impl LiveVideo {
    /// The radar of a configuration.
    pub fn new(chain: &ChainConfig) -> Self {
        let radar = &chain.radar;
        Self {
            schedule: Schedule::new(radar),
            turning: Turning::new(radar.dwells_per_scan),
            intake: Intake::new(&chain.site, chain.video_source.largest_cells as usize, 0), // every datagram has its time
            rejected: Rejected::default(),
            dwells_per_scan: radar.dwells_per_scan,
            first_scan: chain.run.first_scan,
            turn_s: radar.scan_period_s,
            begin: None,
            last: None,
            turn_began: None,
            azimuths_rad: Some(Vec::with_capacity(COUNTED)),
            missing: 0,
            last_fingerprint: None,
            spokes: 0,
            measured_turn_s: None,
        }
    }

    /// Takes a datagram that was received at `now_ns`, UTC, and hands over the dwells in it; sessions and stamps are the publisher's.
    pub fn take(&mut self, datagram: &[u8], now_ns: u64, mut dwell: impl FnMut(DwellHeader, Spoke)) {
        let datagram = Datagram { time_ns: Some(now_ns), destination: None, offset: 0, bytes: Cow::Borrowed(datagram) };
        if !self.intake.take(&datagram, Form::Pcap) {
            self.rejected.count(Reject::OtherCategory);
        }
        let mut spokes = std::mem::take(&mut self.intake.spokes);
        self.spokes += spokes.len() as u64;
        for spoke in spokes.drain(..) {
            if let Some(header) = self.header(&spoke, now_ns) {
                dwell(header, spoke);
            }
        }
        self.intake.spokes = spokes;
    }

    /// The header of a spoke; none if it has no place in the schedule.
    fn header(&mut self, spoke: &Spoke, now_ns: u64) -> Option<DwellHeader> {
        let fingerprint = Some(spoke.fingerprint());
        if fingerprint == self.last_fingerprint {
            self.rejected.count(Reject::Late);
            return None;
        }
        if let Some(azimuths_rad) = &mut self.azimuths_rad {
            azimuths_rad.push(spoke.azimuth_rad);
        }
        let dwell_ns = self.turn_s / f64::from(self.dwells_per_scan) * NS_PER_S;
        let measured_ns = now_ns.saturating_sub((f64::from(spoke.followers) * dwell_ns) as u64);
        let passed = self.last.map_or(0.0, |(_, last_ns)| measured_ns.saturating_sub(last_ns) as f64 / dwell_ns);
        let place = if passed > PAUSE * f64::from(self.dwells_per_scan) {
            self.turning.resume(spoke.azimuth_rad, passed)
        } else {
            self.turning.place(spoke.azimuth_rad, self.last.map(|_| passed))
        };
        if place.is_some() {
            self.last_fingerprint = fingerprint;
        }
        let turn = u64::from(self.dwells_per_scan);
        let placed = place.map(|place| (place, *self.begin.get_or_insert(place.next_multiple_of(turn))));
        let Some((place, begin)) = placed.filter(|(place, begin)| place >= begin) else {
            self.rejected.count(Reject::Late);
            return None;
        };
        // Packets are late by different times; the beam passes one spoke after the other.
        let time_ns = self.last.map_or(measured_ns, |(_, last_ns)| measured_ns.max(last_ns + 1));
        let last_place = self.last.replace((place, time_ns)).map_or(place, |(last, _)| last + 1);
        self.missing += place - last_place;
        if self.turn_began.is_none_or(|(began, _)| began / turn < place / turn) {
            let began = self.turn_began.replace((place, time_ns));
            self.learn_turn(began, (place, time_ns));
        }
        let seq = place - begin + u64::from(self.first_scan) * turn;
        Some(self.schedule.header(seq, time_ns, self.turn_s, spoke))
    }

    /// Takes the time of a turn from the beginnings of two, unless there was a pause between them: it is about that of the last turn, or of
    /// the one that is believed.
    fn learn_turn(&mut self, before: Option<(u64, u64)>, (place, time_ns): (u64, u64)) {
        let Some((place_before, before_ns)) = before else { return };
        let turns = (place - place_before) as f64 / f64::from(self.dwells_per_scan);
        let turn_s = (time_ns - before_ns) as f64 / NS_PER_S / turns;
        let is_about = |other_s: f64| (turn_s / other_s - 1.0).abs() < OTHER_TURN;
        if turns < 1.0 + PAUSE && (is_about(self.turn_s) || self.measured_turn_s.is_some_and(is_about)) {
            self.turn_s = turn_s;
        }
        self.measured_turn_s = Some(turn_s);
    }

    /// Spokes in a turn by their spacing, once enough have come, if they are not as many as configured; told once.
    pub fn other_count(&mut self) -> Option<u32> {
        let azimuths_rad = self.azimuths_rad.take_if(|azimuths_rad| azimuths_rad.len() >= COUNTED)?;
        let found = spokes_per_turn(azimuths_rad.iter().copied())?;
        other_count(found, self.dwells_per_scan)
    }

    /// What was not used, by reason.
    pub fn rejected(&self) -> Rejected {
        let mut rejected = self.rejected;
        rejected.add(&self.intake.rejected);
        rejected.count_many(Reject::BadHeader, self.intake.unread);
        rejected
    }

    /// Spokes of the radar so far, with or without a place.
    pub fn spokes(&self) -> u64 {
        self.spokes
    }

    /// Time of a turn as learnt, s.
    pub fn turn_s(&self) -> f64 {
        self.turn_s
    }

    /// Dwells so far whose spokes have not come.
    pub fn missing(&self) -> u64 {
        self.missing
    }
}
