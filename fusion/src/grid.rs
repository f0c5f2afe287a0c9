//! System tracks by place, so that only near ones are compared.

/// Side of a cell, m.
const CELL_M: f64 = 4000.0;

/// Numbers of system tracks, ordered by the cell of the ground that they are in.
#[derive(Debug, Default)]
pub(crate) struct Grid {
    entries: Vec<(u64, u32)>,
}

impl Grid {
    /// Begins anew with these places east and north, m.
    pub(crate) fn fill(&mut self, places: impl Iterator<Item = (u32, [f64; 2])>) {
        self.entries.clear();
        self.entries.extend(places.map(|(number, place)| (key(cell(place)), number)));
        self.entries.sort_unstable();
    }

    /// Those in the cells that a circle touches; some of them may lie outside it.
    pub(crate) fn near(&self, [east_m, north_m]: [f64; 2], radius_m: f64) -> impl Iterator<Item = u32> {
        let (low, high) =
            (cell([east_m - radius_m, north_m - radius_m]), cell([east_m + radius_m, north_m + radius_m]));
        (low.1..=high.1).flat_map(move |row| {
            let from = self.entries.partition_point(|entry| entry.0 < key((low.0, row)));
            let last = key((high.0, row));
            self.entries[from..].iter().take_while(move |entry| entry.0 <= last).map(|entry| entry.1)
        })
    }
}

/// Column and row; far outside any radar's reach they end.
fn cell(place: [f64; 2]) -> (u32, u32) {
    let of = |value: f64| (value / CELL_M + f64::from(1 << 20)).clamp(0.0, f64::from(1 << 21)) as u32;
    (of(place[0]), of(place[1]))
}

/// Cells of a row follow one another.
fn key((column, row): (u32, u32)) -> u64 {
    u64::from(row) << 32 | u64::from(column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_near_is_left_out() {
        let place = |i: u32| [f64::from(i * 7919 % 200_000) - 1e5, f64::from(i * 104_729 % 200_000) - 1e5];
        let mut grid = Grid::default();
        grid.fill((0..2000).map(|i| (i, place(i))));
        for (at, radius_m) in [([0.0, 0.0], 5_000.0), ([-99_000.0, 98_000.0], 900.0), ([4000.0, -4000.0], 1.0)] {
            let found: Vec<u32> = grid.near(at, radius_m).collect();
            let near = |&i: &u32| (place(i)[0] - at[0]).hypot(place(i)[1] - at[1]) <= radius_m;
            assert!((0..2000).filter(near).all(|i| found.contains(&i)));
            assert!(found.len() < 60, "{} for {radius_m} m", found.len());
        }
    }
}
