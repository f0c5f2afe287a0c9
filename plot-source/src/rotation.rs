//! When each turn of the antenna began.
//!
//! A start-of-update-cycle message is sent as the antenna passes north: in the Barcelona
//! recording azimuth is 2π (t − t₀)/T to within 8° throughout, where t₀ is the time of the
//! message and T the time to the next. Some messages are missing; the antenna turned all the
//! same, so a gap of n periods is n scans of equal length.

/// A pause longer than this many periods is one scan: the recording was interrupted.
const LONGEST_GAP: u64 = 60;

/// North passages, ns UTC, ascending; scan k lasts from passage k to passage k + 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rotations {
    passages_ns: Vec<u64>,
}

impl Rotations {
    /// From the start-of-cycle messages of a recording whose first target report was made at
    /// `first_report_ns`. The first scan is the one that the first message closes, unless
    /// there are no reports in it; the last one begins with the last message. `None` without messages.
    pub fn new(mut cycles_ns: Vec<u64>, first_report_ns: Option<u64>, period_ns: u64) -> Option<Self> {
        cycles_ns.sort_unstable();
        let first = *cycles_ns.first()?;
        let mut passages_ns = Vec::with_capacity(cycles_ns.len() + 2);
        if first_report_ns.is_some_and(|report| report < first) {
            passages_ns.push(first.saturating_sub(period_ns));
        }
        passages_ns.push(first);
        for time_ns in cycles_ns {
            let last = *passages_ns.last()?;
            let gap = time_ns - last;
            if gap > period_ns / 2 {
                let turns = match (gap + period_ns / 2) / period_ns {
                    turns @ 2..=LONGEST_GAP => turns,
                    _ => 1,
                };
                passages_ns.extend((1..=turns).map(|turn| last + gap * turn / turns));
            }
        }
        passages_ns.push(passages_ns.last()? + period_ns);
        Some(Self { passages_ns })
    }

    /// Number of scans.
    pub fn scans(&self) -> usize {
        self.passages_ns.len() - 1
    }

    /// Begin and end of a scan.
    pub fn bounds_ns(&self, scan: usize) -> (u64, u64) {
        (self.passages_ns[scan], self.passages_ns[scan + 1])
    }

    /// The scan that a report belongs to: the one whose start is nearest to the time at which
    /// the antenna passed north before the report. Time alone would mistake reports near north.
    pub fn scan_of(&self, time_ns: u64, turned: f64) -> Option<usize> {
        let roughly = self.scan_at(time_ns).unwrap_or(0);
        let (begin, end) = self.bounds_ns(roughly.min(self.scans() - 1));
        let north_ns = time_ns.saturating_sub(((end - begin) as f64 * turned) as u64);
        let after = self.passages_ns.partition_point(|&passage| passage <= north_ns);
        let distance = |index: usize| self.passages_ns[index].abs_diff(north_ns);
        let nearest = match after {
            0 => 0,
            after if after == self.passages_ns.len() => after - 1,
            after if distance(after) < distance(after - 1) => after,
            after => after - 1,
        };
        let within = nearest < self.scans() && distance(nearest) <= (end - begin) / 2;
        within.then_some(nearest)
    }

    /// The scan in which a time lies.
    pub fn scan_at(&self, time_ns: u64) -> Option<usize> {
        let after = self.passages_ns.partition_point(|&passage| passage <= time_ns);
        (1..self.passages_ns.len()).contains(&after).then(|| after - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_message_is_made_up_for() {
        let rotations = Rotations::new(vec![1000, 2010, 4030, 5040], Some(300), 1000).expect("cycles");
        assert_eq!(rotations.passages_ns, [0, 1000, 2010, 3020, 4030, 5040, 6040]);
        let nothing_before = Rotations::new(vec![1000, 2000], Some(1300), 1000).expect("cycles");
        assert_eq!(nothing_before.passages_ns, [1000, 2000, 3000]);
        let interrupted = Rotations::new(vec![1000, 90_000], None, 1000).expect("cycles");
        assert_eq!(interrupted.passages_ns, [1000, 90_000, 91_000]);
        assert_eq!(Rotations::new(vec![], Some(5), 1000), None);
    }

    #[test]
    fn reports_near_north_belong_to_the_turn_that_their_azimuth_tells() {
        let rotations = Rotations::new(vec![1000, 2000, 3000], None, 1000).expect("cycles");
        assert_eq!(rotations.scan_of(1990, 0.01), Some(1)); // early, just past north
        assert_eq!(rotations.scan_of(2010, 0.99), Some(0)); // late, just before north
        assert_eq!(rotations.scan_of(2500, 0.5), Some(1));
        assert_eq!(rotations.scan_of(3990, 0.99), Some(2));
        assert_eq!(rotations.scan_of(200, 0.0), None); // before the first turn
        assert_eq!(rotations.scan_of(5000, 0.0), None); // after the last
    }
}
