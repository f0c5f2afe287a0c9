//! `tracks` messages as ASTERIX: category 062 for the tracks, category 065 once a scan for the state of the system.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use asterix::cat062::{Accuracy, Movement, SystemTrack};
use asterix::cat065::SystemStatus;
use asterix::report::{SourceId, TimeOfDay};
use asterix::tables::{CAT062_1_21, CAT065_1_6};
use asterix::{BlockWriter, EncodeError};
use common::config::{ChainConfig, Source};
use common::geodesy::LocalFrame;
use common::message::END_OF_SCAN;
use common::tracks::{
    COASTING, KIND_COORDINATED_TURN, KIND_MANOEUVRE, KIND_MEAN_ACCELERATION, STATE, TENTATIVE, TERMINATED, Track,
    TracksHeader,
};
use common::units::{DAY_NS, NS_PER_S};

/// Largest datagram, octets: it fits into one packet of an Ethernet.
const LARGEST: usize = 1400;
/// A standard error of the height above this says that there is no height, m.
const NO_HEIGHT_M: f64 = 2000.0;
/// A slower climb or descent is level flight, m/s; a slower change of speed is none, m/s².
const LEVEL_MPS: f64 = 1.5;
const EVEN_MPS2: f64 = 0.5;
/// A track without plots for so long has ended, though no message has said so, ns.
const FORGOTTEN_NS: u64 = 600_000_000_000;

/// What is remembered of a track.
#[derive(Debug, Clone, Copy)]
struct Known {
    first_ns: u64,
    last_plot_ns: u64,
}

/// The tracks of a site, of one radar or fused, on their way into datagrams.
#[derive(Debug)]
pub struct TrackDatagrams {
    source: SourceId,
    frame: Option<LocalFrame>,
    monosensor: bool,
    simulated: bool,
    tentative: bool,
    known: HashMap<u64, Known>,
    not_sent: u64,
}

impl TrackDatagrams {
    /// For the site of a chain, whose targets may be simulated; with `tentative` also tracks that are not confirmed.
    pub fn new(chain: &ChainConfig, simulated: bool, tentative: bool) -> Self {
        let [sac, sic] = (chain.site.source_id() as u16).to_be_bytes();
        Self {
            source: SourceId { sac, sic },
            frame: chain.site.position.as_ref().map(LocalFrame::new),
            monosensor: chain.run.source != Source::Fusion,
            simulated,
            tentative,
            known: HashMap::new(),
            not_sent: 0,
        }
    }

    /// Tracks whose position no item can hold.
    pub fn not_sent(&self) -> u64 {
        self.not_sent
    }

    /// The datagrams of a message.
    pub fn datagrams(&mut self, header: &TracksHeader, tracks: &[Track]) -> Vec<Vec<u8>> {
        let mut datagrams = Vec::new();
        let mut open = Vec::new();
        let with_tentative = self.tentative;
        for track in tracks.iter().filter(|track| with_tentative || track.state_code != TENTATIVE) {
            let record = self.record(track);
            let mut octets = Vec::new();
            let mut block = BlockWriter::new(CAT062_1_21, &mut octets);
            if block.record(|writer| record.write(writer)).is_err() {
                self.not_sent += 1;
                continue;
            }
            if open.len() + octets.len() > LARGEST {
                datagrams.push(std::mem::take(&mut open));
            }
            join(&mut open, &octets);
        }
        if !open.is_empty() {
            datagrams.push(open);
        }
        if header.has(END_OF_SCAN) {
            self.known.retain(|_, known| header.time_ns.saturating_sub(known.last_plot_ns) < FORGOTTEN_NS);
            datagrams.extend(self.status(header).ok());
        }
        datagrams
    }

    fn status(&self, header: &TracksHeader) -> Result<Vec<u8>, EncodeError> {
        let status = SystemStatus {
            source: self.source,
            time_of_day: Some(time_of_day(header.time_ns)),
            ..SystemStatus::default()
        };
        let mut octets = Vec::new();
        BlockWriter::new(CAT065_1_6, &mut octets).record(|writer| status.write(writer))?;
        Ok(octets)
    }

