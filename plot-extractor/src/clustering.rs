//! Hits to clusters: neighbours in range, Doppler (a circle), elevation and successive
//! dwells belong together, also across north.

use crate::cfar::Hit;

/// Cells of a dwell along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CellGrid {
    /// Elevation beams.
    pub elevations: usize,
    /// Doppler cells.
    pub dopplers: usize,
    /// Range cells.
    pub ranges: usize,
}

impl CellGrid {
    /// Cells of a dwell.
    pub fn cells(self) -> usize {
        self.elevations * self.dopplers * self.ranges
    }

    /// (elevation, Doppler, range) of a cell.
    pub fn place(self, cell: u32) -> (usize, usize, usize) {
        let (row, range) = (cell as usize / self.ranges, cell as usize % self.ranges);
        (row / self.dopplers, row % self.dopplers, range)
    }

    /// The cell at (elevation, Doppler, range) offset by −1, 0 or 1 each; Doppler wraps
    /// round, the others end. None beyond an end.
    pub fn neighbour(self, cell: u32, step: (isize, isize, isize)) -> Option<u32> {
        let (elevation, doppler, range) = self.place(cell);
        let elevation = elevation.checked_add_signed(step.0).filter(|&e| e < self.elevations)?;
        let range = range.checked_add_signed(step.2).filter(|&r| r < self.ranges)?;
        let doppler = (doppler + self.dopplers).checked_add_signed(step.1)? % self.dopplers;
        Some(((elevation * self.dopplers + doppler) * self.ranges + range) as u32)
    }
}

/// Power over noise before, in and after the peak cell; NaN where there is no cell.
pub type Cut = [f64; 3];

/// How far a cluster reaches along an axis, and the largest power of its hits at either end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// First cell, or dwell.
    pub first: u64,
    /// Last cell, or dwell.
    pub last: u64,
    /// Power at both.
    pub powers: [f64; 2],
}

impl Reach {
    fn of(place: u64, power: f64) -> Self {
        Self { first: place, last: place, powers: [power; 2] }
    }

    fn absorb(&mut self, other: &Self) {
        let strongest = |mine: (u64, f64), other: (u64, f64), nearer: bool| match mine.0 == other.0 {
            true => mine.1.max(other.1),
            false if nearer => mine.1,
            false => other.1,
        };
        self.powers = [
            strongest((self.first, self.powers[0]), (other.first, other.powers[0]), self.first < other.first),
            strongest((self.last, self.powers[1]), (other.last, other.powers[1]), self.last > other.last),
        ];
        self.first = self.first.min(other.first);
        self.last = self.last.max(other.last);
    }

    /// The same with powers over `noise`.
    #[must_use]
    pub fn over(self, noise: f64) -> Self {
        Self { powers: self.powers.map(|power| power / noise), ..self }
    }

    /// Cells, or dwells.
    pub fn length(&self) -> u64 {
        self.last - self.first + 1
    }
}

/// A group of neighbouring hits.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// First dwell with a hit.
    pub first_dwell: u64,
    /// Last dwell with a hit.
    pub last_dwell: u64,
    /// Hits.
    pub hits: u32,
    /// Dwell of the strongest hit.
    pub peak_dwell: u64,
    /// The strongest hit.
    pub peak: Hit,
    /// How far it reaches along range, azimuth (dwells) and elevation.
    pub reaches: [Reach; 3],
    /// Powers through the peak along range.
    pub range: Cut,
    /// Powers through the peak along azimuth.
    pub azimuth: Cut,
    /// Powers through the peak along elevation.
    pub elevation: Cut,
    /// Powers through the peak along Doppler.
    pub doppler: Cut,
}

/// Marks a cell without a hit.
const NONE: u32 = u32::MAX;

/// Which cluster each hit of one dwell belongs to.
#[derive(Debug, Default)]
struct Labels {
    of_cell: Vec<u32>,
    cells: Vec<u32>,
}

