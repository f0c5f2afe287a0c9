//! The tables of `docs/results/track-loss.md`.

use common::config::{Association, GateRule, Swerling};
use serde_json::Value;

use super::cases::{ASSOCIATIONS, CHOICES_DB, GATE_RULES, GOES_ON, PFA, SNR_DB, Setting, configured};
use super::{P_ERROR150, P_LOSS};
use crate::page::{Block, figure, find};
use crate::settings::Settings;
use crate::trajectory::Trajectory;
use crate::{Row, fluctuation};

pub(super) fn blocks(rows: &[Row], costs: &[(Setting, f64)], verdict: &[String]) -> Vec<Block> {
    vec![
        source(rows),
        special(rows),
        ratios(rows),
        error150(rows),
        kinds(rows),
        flights(rows),
        choices(rows, costs),
        Block::list("track-loss-verdict", &verdict.iter().map(|line| line.replace("\n  ", "; ")).collect::<Vec<_>>()),
    ]
}

/// One line of figures by SNR.
struct Line {
    trajectory: Trajectory,
    pfa: f64,
    swerling: Swerling,
    association: Association,
    gate_rule: GateRule,
    settings: &'static str,
}

impl Line {
    /// PDA with statistics, Swerling I, with the settings' own gate rule.
    fn new(trajectory: Trajectory, pfa: f64, settings: &'static str) -> Self {
        let gate_rule = if settings == Settings::Default.name() { GateRule::Union } else { GateRule::MostProbable };
        Self { trajectory, pfa, swerling: Swerling::One, association: Association::PdaStatistics, gate_rule, settings }
    }

    fn at<'a>(&self, rows: &'a [Row], metric: &str, snr_db: f64) -> Option<&'a Row> {
        let case: [(&str, Value); 7] = [
            ("trajectory", self.trajectory.name().into()),
            ("pfa", self.pfa.into()),
            ("snr_db", snr_db.into()),
            ("swerling", fluctuation::parameter(self.swerling)),
            ("association", configured(&self.association)),
            ("gate_rule", configured(&self.gate_rule)),
            ("settings", self.settings.into()),
        ];
        find(rows, metric, &case)
    }

    /// The names in front and the figures at each SNR.
    fn cells(&self, rows: &[Row], metric: &str, decimals: usize, names: &[&str]) -> Vec<String> {
        let figures = SNR_DB.iter().map(|&snr_db| figure(self.at(rows, metric, snr_db), decimals));
        names.iter().map(ToString::to_string).chain(figures).collect()
    }
}

fn association_name(association: Association) -> &'static str {
    match association {
        Association::PdaStatistics => "PDA + statistics",
        Association::Pda => "PDA",
        Association::Strongest => "strongest",
        Association::Nearest => "nearest",
        Association::Mht => "hypotheses (T21)",
    }
}

const BY_SNR: [&str; 5] = ["8 dB", "10 dB", "12 dB", "14 dB", "16 dB"];

