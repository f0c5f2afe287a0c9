//! The cheapest pairing of targets and tracks.

/// Pairs rows with columns at the lowest total cost, each at most once. `pairs` lists
/// (row, column, cost); an unpaired row costs `unpaired`, an unpaired column nothing.
///
/// Successive shortest paths with potentials (Jonker & Volgenant 1987) on rows × (columns +
/// one private way out per row): O(rows² · (rows + columns)).
pub fn cheapest(rows: usize, columns: usize, pairs: &[(usize, usize, f64)], unpaired: f64) -> Vec<Option<usize>> {
    let width = columns + rows;
    let mut cost = vec![f64::INFINITY; rows * width];
    for &(row, column, value) in pairs {
        cost[row * width + column] = value;
    }
    for row in 0..rows {
        cost[row * width + columns + row] = unpaired;
    }
    let mut potential_row = vec![0.0; rows];
    let mut potential_column = vec![0.0; width];
    let mut row_of: Vec<Option<usize>> = vec![None; width];
    for start in 0..rows {
        let mut distance = vec![f64::INFINITY; width];
        let mut came_from: Vec<Option<usize>> = vec![None; width];
        let mut done = vec![false; width];
        let (mut row, mut base, mut last) = (start, 0.0, None);
        let end = loop {
            for column in (0..width).filter(|&column| !done[column]) {
                let reduced = cost[row * width + column] - potential_row[row] - potential_column[column];
                if base + reduced < distance[column] {
                    distance[column] = base + reduced;
                    came_from[column] = last;
                }
            }
            let open = (0..width).filter(|&column| !done[column]);
            let nearest = open.min_by(|&a, &b| distance[a].total_cmp(&distance[b])).expect("a way out is always open");
            done[nearest] = true;
            base = distance[nearest];
            match row_of[nearest] {
                Some(next) => (row, last) = (next, Some(nearest)),
                None => break nearest,
            }
        };
        for column in (0..width).filter(|&column| done[column]) {
            let slack = base - distance[column];
            potential_column[column] -= slack;
            if column != end {
                potential_row[row_of[column].expect("columns on the way are paired")] += slack;
            }
        }
        potential_row[start] += base;
        let mut column = end;
        while let Some(before) = came_from[column] {
            row_of[column] = row_of[before];
            column = before;
        }
        row_of[column] = Some(start);
    }
    let mut paired = vec![None; rows];
    for (column, row) in row_of[..columns].iter().enumerate() {
        if let Some(row) = *row {
            paired[row] = Some(column);
        }
    }
    paired
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn total(pairing: &[Option<usize>], pairs: &[(usize, usize, f64)], unpaired: f64) -> f64 {
        let cost = |row, column| pairs.iter().find(|&&(r, c, _)| (r, c) == (row, column)).expect("a listed pair").2;
        pairing.iter().enumerate().map(|(row, column)| column.map_or(unpaired, |column| cost(row, column))).sum()
    }

    /// Every pairing there is.
    fn cheapest_naive(row: usize, rows: usize, used: u32, pairs: &[(usize, usize, f64)], unpaired: f64) -> f64 {
        if row == rows {
            return 0.0;
        }
        let mut best = unpaired + cheapest_naive(row + 1, rows, used, pairs, unpaired);
        for &(_, column, cost) in pairs.iter().filter(|&&(r, column, _)| r == row && used & 1 << column == 0) {
            best = best.min(cost + cheapest_naive(row + 1, rows, used | 1 << column, pairs, unpaired));
        }
        best
    }

    proptest! {
        #[test]
        fn it_is_the_cheapest(costs in prop::collection::vec(prop::option::of(0.0..10.0_f64), 0..25), rows in 1usize..5) {
            let columns = costs.len() / rows;
            let pairs: Vec<_> = (0..rows * columns)
                .filter_map(|index| costs[index].map(|cost| (index / columns, index % columns, cost)))
                .collect();
            let pairing = cheapest(rows, columns, &pairs, 6.0);
            let columns_used: Vec<_> = pairing.iter().flatten().collect();
            let distinct: std::collections::HashSet<_> = columns_used.iter().collect();
            prop_assert_eq!(columns_used.len(), distinct.len());
            let best = cheapest_naive(0, rows, 0, &pairs, 6.0);
            prop_assert!((total(&pairing, &pairs, 6.0) - best).abs() < 1e-9);
        }
    }
}
