//! Equal decisions in a row.

/// A decision for a system track, and how often in a row it was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decision {
    /// Number of the system track.
    pub(super) system: u64,
    /// How often in a row.
    pub(super) count: u32,
    /// Cycle of the last time.
    cycle: u64,
}

impl Decision {
    /// The decision of this cycle after `before`; decisions are made every `every` cycles, and one that was left out ends the row.
    pub(super) fn again(before: Option<Self>, system: u64, cycle: u64, every: u64) -> Self {
        let in_a_row = before.filter(|before| before.system == system && before.cycle + every == cycle);
        Self { system, count: in_a_row.map_or(0, |before| before.count) + 1, cycle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_system_track_or_a_gap_begins_a_new_row() {
        let mut decision = None;
        let mut decide = |system, cycle| {
            decision = Some(Decision::again(decision, system, cycle, 1));
            decision.map_or(0, |decision| decision.count)
        };
        assert_eq!(
            [decide(7, 1), decide(7, 2), decide(8, 3), decide(8, 4), decide(8, 6), decide(8, 7)],
            [1, 2, 1, 2, 1, 2]
        );
    }
}
