//! Plots that several tracks could have caused: joint events without coalescence, of targets that the radar may not resolve.
//!
//! With g_σm = r_σ D p_σm λ_m/ρ_m the likelihood ratio of "plot m is track σ's" to "it is false", and b_σ = 1 − r_σ D, a joint event
//! gives every track a plot of its own, one that it has in common with one other track, or none. Its weight is the product of
//! ```text
//! g_σm, b_σ      for plots of one track each, and for none
//! u_στ c_στm     for a plot that two tracks have in common: they were not resolved           ([`crate::association::resolution`])   (J1)
//! 1 − u_στ       for every other pair; (1 − u_στ) b_σ b_τ + u_στ min(b_σ, b_τ) if both have none              (J2)
//! ```
//! To track τ a plot is worth
//! ```text
//! share_m = [Σ events with τ → m] / g_τm  :  [Σ events with τ → none] / b_τ                                 (J3)
//! ```
//! of what it would be worth to τ alone, and the scan as a whole speaks for τ by [Σ all events] : [Σ events without τ]. Of the events
//! in which the same tracks are detected by the same plots, only the best permutation counts: without that, PDA draws tracks of near
//! targets together (Blom & Bloem 2000, JPDA*).
//!
//! Only plots that τ itself could have caused take part, and what a rival finds elsewhere counts as none: so events
//! stay few. The predictions of all tracks are those before the scan, and what is known of those updated by one message is
//! what was known before it, so the order of processing does not matter.
//!
//! All weights are logarithms: the λ of a strong plot is as large as a number can be, and a product of some of them larger.

use common::amplitude::TargetStatistics;

use crate::association::FalsePlots;
use crate::association::hypotheses::ln_sum;
use crate::association::resolution::Place;
use crate::association::rivals::MOST_NEAR;
use crate::filter::{Densities, Evidence, Expectation, Group, LANES, Layout, Machine, Prior, expect};
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;

/// Plots in the windows of a track and its rivals that there is room for from the start: their number varies by chance.
const ROOM: usize = 128;
/// Rivals that are taken into account at once: those that claim most.
const MOST_RIVALS: usize = 3;
/// Tracks of an event.
const MOST_TRACKS: usize = 1 + MOST_RIVALS;
/// Plots that are shared out at once: those that are most probably τ's.
const MOST_PLOTS: usize = 8;
/// "No plot" among the indices of shared plots.
const NONE: u8 = MOST_PLOTS as u8;
/// g below which a plot is not τ's.
const LEAST_RATIO: f64 = 1e-3;
/// A share is at least this: too little for a plot of the largest λ ([`common::amplitude::MAX_RATIO`]) to count, and more than
/// nothing, so that what the plot would be worth without rivals can still be told from the product.
pub const LEAST_SHARE: f64 = 1e-300;

/// A track that wants plots.
#[derive(Debug, Clone, Copy)]
pub struct Claimant<'a> {
    /// What it expects of this scan: u*, P*, W*.
    pub prediction: &'a [f64],
    /// When, ns UTC.
    pub time_ns: u64,
    /// r.
    pub existence: f64,
    /// D.
    pub detection_probability: f64,
    /// Statistics of its power; without, or where they are not used, λ = 1.
    pub target: Option<&'a TargetStatistics>,
    /// Whether it has been seen apart from all others: two such tracks may have a plot in common. Others may be one target.
    pub seen_apart: bool,
}

/// A plot of two targets as what it says of τ alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Common {
    /// Index of the plot.
    pub plot: usize,
    /// What it measures of τ, (J4).
    pub measurement: Measurement,
    /// What that is worth, as a plot's share.
    pub share: f64,
}

/// What the plots offered to a track are worth to it.
#[derive(Debug, Clone, Copy)]
pub struct Shared<'a> {
    /// By plot; empty where no rival is concerned.
    pub shares: &'a [f64],
    /// Plots that it may have in common with a rival.
    pub common: &'a [Common],
    /// What evidence for the track is to be multiplied by: [Σ events with τ → none]/b_τ : [Σ events without τ].
    pub evidence: f64,
    /// The largest probability that a rival, if it exists, is not resolved from it.
    pub unresolved: f64,
}

