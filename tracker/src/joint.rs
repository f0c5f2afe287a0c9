//! Plots that several tracks could have caused: joint events without coalescence.
//!
//! With g_σm = r_σ D p_σm λ_m/ρ_m the likelihood ratio of "plot m is track σ's" to "it is false", and b_σ = 1 − r_σ D, a joint event
//! gives every track a plot of its own or none; its weight is the product of g and b. To track τ a plot is worth
//! ```text
//! share_m = [Σ events with τ → m] / g_τm  :  [Σ events with τ → none] / b_τ
//! ```
//! of what it would be worth to τ alone. Of the events in which the same tracks are detected by the same plots, only the best
//! permutation counts: without that, PDA draws tracks of near targets together (Blom & Bloem 2000, JPDA*).
//!
//! Only plots that τ itself could have caused take part, and what a rival finds elsewhere counts as none: so events
//! stay few. The predictions of all tracks are those before the scan, and what is known of those updated by one message is
//! what was known before it, so the order of processing does not matter.
//!
//! All weights are logarithms: the λ of a strong plot is as large as a number can be, and a product of some of them larger.

use std::f64::consts::TAU;

use common::amplitude::TargetStatistics;

use crate::association::FalsePlots;
use crate::gate::Radar;
use crate::hypotheses::ln_sum;
use crate::imm::Imm;
use crate::measurement::{COORDINATES, Expected, Measurement};
use crate::motion::{CONSTANT_VELOCITY, MODES};
use crate::neighbours::Neighbours;
use crate::track::{LiveTrack, Passage};

/// Rivals that are taken into account at once: those that claim most.
const MOST_RIVALS: usize = 3;
/// Rivals that are asked what they claim: the nearest.
const MOST_NEAR: usize = 6;
/// Plots that are shared out at once: those that are most probably τ's.
const MOST_PLOTS: usize = 8;
/// g below which a plot is not τ's.
const LEAST_RATIO: f64 = 1e-3;
/// A share is at least this: too little for a plot of the largest λ ([`common::amplitude::MAX_RATIO`]) to count, and more than
/// nothing, so that what the plot would be worth without rivals can still be told from the product.
pub const LEAST_SHARE: f64 = 1e-300;
/// Tracks nearer than this may want the same plots, cells of range.
const RIVAL_CELLS: f64 = 5.0;
/// Passages nearer than this belong to the same turn, turns.
const RIVAL_TURNS: f64 = 0.4;

/// A track that wants plots.
#[derive(Debug, Clone, Copy)]
pub struct Claimant<'a> {
    /// What it expects of this turn.
    pub prediction: &'a Imm,
    /// When, ns UTC.
    pub time_ns: u64,
    /// r.
    pub existence: f64,
    /// D.
    pub detection_probability: f64,
    /// Statistics of its power; without, λ = 1.
    pub target: Option<&'a TargetStatistics>,
}

/// Room for sharing out plots, reused.
#[derive(Debug, Default)]
pub struct Sharing {
    /// ln g of the plots at hand, of the track at hand.
    ln_ratios: Vec<f64>,
    /// Indices of the plots that are shared out.
    wanted: Vec<usize>,
    claims: Vec<Claim>,
    events: Vec<Event>,
}

/// What one track has to do with the plots that are shared out.
#[derive(Debug, Clone, Copy)]
struct Claim {
    /// ln b, what it finds elsewhere included.
    ln_none: f64,
    /// ln g by wanted plot.
    ln_ratio: [f64; MOST_PLOTS],
}

/// A joint event: which tracks are detected, by which plots, and what τ gets.
#[derive(Debug, Clone, Copy)]
struct Event {
    detected: u32,
    plots: u32,
    ln_weight: f64,
    /// Index of τ's plot; `MOST_PLOTS` for none.
    own: usize,
}

