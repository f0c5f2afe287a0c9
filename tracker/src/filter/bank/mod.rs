//! Filters of correlated acceleration by coordinate (M1)-(M4): several hypotheses on its mean, or one hypothesis whose bandwidth adapts.
//!
//! East, north and up are filtered apart, with the plots' position errors along each. Everyone else sees one component: position, velocity and
//! acceleration of all hypotheses together. Association makes one weight of each plot by that component, which every hypothesis takes; range
//! rates count there and not in the filters.
//!
//! The memory of a state is a block for each coordinate ([`Block`]).

mod adaptive;
mod axis;
mod block;
mod coordinates;
mod hypotheses;
mod rule;
mod singer;

pub use adaptive::AdaptiveBandwidth;
pub(super) use adaptive::LAYOUT as ADAPTIVE_LAYOUT;
pub use block::Block;
pub use hypotheses::MultiAlternative;
pub(super) use hypotheses::layout as layout_of_hypotheses;
pub use rule::Rule;
