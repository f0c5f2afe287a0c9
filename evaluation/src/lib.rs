//! Measures of detection and tracking, each with the interval that says how sure it is.
//!
//! ```text
//! estimate       a figure with its interval       quantile       normal, Student, χ², beta
//! proportion     Wilson                           mean           Student; moments of a stream
//! poisson        counts and rates                 bootstrap      anything else: ratios, rms
//! simultaneous   several figures at once          contrast       difference, sum, ratio of two
//! rms            root mean square errors          consistency    NEES, NIS and their χ² region
//! assignment     the cheapest pairing             ospa, gospa    distance of two sets of states
//! track_loss     out of bounds for some scans     initiation     scans until a target is followed
//! following      who follows whom in a scan       identity       changes of a target's track
//! ```
//!
//! The crate depends on nothing of the chain: numbers in, numbers out. It reads no clock and draws random numbers
//! only from the generator it is given.

pub mod assignment;
pub mod bootstrap;
pub mod consistency;
pub mod contrast;
mod estimate;
pub mod following;
pub mod gospa;
pub mod identity;
pub mod initiation;
pub mod mean;
pub mod ospa;
pub mod poisson;
pub mod proportion;
pub mod quantile;
pub mod rms;
pub mod simultaneous;
pub mod track_loss;

pub use estimate::Estimate;
