//! Tracks as ASTERIX: category 062 for the tracks, category 065 once a scan for the state of the system.

use asterix::cat062::{Accuracy, Movement, SystemTrack, UnitTrack};
use asterix::cat065::SystemStatus;
use asterix::report::{SourceId, TimeOfDay};
use asterix::tables::{CAT062_1_21, CAT065_1_6};
use asterix::{BlockWriter, EncodeError};
use common::tracks::{
    COASTING, KIND_COORDINATED_TURN, KIND_MANOEUVRE, KIND_MEAN_ACCELERATION, STATE, TENTATIVE, Track, pack,
};
use common::units::DAY_NS;

use crate::format::{Format, Frames, Update};
use crate::targets::{Site, Target};

/// Largest datagram, octets: it fits into one packet of an Ethernet.
pub(crate) const LARGEST: usize = 1400;
/// A slower climb or descent is level flight, m/s; a slower change of speed is none, m/s².
const LEVEL_MPS: f64 = 1.5;
const EVEN_MPS2: f64 = 0.5;

/// Tracks of radars and fused ones on their way into datagrams.
#[derive(Debug, Default)]
pub struct AsterixTracks {
    open: Vec<u8>,
    record: Vec<u8>,
    not_said: u64,
}

impl Format for AsterixTracks {
    fn tracks(&mut self, update: &Update<'_>, out: &mut Frames) {
        for target in update.targets {
            let record = system_track(update, target);
            self.record.clear();
            let mut block = BlockWriter::new(CAT062_1_21, &mut self.record);
            if block.record(|writer| record.write(writer)).is_err() {
                self.not_said += 1;
                continue;
            }
            join(&mut self.open, &self.record, out);
        }
        if !self.open.is_empty() {
            out.push(&self.open);
            self.open.clear();
        }
        if update.ends_scan {
            // A time and a source can always be written.
            let _ = out.frame(|octets| status(update, octets));
        }
    }

    fn not_said(&self) -> u64 {
        self.not_said
    }
}

fn status(update: &Update<'_>, octets: &mut Vec<u8>) -> Result<(), EncodeError> {
    let status = SystemStatus {
        source: update.site.source(),
        time_of_day: Some(time_of_day(update.time_ns)),
        ..SystemStatus::default()
    };
    BlockWriter::new(CAT065_1_6, octets).record(|writer| status.write(writer))
}

fn system_track(update: &Update<'_>, target: &Target<'_>) -> SystemTrack {
    let (site, track) = (update.site, target.track);
    let [x, vx, ax, y, vy, ay, _, vz, _] = track.state;
    let sigma = |component: usize| target.sigma(component);
    let has_height = target.has_height();
    let knows_acceleration = usize::from(track.known) == STATE;
    let of_unit = |(unit, id)| UnitTrack { unit, number: UnitTrack::number_of(id) };
    let mut slaves = update.origins.contributors(track.id).map(of_unit).peekable();
    let master = slaves.peek().map(|_| of_unit((site.source().sic, track.id)));
    let mut composed = [None; 9];
    for (place, of_unit) in composed.iter_mut().zip(master.into_iter().chain(slaves)) {
        *place = Some(of_unit);
    }
    SystemTrack {
        source: site.source(),
        number: UnitTrack::number_of(track.id),
        time_of_day: Some(time_of_day(target.time_ns)),
        position_deg: target.place.map(|place| [place.latitude_deg, place.longitude_deg]),
        position_m: Some([x, y]),
        velocity_mps: Some([vx, vy]),
        acceleration_mps2: knows_acceleration.then_some([ax, ay]),
        height_m: target.place.filter(|_| has_height).map(|place| place.height_m),
        climb_rate_mps: has_height.then_some(vz),
        monosensor: !site.is_fused,
        tentative: track.state_code == TENTATIVE,
        simulated: site.is_simulated,
        first: target.is_first,
        last: target.has_ended(),
        coasted: track.state_code == COASTING,
        track_age_s: Some(target.age_s),
        plot_age_s: Some(target.since_plot_s),
        movement: Some(movement(track, has_height)),
        accuracy: Some(Accuracy {
            position_m: [sigma(0), sigma(3)],
            covariance_m2: track.covariance[pack(0, 3)],
            height_m: has_height.then(|| sigma(6)),
            velocity_mps: [sigma(1), sigma(4)],
            acceleration_mps2: knows_acceleration.then(|| [sigma(2), sigma(5)]),
            climb_rate_mps: has_height.then(|| sigma(7)),
        }),
        composed,
        plot: update.origins.plot(track).map(|(radar, plot)| (radar_of(radar, site), plot.range_m, plot.azimuth_rad)),
        ..SystemTrack::default()
    }
}