/// Room for sharing out plots, reused.
#[derive(Debug)]
pub struct Sharing {
    /// What the tracks expect, and the densities of the plots under it.
    views: Views,
    /// What the plots are to the track at hand.
    offers: Vec<Offer>,
    /// Indices of the plots that are shared out.
    wanted: Vec<usize>,
    /// τ first.
    claims: Vec<Claim>,
    events: Vec<Event>,
    shares: Vec<f64>,
    common: Vec<Common>,
}

/// A plot to one track.
#[derive(Debug, Clone, Copy)]
struct Offer {
    /// ln g.
    ln_ratio: f64,
    /// ln (D λ/ρ).
    ln_power: f64,
}

/// What one track has to do with the plots that are shared out.
#[derive(Debug, Clone, Copy)]
struct Claim {
    existence: f64,
    seen_apart: bool,
    place: Place,
    /// b.
    missed: f64,
    /// ln b, what it finds elsewhere included.
    ln_none: f64,
    /// By wanted plot.
    offers: [Offer; MOST_PLOTS],
    /// With each track before it.
    together: [Together; MOST_TRACKS],
}

/// Two tracks that may be one plot.
#[derive(Debug, Clone, Copy)]
struct Together {
    /// u; 0 for tracks that have no plot in common.
    unresolved: f64,
    /// ln (u c) by wanted plot.
    ln_common: [f64; MOST_PLOTS],
}

/// A joint event.
#[derive(Debug, Clone, Copy)]
struct Event {
    ln_weight: f64,
    /// Sets of the tracks that have a plot, and of the plots.
    detected: u32,
    plots: u32,
    /// Plot of each track.
    taken: [u8; MOST_TRACKS],
}

/// What up to eight tracks expect, τ in the first lane, and the densities of plots under it.
#[derive(Debug)]
struct Views {
    prediction: Group,
    expected: Vec<Expectation>,
    evidence: Evidence,
    densities: Densities,
    machine: Machine,
    inflation: f64,
}

impl Views {
    /// Densities of `plots` under each of `claimants`.
    fn look(&mut self, claimants: &[Claimant<'_>], plots: &[Measurement]) {
        let Self { prediction, expected, evidence, densities, .. } = self;
        evidence.clear(prediction.layout().len());
        for plot in plots {
            for (lane, claimant) in claimants.iter().enumerate() {
                let offset_s = common::units::seconds_between(claimant.time_ns, plot.time_ns);
                evidence.add(lane, plot, offset_s, 1.0);
            }
        }
        let prior = Prior { prediction, expected, inflation: self.inflation };
        densities.evaluate(self.machine, claimants.len(), prior, evidence);
    }

    /// ln Σ_j W*_j N(y_m; h_j, D_j) of plot `m` in `lane`.
    fn ln_density(&self, m: usize, lane: usize) -> f64 {
        let components = 0..self.prediction.layout().len();
        ln_sum(components.map(|j| self.prediction.weight(j, lane).ln() + self.densities.ln(m, j, lane)))
    }

    /// Where the track in `lane` is expected.
    fn place(&self, lane: usize) -> Place {
        Place::new(&self.prediction, &self.expected, lane)
    }
}

impl Sharing {
    /// Room for states of a form.
    pub fn new(layout: &Layout, machine: Machine, inflation: f64) -> Self {
        Self {
            views: Views {
                prediction: Group::new(layout),
                expected: Vec::new(),
                evidence: Evidence::with_room(ROOM),
                densities: Densities::with_room(ROOM * layout.len()),
                machine,
                inflation,
            },
            offers: Vec::with_capacity(ROOM * (1 + MOST_NEAR)),
            wanted: Vec::with_capacity(ROOM),
            claims: Vec::with_capacity(1 + MOST_NEAR),
            events: Vec::with_capacity(4096),
            shares: Vec::with_capacity(ROOM),
            common: Vec::with_capacity(MOST_PLOTS * MOST_RIVALS),
        }
    }
}

const _: () = assert!(MOST_NEAR < LANES);

impl Sharing {
    /// Computes with other instructions.
    pub fn on(&mut self, machine: Machine) {
        self.views.machine = machine;
    }

