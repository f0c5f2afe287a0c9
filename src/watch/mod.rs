//! What the processes of a chain say of themselves, and who is told: the terminal, scripts, Prometheus.

pub(crate) mod endpoint;
pub(crate) mod metrics;
pub(crate) mod screen;
pub(crate) mod status;
