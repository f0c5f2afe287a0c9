//! The tables of `docs/results/real-recordings.md`, with what others reach on the same plots.

use serde_json::Value;

use super::{AIRPORT, FERRY};
use crate::Row;
use crate::page::{Block, figure, find};

/// Metric, head of its column, decimals.
type Column = (&'static str, &'static str, usize);

const FERRY_COLUMNS: [Column; 12] = [
    ("followed", "followed", 3),
    ("changes", "changes", 0),
    ("delay_scans", "delay, scans", 1),
    ("delay_median_scans", "… median", 1),
    ("rms_m", "rms, m", 1),
    ("false_per_scan", "false per scan", 2),
    ("moving_false_per_scan", "moving false per scan", 2),
    ("moving_false_tracks", "moving false tracks", 0),
    ("gospa_near_m", "GOSPA near, m", 1),
    ("gospa_all_m", "GOSPA all, m", 1),
    ("followed_registered", "registered: followed", 3),
    ("rms_registered_m", "registered: rms, m", 1),
];

/// Measured by independent programs on the same plots, 2026-11.
const FERRY_PEERS: [[&str; 11]; 5] = [
    ["*Stone Soup GNN, untuned*", ".918 [.83, .98]", "1", "4.2", "2", "8.8", "2.93", "2.37", "79", "16.7", "47.8"],
    ["*Stone Soup GNN, tuned*", ".888 [.79, .96]", "1", "6.2", "4", "8.8", "1.27", "1.08", "26", "15.7", "32.5"],
    ["*Stone Soup JPDA, tuned*", ".886 [.79, .96]", "1", "6.2", "4", "8.8", "1.24", "1.05", "24", "15.0", "31.8"],
    ["*VIMMJIPDA, published*", ".911 [.81, .98]", "4", "4.7", "2", "9.2", "2.44", "2.05", "51", "16.8", "44.7"],
    ["*VIMMJIPDA, tuned*", ".873 [.76, .96]", "2", "6.7", "4", "9.1", "1.56", "1.33", "27", "15.9", "36.7"],
];

const AIRPORT_COLUMNS: [Column; 6] = [
    ("followed", "followed", 3),
    ("followed_on_ground", "… aircraft on the ground", 3),
    ("distance_p50_m", "distance 50 %, m", 2),
    ("distance_p95_m", "95 %, m", 1),
    ("changes", "changes", 0),
    ("never_near_per_hour", "never near an address, per hour", 0),
];

/// As [`FERRY_PEERS`].
const AIRPORT_PEERS: [[&str; 7]; 4] = [
    ["*the radar's own tracker*", ".737", ".984", "3.54", "13.5", "133", "247"],
    ["*Stone Soup GNN*", ".755", ".991", "3.42", "14.2", "91", "148"],
    ["*Stone Soup GNN, long hold, in-sample*", ".755", ".992", "3.45", "15.4", "81", "99"],
    ["*alpha-beta, nearest neighbour*", ".739", ".988", "3.48", "13.9", "111", "201"],
];

pub(super) fn blocks(rows: &[Row]) -> Vec<Block> {
    let peers = |lines: &[&[&str]]| lines.iter().map(|line| line.iter().map(ToString::to_string).collect()).collect();
    vec![
        table(rows, "real-ferry", FERRY, &FERRY_COLUMNS, peers(&FERRY_PEERS.each_ref().map(|line| &line[..]))),
        table(rows, "real-airport", AIRPORT, &AIRPORT_COLUMNS, peers(&AIRPORT_PEERS.each_ref().map(|line| &line[..]))),
    ]
}

/// A line for each peer, then one for each tracker.
fn table(rows: &[Row], block: &'static str, recording: &str, columns: &[Column], peers: Vec<Vec<String>>) -> Block {
    let head: Vec<&str> = std::iter::once("tracker").chain(columns.iter().map(|&(_, head, _)| head)).collect();
    let is_first = |row: &&Row| row.metric == columns[0].0 && row.case.get("recording") == Some(&recording.into());
    let line = |row: &Row| {
        let tracker = row.case.get("tracker").cloned().unwrap_or_default();
        let cell = |&(metric, _, decimals): &Column| {
            let case = [("recording", Value::from(recording)), ("tracker", tracker.clone())];
            figure(find(rows, metric, &case), decimals)
        };
        std::iter::once(tracker.as_str().unwrap_or_default().to_string()).chain(columns.iter().map(cell)).collect()
    };
    let mut lines = peers;
    for line in &mut lines {
        line.resize(head.len(), "–".into());
    }
    lines.extend(rows.iter().filter(is_first).map(line));
    Block::table(block, &head, &lines)
}
