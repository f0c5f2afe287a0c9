//! When a track has lost its target.

/// A run of scans out of bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loss {
    /// Index of the first scan of the run: when the track was lost.
    pub began: usize,
    /// Index of the scan that completed the run: when it could be said.
    pub noticed: usize,
}

/// Counts scans in a row out of bounds, as they come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Watch {
    scans: usize,
    seen: usize,
    outside: usize,
}

impl Watch {
    /// `scans` scans in a row lose a track.
    ///
    /// # Panics
    /// If `scans` is 0.
    pub fn new(scans: usize) -> Self {
        assert!(scans > 0, "a run has at least one scan");
        Self { scans, seen: 0, outside: 0 }
    }

    /// Takes a scan; the loss in the scan that completes it. A run that goes on is not lost again.
    pub fn see(&mut self, inside: bool) -> Option<Loss> {
        self.seen += 1;
        self.outside = if inside { 0 } else { self.outside + 1 };
        (self.outside == self.scans).then(|| Loss { began: self.seen - self.scans, noticed: self.seen - 1 })
    }
}

/// The first `scans` scans in a row in which the error exceeds `bound`; `None` if the track is kept to the end.
///
/// `errors` has one value a scan, in the unit of `bound`; NaN, where there is no track at all, counts as out of bounds.
/// A run that the end of the record cuts short is no loss. The criterion does not depend on gates, so trackers with
/// gates of different size can be compared.
///
/// # Panics
/// If `scans` is 0.
pub fn first(errors: impl IntoIterator<Item = f64>, bound: f64, scans: usize) -> Option<Loss> {
    let mut watch = Watch::new(scans);
    errors.into_iter().find_map(|error| watch.see(error <= bound))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn three_in_a_row() {
        let errors = [10.0, 200.0, 200.0, 150.0, 151.0, f64::NAN, 9999.0, 10.0];
        assert_eq!(first(errors, 150.0, 3), Some(Loss { began: 4, noticed: 6 }));
        assert_eq!(first(errors, 150.0, 4), None);
        assert_eq!(first(errors, 100.0, 3), Some(Loss { began: 1, noticed: 3 }));
        assert_eq!(first([200.0, 200.0], 150.0, 3), None);
    }

    proptest! {
        /// The definition: the first window whose values are all out of bounds.
        #[test]
        fn it_is_the_first_window_out_of_bounds(errors in prop::collection::vec(0_u8..4, 0..30), scans in 1_usize..5) {
            let errors: Vec<f64> = errors.into_iter().map(f64::from).collect();
            let window = errors.windows(scans).position(|window| window.iter().all(|&error| error > 1.0));
            let expected = window.map(|began| Loss { began, noticed: began + scans - 1 });
            prop_assert_eq!(first(errors, 1.0, scans), expected);
        }
    }
}
