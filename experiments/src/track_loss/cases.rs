//! The cases, and what is published of them.

use std::fmt;

use common::config::{Association, GateRule, Swerling, TrackerConfig};
use serde::Serialize;
use serde_json::Value;

use crate::settings::Settings;
use crate::trajectory::{self, Trajectory};
use crate::world::Conditions;
use crate::{Case, Options, fluctuation};

/// Settings of the source, tracks going on, as in the JSON.
pub(super) const GOES_ON: &str = "source, going on";
/// F per cell.
pub(super) const PFA: [f64; 3] = [0.1, 0.01, 0.001];
/// Mean signal-to-noise ratios, dB.
pub(super) const SNR_DB: [f64; 5] = [8.0, 10.0, 12.0, 14.0, 16.0];

/// One case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// How the target flies.
    pub trajectory: Trajectory,
    /// F per cell.
    pub pfa: f64,
    /// S, dB.
    pub snr_db: f64,
    /// Fluctuation of the target.
    pub swerling: Swerling,
    /// How plots are weighed.
    pub association: Association,
    /// Where they are looked for.
    pub gate_rule: GateRule,
    /// Everything else.
    pub settings: Settings,
    /// Whether a track that the source gives up goes on.
    pub goes_on: bool,
}

/// How plots are weighed, but for hypotheses.
pub(super) const ASSOCIATIONS: [Association; 4] =
    [Association::PdaStatistics, Association::Pda, Association::Strongest, Association::Nearest];
/// Where plots are looked for.
pub(super) const GATE_RULES: [GateRule; 3] = [GateRule::MostProbable, GateRule::Widest, GateRule::Union];
/// Where all choices are compared, dB.
pub(super) const CHOICES_DB: f64 = 12.0;

impl Setting {
    /// PDA with statistics and the usual gates of `settings`, Swerling I.
    fn new(settings: Settings, trajectory: Trajectory, pfa: f64, snr_db: f64) -> Self {
        let (swerling, association) = (Swerling::One, Association::PdaStatistics);
        let gate_rule = usual_rule(settings);
        Self { trajectory, pfa, snr_db, swerling, association, gate_rule, settings, goes_on: false }
    }

    /// Whether gate and end of tracks are those of its settings.
    pub(super) fn is_usual(&self) -> bool {
        self.gate_rule == usual_rule(self.settings) && !self.goes_on
    }

    /// The world.
    pub fn conditions(&self) -> Conditions {
        Conditions { pfa: self.pfa, reference_cells: 0, snr_db: self.snr_db, swerling: self.swerling }
    }

    /// The tracker.
    pub fn config(&self) -> TrackerConfig {
        let config = self.settings.config(&self.conditions());
        TrackerConfig { association: self.association, gate_rule: self.gate_rule, ..config }
    }

    /// As in the JSON.
    pub fn case(&self) -> Case {
        Case::new()
            .with("trajectory", self.trajectory.name())
            .with("pfa", self.pfa)
            .with("snr_db", self.snr_db)
            .with("swerling", fluctuation::parameter(self.swerling))
            .with("association", configured(&self.association))
            .with("gate_rule", configured(&self.gate_rule))
            .with("settings", if self.goes_on { GOES_ON } else { self.settings.name() })
    }

    /// Published `p_loss`.
    pub(super) fn reference_loss(&self) -> Option<f64> {
        use {Association::PdaStatistics, Settings::Source, Swerling::Zero, Trajectory::B};
        if self.goes_on {
            return None;
        }
        let at_16_db = self.trajectory == B && self.association == PdaStatistics && is(self.snr_db, 16.0);
        match (self.settings, self.gate_rule, self.swerling) {
            (Source, GateRule::MostProbable, Swerling::One) => table(self),
            (Source, GateRule::Widest, Zero) if at_16_db && is(self.pfa, 0.1) => Some(0.013),
            (Settings::SourceWithGateProbability, _, Swerling::One) if at_16_db && is(self.pfa, 0.01) => Some(0.71),
            (Settings::SourceWithGateProbability, _, Zero) if at_16_db && is(self.pfa, 0.01) => Some(0.008),
            _ => None,
        }
    }

