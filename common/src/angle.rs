//! Angles on the circle: the only place where they are wrapped or subtracted.

use std::f64::consts::{PI, TAU};

/// `angle` brought to [0, 2π); any finite input.
#[inline]
pub fn wrap(angle_rad: f64) -> f64 {
    if (0.0..TAU).contains(&angle_rad) {
        return angle_rad; // what the division would give, at a fraction of its time
    }
    let wrapped = angle_rad.rem_euclid(TAU);
    // rem_euclid of a tiny negative number rounds to 2π itself.
    if wrapped < TAU { wrapped } else { 0.0 }
}

/// The shortest way from `b` to `a`, in [−π, π).
#[inline]
pub fn difference(a_rad: f64, b_rad: f64) -> f64 {
    wrap(a_rad - b_rad + PI) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn wrap_stays_on_the_circle(angle in -1e6..1e6_f64) {
            let wrapped = wrap(angle);
            prop_assert!((0.0..TAU).contains(&wrapped));
            prop_assert!((wrapped.sin() - angle.sin()).abs() < 1e-8);
            prop_assert!((wrapped.cos() - angle.cos()).abs() < 1e-8);
        }

        #[test]
        fn difference_undoes_addition(b in 0.0..TAU, step in -3.1..3.1_f64) {
            prop_assert!((difference(wrap(b + step), b) - step).abs() < 1e-12);
        }
    }

    #[test]
    fn a_tiny_negative_angle_wraps_to_zero() {
        assert!(wrap(-1e-20) < TAU);
        assert!((difference(1e-3, TAU - 1e-3) - 2e-3).abs() < 1e-15);
    }
}
