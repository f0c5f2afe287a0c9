//! `outliers`: measurements of one radar with wrong elevations, judged by the classic rule and channel by channel (F4).
//!
//! ```text
//! right                share of the measurements whose elevation is kept if it is good, and thrown away if it is not
//! right_later          the same of the looks from the eleventh on
//! good_kept, bad_kept  the same of good and of bad ones alone
//! range_azimuth_kept   share of the measurements whose range and azimuth are kept: they are always good
//! ```

mod page;

use common::random::{Purpose, generator};
use fusion::outliers::{Channels, Classic, Coordinates, Limits};
use fusion::simulation::normal;
use fusion::simulation::scenarios::DEGREE;
use nalgebra::Vector3;
use rand::RngExt;

use crate::parallel::runs;
use crate::{Case, Options, Progress, Results, Row};

/// Measurements of a run, and the time between two, s.
const LOOKS: u32 = 30;
const PERIOD_S: f64 = 5.0;
/// Looks after which the cluster of the target has had time to become the fullest.
const EARLY: usize = 10;
/// What is known of targets and radar.
const LIMITS: Limits = Limits { speed_mps: 1000.0, sigma: [50.0, 0.1 * DEGREE, 0.1 * DEGREE], forget_s: 60.0 };
/// Shares of measurements with a wrong elevation.
const SHARES: [f64; 3] = [0.1, 0.2, 0.3];
/// Right decisions by share at regular outliers in straight flight, of an independent program.
const REFERENCES: [(Rule, [f64; 3]); 2] =
    [(Rule::Classic, [0.931, 0.868, 0.754]), (Rule::Channels, [0.988, 0.984, 0.976])];

/// Greatest elevation of a random outlier, rad.
const HIGHEST_RAD: f64 = 0.8;

/// How elevations are wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Wrong {
    /// Twice what they are: they look like a target of their own.
    Regular,
    /// Anything.
    Random,
}

/// How the target flies.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Flight {
    Straight,
    /// In circles from a third of the run on, at 2 g.
    Turning,
}

/// Who decides.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rule {
    Classic,
    Channels,
}

const CASES: [(Flight, Wrong); 4] = [
    (Flight::Straight, Wrong::Regular),
    (Flight::Straight, Wrong::Random),
    (Flight::Turning, Wrong::Regular),
    (Flight::Turning, Wrong::Random),
];

impl Rule {
    const ALL: [Self; 2] = [Self::Classic, Self::Channels];

    fn name(self) -> &'static str {
        match self {
            Self::Classic => "classic",
            Self::Channels => "channels",
        }
    }
}

impl Flight {
    fn name(self) -> &'static str {
        match self {
            Self::Straight => "straight",
            Self::Turning => "turning",
        }
    }
}

impl Wrong {
    fn name(self) -> &'static str {
        match self {
            Self::Regular => "regular",
            Self::Random => "random",
        }
    }
}

/// A measurement.
struct Look {
    time_s: f64,
    measured: Coordinates,
    is_bad: bool,
}

/// Decisions of one run.
#[derive(Debug, Default, Clone, Copy)]
struct Decisions {
    good: [u64; 2],
    bad: [u64; 2],
    range_azimuth: [u64; 2],
    /// Right ones of the later looks.
    later: [u64; 2],
}

/// Runs the experiment: 2000 runs of each case.
///
/// # Errors
/// Never.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(2000, 5);
    progress.expect((CASES.len() * SHARES.len()) as u64 * u64::from(runs_of_each));
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    for (flight, wrong) in CASES {
        for (place, share) in SHARES.into_iter().enumerate() {
            progress.say(format!("{}, {} outliers", flight.name(), wrong.name()));
            let decisions = runs(options.threads, runs_of_each, progress, |run| {
                let looks = looks(flight, wrong, share, options.seed, run);
                Rule::ALL.map(|rule| judge(rule, &looks))
            });
            for (index, rule) in Rule::ALL.into_iter().enumerate() {
                let case = Case::new()
                    .with("flight", flight.name())
                    .with("outliers", wrong.name())
                    .with("share", share)
                    .with("rule", rule.name());
                let row = |metric, of: fn(&Decisions) -> [u64; 2]| {
                    let clusters: Vec<[u64; 2]> = decisions.iter().map(|of_run| of(&of_run[index])).collect();
                    Row::clustered(&case, metric, &clusters)
                };
                let mut right = row("right", |of| [of.good[0] + of.bad[1] - of.bad[0], of.good[1] + of.bad[1]]);
                if (flight, wrong) == CASES[0]
                    && let Some((_, values)) = REFERENCES.iter().find(|(of, _)| *of == rule)
                {
                    right = right.against(values[place], "an independent program");
                }
                results.rows.extend([
                    right,
                    row("right_later", |of| of.later),
                    row("good_kept", |of| of.good),
                    row("bad_kept", |of| of.bad),
                    row("range_azimuth_kept", |of| of.range_azimuth),
                ]);
            }
        }
    }
    results.blocks = page::blocks(&results.rows);
    Ok(results)
}

/// What a radar measures of an aircraft that passes at 70 km.
fn looks(flight: Flight, wrong: Wrong, share: f64, seed: u64, run: u32) -> Vec<Look> {
    let mut rng = generator(seed, Purpose::Measurement, run, 0);
    let mut position_m = Vector3::new(60_000.0, 50_000.0, 9000.0);
    let mut velocity_mps = Vector3::new(-220.0, 90.0, 0.0);
    let mut looks = Vec::new();
    let mut now_s = 0.0;
    for look in 0..LOOKS {
        let time_s = f64::from(look) * PERIOD_S + 0.1 * normal(&mut rng);
        let dt_s = time_s - now_s;
        if flight == Flight::Turning && look > LOOKS / 3 {
            let turned_rad: f64 = 20.0 / velocity_mps.norm() * dt_s;
            velocity_mps = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), -turned_rad) * velocity_mps;
        }
        position_m += velocity_mps * dt_s;
        now_s = time_s;
        let ground_m = position_m.xy().norm();
        let truth = [position_m.norm(), position_m.x.atan2(position_m.y), position_m.z.atan2(ground_m)];
        let mut measured = truth;
        let is_bad = rng.random::<f64>() < share;
        if is_bad {
            measured[2] = match wrong {
                Wrong::Regular => 2.0 * truth[2],
                Wrong::Random => rng.random_range(0.0..HIGHEST_RAD),
            };
        }
        for (value, sigma) in measured.iter_mut().zip(LIMITS.sigma) {
            *value += sigma * normal(&mut rng);
        }
        looks.push(Look { time_s, measured, is_bad });
    }
    looks
}

fn judge(rule: Rule, looks: &[Look]) -> Decisions {
    let (mut classic, mut channels) = (Classic::new(LIMITS), Channels::new(LIMITS));
    let mut decisions = Decisions::default();
    for (index, look) in looks.iter().enumerate() {
        let kept = match rule {
            Rule::Classic => [classic.keeps(look.time_s, look.measured); 3],
            Rule::Channels => channels.keeps(look.time_s, look.measured),
        };
        let of = if look.is_bad { &mut decisions.bad } else { &mut decisions.good };
        of[0] += u64::from(kept[2]);
        of[1] += 1;
        decisions.range_azimuth[0] += u64::from(kept[0] && kept[1]);
        decisions.range_azimuth[1] += 1;
        if index >= EARLY {
            decisions.later[0] += u64::from(kept[2] != look.is_bad);
            decisions.later[1] += 1;
        }
    }
    decisions
}
