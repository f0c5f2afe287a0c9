//! What the state of a family of filters consists of: as numbers, one after the other.
//!
//! ```text
//! [ W of each component | mean, packed covariance of the first | … of the last | memory of the family ]
//! ```
//! A component knows the leading 3 (position), 6 (and velocity) or 9 (and acceleration) states of [`super::gaussian`]. How many components
//! there are and what each knows is fixed for a family; what changes from track to track (a set of turn rates, a score) is its memory.

use common::tracks::MODELS;

use super::gaussian::packed;

/// The form of a family's states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    known: [usize; MODELS],
    /// First word of each component, then that of the memory.
    starts: [usize; MODELS + 1],
    len: usize,
    memory: usize,
    /// The component whose position stands for the track's where one place is asked for.
    pub reference: usize,
    /// The component whose gate is searched if another's is empty (T10).
    pub widest: usize,
}

impl Layout {
    /// Of components that know `known` states each, with `memory` further numbers.
    pub const fn new(known: &[usize], memory: usize, reference: usize, widest: usize) -> Self {
        assert!(!known.is_empty() && known.len() <= MODELS && reference < known.len() && widest < known.len());
        let mut layout =
            Self { known: [0; MODELS], starts: [known.len(); MODELS + 1], len: known.len(), memory, reference, widest };
        let mut j = 0;
        while j < known.len() {
            assert!(known[j] == 3 || known[j] == 6 || known[j] == 9);
            layout.known[j] = known[j];
            layout.starts[j + 1] = layout.starts[j] + known[j] + packed(known[j]);
            j += 1;
        }
        layout
    }

    /// Number of components.
    #[expect(clippy::len_without_is_empty, reason = "there is at least one")]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// States that component `j` knows.
    pub const fn known(&self, j: usize) -> usize {
        self.known[j]
    }

    /// First word of component `j`: its mean, then its covariance.
    pub const fn start(&self, j: usize) -> usize {
        self.starts[j]
    }

    /// First word of the memory.
    pub const fn memory_start(&self) -> usize {
        self.starts[self.len]
    }

    /// Words of a state.
    pub const fn words(&self) -> usize {
        self.starts[self.len] + self.memory
    }

    /// The most states that any component knows.
    pub fn most_known(&self) -> usize {
        self.known.iter().copied().fold(0, usize::max)
    }
}
