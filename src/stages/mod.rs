//! The processes of a chain: which there are, how each is started and watched, where one that died goes on.

pub(crate) mod child;
pub(crate) mod name;
pub(crate) mod orphans;
pub(crate) mod resume;
pub(crate) mod stage;
pub(crate) mod supervisor;
