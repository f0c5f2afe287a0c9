//! The marine radar of a ferry, and two boats with satellite receivers: five scenarios, ten legs of a boat.
//!
//! ```text
//! covered    from the first plot within 25 m of the boat that has another one in the next two scans
//! followed   a confirmed track within 25 m, one to one
//! delay      scans from the begin of coverage to the first one followed; the whole leg where it never is
//! false      a confirmed track that is not within 50 m of a boat; moving: over 1 m/s over ground
//! GOSPA      c = 40 m, p = 2; near: only tracks within 60 m of a boat
//! ```
//!
//! Plots are older than the time stamp of their scan. The lag is estimated on all other scenarios than the scored one, as that part of
//! the distances from boats to their plots which lies along the course:
//!
//! ```text
//! L = − Σ (plot − boat)·v / Σ v²
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::Context;
use common::config::{ChainConfig, TrackerConfig};
use common::tracks::{TERMINATED, Track};
use common::truth::TruthTarget;
use common::units::{NS_PER_S, seconds_between};
use evaluation::following::pair;
use evaluation::gospa::gospa;
use evaluation::identity::Holder;
use plot_source::Source;
use plot_source::scan_lines::ScanLines;
use tracker::Tracker;
use tracker::tuning::learn;

use super::{FERRY, case, figure, preset, trackers};
use crate::parallel::runs;
use crate::{Options, Progress, Results, Row};

const PRESET: &str = include_str!("../../../config/ferry.toml");
const RECORDING: &str = include_str!("../../../config/data/ferry-radar.jsonl");

const FOLLOWED_M: f64 = 25.0;
const NEAR_M: f64 = 60.0;
const FALSE_M: f64 = 50.0;
const MOVING_MPS: f64 = 1.0;
const CUTOFF_M: f64 = 40.0;
const ORDER: f64 = 2.0;
/// Scans after the first plot of a boat in which there has to be another one.
const CONFIRMED_BY: usize = 2;
/// A track that was not reported for so many scans has ended.
const FORGOTTEN_SCANS: f64 = 2.5;
/// Steps of the estimate of the lag: each pairs plots and boats anew.
const LAG_STEPS: u32 = 8;

/// The preset with what `radar-chain tune` learns of the other scenarios.
const LEARNT: &str = "preset, learnt from the others";

type Place = [f64; 2];

/// One scenario.
struct Scene {
    text: String,
    lines: ScanLines,
    /// Positions of each boat about the radar.
    boats: Vec<Vec<TruthTarget>>,
}

/// A boat in a scenario.
#[derive(Debug, Default, Clone)]
struct Leg {
    covered: f64,
    followed: f64,
    changes: f64,
    delay_scans: f64,
    squares_m2: f64,
}

/// All tracks in a scenario.
#[derive(Debug, Default, Clone)]
struct Scored {
    legs: Vec<Leg>,
    scans: f64,
    outside: f64,
    outside_moving: f64,
    moving_tracks: f64,
    gospa_near_m: f64,
    gospa_all_m: f64,
}