    /// What each of `plots` is worth to `own` among `rivals`, of which those beyond [`MOST_NEAR`] do not count.
    pub fn share<'a>(
        &mut self,
        own: &Claimant<'_>,
        rivals: impl Iterator<Item = Claimant<'a>>,
        plots: &[Measurement],
        clutter: impl Fn(&Measurement) -> FalsePlots,
        radar: &Radar,
    ) -> Shared<'_> {
        self.shares.clear();
        self.common.clear();
        let mut claimants = [*own; 1 + MOST_NEAR];
        let mut count = 1;
        for rival in rivals.take(MOST_NEAR) {
            claimants[count] = rival;
            count += 1;
        }
        if count == 1 {
            return Shared { shares: &self.shares, common: &self.common, evidence: 1.0, unresolved: 0.0 };
        }
        let claimants = &claimants[..count];
        for (lane, claimant) in claimants.iter().enumerate() {
            self.views.prediction.load(lane, claimant.prediction);
        }
        let Views { prediction, expected, machine, .. } = &mut self.views;
        expect(*machine, count, radar, 1.0, prediction, expected);
        self.views.look(claimants, plots);
        let unresolved = self.claim(claimants, plots, &clutter, radar);
        let mut evidence = 1.0;
        if self.claims.len() > 1 {
            self.put_together(plots, radar);
            self.events.clear();
            let nobody = Event { ln_weight: 0.0, detected: 0, plots: 0, taken: [NONE; MOST_TRACKS] };
            extend(&self.claims, self.wanted.len(), nobody, 0, &mut self.events);
            keep_best_permutations(&mut self.events);
            evidence = self.weigh(own, plots, &clutter, radar);
        }
        Shared { shares: &self.shares, common: &self.common, evidence, unresolved }
    }

    /// Fills `claims` with τ and the rivals that claim most, if τ wants any plot. Returns the largest probability that a rival is not
    /// resolved from it.
    fn claim(
        &mut self,
        claimants: &[Claimant<'_>],
        plots: &[Measurement],
        clutter: &impl Fn(&Measurement) -> FalsePlots,
        radar: &Radar,
    ) -> f64 {
        let Self { views, offers, wanted, claims, .. } = self;
        let offer = |lane: usize, (m, plot): (usize, &Measurement)| {
            claimants[lane].offer(views.ln_density(m, lane), plot, clutter(plot))
        };
        offers.clear();
        offers.extend(plots.iter().enumerate().map(|plot| offer(0, plot)));
        wanted.clear();
        wanted.extend((0..plots.len()).filter(|&m| offers[m].ln_ratio > LEAST_RATIO.ln()));
        wanted.sort_unstable_by(|&a, &b| offers[b].ln_ratio.total_cmp(&offers[a].ln_ratio).then(a.cmp(&b)));
        wanted.truncate(MOST_PLOTS);
        let own = views.place(0);
        claims.clear();
        claims.push(Claim::new(&claimants[0], own, offers, wanted));
        let mut unresolved = 0.0_f64;
        for (lane, rival) in claimants.iter().enumerate().skip(1) {
            let place = views.place(lane);
            unresolved = unresolved.max(own.unresolved(&place, radar));
            if wanted.is_empty() {
                continue;
            }
            offers.clear();
            offers.extend(plots.iter().enumerate().map(|plot| offer(lane, plot)));
            let claim = Claim::new(rival, place, offers, wanted);
            if claim.strength() > LEAST_RATIO {
                claims.push(claim);
            }
        }
        claims[1..].sort_unstable_by(|a, b| b.strength().total_cmp(&a.strength()));
        claims.truncate(MOST_TRACKS);
        unresolved
    }

    /// What the tracks may have in common.
    fn put_together(&mut self, plots: &[Measurement], radar: &Radar) {
        for second in 1..self.claims.len() {
            for first in 0..second {
                let (a, b) = (&self.claims[first], &self.claims[second]);
                if a.seen_apart && b.seen_apart {
                    self.claims[second].together[first] = Together::new(a, b, plots, &self.wanted, radar);
                }
            }
        }
    }

    /// Sums events up to shares.
    fn weigh(
        &mut self,
        tau: &Claimant<'_>,
        plots: &[Measurement],
        clutter: &impl Fn(&Measurement) -> FalsePlots,
        radar: &Radar,
    ) -> f64 {
        let Self { views, wanted, claims, events, shares, common, .. } = self;
        let own = &claims[0];
        let sum = |of: &dyn Fn(&Event) -> Option<f64>| ln_sum(events.iter().filter_map(of));
        let ln_taking = |plot: usize, with: Option<usize>| {
            sum(&|event| (event.taken[0] == plot as u8 && event.partner(0) == with).then_some(event.ln_weight))
        };
        let ln_none = sum(&|event| (event.taken[0] == NONE).then_some(event.ln_weight)) - own.ln_none;
        let ln_without = sum(&|event| {
            let pairs = || (1..claims.len()).map(|other| apart(claims, event, 0, other)).sum::<f64>();
            (event.taken[0] == NONE).then(|| event.ln_weight - own.ln_none - pairs())
        });
        let ln_total = sum(&|event| Some(event.ln_weight));
        shares.resize(plots.len(), 1.0);
        for (index, &plot) in wanted.iter().enumerate() {
            let share = (ln_taking(index, None) - own.offers[index].ln_ratio - ln_none).exp();
            shares[plot] = if share.is_finite() { share.max(LEAST_SHARE) } else { 1.0 };
            for (rival, claim) in
                claims.iter().enumerate().skip(1).filter(|(_, claim)| claim.together[0].unresolved > 0.0)
            {
                let ln_weight = ln_taking(index, Some(rival));
                if ln_weight - ln_total < LEAST_RATIO.ln() {
                    continue;
                }
                let measurement = own.place.of_common(&claim.place, &plots[plot], radar);
                views.look(std::slice::from_ref(tau), std::slice::from_ref(&measurement));
                let offer = tau.offer(views.ln_density(0, 0), &measurement, clutter(&measurement));
                let share = (ln_weight - offer.ln_ratio - ln_none).exp();
                if share > 0.0 && share.is_finite() {
                    common.push(Common { plot, measurement, share });
                }
            }
        }
        (ln_none - ln_without).exp()
    }
}