impl Sharing {
    /// Appends to `shares` what each of `plots` is worth to `own` among `rivals`; nothing where no rival is concerned.
    pub fn share<'a>(
        &mut self,
        own: &Claimant<'_>,
        rivals: impl Iterator<Item = Claimant<'a>>,
        plots: &[Measurement],
        clutter: impl Fn(&[f64; COORDINATES]) -> FalsePlots,
        inflation: f64,
        shares: &mut Vec<f64>,
    ) {
        let mut rivals = rivals.peekable();
        if plots.is_empty() || rivals.peek().is_none() {
            return;
        }
        own.ln_ratios(plots, &clutter, inflation, &mut self.ln_ratios);
        self.wanted.clear();
        self.wanted.extend((0..plots.len()).filter(|&m| self.ln_ratios[m] > LEAST_RATIO.ln()));
        let by_own = &self.ln_ratios;
        self.wanted.sort_unstable_by(|&a, &b| by_own[b].total_cmp(&by_own[a]).then(a.cmp(&b)));
        self.wanted.truncate(MOST_PLOTS);
        if self.wanted.is_empty() {
            return;
        }
        self.claims.clear();
        self.claims.push(Claim::new(own, &self.ln_ratios, &self.wanted));
        for rival in rivals {
            rival.ln_ratios(plots, &clutter, inflation, &mut self.ln_ratios);
            let claim = Claim::new(&rival, &self.ln_ratios, &self.wanted);
            if claim.strength() > LEAST_RATIO {
                self.claims.push(claim);
            }
        }
        if self.claims.len() < 2 {
            return;
        }
        self.claims[1..].sort_unstable_by(|a, b| b.strength().total_cmp(&a.strength()));
        self.claims.truncate(1 + MOST_RIVALS);
        self.events.clear();
        let nobody = Event { detected: 0, plots: 0, ln_weight: 0.0, own: MOST_PLOTS };
        extend(&self.claims, self.wanted.len(), nobody, 0, &mut self.events);
        keep_best_permutations(&mut self.events);
        let own = self.claims[0];
        let ln_weight_of = |plot: usize| {
            ln_sum(self.events.iter().filter(move |event| event.own == plot).map(|event| event.ln_weight))
        };
        let ln_none = ln_weight_of(MOST_PLOTS) - own.ln_none;
        let first = shares.len();
        shares.resize(first + plots.len(), 1.0);
        for (index, &plot) in self.wanted.iter().enumerate() {
            let share = (ln_weight_of(index) - own.ln_ratio[index] - ln_none).exp();
            shares[first + plot] = if share.is_finite() { share.max(LEAST_SHARE) } else { 1.0 };
        }
    }
}

impl Claimant<'_> {
    /// ln g of every plot.
    fn ln_ratios(
        &self,
        plots: &[Measurement],
        clutter: &impl Fn(&[f64; COORDINATES]) -> FalsePlots,
        inflation: f64,
        ln_ratios: &mut Vec<f64>,
    ) {
        let expected: [Expected; MODES] = std::array::from_fn(|j| Expected::new(j, &self.prediction.modes[j]));
        ln_ratios.clear();
        ln_ratios.extend(plots.iter().map(|plot| {
            let offset_s = common::units::seconds_between(self.time_ns, plot.time_ns);
            let mut ln_densities = [f64::NEG_INFINITY; MODES];
            for (j, expected) in expected.iter().enumerate() {
                if let Some(likelihood) = expected.likelihood(plot, inflation) {
                    let d = expected.innovation(plot, offset_s);
                    ln_densities[j] =
                        self.prediction.probability[j].ln() + likelihood.ln_density(d, likelihood.solve(d));
                }
            }
            let here = clutter(&plot.polar);
            let ratio = match self.target {
                Some(target) if plot.has_power => target.likelihood_ratio_in_clutter(plot.power, here.mean_excess),
                _ => 1.0,
            };
            ln_sum(ln_densities.into_iter()) + (self.existence * self.detection_probability * ratio / here.density).ln()
        }));
    }
}

impl Claim {
    fn new(claimant: &Claimant<'_>, ln_ratios: &[f64], wanted: &[usize]) -> Self {
        let mut ln_ratio = [f64::NEG_INFINITY; MOST_PLOTS];
        for (own, &plot) in ln_ratio.iter_mut().zip(wanted) {
            *own = ln_ratios[plot];
        }
        let missed = (1.0 - claimant.existence * claimant.detection_probability).ln();
        let elsewhere =
            ln_ratios.iter().enumerate().filter(|(plot, _)| !wanted.contains(plot)).map(|(_, ln_ratio)| *ln_ratio);
        Self { ln_none: ln_sum(elsewhere.chain([missed])), ln_ratio }
    }

