//! The tracks of a tracker that has died go on where it last published them: same number, state, existence and counts.
//!
//! What it knew and did not publish begins anew: each model's own state (all begin with the moments of the track), the map of false plots,
//! tentative tracks. The turns without a tracker count as turns whose results were lost: after too many of them a track ends as any other
//! does, with a last message.

use common::commands::{ACCEPTED, Command, DROP, LABEL};
use common::tracks::{Models, TERMINATED, Track};
use common::units::seconds_between;

use super::Tracker;
use super::births::Births;
use crate::association::clutter_map::OwnPlots;
use crate::association::hypotheses::Hypotheses;
use crate::beam::opportunity::{DetectionTime, Opportunity};
use crate::environment::Environment;
use crate::filter::gaussian::Gaussian;
use crate::filter::{Followed, Mixture};
use crate::tracks::amplitude::Amplitude;
use crate::tracks::life::Life;
use crate::tracks::track::{LastScan, LiveTrack};

impl Tracker {
    /// Goes on with the confirmed tracks of a tracker before, of each its last message, from the next plots on. Left are those whose numbers
    /// this tracker will give itself, those followed by another estimator, and those that lie in the future of the plots.
    pub fn take_over(&mut self, tracks: Vec<Track>) {
        self.before = tracks;
    }

    /// Makes tracks of those of the tracker before, once the first plots tell where the beam is.
    pub(super) fn go_on(&mut self, environment: &Environment, messages: &mut Vec<Track>) {
        for track in std::mem::take(&mut self.before) {
            let ahead_s = seconds_between(self.sweep.time_ns(), track.time_ns);
            let is_ours = track.id < self.next_id && track.estimator == environment.filter.estimator();
            let is_sound = track.existence > 0.0 && track.existence.is_finite() && track.snr_db.is_finite();
            if track.state_code == TERMINATED {
                messages.push(track); // dropped meanwhile
            } else if is_ours && is_sound && track.is_confirmed() && ahead_s < self.sweep.period_s() {
                self.go_on_with(&track, environment);
            }
        }
    }

    /// Carries out what an operator asks of a track that has not gone on yet; `None` if that is none of these.
    pub(super) fn carry_out_before(&mut self, command: &Command) -> Option<u32> {
        let track = self.before.iter_mut().find(|track| track.id == command.track_id && track.is_confirmed())?;
        match command.kind {
            DROP => track.state_code = TERMINATED,
            LABEL => {}
            _ => return None,
        }
        Some(ACCEPTED)
    }

    fn go_on_with(&mut self, track: &Track, environment: &Environment) {
        let Self { config, sweep, tracks, forecast, rules, births: Births { state, .. }, .. } = self;
        let moments = Gaussian::from_message(&track.state, &track.covariance);
        environment.filter.start(&Followed(moments), state);
        environment.filter.believe(&models_of(track), state);
        if !Mixture::new(environment.filter.layout(), state).is_sound() {
            return;
        }
        let (position_m, [vx, vy, _]) = (moments.position(), moments.velocity());
        let [x, y, _] = position_m;
        let angle_rad = sweep.angle_at(track.time_ns, x.atan2(y));
        let time = DetectionTime::predict([x, y], [vx, vy], track.time_ns, angle_rad, sweep);
        let range_m = moments.position().iter().map(|axis| axis * axis).sum::<f64>().sqrt();
        let here = Opportunity::at(position_m, range_m, track.time_ns, angle_rad);
        let hypotheses = Hypotheses::most(config).map(|most| tracks.hypotheses(state, most));
        let snr_db = f64::from(track.snr_db);
        let follower = LiveTrack {
            id: track.id,
            next: here,
            life: Life::before(track),
            time_ns: track.time_ns,
            angle_rad,
            searched_to_rad: angle_rad,
            // A target each, until the contrary is seen.
            scans_apart: config.confirm_hits,
            amplitude: Amplitude::before(config, &environment.detector, snr_db, track.hits),
            own_plots: OwnPlots::default(),
            last: here,
            last_scan: LastScan::EMPTY,
            hypotheses,
            duplicate_of: None,
        };
        let handle = tracks.add(follower, state);
        let place = handle.place as usize;
        if forecast.predict_one(environment, rules.alpha, tracks, place, time, sweep) {
            self.confirmed += 1;
            self.agenda.add(handle, &tracks[place].next);
            self.updates.rivals.record(place, &tracks[place]);
        } else {
            tracks.free(place);
        }
    }
}

fn models_of(track: &Track) -> Models {
    Models {
        count: track.models.into(),
        kind: track.model_kind,
        probability: track.model_probability,
        parameter: track.model_parameter,
    }
}
