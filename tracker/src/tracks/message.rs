//! The message of a track.

use common::tracks::{PACKED, STATE, Track};

use super::track::LiveTrack;
use crate::filter::gaussian::{MESSAGE_ORDER, message_index};
use crate::filter::{Filter, Mixture, Moments};

/// Where each element of a packed covariance goes in a message.
const COVARIANCE_ORDER: [usize; PACKED] = covariance_order();

const fn covariance_order() -> [usize; PACKED] {
    let mut order = [0; PACKED];
    let (mut index, mut column) = (0, 0);
    while column < STATE {
        let mut row = 0;
        while row <= column {
            order[index] = message_index(row, column);
            index += 1;
            row += 1;
        }
        column += 1;
    }
    order
}

/// Appends the message of a track: `lane` of the moments of its posterior and of its last prediction.
pub fn push(
    messages: &mut Vec<Track>,
    track: &LiveTrack,
    filter: &dyn Filter,
    state: Mixture<'_>,
    moments: [&Moments; 2],
    lane: usize,
) {
    let (models, likeliest) = (filter.models(state), state.most_probable());
    // Written in place: a message is 1.7 kB.
    messages.push(Track::EMPTY);
    let Some(message) = messages.last_mut() else { return };
    message.time_ns = track.time_ns;
    message.id = track.id;
    message.model_probability = models.probability;
    message.model_parameter = models.parameter;
    message.existence = track.life.existence;
    message.gate_volume = track.last_scan.gate_volume;
    message.weight_none = track.last_scan.weight_none;
    message.weight_best = track.last_scan.weight_best;
    message.best_plot_seq = track.last_scan.best_plot.0;
    message.best_plot_index = track.last_scan.best_plot.1;
    message.plots_in_gate = track.last_scan.plots_in_gate;
    message.state_code = track.life.state;
    message.gate_code = track.last_scan.gate_code;
    message.age_scans = track.life.age;
    message.hits = track.life.hits;
    message.misses = track.life.misses;
    message.snr_db = track.amplitude.snr_db() as f32;
    message.model_kind = models.kind;
    message.estimator = filter.estimator();
    message.known = filter.layout().most_known() as u8;
    message.models = models.count as u8;
    message.used = track.last_scan.used;
    let [posterior, prediction] = moments;
    for i in 0..STATE {
        message.state[MESSAGE_ORDER[i]] = posterior.mean[i].0[lane];
        message.predicted_state[MESSAGE_ORDER[i]] = prediction.mean[i].0[lane];
    }
    for (k, &place) in COVARIANCE_ORDER.iter().enumerate() {
        message.covariance[place] = posterior.covariance[k].0[lane];
        message.predicted_covariance[place] = prediction.covariance[k].0[lane];
    }
    for (value, &place) in state.mean(likeliest).iter().zip(&MESSAGE_ORDER) {
        message.model_state[place] = *value;
    }
    for (value, &place) in state.covariance(likeliest).iter().zip(&COVARIANCE_ORDER) {
        message.model_covariance[place] = *value;
    }
}
