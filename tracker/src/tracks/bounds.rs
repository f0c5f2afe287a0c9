//! When a track no longer follows anything: it does not know where its target is, or it does what no target can.
//!
//! | bound | why |
//! |---|---|
//! | deviation of position ≤ 2 v_max T + 3 cells | a target that could be anywhere within some turns' flight is lost |
//! | speed − 3 deviations ≤ 1.5 v_max | v_max is the fastest that starts; it may gain some speed |
//! | false plots in the estimate's ellipsoid of two deviations ≤ 1 | where false plots lie all over it, a plot in its gate is no evidence |

use crate::plots::radar::Radar;

/// Turns of the fastest flight that a position may be uncertain by.
const TURNS: f64 = 2.0;
/// Resolution cells that come on top.
const CELLS: f64 = 3.0;
/// Speed over that of the fastest start.
const SPEED: f64 = 1.5;
/// Standard deviations of the speed that it must be too fast by.
const SURE: f64 = 3.0;
/// False plots in an estimate that says nothing.
const ADRIFT: f64 = 1.0;

/// How well a track knows its target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Volume of the ellipsoid of two standard deviations, in the measure of y and of what the radar measures (m³·m/s, or fewer dimensions).
    pub volume: f64,
    /// Root of the sum of the variances of position, m.
    pub position_m: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Root of the sum of the variances of velocity, m/s.
    pub velocity_mps: f64,
}

impl Spread {
    /// Whether the target is lost, or was none: of a radar that starts tracks of up to `fastest_mps` and turns in `period_s`, at a range.
    pub fn is_lost(&self, radar: &Radar, range_m: f64, fastest_mps: f64, period_s: f64) -> bool {
        self.position_m > TURNS * fastest_mps * period_s + CELLS * radar.cell_m(range_m)
            || self.speed_mps - SURE * self.velocity_mps > SPEED * fastest_mps
    }

    /// Whether plots among false ones of such a `density` (in the measure of y) are no evidence.
    pub fn is_adrift(&self, density: f64) -> bool {
        density * self.volume > ADRIFT
    }
}
