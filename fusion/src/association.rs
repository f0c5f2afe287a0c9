//! Which local track is which system track: the cheapest assignment within gates (F5).

use evaluation::assignment::cheapest;

use crate::comparison::chi_squared;
use crate::gaussian::Gaussian;
use crate::grouping::components;
use crate::rules;

/// A local track (row) that may be a system track (column), and χ² of their difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Number of the local track.
    pub row: u32,
    /// Number of the system track.
    pub column: u32,
    /// χ².
    pub cost: f64,
}

/// Gives each row its column at the lowest total cost, or none where to stay alone, at the cost `alone`, is cheaper. Sets of
/// rows and columns without candidates in common are assigned one by one.
pub fn assign(rows: usize, candidates: &[Candidate], alone: f64) -> Vec<Option<u32>> {
    let mut assigned = vec![None; rows];
    let mut columns: Vec<u32> = candidates.iter().map(|candidate| candidate.column).collect();
    columns.sort_unstable();
    columns.dedup();
    let place = |column: u32| columns.binary_search(&column).unwrap_or(0);
    let mut edges: Vec<(usize, usize)> =
        candidates.iter().map(|of| (of.row as usize, rows + place(of.column))).collect();
    edges.extend_from_within(..);
    let half = candidates.len();
    edges[half..].iter_mut().for_each(|edge| *edge = (edge.1, edge.0));
    edges.sort_unstable();
    let of = |node: usize| {
        let from = edges.partition_point(|edge| edge.0 < node);
        edges[from..].iter().take_while(move |edge| edge.0 == node).map(|edge| edge.1)
    };
    let number = components(rows + columns.len(), of);
    let mut by_component: Vec<&Candidate> = candidates.iter().collect();
    by_component.sort_by_key(|candidate| (number[candidate.row as usize], candidate.row, candidate.column));
    for together in by_component.chunk_by(|a, b| number[a.row as usize] == number[b.row as usize]) {
        let unique = |key: fn(&Candidate) -> u32| {
            let mut all: Vec<u32> = together.iter().map(|&of| key(of)).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let (own_rows, own_columns) = (unique(|of| of.row), unique(|of| of.column));
        let at = |all: &[u32], key: u32| all.binary_search(&key).unwrap_or(0);
        let pairs: Vec<(usize, usize, f64)> =
            together.iter().map(|of| (at(&own_rows, of.row), at(&own_columns, of.column), of.cost)).collect();
        for (row, column) in cheapest(own_rows.len(), own_columns.len(), &pairs, alone).into_iter().enumerate() {
            assigned[own_rows[row] as usize] = column.map(|column| own_columns[column]);
        }
    }
    assigned
}

/// The tracks of several radars at one time, as sets of those that are of one target: radar after radar is assigned to what
/// the radars before it have made together.
pub fn partition(radars: &[Vec<Gaussian>], gate: f64) -> Vec<Vec<(usize, usize)>> {
    let mut systems: Vec<(Vec<(usize, usize)>, Gaussian)> = Vec::new();
    for (radar, tracks) in radars.iter().enumerate() {
        let mut candidates = Vec::new();
        for (row, track) in tracks.iter().enumerate() {
            for (column, (_, system)) in systems.iter().enumerate() {
                let cost = chi_squared(&(track.mean - system.mean), track.covariance + system.covariance);
                if cost <= gate {
                    candidates.push(Candidate { row: row as u32, column: column as u32, cost });
                }
            }
        }
        for (row, column) in assign(tracks.len(), &candidates, gate).into_iter().enumerate() {
            let track = tracks[row];
            match column.and_then(|column| systems.get_mut(column as usize)) {
                Some((members, system)) => {
                    members.push((radar, row));
                    *system = rules::information(&[*system, track]).unwrap_or(*system);
                }
                None => systems.push((vec![(radar, row)], track)),
            }
        }
    }
    systems.into_iter().map(|(members, _)| members).collect()
}
