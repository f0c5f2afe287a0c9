//! A recording of radar video: its spokes with their places in the scan and their times.

use std::path::Path;

use asterix::recording::{Form, Recording};
use common::config::ChainConfig;
use common::dwell::DwellHeader;
use common::health::{Reject, Rejected};
use common::message::END_OF_STREAM;
use common::units::{DAY_NS, NS_PER_S};

use crate::cat240::MOST_CELLS;
use crate::error::VideoError;
use crate::intake::Intake;
use crate::schedule::Schedule;
use crate::spoke::Spoke;
use crate::turning::Turning;

/// Spacings of spokes looked at to tell how many there are in a turn.
const SPACINGS: usize = 4096;
/// Their number may differ by this share from what is configured.
const SPACING_TOLERANCE: f64 = 0.2;

/// The spokes of a file that have a place in a scan, in order.
#[derive(Debug)]
pub struct VideoRecording {
    dwells: Vec<(DwellHeader, Spoke)>,
    rejected: Rejected,
    unread: u64,
    most_cells: usize,
}

impl VideoRecording {
    /// Reads the file that the configuration names.
    ///
    /// # Errors
    /// [`VideoError`]: there is no file, or no video in it, or its spokes are not those of the configuration.
    pub fn open(chain: &ChainConfig) -> Result<Self, VideoError> {
        if chain.video_source.file.is_empty() {
            return Err(VideoError::NoFile);
        }
        let path = Path::new(&chain.video_source.file);
        let bytes = std::fs::read(path).map_err(|cause| VideoError::Read { path: path.into(), cause })?;
        Self::read(&bytes, path, chain)
    }

    /// The same of the bytes of a file; `path` is its name in errors.
    ///
    /// # Errors
    /// As [`VideoRecording::open`].
    pub fn read(bytes: &[u8], path: &Path, chain: &ChainConfig) -> Result<Self, VideoError> {
        let recording = Recording::whole(bytes);
        let mut found = Intake::new(&chain.site, MOST_CELLS, chain.run.epoch_s * 1_000_000_000 / DAY_NS * DAY_NS);
        found.unread = recording.lost.len() as u64;
        for datagram in &recording.datagrams {
            // A capture of a network has much else in it.
            found.take(datagram, recording.form);
        }
        if found.spokes.is_empty() {
            let what = match (bytes.len(), recording.form) {
                (0, _) => "an empty file".into(),
                (bytes, Form::Blocks) => format!("{bytes} bytes of something else"),
                _ => format!("{} datagrams of something else", recording.datagrams.len()),
            };
            return Err(VideoError::NoVideo { path: path.into(), found: what });
        }
        let (expected, in_a_turn) =
            (chain.radar.dwells_per_scan, spokes_per_turn(found.spokes.iter().map(|spoke| spoke.azimuth_rad)));
        if let Some(found) = in_a_turn.and_then(|found| other_count(found, expected)) {
            return Err(VideoError::Spokes { path: path.into(), found, expected });
        }
        Ok(Self::place(found, chain))
    }

    /// Places the spokes in scans and gives them times.
    fn place(found: Intake, chain: &ChainConfig) -> Self {
        let Intake { spokes, mut rejected, unread, .. } = found;
        let radar = &chain.radar;
        let (schedule, dwells_per_scan) = (Schedule::new(radar), radar.dwells_per_scan);
        let mut turning = Turning::new(dwells_per_scan);
        let mut placed: Vec<(u64, Spoke)> = Vec::with_capacity(spokes.len());
        let configured_ns = radar.scan_period_s / f64::from(dwells_per_scan) * NS_PER_S;
        let (mut last_ns, mut last_fingerprint) = (None, None);
        for spoke in spokes {
            let measured_ns = spoke.time_ns.map(|time_ns| time_ns as f64 - f64::from(spoke.followers) * configured_ns);
            let passed = measured_ns
                .zip(last_ns)
                .map(|(measured_ns, last_ns): (f64, f64)| (measured_ns - last_ns) / configured_ns);
            let fingerprint = Some(spoke.fingerprint());
            let place = if fingerprint == last_fingerprint { None } else { turning.place(spoke.azimuth_rad, passed) };
            let Some(place) = place else {
                rejected.count(Reject::Late);
                continue;
            };
            (last_ns, last_fingerprint) = (measured_ns.or(last_ns), fingerprint);
            placed.push((place, spoke));
        }
        rejected.count_many(Reject::Late, begin_at_north(&mut placed, dwells_per_scan));
        let scan_period_s = measured_period_s(&placed, dwells_per_scan).unwrap_or(radar.scan_period_s);
        let dwell_ns = scan_period_s / f64::from(dwells_per_scan) * NS_PER_S;
        let epoch_ns = chain.run.epoch_s * 1_000_000_000;
        let most_cells = placed.iter().map(|(_, spoke)| spoke.cells).max().unwrap_or(0);
        let is_timed = placed.iter().any(|(_, spoke)| spoke.time_ns.is_some());
        let mut before_ns = 0;
        let mut dwells: Vec<(DwellHeader, Spoke)> = Vec::with_capacity(placed.len());
        for (seq, spoke) in placed {
            let untimed_ns =
                if is_timed { before_ns + dwell_ns as u64 } else { epoch_ns + (seq as f64 * dwell_ns) as u64 };
            let time_ns = spoke
                .time_ns
                .map_or(untimed_ns, |time_ns| time_ns.saturating_sub((f64::from(spoke.followers) * dwell_ns) as u64));
            // Packets are late by different times; the beam passes one spoke after the other.
            before_ns = time_ns.max(before_ns + 1);
            let header = schedule.header(seq, before_ns, scan_period_s, &spoke);
            dwells.push((header, spoke));
        }
        let begin = dwells.partition_point(|(header, _)| header.scan < chain.run.first_scan);
        dwells.drain(..begin);
        if chain.run.scans > 0 {
            dwells.truncate(dwells.partition_point(|(header, _)| header.scan < chain.run.scans));
        }
        if let Some((last, _)) = dwells.last_mut() {
            last.flags |= END_OF_STREAM;
        }
        Self { dwells, rejected, unread, most_cells }
    }

