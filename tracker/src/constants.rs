//! Numbers that tune the tracker and are no configuration: nobody has yet had a reason to change them.

/// Association weight with a confirmed track from which a plot starts no new one and is no evidence for a tentative one.
pub(crate) const EXPLAINED: f64 = 0.2;
/// Weight of "none" above which a scan counts as one without a plot.
pub(crate) const MISS_WEIGHT: f64 = 0.5;
/// Scans for which two targets may be a single plot before that speaks against one of them.
pub(crate) const MERGED_SCANS: u32 = 12;
/// Probability of not being resolved below which two tracks are apart.
pub(crate) const APART: f64 = 0.5;

/// Scans in which two tracks share their best plot before one of them goes: if one is tentative, and if both are confirmed.
pub(crate) const SHARED_SCANS: [u32; 2] = [2, 6];
/// Share of the greatest speed at which two targets that have been seen apart pass each other within a resolution cell, and the scans of that at
/// most: two that the radar does not resolve for longer are one to it.
pub(crate) const PASSING_SPEED: f64 = 0.035;
pub(crate) const MOST_PASSING: f64 = 60.0;
/// Squared distance of two tracks' positions and velocities below which they may be one: of χ² with 6 degrees of freedom, 0.999.
pub(crate) const SAME: f64 = 22.458;

/// A prediction is renewed if the beam will pass this much earlier or later than it was made for, s.
pub(crate) const TIMING_S: f64 = 0.02;
/// A plot this far behind what has been processed may still be used, cells of azimuth: interpolation moves plots a little.
pub(crate) const LATE_CELLS: f64 = 2.0;

/// Turns in which a track that an operator has asked for must begin.
pub(crate) const ACQUISITION_TURNS: u32 = 5;
/// Cells in range and azimuth that its plots may lie beside the place asked for.
pub(crate) const ACQUISITION_CELLS: f64 = 3.0;
/// Existence below which two plots start no track.
pub(crate) const LEAST_EXISTENCE: f64 = 1e-7;
/// Shortest and longest time between two plots of successive turns, turns.
pub(crate) const STEP_TURNS: [f64; 2] = [0.25, 1.5];

/// Plots of one gate, or of one beam width, that are no crowd: a target's own, and a neighbour's.
pub(crate) const FEW: usize = 3;
