//! Checks of a machine and of a chain: is it fit, does it keep its limits, does it survive kills.

pub(crate) mod chaos;
pub(crate) mod compare;
pub(crate) mod doctor;
pub(crate) mod machine;
pub(crate) mod soak;
pub(crate) mod source;
