//! The only conversions of units; everything else is SI and radians.

/// Power ratio of a level in dB.
pub fn from_db(level_db: f64) -> f64 {
    10.0_f64.powf(level_db / 10.0)
}

/// Level in dB of a power ratio.
pub fn to_db(ratio: f64) -> f64 {
    10.0 * ratio.log10()
}

/// Speed of light, m/s.
pub const SPEED_OF_LIGHT_MPS: f64 = 299_792_458.0;

/// Bytes in a MiB.
pub const MIB: f64 = 1_048_576.0;

/// ns in a second.
pub const NS_PER_S: f64 = 1e9;
/// Nanoseconds of a day.
pub const DAY_NS: u64 = 86_400_000_000_000;

/// `t1 − t0` in s; negative when `t1` is earlier.
#[inline]
pub fn seconds_between(t0_ns: u64, t1_ns: u64) -> f64 {
    if t1_ns >= t0_ns { (t1_ns - t0_ns) as f64 / NS_PER_S } else { -((t0_ns - t1_ns) as f64) / NS_PER_S }
}