impl Claimant<'_> {
    /// What a plot of density exp(`ln_density`) is to it among false plots `here`.
    fn offer(&self, ln_density: f64, plot: &Measurement, here: FalsePlots) -> Offer {
        let ratio = match self.target {
            Some(target) if plot.has_power => target.likelihood_ratio_among(plot.power, here.power),
            _ => 1.0,
        };
        let ln_power = (self.detection_probability * ratio / here.density).ln();
        Offer { ln_ratio: ln_density + ln_power + self.existence.ln(), ln_power }
    }
}

impl Claim {
    fn new(claimant: &Claimant<'_>, place: Place, all: &[Offer], wanted: &[usize]) -> Self {
        let mut offers = [Offer { ln_ratio: f64::NEG_INFINITY, ln_power: f64::NEG_INFINITY }; MOST_PLOTS];
        for (own, &plot) in offers.iter_mut().zip(wanted) {
            *own = all[plot];
        }
        let missed = 1.0 - claimant.existence * claimant.detection_probability;
        let elsewhere =
            all.iter().enumerate().filter(|(plot, _)| !wanted.contains(plot)).map(|(_, offer)| offer.ln_ratio);
        Self {
            existence: claimant.existence,
            seen_apart: claimant.seen_apart,
            place,
            missed,
            ln_none: ln_sum(elsewhere.chain([missed.ln()])),
            offers,
            together: [Together::NEVER; MOST_TRACKS],
        }
    }

