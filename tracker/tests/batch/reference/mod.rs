//! The drone filter one track at a time, in loops over small matrices: the definition that the vectors must equal.

pub(crate) mod expected;
pub(crate) mod imm;
pub(crate) mod motion;
pub(crate) mod rule;