impl Labels {
    fn clear(&mut self) {
        for &cell in &self.cells {
            self.of_cell[cell as usize] = NONE;
        }
        self.cells.clear();
    }

    fn set(&mut self, cell: u32, cluster: u32) {
        self.of_cell[cell as usize] = cluster;
        self.cells.push(cell);
    }
}

/// Grows clusters dwell by dwell.
#[derive(Debug)]
pub struct Clustering {
    grid: CellGrid,
    max_dwells: u64,
    now: Labels,
    before: Labels,
    clusters: Vec<Cluster>,
    /// Cluster that another was merged into; itself for a living one.
    parents: Vec<u32>,
    open: Vec<u32>,
    last_dwell: Option<u64>,
}

impl Clustering {
    /// Clusters over `grid` that are closed when they span `max_dwells` dwells.
    pub fn new(grid: CellGrid, max_dwells: u32) -> Self {
        let labels = || Labels { of_cell: vec![NONE; grid.cells()], cells: Vec::new() };
        Self {
            grid,
            max_dwells: u64::from(max_dwells),
            now: labels(),
            before: labels(),
            clusters: Vec::new(),
            parents: Vec::new(),
            open: Vec::new(),
            last_dwell: None,
        }
    }

    /// First dwell of the oldest cluster that may still grow.
    pub fn oldest_open(&self) -> Option<u64> {
        self.open.iter().map(|&cluster| self.clusters[cluster as usize].first_dwell).min()
    }

    /// Takes the hits of `dwell` (a number that counts on over scans), by ascending cell,
    /// with the powers of its cells and of the cells of the dwell before. Appends clusters that can grow no more.
    pub fn add(&mut self, dwell: u64, hits: &[Hit], powers: &[f32], powers_before: &[f32], closed: &mut Vec<Cluster>) {
        let follows = self.last_dwell.is_some_and(|last| dwell.checked_sub(1) == Some(last));
        self.last_dwell = Some(dwell);
        if !follows {
            self.close_all(closed);
        }
        std::mem::swap(&mut self.now, &mut self.before);
        self.now.clear();
        for &hit in hits {
            let cluster = self.home_of(dwell, hit);
            self.now.set(hit.cell, cluster);
        }
        for index in 0..self.open.len() {
            let cluster = &mut self.clusters[self.open[index] as usize];
            let noise = f64::from(cluster.peak.noise);
            if cluster.peak_dwell == dwell {
                cluster.cut_through_peak(self.grid, powers);
                let before = follows.then(|| f64::from(powers_before[cluster.peak.cell as usize]) / noise);
                let peak = f64::from(cluster.peak.power) / noise;
                cluster.azimuth = [before.unwrap_or(f64::NAN), peak, f64::NAN];
            } else if cluster.peak_dwell + 1 == dwell {
                cluster.azimuth[2] = f64::from(powers[cluster.peak.cell as usize]) / noise;
            }
        }
        let (clusters, max_dwells) = (&self.clusters, self.max_dwells);
        self.open.retain(|&index| {
            let cluster = &clusters[index as usize];
            // A peak in the last dwell still waits for the power after it.
            let grows = cluster.last_dwell == dwell && dwell - cluster.first_dwell + 1 < max_dwells;
            let open = grows || cluster.peak_dwell == dwell;
            if !open {
                closed.push(cluster.clone());
            }
            open
        });
        if self.open.is_empty() {
            self.clusters.clear();
            self.parents.clear();
            self.now.clear();
        }
    }

    /// Closes all clusters, at the end of a stream or before a gap.
    pub fn close_all(&mut self, closed: &mut Vec<Cluster>) {
        closed.extend(self.open.drain(..).map(|cluster| self.clusters[cluster as usize].clone()));
        self.clusters.clear();
        self.parents.clear();
        self.now.clear();
        self.before.clear();
    }

