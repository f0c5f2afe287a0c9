//! IMM-PDA tracking with plot statistics: plots in, tracks out.
