//! The kinds of targets, as experiments name them.

use common::config::Swerling;
use serde_json::Value;

/// All kinds.
pub const ALL: [Swerling; 3] = [Swerling::Zero, Swerling::One, Swerling::Three];

/// Name in cases, tables and figures, as in the configuration.
pub fn name(swerling: Swerling) -> &'static str {
    match swerling {
        Swerling::Zero => "0",
        Swerling::One => "I",
        Swerling::Three => "III",
    }
}

/// The kind as a parameter of a case.
pub fn parameter(swerling: Swerling) -> Value {
    name(swerling).into()
}