    fn record(&mut self, track: &Track) -> SystemTrack {
        let ended = track.state_code == TERMINATED;
        let fresh = Known { first_ns: track.time_ns, last_plot_ns: track.time_ns };
        let (first, known) = match self.known.entry(track.id) {
            Entry::Vacant(place) => (true, *place.insert(fresh)),
            Entry::Occupied(mut place) => {
                if track.misses == 0 {
                    place.get_mut().last_plot_ns = track.time_ns;
                }
                (false, *place.get())
            }
        };
        if ended {
            self.known.remove(&track.id);
        }
        let since_s = |time_ns: u64| track.time_ns.saturating_sub(time_ns) as f64 / NS_PER_S;
        let [x, vx, ax, y, vy, ay, _, vz, _] = track.state;
        let sigma = |index: usize| track.covariance[packed(index, index)].max(0.0).sqrt();
        let has_height = sigma(6) < NO_HEIGHT_M && sigma(6) > 0.0;
        let place = self.frame.map(|frame| frame.place(track.position_m()));
        let knows_acceleration = usize::from(track.known) == STATE;
        SystemTrack {
            source: self.source,
            number: track.id as u16,
            time_of_day: Some(time_of_day(track.time_ns)),
            position_deg: place.as_ref().map(|place| [place.latitude_deg, place.longitude_deg]),
            position_m: Some([x, y]),
            velocity_mps: Some([vx, vy]),
            acceleration_mps2: knows_acceleration.then_some([ax, ay]),
            height_m: place.filter(|_| has_height).map(|place| place.height_m),
            climb_rate_mps: has_height.then_some(vz),
            monosensor: self.monosensor,
            tentative: track.state_code == TENTATIVE,
            simulated: self.simulated,
            first,
            last: ended,
            coasted: track.state_code == COASTING,
            track_age_s: Some(since_s(known.first_ns)),
            plot_age_s: Some(since_s(known.last_plot_ns)),
            movement: Some(movement(track, has_height)),
            accuracy: Some(Accuracy {
                position_m: [sigma(0), sigma(3)],
                covariance_m2: track.covariance[packed(0, 3)],
                height_m: has_height.then(|| sigma(6)),
                velocity_mps: [sigma(1), sigma(4)],
                acceleration_mps2: knows_acceleration.then(|| [sigma(2), sigma(5)]),
                climb_rate_mps: has_height.then(|| sigma(7)),
            }),
            ..SystemTrack::default()
        }
    }
}

/// Appends a block's record to the block that is open, whose length grows with it.
fn join(open: &mut Vec<u8>, block: &[u8]) {
    const HEADER: usize = asterix::block::HEADER;
    if open.is_empty() {
        open.extend_from_slice(block);
        return;
    }
    open.extend_from_slice(&block[HEADER..]);
    let length = open.len() as u16;
    open[1..HEADER].copy_from_slice(&length.to_be_bytes());
}

fn time_of_day(time_ns: u64) -> TimeOfDay {
    let steps = u128::from(time_ns % DAY_NS) * u128::from(TimeOfDay::STEPS_PER_S) / 1_000_000_000;
    TimeOfDay { steps: steps as u32, period: TimeOfDay::DAY }
}

/// Place of an element of the packed upper triangle, row by row.
fn packed(row: usize, column: usize) -> usize {
    row * STATE - row * (row + 1) / 2 + column
}

