//! Predictions for the next detection opportunity, and the messages of tracks, for up to eight tracks at once.

use common::tracks::Track;

use crate::association::gate::Gate;
use crate::beam::opportunity::{DetectionTime, Opportunity};
use crate::beam::sweep::Sweep;
use crate::environment::Environment;
use crate::filter::{Expectation, Group, Layout, Moments, Row, expect};
use crate::tracks::message;
use crate::tracks::states::Of;
use crate::tracks::store::TrackStore;

/// Room for predictions and messages, reused.
#[derive(Debug)]
pub(super) struct Forecast {
    /// Posteriors that are not at hand, loaded.
    posterior: Group,
    prediction: Group,
    expected: Vec<Expectation>,
    /// Of the posteriors and of the predictions before.
    moments: [Moments; 2],
}

impl Forecast {
    pub(super) fn new(layout: &Layout) -> Self {
        Self {
            posterior: Group::new(layout),
            prediction: Group::new(layout),
            expected: Vec::new(),
            moments: Default::default(),
        }
    }

    /// Predicts `posterior` to the times of its lanes; `take` gets each lane's opportunity, and the prediction if it is sound.
    pub(super) fn predict(
        &mut self,
        environment: &Environment,
        alpha: f64,
        posterior: &Group,
        times: &[DetectionTime],
        sweep: &Sweep,
        mut take: impl FnMut(usize, Opportunity, Option<&Group>),
    ) {
        let Self { prediction, expected, .. } = self;
        let Environment { filter, machine, radar, .. } = environment;
        let mut step_s = Row::ZERO;
        for (lane, time) in times.iter().enumerate() {
            step_s.0[lane] = time.step_s();
        }
        filter.predict(*machine, times.len(), posterior, &step_s, prediction);
        expect(*machine, times.len(), radar, alpha, prediction, expected);
        let sound = prediction.soundness(*machine, times.len());
        let reference = prediction.layout().reference;
        for (lane, time) in times.iter().enumerate() {
            let gates = expected.iter().map(|expected| Gate::new(expected, lane, alpha));
            let position_m = [0, 1, 2].map(|axis| prediction.mean(reference, axis, lane));
            let next = Opportunity::new(time, position_m, gates, sweep);
            take(lane, next, (sound.0[lane] > 0.0).then_some(&*prediction));
        }
    }

    /// Predicts the track at a place from what the store knows of it. Returns whether the prediction is sound.
    pub(super) fn predict_one(
        &mut self,
        environment: &Environment,
        alpha: f64,
        tracks: &mut TrackStore,
        place: usize,
        time: DetectionTime,
        sweep: &Sweep,
    ) -> bool {
        let mut posterior = std::mem::replace(&mut self.posterior, Group::EMPTY);
        posterior.load(0, tracks.states.posterior_mut(place));
        let mut sound = false;
        self.predict(environment, alpha, &posterior, &[time], sweep, |lane, next, prediction| {
            tracks[place].next = next;
            if let Some(prediction) = prediction {
                prediction.store(lane, tracks.states.prediction_mut(place, Of::NextScan));
                sound = true;
            }
        });
        self.posterior = posterior;
        sound
    }

    /// Appends the message of the track at a place from what the store knows of it.
    pub(super) fn tell(
        &mut self,
        environment: &Environment,
        tracks: &TrackStore,
        place: usize,
        messages: &mut Vec<Track>,
    ) {
        let Self { posterior, prediction, moments: [of_posterior, of_prediction], .. } = self;
        let Environment { filter, machine, .. } = environment;
        let track = &tracks[place];
        let state = tracks.states.posterior(place);
        prediction.load(0, tracks.states.prediction_words(place, Of::LastScan));
        posterior.load(0, tracks.states.posterior_words(place));
        for (moments, group) in [(&mut *of_posterior, &*posterior), (&mut *of_prediction, &*prediction)] {
            moments.evaluate(*machine, 1, group);
        }
        for (moments, state) in
            [(&mut *of_posterior, state), (&mut *of_prediction, tracks.states.prediction(place, Of::LastScan))]
        {
            let mut all = moments.gaussian(0);
            filter.complete(state, None, &mut all);
            moments.set(0, &all);
        }
        message::push(messages, track, filter.as_ref(), state, [of_posterior, of_prediction], 0);
        if let Some(message) = messages.last_mut() {
            let component = state.most_probable();
            let mut likeliest = state.gaussian(component);
            filter.complete(state, Some(component), &mut likeliest);
            message.model_covariance = likeliest.to_message().1;
        }
    }
}

/// When the beam meets a target again whose mean position and velocity (east and north) are in `lane`.
pub(super) fn next_detection(
    moments: &Moments,
    lane: usize,
    time_ns: u64,
    angle_rad: f64,
    sweep: &Sweep,
) -> DetectionTime {
    let of = |i: usize| moments.mean[i].0[lane];
    DetectionTime::predict([of(0), of(1)], [of(3), of(4)], time_ns, angle_rad, sweep)
}