pub(super) fn run(options: &Options, progress: &Progress, results: &mut Results) -> anyhow::Result<()> {
    let chain = preset("config/ferry.toml", PRESET)?;
    let all = scenes()?;
    let scenes = options.some_of(&all.iter().collect::<Vec<_>>());
    let lags: Vec<f64> = (0..scenes.len()).map(|without| lag_without(&scenes, without)).collect();
    let trackers = trackers(&chain.tracker, options);
    progress.expect(((2 * trackers.len() + 1) * scenes.len()) as u64);
    for (name, config) in &trackers {
        progress.say(format!("{FERRY}, {name}"));
        let follow = |lag: fn(f64) -> f64| -> anyhow::Result<Vec<Scored>> {
            let of = |run: u32| follow(&chain, config, scenes[run as usize], lag(lags[run as usize]));
            runs(options.threads, scenes.len() as u32, progress, of).into_iter().collect()
        };
        let as_stamped = follow(|_| 0.0)?;
        let registered = follow(|lag_s| lag_s)?;
        rows(name, options.seed, &as_stamped, &registered, &mut results.rows);
    }
    let learnt = |run: u32| learnt_without(&chain, &scenes, run as usize);
    progress.say(format!("{FERRY}, {LEARNT}"));
    let learnt: Vec<ChainConfig> =
        runs(options.threads, scenes.len() as u32, progress, learnt).into_iter().collect::<anyhow::Result<_>>()?;
    let follow = |lag: fn(f64) -> f64| -> anyhow::Result<Vec<Scored>> {
        let pieces = scenes.iter().zip(&lags).zip(&learnt);
        pieces.map(|((scene, &lag_s), chain)| follow(chain, &chain.tracker, scene, lag(lag_s))).collect()
    };
    rows(LEARNT, options.seed, &follow(|_| 0.0)?, &follow(|lag_s| lag_s)?, &mut results.rows);
    results.rows.push(Row::new(
        &case(FERRY, "lag"),
        "plot_lag_s",
        figure(&lags, options.seed, mean_of(|lag: &f64| *lag)),
    ));
    Ok(())
}

fn rows(name: &str, seed: u64, as_stamped: &[Scored], registered: &[Scored], rows: &mut Vec<Row>) {
    let case = case(FERRY, name);
    let legs: Vec<Leg> = as_stamped.iter().flat_map(|scored| scored.legs.clone()).collect();
    let with_lag: Vec<Leg> = registered.iter().flat_map(|scored| scored.legs.clone()).collect();
    let share = |legs: &[Leg]| figure(legs, seed, ratio(|leg: &Leg| leg.followed, |leg| leg.covered));
    let rms =
        |legs: &[Leg]| figure(legs, seed, |legs| ratio(|leg: &Leg| leg.squares_m2, |leg| leg.followed)(legs).sqrt());
    let median = |legs: &[&Leg]| {
        let mut delays: Vec<f64> = legs.iter().map(|leg| leg.delay_scans).collect();
        delays.sort_by(f64::total_cmp);
        0.5 * (delays[(delays.len() - 1) / 2] + delays[delays.len() / 2])
    };
    let per_scan = |of: fn(&Scored) -> f64| figure(as_stamped, seed, ratio(of, |scored| scored.scans));
    let total = |of: fn(&Scored) -> f64| figure(as_stamped, seed, move |all| all.iter().map(|scored| of(scored)).sum());
    for (metric, estimate) in [
        ("followed", share(&legs)),
        ("changes", figure(&legs, seed, |legs| legs.iter().map(|leg| leg.changes).sum())),
        ("delay_scans", figure(&legs, seed, mean_of(|leg: &Leg| leg.delay_scans))),
        ("delay_median_scans", figure(&legs, seed, median)),
        ("rms_m", rms(&legs)),
        ("false_per_scan", per_scan(|scored| scored.outside)),
        ("moving_false_per_scan", per_scan(|scored| scored.outside_moving)),
        ("moving_false_tracks", total(|scored| scored.moving_tracks)),
        ("gospa_near_m", per_scan(|scored| scored.gospa_near_m)),
        ("gospa_all_m", per_scan(|scored| scored.gospa_all_m)),
        ("boat_scans", figure(&legs, seed, |legs| legs.iter().map(|leg| leg.covered).sum())),
        ("followed_registered", share(&with_lag)),
        ("rms_registered_m", rms(&with_lag)),
    ] {
        rows.push(Row::new(&case, metric, estimate));
    }
}

fn ratio<T>(above: impl Fn(&T) -> f64, below: impl Fn(&T) -> f64) -> impl Fn(&[&T]) -> f64 {
    move |all| all.iter().map(|one| above(one)).sum::<f64>() / all.iter().map(|one| below(one)).sum::<f64>()
}

