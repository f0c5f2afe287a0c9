//! Recordings as Parquet tables, with the columns of the CSV.
//!
//! The Parquet library and what it needs take a tenth of a build from nothing, and no chain needs them: so they are a
//! program of their own, which `recorder export --format parquet` starts.

mod parquet_table;

pub use parquet_table::Parquet;
