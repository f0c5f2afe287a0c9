//! How often a target's track changes its identity.

/// The track that follows one target, scan by scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Holder<Id> {
    last: Option<Id>,
}

impl<Id> Default for Holder<Id> {
    fn default() -> Self {
        Self { last: None }
    }
}

impl<Id: PartialEq> Holder<Id> {
    /// Takes the track that follows the target now; whether it is another one than the last. Scans without a track are
    /// left out: a target that is lost and found again by the same track has not changed it.
    pub fn follow(&mut self, id: Id) -> bool {
        let changes = self.last.as_ref().is_some_and(|last| *last != id);
        self.last = Some(id);
        changes
    }

    /// Whether this track was the last to follow the target.
    pub fn is(&self, id: &Id) -> bool {
        self.last.as_ref() == Some(id)
    }
}

/// Number of changes of the holder of one target, scan by scan: `None` where no track follows it.
///
/// The order of scans matters, the length of gaps does not. Divided by hours of truth it compares runs of different length.
pub fn changes<Id: PartialEq>(holders: impl IntoIterator<Item = Option<Id>>) -> u64 {
    let mut holder = Holder::default();
    holders.into_iter().flatten().map(|id| u64::from(holder.follow(id))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn gaps_are_no_changes() {
        assert_eq!(changes([Some(1), None, Some(1), Some(1)]), 0);
        assert_eq!(changes([None, Some(1), Some(2), None, Some(1)]), 2);
        assert_eq!(changes::<u64>([]), 0);
        let mut holder = Holder::default();
        assert!(!holder.is(&7) && !holder.follow(7) && holder.is(&7) && holder.follow(8) && !holder.is(&7));
    }

    proptest! {
        /// The definition: neighbours that differ after the gaps are taken out.
        #[test]
        fn neighbours_that_differ(holders in prop::collection::vec(prop::option::of(0_u8..3), 0..40)) {
            let held: Vec<u8> = holders.iter().copied().flatten().collect();
            let expected = held.windows(2).filter(|pair| pair[0] != pair[1]).count() as u64;
            prop_assert_eq!(changes(holders), expected);
        }
    }
}