fn mean_of<T>(of: impl Fn(&T) -> f64) -> impl Fn(&[&T]) -> f64 {
    ratio(of, |_| 1.0)
}

/// The scenarios of the recording, one after the other.
fn scenes() -> anyhow::Result<Vec<Scene>> {
    let mut texts: BTreeMap<u32, String> = BTreeMap::new();
    for line in RECORDING.lines() {
        let scans = ScanLines::of(line.as_bytes()).context("a scan of the ferry's recording")?;
        let text = texts.entry(scans.scans[0].scenario.unwrap_or(0)).or_default();
        text.push_str(line);
        text.push('\n');
    }
    let scene = |text: String| {
        let lines = ScanLines::of(text.as_bytes()).context("a scenario of the ferry's recording")?;
        let mut boats: BTreeMap<u32, Vec<TruthTarget>> = BTreeMap::new();
        for boat in lines.truth(f64::INFINITY) {
            boats.entry(boat.target_id).or_default().push(boat);
        }
        Ok(Scene { text, boats: boats.into_values().collect(), lines })
    };
    texts.into_values().map(scene).collect()
}

/// Where a boat was at a time, on the straight line between the nearest two of its positions, and its velocity.
fn boat_at(boat: &[TruthTarget], time_ns: i64) -> (Place, Place) {
    let next = boat.partition_point(|fix| fix.time_ns as i64 <= time_ns).clamp(1, boat.len() - 1);
    let (before, after) = (&boat[next - 1], &boat[next]);
    let step_s = seconds_between(before.time_ns, after.time_ns);
    let since_s = (time_ns - before.time_ns as i64) as f64 / NS_PER_S;
    let (from, to) = (before.position_m(), after.position_m());
    let velocity = [0, 1].map(|axis| (to[axis] - from[axis]) / step_s);
    ([0, 1].map(|axis| from[axis] + velocity[axis] * since_s), velocity)
}

fn distance_m(a: Place, b: Place) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl Scene {
    /// Plots of a scan about the radar, m east and north.
    fn plots(&self, scan: usize) -> impl Iterator<Item = Place> {
        let place = |(range_m, azimuth_rad): (f64, f64)| [range_m * azimuth_rad.sin(), range_m * azimuth_rad.cos()];
        self.lines.scans[scan].polar().map(place)
    }

    /// When the plots of a scan were measured, if they lag their time stamp by `lag_s`.
    fn time_ns(&self, scan: usize, lag_s: f64) -> i64 {
        self.lines.scans[scan].time_ns() - (lag_s * NS_PER_S) as i64
    }

    /// The scan from which a boat is covered; the plots count as stamped.
    fn covered_from(&self, boat: &[TruthTarget]) -> usize {
        let scans = self.lines.scans.len();
        let sees = |scan: usize| {
            let (place, _) = boat_at(boat, self.time_ns(scan, 0.0));
            self.plots(scan).any(|plot| distance_m(plot, place) <= FOLLOWED_M)
        };
        let seen: Vec<bool> = (0..scans).map(sees).collect();
        let has_another = |scan: usize| seen.iter().skip(scan + 1).take(CONFIRMED_BY).any(|&seen| seen);
        (0..scans).find(|&scan| seen[scan] && has_another(scan)).unwrap_or(scans)
    }

    /// Velocity of the radar over ground, m/s east and north.
    fn own_velocity(&self, scan: usize) -> Place {
        let last = self.lines.scans.len() - 1;
        let [from_s, to_s] = [scan.saturating_sub(1), (scan + 1).min(last)]
            .map(|scan| self.lines.scans[scan].time_ns() as f64 / NS_PER_S);
        let (from, to) = (self.lines.own_ship_ne_m(from_s), self.lines.own_ship_ne_m(to_s));
        [(to[1] - from[1]) / (to_s - from_s), (to[0] - from[0]) / (to_s - from_s)]
    }
}

