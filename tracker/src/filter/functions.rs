//! exp, sine, cosine and arctan of a vector of lanes, to a few units in the last place.
//!
//! ```text
//! exp x = 2^k e^r,  k = round(x / ln 2),  |r| ≤ ln 2 / 2: Taylor's series        (Cody & Waite's reduction)
//! sin, cos: of a quarter of the angle, |x| ≤ π/4, doubled twice                   (Cephes, Moshier)
//! arctan:  an eighth turn at a time, then t + t z P(z)/Q(z), z = t²              (Cephes, Moshier)
//! ```

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LOG2_E, PI};

use pulp::Simd;

use super::lanes::V;

/// 1.5 · 2⁵²: adding it rounds to a whole number, which then stands in the lowest bits.
const TO_WHOLE: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts; k times the first is exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
/// 1/n!, from 13 down to 0.
const FACTORIALS: [f64; 14] = [
    1.0 / 6_227_020_800.0,
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
    1.0,
    1.0,
];
/// Below this e^x counts as 0, so that no result is denormal.
const EXP_LEAST: f64 = -708.0;
/// Above this e^x stays as it is here.
const EXP_MOST: f64 = 709.0;

/// (sin x − x)/x³ and (cos x − 1 + x²/2)/x⁴ in x², |x| ≤ π/4.
const SINE: [f64; 6] = [
    1.589_623_015_765_465_7e-10,
    -2.505_074_776_285_780_7e-8,
    2.755_731_362_138_572_5e-6,
    -1.984_126_982_958_954e-4,
    8.333_333_333_322_118e-3,
    -1.666_666_666_666_663e-1,
];
const COSINE: [f64; 6] = [
    -1.135_853_652_138_768_2e-11,
    2.087_570_084_197_473e-9,
    -2.755_731_417_929_674e-7,
    2.480_158_728_885_170_5e-5,
    -1.388_888_888_887_305_6e-3,
    4.166_666_666_666_659e-2,
];

/// P and Q of arctan on |t| ≤ 0.66.
const ATAN_P: [f64; 5] = [
    -8.750_608_600_031_904e-1,
    -1.615_753_718_733_365e1,
    -7.500_855_792_314_705e1,
    -1.228_866_684_490_136_1e2,
    -6.485_021_904_942_025e1,
];
const ATAN_Q: [f64; 6] = [
    1.0,
    2.485_846_490_142_306_4e1,
    1.650_270_098_316_988_6e2,
    4.328_810_604_912_903e2,
    4.853_903_996_359_137e2,
    1.945_506_571_482_614e2,
];
/// tan(π/8).
const TAN_PI_8: f64 = 0.414_213_562_373_095_03;

impl<S: Simd> V<S> {
    /// e^x; 0 below −708, constant above 709.
    #[inline(always)]
    pub(in crate::filter) fn exp(self) -> Self {
        let x = self.min(self.splat(EXP_MOST)).max(self.splat(EXP_LEAST));
        let to_whole = self.splat(TO_WHOLE);
        let whole = x * self.splat(LOG2_E) + to_whole;
        let k = whole - to_whole;
        let r = x - k * self.splat(LN_2[0]) - k * self.splat(LN_2[1]);
        let power = polynomial(r, &FACTORIALS).times_power_of_two(whole);
        self.splat(EXP_LEAST).less(self).pick(power, self.splat(0.0))
    }

    /// Sine and cosine of an angle of up to some thousand turns, rad; finite for any finite angle.
    #[inline(always)]
    pub(in crate::filter) fn sin_cos(self) -> (Self, Self) {
        let (one, half, to_whole) = (self.splat(1.0), self.splat(0.5), self.splat(TO_WHOLE));
        let turns = self * self.splat(0.5 / PI) + to_whole - to_whole;
        let within = (self - turns * self.splat(2.0 * PI)).min(self.splat(PI)).max(self.splat(-PI));
        let x = (within * self.splat(0.25)).rounded();
        let square = (x * x).rounded();
        let cube = (square * x).rounded();
        let mut sine = x + cube * polynomial(square, &SINE);
        let mut cosine = one - half * square + square * square * polynomial(square, &COSINE);
        for _ in 0..2 {
            let twice = sine + sine;
            (sine, cosine) = ((twice * cosine).rounded(), one - twice * sine);
        }
        (sine, cosine)
    }

    /// β of (T5): the angle of (`self`, `north`) clockwise from north, in [0, 2π); 0 of (0, 0).
    #[inline(always)]
    pub(in crate::filter) fn azimuth(self, north: Self) -> Self {
        let zero = self.splat(0.0);
        let acute = self.abs().acute_angle(north.abs());
        let half_turn = north.less(zero).pick(self.splat(PI) - acute, acute);
        let tau = self.splat(2.0 * PI);
        let turn = self.less(zero).pick(tau - half_turn, half_turn);
        turn.less(tau).pick(turn, zero)
    }

