//! Cells in, plots out: CFAR, clustering over range, Doppler, elevation and successive
//! dwells, interpolation of the position, decision statistics.
//!
//! ```text
//! dwell ─▶ cfar (hits) ─▶ clustering (one cluster per target) ─▶ centroid ─▶ plots of a sector
//! ```
//!
//! Formulas: (C3), (C4), (C8)-(C12) of `docs/theory/amplitude.md`, (C6), (C7), (C14) of `docs/theory/cells-and-plots.md`. The library knows no clock
//! and no shared memory; [`process`] is the shell around it.

pub mod centroid;
pub mod cfar;
pub mod clustering;
pub mod extent;
pub mod extractor;
pub mod jamming;
pub mod process;
pub mod replay;

pub use extractor::PlotExtractor;
