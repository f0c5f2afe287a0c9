//! Eight tracks at a time: predict, gate, associate and update as vector operations.
//!
//! The filter of [`crate::filter::uav::imm`] and [`crate::plots::measurement`] with the association rule (T20), in structure-of-arrays
//! [`Block`]s. One pass over a block:
//! ```text
//! predict  (vectors)    W*, u*, P* of three modes ─▶ h, P* H₄ᵀ, gate of each mode, U_j                 (T2)-(T5), (T9)
//! choose   (by track)   t, D from U_j;  plots with q ≥ t in any gate ─▶ slot m = 1, 2, … of the lane   (T20) 1-3
//! update   (vectors)    for each mode:
//!                         for each slot:  D⁻¹ unless as before;  d, y = D⁻¹ d, e;  Σ e, ȳ, Σ e (y yᵀ − D⁻¹) about ȳ
//!                         L, w;  û = u* + B ȳ;  P̂ = P* + B M Bᵀ                                        (T20) 4, (T14)
//!                       W ∝ W* L
//! ```
//! `choose` is the caller's: it knows the plots, the threshold and the clutter. [`Bank`] is such a caller.
//!
//! The budget is 5040 multiplications and additions a track and 159 a plot; at 8 lanes and two fused operations a
//! cycle some 200 cycles. What is not arithmetic must therefore stay small: a block is loaded and stored whole, the
//! states of two axes stay in registers from P̂ to P*, slots of equal errors share one factorisation.
//!
//! The oracle is the plain code, one track at a time, in `tests/batch`.

#![expect(clippy::inline_always, reason = "vectors must stay in the function that was compiled for the machine")]

mod bank;
mod block;
mod candidates;
mod expect;
mod functions;
mod kernel;
mod lanes;
mod predict;
mod update;

pub use bank::{Bank, Offer, Passed, Scan};
pub use block::{Block, Mode};
pub use candidates::Candidates;
pub use expect::Expectation;
pub use kernel::{Forecast, Kernel};
pub use lanes::{LANES, Row};
pub use predict::Step;
pub use update::Weights;
