//! Equal decisions in a row.

/// A decision for a system track or for none, and how often in a row it was made on new data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decision {
    /// Number of the system track.
    pub(super) system: Option<u64>,
    /// How often in a row. What is decided again on the same data is no further decision.
    pub(super) count: u32,
    /// Cycle of the last time.
    cycle: u64,
    /// Time of the newest data that it was made on, ns.
    data_ns: u64,
}

impl Decision {
    /// The decision of this cycle after `before`, on data up to `data_ns`; decisions are made every `every` cycles, and one that was left
    /// out ends the row.
    pub(super) fn again(before: Option<Self>, system: Option<u64>, cycle: u64, every: u64, data_ns: u64) -> Self {
        let in_a_row = before.filter(|before| before.system == system && before.cycle + every == cycle);
        let count = in_a_row.map_or(1, |before| before.count + u32::from(data_ns > before.data_ns));
        Self { system, count, cycle, data_ns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often in a row, for decisions for a system track in a cycle on data of a time.
    fn counts(decisions: &[(u64, u64, u64)]) -> Vec<u32> {
        let mut decision = None;
        let decide = |&(system, cycle, data_ns): &(u64, u64, u64)| {
            let now = Decision::again(decision, Some(system), cycle, 1, data_ns);
            decision = Some(now);
            now.count
        };
        decisions.iter().map(decide).collect()
    }

    #[test]
    fn another_system_track_or_a_gap_begins_a_new_row() {
        let decisions = [(7, 1, 1), (7, 2, 2), (8, 3, 3), (8, 4, 4), (8, 6, 6), (8, 7, 7)];
        assert_eq!(counts(&decisions), [1, 2, 1, 2, 1, 2]);
    }

    #[test]
    fn what_is_decided_again_on_the_same_data_does_not_count() {
        assert_eq!(counts(&[(7, 1, 10), (7, 2, 10), (7, 3, 10), (7, 4, 20), (7, 5, 20)]), [1, 1, 1, 2, 2]);
    }
}