    /// How probably it takes one of the plots that are shared out.
    fn strength(&self) -> f64 {
        1.0 / (1.0 + (self.ln_none - ln_sum(self.ln_ratio.into_iter())).exp())
    }
}

/// All events of the tracks from `track` on, appended to what `event` says of those before.
fn extend(claims: &[Claim], plots: usize, event: Event, track: usize, events: &mut Vec<Event>) {
    let Some(claim) = claims.get(track) else {
        events.push(event);
        return;
    };
    extend(claims, plots, Event { ln_weight: event.ln_weight + claim.ln_none, ..event }, track + 1, events);
    for plot in (0..plots).filter(|plot| event.plots & (1 << plot) == 0 && claim.ln_ratio[*plot] > f64::NEG_INFINITY) {
        let next = Event {
            detected: event.detected | 1 << track,
            plots: event.plots | 1 << plot,
            ln_weight: event.ln_weight + claim.ln_ratio[plot],
            own: if track == 0 { plot } else { event.own },
        };
        extend(claims, plots, next, track + 1, events);
    }
}

/// Of events with the same tracks and the same plots only the one of the largest weight.
fn keep_best_permutations(events: &mut Vec<Event>) {
    let key = |event: &Event| (event.detected, event.plots);
    events
        .sort_unstable_by(|a, b| key(a).cmp(&key(b)).then(b.ln_weight.total_cmp(&a.ln_weight)).then(a.own.cmp(&b.own)));
    events.dedup_by(|next, kept| key(next) == key(kept));
}

/// The confirmed tracks, by where they are and were expected.
#[derive(Debug, Default)]
pub struct Rivals(Neighbours);

impl Rivals {
    /// Takes the tracks as they are.
    pub fn build(&mut self, tracks: &[LiveTrack], radar: &Radar) {
        let confirmed = tracks.iter().zip(0..).filter(|(track, _)| track.life.is_confirmed());
        let places = confirmed.flat_map(|(track, index): (_, u32)| {
            [(place(&track.next), 2 * index), (place(&track.last), 2 * index + 1)]
        });
        self.0.build(RIVAL_CELLS * radar.cell[0], places);
    }

    /// The nearest confirmed tracks that may want the same plots as track `index` in this turn, with what they expect of it.
    pub fn of<'a>(
        &self,
        index: usize,
        tracks: &'a [LiveTrack],
        radar: &Radar,
    ) -> impl Iterator<Item = (&'a LiveTrack, &'a Passage)> {
        let own = &tracks[index].next;
        let reach_m = RIVAL_CELLS * radar.cell[0];
        let centre = place(own);
        let mut nearest = [None::<(f64, &LiveTrack, &Passage)>; MOST_NEAR];
        for label in self.0.near(centre) {
            let track = &tracks[label as usize / 2];
            let passages = [&track.next, &track.last];
            let of_this_turn = |passage: &&Passage| (passage.angle_rad - own.angle_rad).abs() < RIVAL_TURNS * TAU;
            if track.id == tracks[index].id || passages.iter().position(of_this_turn) != Some(label as usize % 2) {
                continue;
            }
            let expects = passages[label as usize % 2];
            let position = place(expects);
            let square: f64 = (0..3).map(|axis| (position[axis] - centre[axis]).powi(2)).sum();
            if square >= reach_m * reach_m {
                continue;
            }
            let nearer = |other: &Option<(f64, &LiveTrack, &Passage)>| {
                other.is_some_and(|(least, other, _)| least.total_cmp(&square).then(other.id.cmp(&track.id)).is_lt())
            };
            let rank = nearest.partition_point(nearer);
            if rank < MOST_NEAR {
                nearest[rank..].rotate_right(1);
                nearest[rank] = Some((square, track, expects));
            }
        }
        nearest.into_iter().flatten().map(|(_, track, expects)| (track, expects))
    }
}

fn place(passage: &Passage) -> [f64; 3] {
    passage.prediction.modes[CONSTANT_VELOCITY].position()
}
