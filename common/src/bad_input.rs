//! What a user has to correct.

/// An error that the user has to correct before a process can start (exit code 2).
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);