    /// Puts a hit into the cluster of its neighbours, merging several, or into a new one.
    fn home_of(&mut self, dwell: u64, hit: Hit) -> u32 {
        let mut home = NONE;
        for elevation in -1..=1 {
            for doppler in -1..=1 {
                for range in -1..=1 {
                    let Some(cell) = self.grid.neighbour(hit.cell, (elevation, doppler, range)) else { continue };
                    for label in [self.before.of_cell[cell as usize], self.now.of_cell[cell as usize]] {
                        if label != NONE {
                            home = self.join(home, label, dwell);
                        }
                    }
                }
            }
        }
        if home == NONE {
            home = self.clusters.len() as u32;
            self.clusters.push(Cluster::of(self.grid, dwell, hit));
            self.parents.push(home);
            self.open.push(home);
        } else {
            self.clusters[home as usize].absorb(&Cluster::of(self.grid, dwell, hit));
        }
        home
    }

    /// Joins the cluster that `label` stands for with `home`, unless it has its full length or is closed.
    fn join(&mut self, home: u32, label: u32, dwell: u64) -> u32 {
        let found = self.root(label);
        if found == home {
            return home;
        }
        let cluster = &self.clusters[found as usize];
        if dwell - cluster.first_dwell >= self.max_dwells || !self.open.contains(&found) {
            return home;
        }
        if home == NONE {
            return found;
        }
        let (kept, merged) = (home.min(found), home.max(found));
        let absorbed = self.clusters[merged as usize].clone();
        self.clusters[kept as usize].absorb(&absorbed);
        self.parents[merged as usize] = kept;
        self.open.retain(|&index| index != merged);
        kept
    }

    fn root(&self, mut cluster: u32) -> u32 {
        while self.parents[cluster as usize] != cluster {
            cluster = self.parents[cluster as usize];
        }
        cluster
    }
}

impl Cluster {
    fn of(grid: CellGrid, dwell: u64, hit: Hit) -> Self {
        let unknown = [f64::NAN; 3];
        let (elevation, _, range) = grid.place(hit.cell);
        Self {
            first_dwell: dwell,
            last_dwell: dwell,
            hits: 1,
            peak_dwell: dwell,
            peak: hit,
            reaches: [range as u64, dwell, elevation as u64].map(|place| Reach::of(place, hit.power.into())),
            range: unknown,
            azimuth: unknown,
            elevation: unknown,
            doppler: unknown,
        }
    }

    fn absorb(&mut self, other: &Self) {
        self.first_dwell = self.first_dwell.min(other.first_dwell);
        self.last_dwell = self.last_dwell.max(other.last_dwell);
        self.hits += other.hits;
        for (reach, other) in self.reaches.iter_mut().zip(&other.reaches) {
            reach.absorb(other);
        }
        if other.peak.power > self.peak.power {
            let Self { first_dwell, last_dwell, hits, reaches, .. } = *self;
            *self = Self { first_dwell, last_dwell, hits, reaches, ..other.clone() };
        }
    }

