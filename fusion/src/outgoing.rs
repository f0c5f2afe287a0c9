//! System tracks as messages: with their contributors, and as tracks like those of any site.

use common::geodesy::{LocalFrame, Position};
use common::system_tracks::{self, CONTRIBUTORS};
use common::tracks::{
    COASTING, CONFIRMED, ESTIMATOR_FUSION, KIND_CONSTANT_VELOCITY, KIND_MANOEUVRE, TERMINATED, Track, pack,
};

use crate::gaussian::STATE;
use crate::system::SystemTrack;

/// The centre, as positions on the earth need it.
pub(crate) struct Centre {
    frame: LocalFrame,
}

impl Centre {
    pub(crate) fn new(position: &Position) -> Self {
        Self { frame: LocalFrame::new(position) }
    }

    /// With contributors and place on the earth; `places` are those of the fused sites among the sites of the chain.
    pub(crate) fn system_track(&self, track: &SystemTrack<'_>, places: &[u32]) -> system_tracks::SystemTrack {
        let estimate = &track.estimate;
        let place = self.frame.place(estimate.position().into());
        let mut of = system_tracks::SystemTrack {
            time_ns: track.time_ns,
            id: track.id,
            latitude_deg: place.latitude_deg,
            longitude_deg: place.longitude_deg,
            height_m: place.height_m,
            manoeuvre_probability: track.manoeuvre,
            contributor_count: track.contributors.len() as u32,
            coasting: track.coasting,
            ended: u32::from(track.ended),
            ..system_tracks::SystemTrack::default()
        };
        for row in 0..STATE {
            of.state[row] = estimate.mean[row];
            for column in row..STATE {
                of.covariance[system_tracks::pack(row, column)] = estimate.covariance[(row, column)];
            }
        }
        for (place, contributor) in of.contributors.iter_mut().zip(track.contributors.iter().take(CONTRIBUTORS)) {
            *place =
                system_tracks::Contributor { id: contributor.id, site: places[contributor.site as usize], reserved: 0 };
        }
        of
    }
}

/// As a track like that of any site: all that reads tracks reads fused ones.
pub(crate) fn track(track: &SystemTrack<'_>) -> Track {
    let (estimate, place) = (&track.estimate, |i: usize| 3 * (i % 3) + i / 3);
    let mut of = Track {
        time_ns: track.time_ns,
        id: track.id,
        existence: 1.0,
        state_code: match (track.ended, track.contributors.is_empty()) {
            (true, _) => TERMINATED,
            (false, true) => COASTING,
            (false, false) => CONFIRMED,
        },
        estimator: ESTIMATOR_FUSION,
        known: STATE as u8,
        models: 2,
        misses: track.coasting,
        ..Track::EMPTY
    };
    (of.model_kind[0], of.model_kind[1]) = (KIND_CONSTANT_VELOCITY, KIND_MANOEUVRE);
    (of.model_probability[0], of.model_probability[1]) = (1.0 - track.manoeuvre, track.manoeuvre);
    for row in 0..STATE {
        of.state[place(row)] = estimate.mean[row];
        for column in row..STATE {
            of.covariance[pack(place(row), place(column))] = estimate.covariance[(row, column)];
        }
    }
    (of.model_state, of.model_covariance) = (of.state, of.covariance);
    (of.predicted_state, of.predicted_covariance) = (of.state, of.covariance);
    of
}
