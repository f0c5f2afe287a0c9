//! The tables of `docs/results/outliers.md`.

use super::{CASES, Rule, SHARES};
use crate::Row;
use crate::page::{Block, figure, find};

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    let mut lines = Vec::new();
    for (flight, wrong) in CASES {
        for share in SHARES {
            let mut line = vec![flight.name().to_string(), wrong.name().to_string(), format!("{:.0} %", 100.0 * share)];
            for metric in ["right", "right_later", "bad_kept", "range_azimuth_kept"] {
                for rule in Rule::ALL {
                    let case = [
                        ("flight", flight.name().into()),
                        ("outliers", wrong.name().into()),
                        ("share", share.into()),
                        ("rule", rule.name().into()),
                    ];
                    line.push(figure(find(rows, metric, &case), 3));
                }
            }
            lines.push(line);
        }
    }
    let head = [
        "flight",
        "outliers",
        "share",
        "right: classic",
        "right: channels",
        "right from look 11: classic",
        "right from look 11: channels",
        "bad kept: classic",
        "bad kept: channels",
        "range and azimuth kept: classic",
        "range and azimuth kept: channels",
    ];
    vec![Block::table("outliers", &head, &lines)]
}