/// The lag of plots behind their time stamps by all scenarios but one, s.
fn lag_without(scenes: &[&Scene], without: usize) -> f64 {
    let mut lag_s = 0.0;
    for _ in 0..LAG_STEPS {
        let (mut along, mut squares) = (0.0, 0.0);
        for scene in scenes.iter().enumerate().filter(|&(index, _)| index != without).map(|(_, scene)| scene) {
            for (scan, boat) in
                (0..scene.lines.scans.len()).flat_map(|scan| scene.boats.iter().map(move |boat| (scan, boat)))
            {
                let (place, velocity) = boat_at(boat, scene.time_ns(scan, lag_s));
                let nearest = scene.plots(scan).min_by(|a, b| distance_m(*a, place).total_cmp(&distance_m(*b, place)));
                if let Some(plot) = nearest.filter(|plot| distance_m(*plot, place) <= FOLLOWED_M) {
                    along += (plot[0] - place[0]) * velocity[0] + (plot[1] - place[1]) * velocity[1];
                    squares += velocity[0] * velocity[0] + velocity[1] * velocity[1];
                }
            }
        }
        lag_s -= along / squares;
    }
    lag_s
}

/// The chain with what the plots of all scenarios but one teach, without truth.
fn learnt_without(chain: &ChainConfig, scenes: &[&Scene], without: usize) -> anyhow::Result<ChainConfig> {
    let others = scenes.iter().enumerate().filter(|&(index, _)| index != without);
    let messages = others.map(|(_, scene)| {
        let source = Source::decode(chain, (Path::new("ferry"), scene.text.as_bytes()), None)?;
        Ok(source.flat_map(|scan| scan.plots).collect::<Vec<_>>())
    });
    let messages = messages.collect::<anyhow::Result<Vec<_>>>()?;
    let recordings: Vec<_> = messages.iter().map(Vec::as_slice).collect();
    let lesson = learn(&recordings, &chain.tracker, |_| {})?;
    let mut chain = ChainConfig { tracker: lesson.applied_to(&chain.tracker), ..chain.clone() };
    let [range, azimuth, _] = lesson.scales();
    chain.plot_source.sigma_range_m *= range;
    chain.plot_source.sigma_azimuth_deg *= azimuth;
    Ok(chain)
}

/// Runs a tracker over a scenario, with its plots taken to be `lag_s` older than they are stamped, and scores it.
fn follow(chain: &ChainConfig, config: &TrackerConfig, scene: &Scene, lag_s: f64) -> anyhow::Result<Scored> {
    let mut chain = ChainConfig { tracker: config.clone(), ..chain.clone() };
    chain.plot_source.registration.plot_lag_s = lag_s;
    let source = Source::decode(&chain, (Path::new("ferry"), scene.text.as_bytes()), None)?;
    anyhow::ensure!(
        source.scans() as usize == scene.lines.scans.len(),
        "a scan of the ferry's recording is not a turn"
    );
    let mut tracker = Tracker::new(&chain.tracker, 1)?;
    let mut alive: BTreeMap<u64, Track> = BTreeMap::new();
    let mut score = Score::new(scene);
    let mut tracks = Vec::new();
    for (scan, messages) in source.enumerate() {
        for (header, plots) in &messages.plots {
            tracker.process_plots(header, plots, &mut tracks);
            for track in &tracks {
                if track.state_code == TERMINATED {
                    alive.remove(&track.id);
                } else if track.is_confirmed() {
                    alive.insert(track.id, *track);
                }
            }
        }
        let now_ns = scene.time_ns(scan, lag_s);
        let age_s = |track: &Track| (now_ns - track.time_ns as i64) as f64 / NS_PER_S;
        alive.retain(|_, track| age_s(track) < FORGOTTEN_SCANS * chain.plot_source.scan_period_s);
        let confirmed: Vec<Moving> = alive
            .values()
            .map(|track| {
                let ([x, y, _], [vx, vy, _]) = (track.position_m(), track.velocity_mps());
                Moving { id: track.id, place: [x + vx * age_s(track), y + vy * age_s(track)], velocity: [vx, vy] }
            })
            .collect();
        score.take(scan, now_ns, &confirmed);
    }
    Ok(score.finish())
}

