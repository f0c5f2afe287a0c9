//! Real plots in place of the simulator: ASTERIX recordings.