    /// Notes the powers about the peak within its own dwell.
    fn cut_through_peak(&mut self, grid: CellGrid, powers: &[f32]) {
        let peak = self.peak;
        let cut = |step: (isize, isize, isize)| {
            let at = |cell: Option<u32>| {
                cell.map_or(f64::NAN, |cell| f64::from(powers[cell as usize]) / f64::from(peak.noise))
            };
            let back = (-step.0, -step.1, -step.2);
            [at(grid.neighbour(peak.cell, back)), at(Some(peak.cell)), at(grid.neighbour(peak.cell, step))]
        };
        self.elevation = cut((1, 0, 0));
        self.doppler = if grid.dopplers >= 3 { cut((0, 1, 0)) } else { [f64::NAN; 3] };
        self.range = cut((0, 0, 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: CellGrid = CellGrid { elevations: 4, dopplers: 6, ranges: 10 };

    fn cell(elevation: usize, doppler: usize, range: usize) -> u32 {
        ((elevation * 6 + doppler) * 10 + range) as u32
    }

    fn hit(cell: u32, power: f32) -> Hit {
        Hit { cell, power, noise: 1.0 }
    }

    /// Feeds dwells of hits and returns the closed clusters.
    fn run(max_dwells: u32, dwells: &[(u64, Vec<Hit>)]) -> Vec<Cluster> {
        let mut clustering = Clustering::new(GRID, max_dwells);
        let mut closed = Vec::new();
        let mut before = vec![0.5; GRID.cells()];
        for (dwell, hits) in dwells {
            let mut powers = vec![0.5; GRID.cells()];
            for hit in hits {
                powers[hit.cell as usize] = hit.power;
            }
            clustering.add(*dwell, hits, &powers, &before, &mut closed);
            before = powers;
        }
        clustering.close_all(&mut closed);
        closed
    }

    #[test]
    fn one_target_over_three_dwells_is_one_cluster_with_its_cuts() {
        let closed = run(
            12,
            &[
                (7, vec![hit(cell(1, 2, 5), 20.0)]),
                (8, vec![hit(cell(1, 2, 5), 50.0), hit(cell(1, 2, 6), 30.0)]),
                (9, vec![hit(cell(1, 2, 5), 25.0)]),
                (10, vec![]),
            ],
        );
        assert_eq!(closed.len(), 1);
        let cluster = &closed[0];
        assert_eq!((cluster.first_dwell, cluster.last_dwell, cluster.peak_dwell, cluster.hits), (7, 9, 8, 4));
        let same = |cut: Cut, powers: Cut| cut.iter().zip(powers).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(same(cluster.azimuth, [20.0, 50.0, 25.0]));
        assert!(same(cluster.range, [0.5, 50.0, 30.0]));
    }

    #[test]
    fn doppler_is_a_circle_and_elevation_is_not() {
        let closed = run(12, &[(0, vec![hit(cell(0, 0, 3), 20.0), hit(cell(0, 5, 3), 30.0)]), (1, vec![])]);
        assert_eq!(closed.len(), 1);
        let closed = run(12, &[(0, vec![hit(cell(0, 2, 3), 20.0), hit(cell(3, 2, 3), 30.0)]), (1, vec![])]);
        assert_eq!(closed.len(), 2);
    }

    #[test]
    fn two_arms_that_meet_later_become_one() {
        let closed = run(
            12,
            &[
                (0, vec![hit(cell(0, 2, 3), 20.0), hit(cell(0, 2, 7), 21.0)]),
                (1, vec![hit(cell(0, 2, 4), 22.0), hit(cell(0, 2, 5), 23.0), hit(cell(0, 2, 6), 24.0)]),
                (2, vec![]),
            ],
        );
        assert_eq!(closed.len(), 1);
        assert_eq!((closed[0].hits, closed[0].peak.cell), (5, cell(0, 2, 6)));
    }

    #[test]
    fn a_ring_of_clutter_is_cut_into_pieces() {
        let dwells: Vec<_> = (0..40).map(|dwell| (dwell, vec![hit(cell(0, 3, 1), 20.0 + dwell as f32)])).collect();
        let closed = run(12, &dwells);
        assert!((3..=5).contains(&closed.len()), "{}", closed.len());
        assert_eq!(closed.iter().map(|cluster| cluster.hits).sum::<u32>(), 40);
        assert!(closed.iter().all(|cluster| cluster.last_dwell - cluster.first_dwell < 13));
    }

    #[test]
    fn a_gap_between_dwells_separates() {
        let closed = run(12, &[(0, vec![hit(5, 20.0)]), (2, vec![hit(5, 20.0)])]);
        assert_eq!(closed.len(), 2);
        assert!(closed[1].azimuth[0].is_nan());
    }
}