/// The radar of a plot: as the plot says, else that of the site.
fn radar_of(source_id: u32, site: &Site) -> SourceId {
    let [.., sac, sic] = source_id.to_be_bytes();
    if source_id == 0 { site.source() } else { SourceId { sac, sic } }
}

/// Appends a block's record to the block that is open, whose length grows with it; a block that would become too large is
/// closed first.
pub(crate) fn join(open: &mut Vec<u8>, block: &[u8], out: &mut Frames) {
    const HEADER: usize = asterix::block::HEADER;
    if open.len() + block.len() > LARGEST {
        out.push(open);
        open.clear();
    }
    if open.is_empty() {
        open.extend_from_slice(block);
        return;
    }
    open.extend_from_slice(&block[HEADER..]);
    let length = open.len() as u16;
    open[1..HEADER].copy_from_slice(&length.to_be_bytes());
}

/// The time of day, cut to the step of ASTERIX.
pub(crate) fn time_of_day(time_ns: u64) -> TimeOfDay {
    let steps = u128::from(time_ns % DAY_NS) * u128::from(TimeOfDay::STEPS_PER_S) / 1_000_000_000;
    TimeOfDay { steps: steps as u32, period: TimeOfDay::DAY }
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
    use crate::origins::Origins;
    use crate::targets::Roster;
    use crate::targets::tests::{NOON_NS, site, targets, track, update};
    use asterix::block::Blocks;
    use asterix::record::Records;
    use common::config::{ChainConfig, OutputConfig, Source};
    use common::plots::{Plot, PlotsHeader};
    use common::system_tracks::{self, CONTRIBUTORS, Contributor, SystemTracksHeader};
    use common::tracks::{CONFIRMED, TERMINATED};

    /// Tracks and the number of status messages in datagrams.
    fn read(frames: &Frames) -> (Vec<SystemTrack>, usize) {
        let (mut tracks, mut statuses) = (Vec::new(), 0);
        for datagram in frames.iter() {
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

    fn send(out: &mut AsterixTracks, site: &Site, targets: &[Target<'_>], ends_scan: bool) -> Frames {
        send_with(out, site, &Origins::default(), (targets, ends_scan))
    }

    fn send_with(
        out: &mut AsterixTracks,
        site: &Site,
        origins: &Origins,
        (targets, ends_scan): (&[Target<'_>], bool),
    ) -> Frames {
        let mut frames = Frames::default();
        let update = Update { ends_scan, ..update(site, targets, origins) };
        out.tracks(&update, &mut frames);
        frames
    }

    #[test]
    fn a_track_goes_out_from_its_first_message_to_its_last() {
        let (mut out, site, mut roster) = (AsterixTracks::default(), site(), Roster::new(&OutputConfig::default()));
        let mut told = |track: Track| {
            let (tracks, mut targets) = ([track], Vec::new());
            roster.targets(&site, 1, &tracks, 0, &mut targets);
            read(&send(&mut out, &site, &targets, true))
        };
        let (first, statuses) = told(track(7, NOON_NS, CONFIRMED));
        assert_eq!((first.len(), statuses), (1, 1));
        let sent = first[0];
        assert_eq!((sent.source, sent.number, sent.first, sent.last), (SourceId { sac: 25, sic: 7 }, 7, true, false));
        assert_eq!(sent.time_of_day.map(|time| time.steps), Some(12 * 3600 * 128));
        assert_eq!((sent.position_m, sent.velocity_mps), (Some([12_345.0, -6789.0]), Some([30.0, -40.0])));
        let place = site.place([12_345.25, -6789.0, 900.0]).expect("a place");
        let [latitude_deg, longitude_deg] = sent.position_deg.expect("a position");
        let half_step_deg = 90.0 / f64::from(1 << 25);
        assert!((latitude_deg - place.latitude_deg).abs() <= half_step_deg);
        assert!((longitude_deg - place.longitude_deg).abs() <= half_step_deg);
        assert!((sent.height_m.expect("a height") - place.height_m).abs() <= 1.0);
        let accuracy = sent.accuracy.expect("errors");
        assert_eq!((accuracy.position_m, accuracy.velocity_mps), ([12.0, 9.0], [1.0, 1.5]));
        assert_eq!(sent.movement.map(|movement| movement.climb), Some(1));
        assert!(sent.monosensor && sent.simulated);

        let (coasted, _) = told(Track { misses: 2, ..track(7, NOON_NS + 2_000_000_000, COASTING) });
        assert_eq!((coasted[0].coasted, coasted[0].first, coasted[0].plot_age_s), (true, false, Some(2.0)));
        let (last, _) = told(track(7, NOON_NS + 3_000_000_000, TERMINATED));
        assert_eq!((last[0].last, last[0].track_age_s), (true, Some(3.0)));
    }

    #[test]
    fn fused_tracks_are_of_several_sensors() {
        let mut chain = ChainConfig::default();
        chain.run.source = Source::Fusion;
        let tracks = [track(7, NOON_NS, CONFIRMED)];
        let frames = send(&mut AsterixTracks::default(), &Site::new(&chain, 1, false), &targets(&tracks), false);
        let (sent, _) = read(&frames);
        assert!(!sent[0].monosensor && !sent[0].simulated);
        assert_eq!((sent[0].plot, sent[0].composed), (None, [None; 9]));
    }

    #[test]
    fn a_track_says_of_which_plot_and_of_which_tracks_it_is() {
        let mut origins = Origins::new(vec![7, 8]);
        let plot = Plot { range_m: 14_000.0, azimuth_rad: 2.0, ..Plot::default() };
        origins.take_plots(
            &PlotsHeader { seq: 3, sectors_per_scan: 32, source_id: 3 << 8 | 4, ..PlotsHeader::default() },
            &[plot],
        );
        let mut site = site();
        site.source_id = 25 << 8 | 9;
        let mut contributors = [Contributor::default(); CONTRIBUTORS];
        contributors[0] = Contributor { id: 0x8001, site: 1, reserved: 0 };
        contributors[1] = Contributor { id: 12, site: 0, reserved: 0 };
        let system =
            system_tracks::SystemTrack { id: 0x8007, contributors, contributor_count: 2, ..Default::default() };
        origins.take_system_tracks(&SystemTracksHeader::default(), &[system]);
        let tracks = [Track { best_plot_seq: 3, best_plot_index: 0, ..track(0x8007, NOON_NS, CONFIRMED) }];
        let frames = send_with(&mut AsterixTracks::default(), &site, &origins, (&targets(&tracks), false));
        let sent = read(&frames).0[0];
        let (source, range_m, azimuth_rad) = sent.plot.expect("a plot");
        assert_eq!(source, SourceId { sac: 3, sic: 4 }, "that of the plot, and not of the site");
        assert!((range_m - 14_000.0).abs() <= 1852.0 / 512.0 && (azimuth_rad - 2.0).abs() <= 1e-4);
        let of_unit = |unit: u8, number: u16| Some(UnitTrack { unit, number });
        assert_eq!(sent.number, 7);
        assert_eq!(sent.composed[..4], [of_unit(9, 7), of_unit(8, 1), of_unit(7, 12), None]);
    }

    #[test]
    fn many_tracks_are_several_datagrams_and_impossible_ones_are_counted() {
        let mut out = AsterixTracks::default();
        let mut tracks: Vec<Track> = (0..500).map(|id| track(id, NOON_NS, CONFIRMED)).collect();
        tracks[100].state[0] = 1e9;
        let frames = send(&mut out, &site(), &targets(&tracks), false);
        let datagrams: Vec<&[u8]> = frames.iter().collect();
        assert!(datagrams.len() > 1 && datagrams.iter().all(|datagram| datagram.len() <= LARGEST));
        let (sent, _) = read(&frames);
        assert_eq!((sent.len(), out.not_said()), (499, 1));
        assert_eq!(sent.iter().map(|track| u64::from(track.number)).sum::<u64>(), (0..500).sum::<u64>() - 100);
    }

    #[test]
    fn a_turn_is_one_where_manoeuvring_models_are_probable() {
        let mut turning = track(1, NOON_NS, CONFIRMED);
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