    /// ε of (T5): the angle of `self` up from `ground` ≥ 0, in [−π/2, π/2]; 0 of (0, 0).
    #[inline(always)]
    pub(in crate::filter) fn elevation(self, ground: Self) -> Self {
        let acute = self.abs().acute_angle(ground);
        self.less(self.splat(0.0)).pick(-acute, acute)
    }

    /// arctan(`self`/`other`) for both ≥ 0, in [0, π/2]; 0 of (0, 0).
    #[inline(always)]
    fn acute_angle(self, other: Self) -> Self {
        // Up to π/8 as it is, up to 3π/8 from π/4, beyond from π/2: one division whichever it is.
        let (y, x) = (self, other);
        let tan_pi_8 = self.splat(TAN_PI_8);
        let low = y.less((x * tan_pi_8).rounded());
        let high = x.less((y * tan_pi_8).rounded());
        let numerator = low.pick(y, high.pick(-x, y - x));
        let denominator = low.pick(x, high.pick(y, y + x));
        let from = low.pick(self.splat(0.0), high.pick(self.splat(FRAC_PI_2), self.splat(FRAC_PI_4)));
        let any = self.splat(0.0).less(denominator);
        let t = any.pick(numerator / denominator, self.splat(0.0));
        let z = (t * t).rounded();
        let angle = from + (t + t * (z * (polynomial(z, &ATAN_P) / polynomial(z, &ATAN_Q))).rounded());
        any.pick(angle, self.splat(0.0))
    }
}

/// Σ c_i x^(n−i) by Horner's rule.
#[inline(always)]
pub(in crate::filter) fn polynomial<S: Simd, const N: usize>(x: V<S>, coefficients: &[f64; N]) -> V<S> {
    let mut sum = x.splat(coefficients[0]);
    for coefficient in &coefficients[1..] {
        sum = sum * x + x.splat(*coefficient);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::lanes::{LANES, Lanes, Row};
    use super::*;
    use common::angle;
    use proptest::prelude::*;
    use pulp::{Arch, WithSimd};

    /// e^x, azimuth and elevation of (x, y), sine and cosine of x in every lane.
    struct All([Row; 2]);

    impl WithSimd for All {
        type Output = [Row; 5];

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> [Row; 5] {
            let mut out = [Row::ZERO; 5];
            for part in 0..Lanes::<S>::parts(LANES) {
                let lanes = Lanes::of(simd, part);
                let [x, y] = lanes.all(&self.0);
                lanes.put(&mut out[0], x.exp());
                lanes.put(&mut out[1], x.azimuth(y));
                lanes.put(&mut out[2], x.elevation(y.abs()));
                let (sine, cosine) = x.sin_cos();
                lanes.put(&mut out[3], sine);
                lanes.put(&mut out[4], cosine);
            }
            out
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]
        /// Against the standard library: four units in the last place.
        #[test]
        fn they_agree_with_the_library(
            x in prop_oneof![-708.0..709.0_f64, -1.0..1.0_f64, -1e-9..1e-9_f64, Just(0.0)],
            y in prop_oneof![-700.0..700.0_f64, -1.0..1.0_f64, Just(0.0)],
        ) {
            for arch in [Arch::new(), Arch::Scalar] {
                let out = arch.dispatch(All([Row::splat(x), Row::splat(y)]));
                let [exp, azimuth, elevation, sine, cosine] = out.map(|row| row.0[7]);
                prop_assert!((exp / x.exp() - 1.0).abs() < 4.0 * f64::EPSILON, "{x} {exp}");
                let expected = if x == 0.0 && y == 0.0 { 0.0 } else { x.atan2(y) };
                prop_assert!(angle::difference(azimuth, expected).abs() < 4.0 * f64::EPSILON * PI, "{x} {y} {azimuth}");
                prop_assert!((0.0..2.0 * PI).contains(&azimuth));
                let limit = 8.0 * f64::EPSILON * (1.0 + x.abs());
                prop_assert!((sine - x.sin()).abs() < limit && (cosine - x.cos()).abs() < limit, "{x} {sine} {cosine}");
                let expected = x.atan2(y.abs());
                prop_assert!((elevation - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{x} {y} {elevation}");
            }
        }
    }

    #[test]
    fn sine_and_cosine_of_any_angle_are_finite() {
        let out = Arch::new().dispatch(All([Row([1e300, -1e300, f64::MAX, 1e16, -1e9, 1e-300, -0.0, 7.0]); 2]));
        assert!(out[3].0.iter().chain(&out[4].0).all(|value| value.abs() <= 1.0 + 1e-9), "{out:?}");
    }

    #[test]
    fn exp_ends_in_zero_and_stays_finite() {
        let out =
            Arch::new().dispatch(All([Row([-1e300, -709.0, -708.0, 0.0, 709.0, 1e300, f64::NEG_INFINITY, 1.0]); 2]));
        assert!(out[0].0[0] <= 0.0 && out[0].0[1] <= 0.0 && out[0].0[6] <= 0.0, "{out:?}");
        assert!(out[0].0.iter().all(|e| e.is_finite()) && out[0].0[3] > 0.99);
    }
}
