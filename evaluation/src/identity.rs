//! How often a target's track changes its identity.

/// Number of changes of the holder of one target, scan by scan: `None` where no track follows it.
///
/// A target that is lost and found again by the same track has not changed it. The order of scans matters, the length
/// of gaps does not. Divided by hours of truth it compares runs of different length.
pub fn changes<Id: PartialEq>(holders: impl IntoIterator<Item = Option<Id>>) -> u64 {
    let mut last = None;
    let mut count = 0;
    for id in holders.into_iter().flatten() {
        count += u64::from(last.as_ref().is_some_and(|last| *last != id));
        last = Some(id);
    }
    count
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
