//! Parameters learnt from plots alone, without truth, by maximum likelihood (ML1)-(ML4) of `docs/theory/tuning.md`.
//!
//! ```text
//! plots ─▶ tracker ─▶ ways: the plots of each confirmed track ─▶ likelihood of each plot given those before it
//!             ▲                                                        │ greatest: search
//!             └──────────────── parameters ◀───────────────────────────┘ until they stay
//! ```
//!
//! The estimate depends on the messages and the configuration alone: no clock, thread or random number.

mod likelihood;
mod parameter;
mod search;
mod ways;

use common::config::{ConfigError, TrackerConfig};
use common::plots::{Plot, PlotsHeader};

pub use parameter::{ERRORS, Parameter};
pub use ways::Counts;

use likelihood::{GROUPS, Likelihood};
use ways::Ways;

/// Most rounds of association and search.
const ROUNDS: u32 = 6;
/// Parameters stay if none changes by more than this, as a natural logarithm.
const SAME: f64 = 0.02;
/// First extent of a search, and of one again from near its end, as natural logarithms.
const STEP: f64 = 0.3;
const AGAIN: f64 = 0.1;
/// Most plots by which parameters are judged; tracks are taken from all over the recording.
const MOST_PLOTS: usize = 5000;
/// Fewest plots of tracks that can tell anything.
const FEWEST_PLOTS: usize = 50;
/// A standard error above this, as a natural logarithm, says that the recording does not tell.
const TOLD: f64 = 0.7;

/// One plots message after the other, as recorded.
pub type Messages = [(PlotsHeader, Vec<Plot>)];

/// An estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learnt {
    /// The most likely value.
    pub value: f64,
    /// Its standard error, in the unit of the value.
    pub error: f64,
}

/// One parameter of the likelihood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Which.
    pub parameter: Parameter,
    /// What the configuration says; 1 of the errors that plots state.
    pub before: f64,
    /// What the recording says; `None` if it does not tell.
    pub learnt: Option<Learnt>,
}

/// All that a recording has taught.
#[derive(Debug, Clone, PartialEq)]
pub struct Lesson {
    /// Errors of plots and motion of targets.
    pub found: Vec<Found>,
    /// Share of detection opportunities of confirmed tracks with a plot.
    pub detection_probability: Option<Learnt>,
    /// False plots per resolution cell and scan, over what the plots reach.
    pub clutter: Option<Learnt>,
    /// Over Poisson's variance, that of the numbers of false plots in ranges and azimuths: 1 if they lie evenly.
    pub clutter_dispersion: Option<f64>,
    /// What was counted in the last round.
    pub counts: Counts,
    /// Plots by which parameters were judged.
    pub plots: usize,
    /// Rounds until the parameters stayed, or [`None`] if they did not.
    pub rounds: Option<u32>,
}

impl Lesson {
    /// Errors and motion, if they have settled.
    fn settled(&self) -> impl Iterator<Item = (Parameter, Learnt)> {
        let found = self.found.iter().filter(|_| self.rounds.is_some());
        found.filter_map(|found| Some((found.parameter, found.learnt?)))
    }

    /// A configuration with what the recording tells. Parameters that have not settled stay as they are.
    #[must_use]
    pub fn applied_to(&self, config: &TrackerConfig) -> TrackerConfig {
        let mut config = config.clone();
        for (parameter, learnt) in self.settled() {
            parameter.set(&mut config, learnt.value);
        }
        if let Some(share) = self.detection_probability {
            config.detection_probability = allowed(share.value);
        }
        config
    }

    /// Factors on the errors that plots state: range, azimuth, elevation; 1 where the recording does not tell, or they have not settled.
    pub fn scales(&self) -> [f64; ERRORS] {
        let mut scales = [1.0; ERRORS];
        for (parameter, learnt) in self.settled() {
            if let Parameter::Error(axis) = parameter {
                scales[axis] = learnt.value;
            }
        }
        scales
    }
}

/// A probability of detection that the tracker takes.
pub fn allowed(share: f64) -> f64 {
    share.clamp(0.05, 0.999)
}

/// Why nothing can be learnt.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// The configuration is not valid.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Too little to learn from.
    #[error(
        "{found} plots of confirmed tracks, expected at least {FEWEST_PLOTS}: a longer recording, or another [tracker]"
    )]
    TooFew {
        /// Plots of confirmed tracks.
        found: usize,
    },
    /// The plots are impossible with the configuration: nothing can be searched from there.
    #[error(
        "the tracks of the recording are impossible with the configured motion: expected another `[tracker]` to begin with"
    )]
    Impossible,
}