/// I062/200: a turn or a change of speed is one where the models that manoeuvre are the more probable ones.
fn movement(track: &Track, has_height: bool) -> Movement {
    const UNDETERMINED: u8 = 3;
    let [_, vx, ax, _, vy, ay, _, vz, _] = track.state;
    let manoeuvres = [KIND_MANOEUVRE, KIND_COORDINATED_TURN, KIND_MEAN_ACCELERATION];
    let manoeuvre: f64 = manoeuvres.iter().map(|&kind| track.probability_of(kind)).sum();
    let speed_mps = vx.hypot(vy);
    let (right_mps2, along_mps2) = ((vy * ax - vx * ay) / speed_mps, (vx * ax + vy * ay) / speed_mps);
    let sign = |value: f64, threshold: f64| match value {
        value if value > threshold => 1,
        value if value < -threshold => 2,
        _ => 0,
    };
    let of_manoeuvre = |value: f64, threshold: f64| match manoeuvre {
        _ if !value.is_finite() => UNDETERMINED,
        probability if probability <= 0.5 => 0,
        _ => sign(value, threshold),
    };
    Movement {
        turn: of_manoeuvre(right_mps2, 0.0),
        speed: of_manoeuvre(along_mps2, EVEN_MPS2),
        climb: if has_height { sign(vz, LEVEL_MPS) } else { UNDETERMINED },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asterix::block::Blocks;
    use asterix::record::Records;
    use common::config::Position;

    const NOON_NS: u64 = 20_000 * DAY_NS + DAY_NS / 2;

    fn chain() -> ChainConfig {
        let mut chain = ChainConfig::default();
        (chain.site.sac, chain.site.sic) = (Some(25), Some(7));
        chain.site.position = Some(Position { latitude_deg: 50.45, longitude_deg: 30.52, height_m: 120.0 });
        chain
    }

    fn track(id: u64, time_ns: u64, state_code: u32) -> Track {
        let mut track = Track { id, time_ns, state_code, known: 9, ..Track::default() };
        track.state = [12_345.25, 30.0, 1.0, -6789.0, -40.0, 0.5, 900.0, 2.0, 0.0];
        for (index, sigma) in [12.0, 1.0, 0.5, 9.0, 1.5, 0.25, 40.0, 1.0, 0.5].into_iter().enumerate() {
            track.covariance[packed(index, index)] = sigma * sigma;
        }
        track
    }

    /// Tracks and the number of status messages in datagrams.
    fn read(datagrams: &[Vec<u8>]) -> (Vec<SystemTrack>, usize) {
        let (mut tracks, mut statuses) = (Vec::new(), 0);
        for datagram in datagrams {
            for block in Blocks::new(datagram).map(|block| block.expect("it can be read")) {
                let edition = if block.category == 62 { CAT062_1_21 } else { CAT065_1_6 };
                for record in Records::new(edition, block.records, 0) {
                    let record = record.expect("it can be read");
                    match block.category {
                        62 => tracks.push(SystemTrack::read(&record)),
                        _ => statuses += usize::from(SystemStatus::read(&record).is_some()),
                    }
                }
            }
        }
        (tracks, statuses)
    }

    #[test]
    fn a_track_goes_out_from_its_first_message_to_its_last() {
        let mut out = TrackDatagrams::new(&chain(), false, false);
        let scan = |flags: u32| TracksHeader { time_ns: NOON_NS, flags, ..TracksHeader::default() };
        assert_eq!(read(&out.datagrams(&scan(0), &[track(7, NOON_NS, TENTATIVE)])), (vec![], 0));
        let (first, statuses) =
            read(&out.datagrams(&scan(END_OF_SCAN), &[track(7, NOON_NS, common::tracks::CONFIRMED)]));
        assert_eq!((first.len(), statuses), (1, 1));
        let sent = first[0];
        assert_eq!((sent.source, sent.number, sent.first, sent.last), (SourceId { sac: 25, sic: 7 }, 7, true, false));
        assert_eq!(sent.time_of_day.map(|time| time.steps), Some(12 * 3600 * 128));
        assert_eq!((sent.position_m, sent.velocity_mps), (Some([12_345.0, -6789.0]), Some([30.0, -40.0])));
        let frame = LocalFrame::new(&chain().site.position.expect("a position"));
        let place = frame.place([12_345.25, -6789.0, 900.0]);
        let [latitude_deg, longitude_deg] = sent.position_deg.expect("a position");
        let half_step_deg = 90.0 / f64::from(1 << 25);
        assert!((latitude_deg - place.latitude_deg).abs() <= half_step_deg);
        assert!((longitude_deg - place.longitude_deg).abs() <= half_step_deg);
        assert!((sent.height_m.expect("a height") - place.height_m).abs() <= 1.0);
        let accuracy = sent.accuracy.expect("errors");
        assert_eq!((accuracy.position_m, accuracy.velocity_mps), ([12.0, 9.0], [1.0, 1.5]));
        assert_eq!(sent.movement.map(|movement| movement.climb), Some(1));

        let coasting = Track { misses: 2, ..track(7, NOON_NS + 2_000_000_000, COASTING) };
        let (coasted, _) = read(&out.datagrams(&scan(0), &[coasting]));
        assert_eq!((coasted[0].coasted, coasted[0].first, coasted[0].plot_age_s), (true, false, Some(2.0)));
        let (last, _) = read(&out.datagrams(&scan(0), &[track(7, NOON_NS + 3_000_000_000, TERMINATED)]));
        assert_eq!((last[0].last, last[0].track_age_s), (true, Some(3.0)));
        assert!(out.known.is_empty());
    }

    /// An observer may miss the message that ends a track: it is forgotten all the same.
    #[test]
    fn a_track_whose_end_was_missed_is_forgotten() {
        let mut out = TrackDatagrams::new(&chain(), false, false);
        let scan = |time_ns: u64| TracksHeader { time_ns, flags: END_OF_SCAN, ..TracksHeader::default() };
        out.datagrams(&scan(NOON_NS), &[track(7, NOON_NS, common::tracks::CONFIRMED)]);
        assert_eq!(out.known.len(), 1);
        out.datagrams(&scan(NOON_NS + FORGOTTEN_NS), &[]);
        assert!(out.known.is_empty());
    }

    #[test]
    fn fused_tracks_are_of_several_sensors() {
        let mut fused = chain();
        fused.run.source = Source::Fusion;
        for (chain, monosensor) in [(chain(), true), (fused, false)] {
            let mut out = TrackDatagrams::new(&chain, true, false);
            let tracks = [track(7, NOON_NS, common::tracks::CONFIRMED)];
            let (sent, _) = read(&out.datagrams(&TracksHeader::default(), &tracks));
            assert_eq!((sent[0].monosensor, sent[0].simulated), (monosensor, true));
        }
    }

    #[test]
    fn many_tracks_are_several_datagrams_and_impossible_ones_are_counted() {
        let mut out = TrackDatagrams::new(&chain(), false, false);
        let mut tracks: Vec<Track> = (0..500).map(|id| track(id, NOON_NS, common::tracks::CONFIRMED)).collect();
        tracks[100].state[0] = 1e9;
        tracks[101].state[3] = f64::NAN;
        let datagrams = out.datagrams(&TracksHeader::default(), &tracks);
        assert!(datagrams.len() > 1 && datagrams.iter().all(|datagram| datagram.len() <= LARGEST));
        let (sent, _) = read(&datagrams);
        assert_eq!((sent.len(), out.not_sent()), (498, 2));
        assert_eq!(sent.iter().map(|track| u64::from(track.number)).sum::<u64>(), (0..500).sum::<u64>() - 201);
    }

    #[test]
    fn a_turn_is_one_where_manoeuvring_models_are_probable() {
        let mut turning = track(1, NOON_NS, common::tracks::CONFIRMED);
        turning.model_kind[0] = KIND_MANOEUVRE;
        turning.model_probability[0] = 0.9;
        turning.models = 1;
        // Flies north, accelerates east: to the right.
        turning.state = [0.0, 0.0, 3.0, 0.0, 50.0, 0.0, 0.0, -4.0, 0.0];
        assert_eq!(movement(&turning, true), Movement { turn: 1, speed: 0, climb: 2 });
        turning.state[2] = -3.0;
        assert_eq!(movement(&turning, false), Movement { turn: 2, speed: 0, climb: 3 });
        turning.model_probability[0] = 0.1;
        assert_eq!(movement(&turning, true).turn, 0);
        turning.state = [0.0; STATE];
        assert_eq!(movement(&turning, true).turn, 3);
    }
}