    /// How probably it takes one of the plots that are shared out.
    fn strength(&self) -> f64 {
        1.0 / (1.0 + (self.ln_none - ln_sum(self.offers.iter().map(|offer| offer.ln_ratio))).exp())
    }
}

impl Together {
    const NEVER: Self = Self { unresolved: 0.0, ln_common: [f64::NEG_INFINITY; MOST_PLOTS] };

    /// (J1). Both targets together are at least as strong as the stronger.
    fn new(a: &Claim, b: &Claim, plots: &[Measurement], wanted: &[usize], radar: &Radar) -> Self {
        let existence = a.existence * b.existence;
        let mut together = Self { unresolved: existence * a.place.unresolved(&b.place, radar), ..Self::NEVER };
        for (index, &plot) in wanted.iter().enumerate() {
            let ln_power = a.offers[index].ln_power.max(b.offers[index].ln_power);
            together.ln_common[index] =
                existence.ln() + ln_power + a.place.ln_common_density(&b.place, &plots[plot], radar);
        }
        together
    }
}

impl Event {
    /// The track with which a track has its plot in common.
    fn partner(&self, track: usize) -> Option<usize> {
        let plot = self.taken[track];
        (0..MOST_TRACKS).find(|&other| other != track && plot != NONE && self.taken[other] == plot)
    }
}

/// All events of the tracks from `track` on, appended to what `event` says of those before.
fn extend(claims: &[Claim], plots: usize, event: Event, track: usize, events: &mut Vec<Event>) {
    let Some(claim) = claims.get(track) else {
        let pairs = (1..claims.len()).flat_map(|b| (0..b).map(move |a| apart(claims, &event, a, b)));
        events.push(Event { ln_weight: event.ln_weight + pairs.sum::<f64>(), ..event });
        return;
    };
    extend(claims, plots, Event { ln_weight: event.ln_weight + claim.ln_none, ..event }, track + 1, events);
    for plot in 0..plots {
        let ln_weight = if event.plots & (1 << plot) == 0 {
            claim.offers[plot].ln_ratio
        } else {
            match (0..track).find(|&other| event.taken[other] == plot as u8) {
                Some(other) if event.partner(other).is_none() => {
                    claim.together[other].ln_common[plot] - claims[other].offers[plot].ln_ratio
                }
                _ => continue,
            }
        };
        if ln_weight > f64::NEG_INFINITY {
            let mut taken = event.taken;
            taken[track] = plot as u8;
            let next = Event {
                ln_weight: event.ln_weight + ln_weight,
                detected: event.detected | 1 << track,
                plots: event.plots | 1 << plot,
                taken,
            };
            extend(claims, plots, next, track + 1, events);
        }
    }
}

/// ln of what two tracks' not having a plot in common is worth (J2).
fn apart(claims: &[Claim], event: &Event, first: usize, second: usize) -> f64 {
    let u = claims[second].together[first].unresolved;
    if u <= 0.0 || (event.taken[first] != NONE && event.taken[first] == event.taken[second]) {
        return 0.0;
    }
    let neither = event.taken[first] == NONE && event.taken[second] == NONE;
    let together = if neither { u / claims[first].missed.max(claims[second].missed) } else { 0.0 };
    (1.0 - u + together).ln()
}

/// Of events with the same tracks and the same plots only the one of the largest weight.
fn keep_best_permutations(events: &mut Vec<Event>) {
    let key = |event: &Event| (event.detected, event.plots);
    events.sort_unstable_by(|a, b| {
        key(a).cmp(&key(b)).then(b.ln_weight.total_cmp(&a.ln_weight)).then(a.taken.cmp(&b.taken))
    });
    events.dedup_by(|next, kept| key(next) == key(kept));
}
