//! The machine's instructions: vectors for several tracks, scalars for one or two, both of the same formulas.

use pulp::Arch;

/// Tracks from which vectors cost less than one track after the other.
const LEAST_VECTOR: usize = 3;

/// Which instructions to compute with.
#[derive(Debug, Clone, Copy)]
pub struct Machine {
    best: Arch,
}

impl Default for Machine {
    /// The best that this machine has.
    fn default() -> Self {
        Self { best: Arch::new() }
    }
}

impl Machine {
    /// With other instructions than the machine's best, to compare.
    pub fn on(best: Arch) -> Self {
        Self { best }
    }

    /// Instructions for `lanes` tracks.
    pub(in crate::filter) fn arch(self, lanes: usize) -> Arch {
        if lanes < LEAST_VECTOR { Arch::Scalar } else { self.best }
    }
}
