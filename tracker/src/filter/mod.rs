//! Estimation: families of filters behind one seam, and the mathematics that they share.
//!
//! Whatever a family is, everyone else (gates, association, joint events, resolution, hypotheses, life, messages) sees its state as a short
//! list of weighted normal distributions, each of the leading 3, 6 or 9 states ([`Layout`], [`Mixture`]). The association turns the plots of
//! a scan into [`Evidence`] once, for every component; that is all that a family learns of a scan. A family ([`Filter`]) says how a state
//! starts, how it is predicted, and, where that is not the rule, how it is updated, merged and reported.
//!
//! ```text
//! layout, mixture   one state as numbers              lanes, functions  vectors of up to eight tracks
//! gaussian          order of states, packed triangles group             states of up to eight tracks
//! start             two plots make a state    (T17)   machine           the machine's instructions
//! propagate         F, G of a component  (T1), (T4)   expect            h(u*), gates       (T5), (T9)
//! markov            Π over any time step     (T2)     evidence, absorb  the update   (T8), (T14), (T15)
//! seam, catalogue   what a family is, and which there are   moments     mean and covariance    (T16)
//! uav, cv, turn, bank  the families
//! ```
//!
//! Formulas are written once, over vectors of up to eight tracks whose width is the machine's; one or two tracks are computed by the same code
//! with vectors of one ([`Machine`]). The filters know neither the beam nor where plots are stored nor the numbers of tracks.

#![expect(clippy::inline_always, reason = "vectors must stay in the function that was compiled for the machine")]

mod absorb;
pub mod bank;
mod catalogue;
pub mod cv;
mod evidence;
mod expect;
mod functions;
pub mod gaussian;
mod group;
mod innovation;
mod lanes;
mod layout;
mod machine;
mod markov;
mod mixture;
mod moments;
mod prior;
mod propagate;
mod seam;
mod start;
pub mod turn;
pub mod uav;

pub use absorb::{Densities, Weights, absorb};
pub use catalogue::{family, layout_of};
pub use evidence::Evidence;
pub use expect::{Expectation, expect};
pub use group::Group;
pub use lanes::{LANES, Row};
pub use layout::Layout;
pub use machine::Machine;
pub use mixture::{Mixture, merge, most_probable};
pub use moments::Moments;
pub use prior::Prior;
pub use seam::{Filter, Update};
pub use start::{Followed, Origin, TwoPlots};