    /// Where the references come from.
    pub(super) fn reference_source(&self) -> &'static str {
        match (self.settings, self.association) {
            (Settings::Default, Association::Mht) => "independent run of (T21)",
            (Settings::Default, _) => "independent run of (T20), 1000 runs",
            _ => "independent run of the source's form, 1000 runs",
        }
    }

    /// Published `p_error150`: (T20), (T21), and the source's form at 12 and 16 dB.
    pub(super) fn reference_error(&self) -> Option<f64> {
        if self.trajectory != Trajectory::B || self.swerling != Swerling::One || !self.is_usual() {
            return None;
        }
        let [by_pfa, by_snr] = [place(&PFA, self.pfa)?, place(&SNR_DB, self.snr_db)?];
        match (self.settings, self.association) {
            (Settings::Default, Association::PdaStatistics) => Some(
                [
                    [0.901, 0.407, 0.075, 0.013, 0.003],
                    [0.898, 0.399, 0.069, 0.011, 0.003],
                    [0.905, 0.427, 0.067, 0.012, 0.001],
                ][by_pfa][by_snr],
            ),
            (Settings::Default, Association::Mht) if by_pfa == 0 && by_snr > 0 => {
                Some([0.287, 0.047, 0.010, 0.003][by_snr - 1])
            }
            (Settings::Source, Association::PdaStatistics) => {
                let [at_12_db, at_16_db] = [[1.0, 1.0], [0.980, 0.867], [0.703, 0.203]][by_pfa];
                [None, None, Some(at_12_db), None, Some(at_16_db)][by_snr]
            }
            _ => None,
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = |value: Value| value.to_string().replace('"', "");
        write!(
            f,
            "{} settings, {}, {} gate, {}, F = {}, {} dB, Swerling {}",
            self.settings.name(),
            text(configured(&self.association)),
            text(configured(&self.gate_rule)),
            self.trajectory.name(),
            self.pfa,
            self.snr_db,
            fluctuation::name(self.swerling)
        )
    }
}

/// Where the settings look for plots.
fn usual_rule(settings: Settings) -> GateRule {
    if settings == Settings::Default { GateRule::Union } else { GateRule::MostProbable }
}

/// A choice as the configuration names it.
pub(super) fn configured(choice: &impl Serialize) -> Value {
    serde_json::to_value(choice).unwrap_or_default()
}

fn is(value: f64, other: f64) -> bool {
    (value - other).abs() < 1e-9
}

fn place(all: &[f64], value: f64) -> Option<usize> {
    all.iter().position(|&other| is(other, value))
}

/// `p_loss` of the source's form, by SNR.
fn table(setting: &Setting) -> Option<f64> {
    use Association::{Nearest, PdaStatistics, Strongest};
    let row = match (setting.trajectory, place(&PFA, setting.pfa)?, setting.association) {
        (Trajectory::Cv, 0, PdaStatistics) => [0.785, 0.376, 0.189, 0.107, 0.063],
        (Trajectory::Cv, 0, Strongest) => [1.0, 1.0, 0.992, 0.955, 0.845],
        (Trajectory::Cv, 0, Nearest) => [1.0, 1.0, 1.0, 0.997, 0.999],
        (Trajectory::Cv, 1, PdaStatistics) => [0.646, 0.220, 0.077, 0.037, 0.020],
        (Trajectory::Cv, 1, Strongest) => [1.0, 1.0, 1.0, 0.990, 0.945],
        (Trajectory::Cv, 1, Nearest) => [1.0, 1.0, 1.0, 0.997, 0.990],
        (Trajectory::Cv, 2, PdaStatistics) => [0.661, 0.186, 0.041, 0.017, 0.006],
        (Trajectory::Cv, 2, Strongest) => [1.0, 1.0, 0.999, 0.986, 0.905],
        (Trajectory::Cv, 2, Nearest) => [1.0, 1.0, 0.998, 0.992, 0.929],
        (Trajectory::B, 1, PdaStatistics) => [1.0, 0.999, 0.990, 0.945, 0.877],
        (Trajectory::B, 1, Strongest) => [1.0, 1.0, 1.0, 1.0, 0.999],
        (Trajectory::B, 0, PdaStatistics) | (Trajectory::B, 1, Nearest) => [1.0; 5],
        (Trajectory::B, 2, PdaStatistics) => [0.993, 0.944, 0.715, 0.437, 0.236],
        (Trajectory::B, 2, Strongest) => [1.0, 1.0, 1.0, 0.999, 0.987],
        (Trajectory::B, 2, Nearest) => [1.0, 1.0, 1.0, 1.0, 0.989],
        _ => return None,
    };
    place(&SNR_DB, setting.snr_db).map(|by_snr| row[by_snr])
}

