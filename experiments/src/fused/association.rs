//! Which local tracks become part of which system track (F5), and what biases (F7), wrong coordinates and formations (F9) do to it.
//!
//! ```text
//! systems_per_target       system tracks alive at the end over targets
//! perfect                  share of the targets whose system track has the tracks of all radars and no other
//! wrong_attachments        share of the attached local tracks that are of another target
//! residual_…               rms over radars of what remains of the biases
//! ```

use common::random::{Purpose, generator};
use fusion::registration::Bias;
use fusion::simulation::scenarios::{DEGREE, EQUAL, usual_bias};
use fusion::simulation::{Outcome, Radar, Scenario, World, normal};
use fusion::{Fusion, Settings, Site};

use crate::parallel::runs;
use crate::{Case, Options, Progress, Results, Row};

const CYCLES: u32 = 60;
const SETTLED: u32 = 30;

/// What is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Setting {
    /// What is looked at.
    pub(super) part: &'static str,
    pub(super) radars: usize,
    pub(super) targets: usize,
    /// Whether radars have biases.
    biased: bool,
    /// Whether biases are estimated.
    pub(super) registered: bool,
    /// Standard deviation of each horizontal coordinate of the radars, m.
    pub(super) misplaced_m: f64,
}

const NETWORK: Setting =
    Setting { part: "registration", radars: 3, targets: 200, biased: true, registered: true, misplaced_m: 0.0 };
const LARGE: Setting = Setting { radars: 8, targets: 1000, ..NETWORK };
const MISPLACED: Setting = Setting { part: "coordinates", biased: false, registered: false, ..NETWORK };

pub(super) const SETTINGS: [Setting; 13] = [
    Setting { registered: false, ..NETWORK },
    NETWORK,
    Setting { registered: false, ..LARGE },
    LARGE,
    MISPLACED,
    Setting { misplaced_m: 100.0, ..MISPLACED },
    Setting { misplaced_m: 300.0, ..MISPLACED },
    Setting { misplaced_m: 1000.0, ..MISPLACED },
    Setting { misplaced_m: 100.0, registered: true, ..MISPLACED },
    Setting { misplaced_m: 300.0, registered: true, ..MISPLACED },
    Setting { misplaced_m: 1000.0, registered: true, ..MISPLACED },
    Setting { part: "formations", registered: false, ..NETWORK },
    Setting { part: "formations", ..NETWORK },
];

impl Setting {
    pub(super) fn case(&self) -> Case {
        Case::new()
            .with("part", self.part)
            .with("radars", self.radars)
            .with("targets", self.targets)
            .with("misplaced_m", self.misplaced_m)
            .with("registration", self.registered)
    }
}

/// How a run ended.
struct End {
    outcome: Outcome,
    /// Rms over radars: m, rad, rad; none without registration or biases.
    residual: Option<[f64; 3]>,
}

pub(super) fn cases(options: &Options) -> usize {
    options.some_of(&SETTINGS).len()
}

pub(super) fn measure(options: &Options, count: u32, progress: &Progress, results: &mut Results) {
    for setting in options.some_of(&SETTINGS) {
        let Setting { part, radars, targets, .. } = setting;
        progress.say(format!("{part}, {radars} × {targets}"));
        let ends = runs(options.threads, count, progress, |run| one_run(&setting, options.seed, run));
        let case = setting.case();
        let mut mean = |metric, of: &dyn Fn(&End) -> f64| {
            results.rows.push(Row::mean(&case, metric, ends.iter().map(of)));
        };
        mean("systems_per_target", &|end| end.outcome.systems as f64 / targets as f64);
        for (axis, metric, unit) in
            [(0, "residual_range_m", 1.0), (1, "residual_azimuth_deg", DEGREE), (2, "residual_elevation_deg", DEGREE)]
        {
            if ends.iter().all(|end| end.residual.is_some()) {
                mean(metric, &|end| end.residual.map_or(f64::NAN, |of| of[axis] / unit));
            }
        }
        let clustered = |metric, of: &dyn Fn(&Outcome) -> [usize; 2]| {
            let clusters: Vec<[u64; 2]> = ends.iter().map(|end| of(&end.outcome).map(|count| count as u64)).collect();
            Row::clustered(&case, metric, &clusters)
        };
        let rows = [
            clustered("perfect", &|end| [end.perfect.min(targets), targets]),
            clustered("wrong_attachments", &|end| [end.wrong, end.attached]),
        ];
        results.rows.extend(rows);
    }
}

fn one_run(setting: &Setting, seed: u64, run: u32) -> End {
    let seed = 1000 * seed + u64::from(run);
    let mut scenario = Scenario::circle(&EQUAL[..setting.radars], setting.targets, seed);
    if setting.biased {
        scenario = scenario.with_biases(&usual_bias(), seed + 1);
    }
    if setting.part == "formations" {
        scenario = scenario.with_formations(seed + 2);
    }
    let prior = if setting.registered { usual_bias() } else { Bias::zeros() };
    let sites = sites(&scenario, setting.misplaced_m, prior, seed);
    let mut fusion = Fusion::new(&scenario.centre, &sites, Settings::default());
    let mut world = World::new(scenario, seed + 3);
    let (_, outcome) = super::scored(&mut world, &mut fusion, SETTLED, CYCLES);
    let radars = &world.scenario().radars;
    let residual = (setting.registered && setting.biased).then(|| {
        let squared = |axis: usize| {
            let of = |(site, radar): (usize, &Radar)| fusion.registration().bias(site)[axis] - radar.bias[axis];
            radars.iter().enumerate().map(of).map(|left| left * left).sum::<f64>() / radars.len() as f64
        };
        [0, 1, 2].map(|axis| squared(axis).sqrt())
    });
    End { outcome, residual }
}

/// The radars as the fusion knows them: where they are not quite.
fn sites(scenario: &Scenario, misplaced_m: f64, bias: Bias, seed: u64) -> Vec<Site> {
    let mut rng = generator(seed, Purpose::Trajectory, 0, 0);
    let site = |radar: &Radar| {
        let away_m = [(); 2].map(|()| misplaced_m * normal(&mut rng));
        let position = Radar::near(&radar.position, away_m, radar.sigma, radar.period_s).position;
        Site {
            position,
            range_m: [0.0, radar.range_m],
            elevation_rad: Site::ALL_ELEVATIONS_RAD,
            period_s: radar.period_s,
            bias,
        }
    };
    scenario.radars.iter().map(site).collect()
}