    /// Headers and cells of the dwells that there are to publish, in order; sessions and stamps are the publisher's.
    pub fn dwells(&self) -> &[(DwellHeader, Spoke)] {
        &self.dwells
    }

    /// What was not used, by reason.
    pub fn rejected(&self) -> &Rejected {
        &self.rejected
    }

    /// Whether the file could be read to its end.
    pub fn is_sound(&self) -> bool {
        self.unread == 0
    }

    /// Parts of the file that could not be read.
    pub fn unread(&self) -> u64 {
        self.unread
    }

    /// Cells of the largest dwell.
    pub fn most_cells(&self) -> usize {
        self.most_cells
    }
}

/// Leaves out what comes before the first north, so that no dwell of the schedule is missing at the beginning, and counts on from there;
/// how many spokes that were. A recording that never passes north stays as it is.
fn begin_at_north(placed: &mut Vec<(u64, Spoke)>, dwells_per_scan: u32) -> u64 {
    let turn = u64::from(dwells_per_scan);
    let before = placed.partition_point(|&(place, _)| place < turn);
    let begins_at_north = placed.first().is_none_or(|&(place, _)| place == 0);
    if begins_at_north || before == placed.len() {
        return 0;
    }
    placed.drain(..before);
    for (place, _) in placed.iter_mut() {
        *place -= turn;
    }
    before as u64
}

/// The number of spokes in a turn, if it is another one than the expected.
pub(crate) fn other_count(found: f64, expected: u32) -> Option<u32> {
    let is_other = (found / f64::from(expected) - 1.0).abs() > SPACING_TOLERANCE;
    is_other.then(|| found.round() as u32)
}

/// How many spokes a turn has by the median of the spacings of their azimuths.
pub(crate) fn spokes_per_turn(azimuths_rad: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let turn = std::f64::consts::TAU;
    let mut spacings: Vec<f64> = azimuths_rad
        .clone()
        .zip(azimuths_rad.skip(1))
        .take(SPACINGS)
        .map(|(azimuth_rad, next_rad)| (next_rad - azimuth_rad).rem_euclid(turn))
        .filter(|&spacing| spacing > 0.0)
        .collect();
    if spacings.is_empty() {
        return None;
    }
    let middle = spacings.len() / 2;
    let (_, median, _) = spacings.select_nth_unstable_by(middle, f64::total_cmp);
    Some(turn / *median)
}

/// Time of a turn, s: the median over spokes and those a turn or little more later, so that a pause does not count; none without times,
/// or of less than a turn.
fn measured_period_s(placed: &[(u64, Spoke)], dwells_per_scan: u32) -> Option<f64> {
    let turn = u64::from(dwells_per_scan);
    let mut later = 0;
    let mut turns_s: Vec<f64> = placed
        .iter()
        .filter_map(|(place, spoke)| {
            later += placed[later..].iter().take_while(|(other, _)| *other < place + turn).count();
            let (other, end) = placed.get(later)?;
            let time_s = end.time_ns?.checked_sub(spoke.time_ns?)? as f64 / NS_PER_S;
            Some(time_s * turn as f64 / (other - place) as f64)
        })
        .filter(|&turn_s| turn_s > 0.0)
        .collect();
    let middle = turns_s.len() / 2;
    (!turns_s.is_empty()).then(|| *turns_s.select_nth_unstable_by(middle, f64::total_cmp).1)
}