fn by_snr(names: &[&'static str]) -> Vec<&'static str> {
    names.iter().copied().chain(BY_SNR).collect()
}

/// Losses of the source's form.
fn source(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for trajectory in [Trajectory::Cv, Trajectory::B] {
        for pfa in PFA {
            for association in ASSOCIATIONS {
                let line = Line { association, ..Line::new(trajectory, pfa, Settings::Source.name()) };
                let names = [trajectory.name(), &pfa.to_string(), association_name(association)];
                lines.push(line.cells(rows, P_LOSS, 3, &names));
            }
        }
    }
    Block::table("track-loss-source", &by_snr(&["", "F", "association"]), &lines)
}

/// The references at 16 dB on B with other gates and weights.
fn special(rows: &[Row]) -> Block {
    let source = |pfa| Line::new(Trajectory::B, pfa, Settings::Source.name());
    let t13 =
        |swerling| Line { swerling, ..Line::new(Trajectory::B, 0.01, Settings::SourceWithGateProbability.name()) };
    let manoeuvre = Line { gate_rule: GateRule::Widest, swerling: Swerling::Zero, ..source(0.1) };
    let cases = [
        ("gate of the manoeuvre mode, Swerling 0, F = 0.1", manoeuvre),
        ("(T13), Swerling I, F = 0.01", t13(Swerling::One)),
        ("(T13), Swerling 0, F = 0.01", t13(Swerling::Zero)),
    ];
    let lines: Vec<Vec<String>> =
        cases.iter().map(|(name, line)| vec![(*name).into(), figure(line.at(rows, P_LOSS, 16.0), 3)]).collect();
    Block::table("track-loss-special", &["B, 16 dB", "loss (reference)"], &lines)
}

/// The nearest neighbour against PDA with statistics.
fn ratios(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for trajectory in [Trajectory::Cv, Trajectory::B] {
        for pfa in PFA {
            let line = Line::new(trajectory, pfa, Settings::Source.name());
            let at = |metric, snr_db| line.at(rows, metric, snr_db).map(|row| Row { reference: None, ..row.clone() });
            let claimed = line.at(rows, "loss_ratio_to_nearest", SNR_DB[0]).and_then(|row| row.reference);
            let mut cells = vec![
                trajectory.name().into(),
                pfa.to_string(),
                claimed.map_or("–".into(), |claimed| claimed.to_string()),
            ];
            cells.extend(SNR_DB.map(|snr_db| figure(at("loss_ratio_to_nearest", snr_db).as_ref(), 1)));
            let times = SNR_DB.iter().filter_map(|&snr_db| at("time_ratio_to_nearest", snr_db));
            let longest = times.max_by(|a, b| a.value.total_cmp(&b.value));
            cells.push(figure(longest.as_ref(), 1));
            lines.push(cells);
        }
    }
    let mut head = by_snr(&["", "F", "claimed"]);
    head.push("time, at most");
    Block::table("track-loss-claims", &head, &lines)
}

/// Position wrong by more than 150 m on B.
fn error150(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for pfa in PFA {
        let of = |settings| Line::new(Trajectory::B, pfa, settings);
        let default = || of(Settings::Default.name());
        for (name, line) in [
            ("source settings", of(Settings::Source.name())),
            ("source settings, tracks going on", of(GOES_ON)),
            ("default (T20)", default()),
            ("hypotheses (T21)", Line { association: Association::Mht, ..default() }),
        ] {
            lines.push(line.cells(rows, P_ERROR150, 3, &[&pfa.to_string(), name]));
        }
    }
    Block::table("track-loss-error150", &by_snr(&["F", ""]), &lines)
}

/// Default settings on B, other kinds of targets.
fn kinds(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for swerling in [Swerling::Zero, Swerling::Three] {
        for pfa in PFA {
            let line = Line { swerling, ..Line::new(Trajectory::B, pfa, Settings::Default.name()) };
            let names = [fluctuation::name(swerling), &pfa.to_string()];
            lines.push(line.cells(rows, P_ERROR150, 3, &names));
        }
    }
    Block::table("track-loss-kinds", &by_snr(&["Swerling", "F"]), &lines)
}

/// Flights that no setting was tuned on.
fn flights(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for trajectory in [Trajectory::A, Trajectory::Cv, Trajectory::Random] {
        for association in [Association::PdaStatistics, Association::Mht] {
            for pfa in PFA {
                let line = Line { association, ..Line::new(trajectory, pfa, Settings::Default.name()) };
                let name = if association == Association::Mht { "hypotheses (T21)" } else { "default (T20)" };
                lines.push(line.cells(rows, P_ERROR150, 3, &[trajectory.name(), name, &pfa.to_string()]));
            }
        }
    }
    Block::table("track-loss-flights", &by_snr(&["flight", "", "F"]), &lines)
}

/// Losses and time of every association and gate rule on B.
fn choices(rows: &[Row], costs: &[(Setting, f64)]) -> Block {
    let mut lines = Vec::new();
    let source = ASSOCIATIONS.map(|association| (Settings::Source, association, GateRule::MostProbable));
    let default = ASSOCIATIONS
        .into_iter()
        .flat_map(|association| GATE_RULES.map(|gate_rule| (Settings::Default, association, gate_rule)));
    let hypotheses = [(Settings::Default, Association::Mht, GateRule::Union)];
    for (settings, association, gate_rule) in source.into_iter().chain(default).chain(hypotheses) {
        let rule = configured(&gate_rule).to_string().replace('"', "");
        let mut cells = vec![settings.name().to_string(), association_name(association).into(), rule];
        for pfa in PFA {
            let line = Line { association, gate_rule, ..Line::new(Trajectory::B, pfa, settings.name()) };
            let loss = line.at(rows, P_ERROR150, CHOICES_DB).map(|row| Row { reference: None, ..row.clone() });
            cells.push(figure(loss.as_ref(), 3));
            let is = |setting: &Setting| {
                (setting.settings, setting.association, setting.gate_rule) == (settings, association, gate_rule)
                    && (setting.pfa - pfa).abs() < 1e-9
            };
            let cost = costs.iter().find(|(setting, _)| is(setting));
            cells.push(cost.map_or("–".into(), |(_, us)| format!("{us:.1}")));
        }
        lines.push(cells);
    }
    let head = ["settings", "association", "gate", "F = 0.1", "µs", "0.01", "µs", "0.001", "µs"];
    Block::table("track-loss-choices", &head, &lines)
}
