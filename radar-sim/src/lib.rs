//! Simulated scanning 3-D radar: the amplitude of every resolution cell.
