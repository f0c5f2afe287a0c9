//! Monte Carlo experiments: the chain's own code against theory, published figures and itself.
//!
//! ```text
//! options ─▶ experiment (one file each) ─▶ results: rows and figures ─▶ table, JSON, SVG
//!                 └─ parallel: the same runs in the same order, on any number of threads
//! ```
//!
//! An experiment is a function `run(&Options, &Progress) -> anyhow::Result<Results>`, listed in [`catalogue`]. Every figure
//! carries its number of samples and a 95 % interval; the seed repeats it exactly.

pub mod accuracy;
pub mod catalogue;
pub mod cfar;
pub mod crossing;
pub mod estimators;
pub mod figures;
pub mod fluctuation;
pub mod follow;
pub mod fused;
pub mod initiation;
pub mod judge;
pub mod multi_alternative;
pub mod options;
pub mod outliers;
pub mod page;
pub mod parallel;
pub mod plot_accuracy;
pub mod progress;
pub mod real_recordings;
pub mod results;
pub mod rows;
pub mod settings;
pub mod surround;
pub mod table;
pub mod track_loss;
pub mod trajectory;
pub mod turning;
pub mod vsmm;
pub mod world;

pub use options::Options;
pub use progress::Progress;
pub use results::Results;
pub use rows::{Case, Row};
