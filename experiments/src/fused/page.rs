//! The tables of `docs/results/fusion.md`.

use super::association::SETTINGS;
use super::classes::{RADARS, RIGHT};
use super::rules::{FLIGHTS, NETWORKS, RULES};
use crate::Row;
use crate::page::{Block, figure, find};

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    vec![rules(rows), association(rows), classes(rows)]
}

fn rules(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for (network, _) in NETWORKS {
        for flight in FLIGHTS {
            for rule in RULES {
                let case = [("radars", network.into()), ("flight", flight.into()), ("rule", rule.into())];
                let of = |metric, decimals| figure(find(rows, metric, &case), decimals);
                let figures = [of("position_m", 1), of("over_best", 3), of("over_central", 3), of("nees", 2)];
                lines.push([network, flight, rule].map(String::from).into_iter().chain(figures).collect());
            }
        }
    }
    let head = ["radars", "flight", "rule", "position, m", "over the best radar", "over the central filter", "NEES/6"];
    Block::table("fusion-rules", &head, &lines)
}

fn association(rows: &[Row]) -> Block {
    let mut lines = Vec::new();
    for setting in SETTINGS {
        let case: Vec<_> = setting.case().iter().map(|(key, value)| (key, value.clone())).collect();
        let of = |metric, decimals| figure(find(rows, metric, &case), decimals);
        lines.push(vec![
            setting.part.into(),
            format!("{} × {}", setting.radars, setting.targets),
            format!("{} m", setting.misplaced_m),
            if setting.registered { "yes" } else { "no" }.into(),
            of("systems_per_target", 3),
            of("perfect", 4),
            of("wrong_attachments", 5),
            of("residual_range_m", 1),
            of("residual_azimuth_deg", 4),
            of("residual_elevation_deg", 4),
        ]);
    }
    let head = [
        "part",
        "radars × targets",
        "misplaced",
        "registration",
        "system tracks a target",
        "perfect",
        "wrong attachments",
        "residual range, m",
        "azimuth, °",
        "elevation, °",
    ];
    Block::table("fusion-association", &head, &lines)
}

fn classes(rows: &[Row]) -> Block {
    let line = |right: f64| {
        let of = |radars: usize| {
            figure(find(rows, "recognised", &[("declared_right", right.into()), ("radars", radars.into())]), 3)
        };
        std::iter::once(right.to_string()).chain(RADARS.map(of)).collect()
    };
    let head: Vec<String> = RADARS.map(|radars| format!("{radars} declarations")).into();
    let head: Vec<&str> = std::iter::once("one is right").chain(head.iter().map(String::as_str)).collect();
    Block::table("fusion-classes", &head, &RIGHT.map(line))
}