/// Learns from recordings of one radar, each a run of its own. `say` is told of each round in a line.
///
/// # Errors
/// [`TuneError`].
pub fn learn(
    recordings: &[&Messages],
    config: &TrackerConfig,
    mut say: impl FnMut(String),
) -> Result<Lesson, TuneError> {
    let parameters = parameter::of(config, has_elevation(recordings));
    let start: Vec<f64> = parameters.iter().map(|parameter| parameter.place_of(parameter.value(config))).collect();
    let mut tuned = config.clone();
    let mut point = start.clone();
    // Those that the recordings turn out not to tell keep the value of the configuration, and the others are searched again.
    let mut free: Vec<usize> = (0..parameters.len()).collect();
    let (mut round, mut since) = (0, 0);
    loop {
        (round, since) = (round + 1, since + 1);
        let ways = Ways::of(recordings, &tuned, parameter::scales(&parameters, &point))?;
        let likelihood = Likelihood::new(&ways, MOST_PLOTS);
        if likelihood.plots() < FEWEST_PLOTS {
            return Err(TuneError::TooFew { found: likelihood.plots() });
        }
        let all = |of_free: &[f64]| {
            let mut point = start.clone();
            free.iter().zip(of_free).for_each(|(&index, &at)| point[index] = at);
            point
        };
        let judge = |of_free: &[f64], without: Option<usize>| {
            let point = all(of_free);
            let at = parameter::with(config, &parameters, &point);
            let is_possible = at.check().is_ok()
                && start.iter().zip(&point).all(|(start, now)| (now - start).abs() <= parameter::FARTHEST)
                && parameter::is_told_apart(&at, config, ways.period_s);
            let scales = parameter::scales(&parameters, &point);
            if is_possible { likelihood.of(&at, scales, without) } else { f64::NEG_INFINITY }
        };
        let begin: Vec<f64> = free.iter().map(|&index| point[index]).collect();
        let of = |of_free: &[f64]| judge(of_free, None);
        if !of(&begin).is_finite() {
            return Err(TuneError::Impossible);
        }
        let found = search::greatest(&begin, STEP, of);
        let moved = begin.iter().zip(&found).map(|(before, now)| (now - before).abs()).fold(0.0, f64::max);
        point = all(&found);
        tuned = parameter::with(config, &parameters, &point);
        let share = ways.counts.detection_probability();
        tuned.detection_probability = allowed(share.map_or(config.detection_probability, |share| share.value));
        let (plots, tracks) = (likelihood.plots(), ways.all.len());
        say(format!("round {round}: {plots} plots of {tracks} tracks, largest change {:.1} %", 100.0 * moved));
        if moved >= SAME && since < ROUNDS {
            continue;
        }
        let errors = search::errors(&found, of);
        let is_told = |error: &Option<f64>| error.is_some_and(|error| error < TOLD);
        if !errors.iter().all(is_told) {
            let told = free.iter().zip(&errors).filter(|(_, error)| is_told(error)).map(|(&index, _)| index).collect();
            free = told;
            point =
                (0..start.len()).map(|index| if free.contains(&index) { point[index] } else { start[index] }).collect();
            // Tracks are made anew with the values that count.
            let share = tuned.detection_probability;
            tuned = parameter::with(config, &parameters, &point);
            tuned.detection_probability = share;
            since = 0;
            continue;
        }
        say("errors: the search again without each eighth of the tracks".into());
        let without: Vec<Vec<f64>> = (0..if likelihood.ways() < 2 * GROUPS { 0 } else { GROUPS })
            .map(|group| search::greatest(&found, AGAIN, |at| judge(at, Some(group))))
            .collect();
        let learnt = |index: usize| {
            let place = free.iter().position(|&free| free == index)?;
            let error = errors[place]?.max(jackknife(without.iter().map(|found| found[place])));
            let (parameter, at) = (parameters[index], point[index]);
            Some(Learnt { value: parameter.value_at(at), error: error * parameter.slope(at) })
        };
        let found = parameters.iter().enumerate().map(|(index, parameter)| Found {
            parameter: *parameter,
            before: parameter.value(config),
            learnt: learnt(index),
        });
        return Ok(Lesson {
            found: found.collect(),
            detection_probability: share,
            clutter: ways.counts.clutter(),
            clutter_dispersion: ways.counts.clutter_dispersion(),
            plots,
            counts: ways.counts,
            rounds: (moved < SAME).then_some(round),
        });
    }
}

/// Standard error by estimates each of which one group was left out of (ML2); 0 without any.
fn jackknife(estimates: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let groups = estimates.len() as f64;
    let mean = estimates.clone().sum::<f64>() / groups;
    let squares: f64 = estimates.map(|estimate| (estimate - mean).powi(2)).sum();
    if groups > 0.0 { ((groups - 1.0) / groups * squares).sqrt() } else { 0.0 }
}

fn has_elevation(recordings: &[&Messages]) -> bool {
    recordings.iter().flat_map(|messages| messages.iter()).any(|(header, _)| header.cell_elevation_rad > 0.0)
}