/// A confirmed track at the time of a scan.
struct Moving {
    id: u64,
    place: Place,
    velocity: Place,
}

/// The score of a scenario while its scans pass.
struct Score<'a> {
    scene: &'a Scene,
    covered_from: Vec<usize>,
    holders: Vec<Holder<u64>>,
    first_followed: Vec<Option<usize>>,
    moving: BTreeSet<u64>,
    scored: Scored,
}

impl<'a> Score<'a> {
    fn new(scene: &'a Scene) -> Self {
        let boats = scene.boats.len();
        Self {
            scene,
            covered_from: scene.boats.iter().map(|boat| scene.covered_from(boat)).collect(),
            holders: vec![Holder::default(); boats],
            first_followed: vec![None; boats],
            moving: BTreeSet::new(),
            scored: Scored { legs: vec![Leg::default(); boats], ..Scored::default() },
        }
    }

    fn take(&mut self, scan: usize, now_ns: i64, tracks: &[Moving]) {
        let boats: Vec<Place> = self.scene.boats.iter().map(|boat| boat_at(boat, now_ns).0).collect();
        let distances = |tracks: &[&Moving]| -> Vec<(usize, usize, f64)> {
            let of = |(boat, place): (usize, &Place)| {
                let each =
                    tracks.iter().enumerate().map(move |(track, it)| (boat, track, distance_m(*place, it.place)));
                each.collect::<Vec<_>>()
            };
            boats.iter().enumerate().flat_map(of).collect()
        };
        let nearest_m =
            |track: &Moving| boats.iter().map(|boat| distance_m(*boat, track.place)).fold(f64::INFINITY, f64::min);
        let all: Vec<&Moving> = tracks.iter().collect();
        let near: Vec<&Moving> = tracks.iter().filter(|track| nearest_m(track) <= NEAR_M).collect();
        let score = |tracks: &[&Moving]| gospa(boats.len(), tracks.len(), &distances(tracks), CUTOFF_M, ORDER).distance;
        let between = distances(&all);
        let pairing =
            pair(boats.len(), all.len(), &between, FOLLOWED_M, |boat, track| self.holders[boat].is(&all[track].id));
        self.scored.scans += 1.0;
        self.scored.gospa_near_m += score(&near);
        self.scored.gospa_all_m += score(&all);
        let own = self.scene.own_velocity(scan);
        for track in tracks.iter().filter(|track| nearest_m(track) > FALSE_M) {
            self.scored.outside += 1.0;
            if (track.velocity[0] + own[0]).hypot(track.velocity[1] + own[1]) > MOVING_MPS {
                self.scored.outside_moving += 1.0;
                self.moving.insert(track.id);
            }
        }
        for (boat, place) in boats.iter().enumerate().filter(|&(boat, _)| scan >= self.covered_from[boat]) {
            let leg = &mut self.scored.legs[boat];
            leg.covered += 1.0;
            if let Some(track) = pairing.track_of[boat] {
                leg.followed += 1.0;
                leg.squares_m2 += distance_m(*place, all[track].place).powi(2);
                leg.changes += f64::from(u8::from(self.holders[boat].follow(all[track].id)));
                self.first_followed[boat].get_or_insert(scan);
            }
        }
    }

    fn finish(mut self) -> Scored {
        for (boat, leg) in self.scored.legs.iter_mut().enumerate() {
            let from = self.covered_from[boat];
            leg.delay_scans = self.first_followed[boat].map_or(leg.covered, |first| (first - from) as f64);
        }
        Scored { moving_tracks: self.moving.len() as f64, ..self.scored }
    }
}