/// All cases, in the order of the rows.
pub(super) fn all(options: &Options) -> Vec<Setting> {
    let grid = |settings: Settings, trajectory: Trajectory| -> Vec<Setting> {
        let at = |pfa: f64| {
            options.some_of(&SNR_DB).into_iter().map(move |snr_db| Setting::new(settings, trajectory, pfa, snr_db))
        };
        options.some_of(&PFA).into_iter().flat_map(at).collect()
    };
    let mut all = Vec::new();
    for trajectory in [Trajectory::Cv, Trajectory::B] {
        for association in ASSOCIATIONS {
            all.extend(
                grid(Settings::Source, trajectory).into_iter().map(|setting| Setting { association, ..setting }),
            );
        }
    }
    let manoeuvre = Setting::new(Settings::Source, Trajectory::B, 0.1, 16.0);
    all.push(Setting { gate_rule: GateRule::Widest, swerling: Swerling::Zero, ..manoeuvre });
    for swerling in [Swerling::One, Swerling::Zero] {
        let setting = Setting::new(Settings::SourceWithGateProbability, Trajectory::B, 0.01, 16.0);
        all.push(Setting { swerling, ..setting });
    }
    for trajectory in options.some_of(&trajectory::ALL) {
        for swerling in options.some_of(&[Swerling::One, Swerling::Zero, Swerling::Three]) {
            all.extend(grid(Settings::Default, trajectory).into_iter().map(|setting| Setting { swerling, ..setting }));
        }
    }
    for trajectory in options.some_of(&trajectory::ALL) {
        let from_10_db = grid(Settings::Default, trajectory).into_iter().filter(|setting| setting.snr_db > 9.0);
        all.extend(from_10_db.map(|setting| Setting { association: Association::Mht, ..setting }));
    }
    let ends = [CHOICES_DB, 16.0];
    let source = options
        .some_of(&PFA)
        .into_iter()
        .flat_map(|pfa| ends.map(|snr_db| Setting::new(Settings::Source, Trajectory::B, pfa, snr_db)));
    all.extend(source.map(|setting| Setting { goes_on: true, ..setting }));
    let choices = options.some_of(&PFA).into_iter().flat_map(choices);
    all.extend(choices.filter(|choice| choice.association != Association::PdaStatistics || !choice.is_usual()));
    all
}

/// Every association with every gate rule, the rest as by default.
fn choices(pfa: f64) -> Vec<Setting> {
    let usual = Setting::new(Settings::Default, Trajectory::B, pfa, CHOICES_DB);
    let rules = |association| GATE_RULES.map(|gate_rule| Setting { association, gate_rule, ..usual });
    ASSOCIATIONS.into_iter().flat_map(rules).collect()
}

/// The cases whose time is measured: the source's associations, all choices and hypotheses, on one trajectory.
pub(super) fn timed(options: &Options) -> Vec<Setting> {
    let mut all = Vec::new();
    for pfa in options.some_of(&PFA) {
        let of = |settings| Setting::new(settings, Trajectory::B, pfa, CHOICES_DB);
        all.extend(ASSOCIATIONS.map(|association| Setting { association, ..of(Settings::Source) }));
        all.extend(choices(pfa));
        all.push(Setting { association: Association::Mht, ..of(Settings::Default) });
    }
    all
}
