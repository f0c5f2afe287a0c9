//! Plots: what they measure, and where they are kept and found.

mod crowd;
pub mod false_alarm_map;
pub mod false_alarms;
pub mod index;
pub mod measurement;
pub mod radar;
pub mod store;
