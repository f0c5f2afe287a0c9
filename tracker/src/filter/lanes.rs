//! One number per track: rows in memory, vectors in registers, and the arithmetic between.
//!
//! [`V`] is as many lanes of a row as the machine's registers hold: 8 with AVX-512, 4 with AVX2, 2 with NEON, 1 without.
//! The product of two is kept as [`Product`] until something is added to it, so that `a * b + c` is one fused operation
//! where the machine has it and formulas still read like formulas.
//!
//! Everything here is inlined into the function that `pulp` compiled for the machine at hand; a call would not be.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use pulp::Simd;

/// Tracks in a group.
pub const LANES: usize = 8;

/// One number of each track of a group: a cache line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; LANES]);

impl Default for Row {
    fn default() -> Self {
        Self::ZERO
    }
}

impl Row {
    /// All zero.
    pub const ZERO: Self = Self::splat(0.0);

    /// The same number in every lane.
    pub const fn splat(value: f64) -> Self {
        Self([value; LANES])
    }
}

/// The part of a group that is worked on: lanes `part` · width and up.
#[derive(Clone, Copy)]
pub(in crate::filter) struct Lanes<S: Simd> {
    simd: S,
    part: usize,
}

impl<S: Simd> Lanes<S> {
    /// Parts of a group of which `lanes` lanes are in use.
    #[inline(always)]
    pub(in crate::filter) fn parts(lanes: usize) -> usize {
        lanes.div_ceil(S::F64_LANES)
    }

    #[inline(always)]
    pub(in crate::filter) fn of(simd: S, part: usize) -> Self {
        Self { simd, part }
    }

    #[inline(always)]
    pub(in crate::filter) fn splat(self, value: f64) -> V<S> {
        V(self.simd, self.simd.splat_f64s(value))
    }

    #[inline(always)]
    pub(in crate::filter) fn get(self, row: &Row) -> V<S> {
        V(self.simd, S::as_simd_f64s(&row.0).0[self.part])
    }

    #[inline(always)]
    pub(in crate::filter) fn put(self, row: &mut Row, value: impl Into<V<S>>) {
        S::as_mut_simd_f64s(&mut row.0).0[self.part] = value.into().1;
    }

    /// Several rows at once.
    #[inline(always)]
    pub(in crate::filter) fn all<const N: usize>(self, rows: &[Row; N]) -> [V<S>; N] {
        let mut values = [self.splat(0.0); N];
        for i in 0..N {
            values[i] = self.get(&rows[i]);
        }
        values
    }
}

/// A vector of lanes.
#[derive(Clone, Copy)]
pub(in crate::filter) struct V<S: Simd>(S, S::f64s);

/// a · b, not yet rounded.
#[derive(Clone, Copy)]
pub(in crate::filter) struct Product<S: Simd>(V<S>, V<S>);

/// One yes or no per lane.
#[derive(Clone, Copy)]
pub(in crate::filter) struct Mask<S: Simd>(S, S::m64s);

impl<S: Simd> V<S> {
    #[inline(always)]
    pub(in crate::filter) fn splat(self, value: f64) -> Self {
        Self(self.0, self.0.splat_f64s(value))
    }

    #[inline(always)]
    pub(in crate::filter) fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt_f64s(self.1))
    }

    #[inline(always)]
    pub(in crate::filter) fn abs(self) -> Self {
        Self(self.0, self.0.abs_f64s(self.1))
    }

    /// The larger one; which of them if either is NaN depends on the machine.
    #[inline(always)]
    pub(in crate::filter) fn max(self, other: Self) -> Self {
        Self(self.0, self.0.max_f64s(self.1, other.1))
    }

    #[inline(always)]
    pub(in crate::filter) fn min(self, other: Self) -> Self {
        Self(self.0, self.0.min_f64s(self.1, other.1))
    }

    /// False where either is NaN.
    #[inline(always)]
    pub(in crate::filter) fn less(self, other: Self) -> Mask<S> {
        Mask(self.0, self.0.less_than_f64s(self.1, other.1))
    }

    /// 0 < x < the largest finite number.
    #[inline(always)]
    pub(in crate::filter) fn is_positive(self) -> Mask<S> {
        self.splat(0.0).less(self).and(self.less(self.splat(f64::MAX)))
    }

    #[inline(always)]
    pub(in crate::filter) fn inverse(self) -> Self {
        self.splat(1.0) / self
    }

    /// x · 2^k for k in the lowest bits of `whole`, where neither x nor the result is denormal or beyond the largest number.
    #[inline(always)]
    pub(in crate::filter) fn times_power_of_two(self, whole: Self) -> Self {
        let simd = self.0;
        let exponent =
            simd.mul_u64s(simd.transmute_u64s_f64s(whole.1), simd.splat_u64s(1 << (f64::MANTISSA_DIGITS - 1)));
        Self(simd, simd.transmute_f64s_u64s(simd.add_u64s(simd.transmute_u64s_f64s(self.1), exponent)))
    }
}

impl<S: Simd> Mask<S> {
    #[inline(always)]
    pub(in crate::filter) fn and(self, other: Self) -> Self {
        Self(self.0, self.0.and_m64s(self.1, other.1))
    }

    /// `yes` where the mask is set, else `no`.
    #[inline(always)]
    pub(in crate::filter) fn pick(self, yes: impl Into<V<S>>, no: impl Into<V<S>>) -> V<S> {
        V(self.0, self.0.select_f64s(self.1, yes.into().1, no.into().1))
    }
}

impl<S: Simd> Product<S> {
    #[inline(always)]
    pub(in crate::filter) fn rounded(self) -> V<S> {
        let simd = self.0.0;
        V(simd, simd.mul_f64s(self.0.1, self.1.1))
    }
}

impl<S: Simd> From<Product<S>> for V<S> {
    #[inline(always)]
    fn from(product: Product<S>) -> Self {
        product.rounded()
    }
}

/// One operator: its trait, operands and result.
macro_rules! operator {
    ($trait:ident $method:ident: $left:ident, $right:ident -> $output:ident, |$a:ident, $b:ident| $result:expr) => {
        impl<S: Simd> $trait<$right<S>> for $left<S> {
            type Output = $output<S>;
            #[inline(always)]
            fn $method(self, $b: $right<S>) -> $output<S> {
                let $a = self;
                $result
            }
        }
    };
}

operator!(Mul mul: V, V -> Product, |a, b| Product(a, b));
operator!(Mul mul: Product, V -> Product, |a, b| Product(a.rounded(), b));
operator!(Div div: V, V -> V, |a, b| V(a.0, a.0.div_f64s(a.1, b.1)));
operator!(Add add: V, V -> V, |a, b| V(a.0, a.0.add_f64s(a.1, b.1)));
operator!(Sub sub: V, V -> V, |a, b| V(a.0, a.0.sub_f64s(a.1, b.1)));
operator!(Add add: Product, V -> V, |a, b| V(b.0, b.0.mul_add_e_f64s(a.0.1, a.1.1, b.1)));
operator!(Sub sub: V, Product -> V, |a, b| V(a.0, a.0.negate_mul_add_e_f64s(b.0.1, b.1.1, a.1)));
operator!(Add add: V, Product -> V, |a, b| b + a);
operator!(Sub sub: Product, V -> V, |a, b| a + -b);
operator!(Add add: Product, Product -> V, |a, b| a + b.rounded());
operator!(Sub sub: Product, Product -> V, |a, b| a.rounded() - b);

impl<S: Simd> Neg for V<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0, self.0.neg_f64s(self.1))
    }
}

impl<S: Simd> AddAssign<Product<S>> for V<S> {
    #[inline(always)]
    fn add_assign(&mut self, product: Product<S>) {
        *self = *self + product;
    }
}

impl<S: Simd> AddAssign for V<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> SubAssign<Product<S>> for V<S> {
    #[inline(always)]
    fn sub_assign(&mut self, product: Product<S>) {
        *self = *self - product;
    }
}

/// a · b, n ≥ 1 terms.
#[inline(always)]
pub(in crate::filter) fn dot<S: Simd, const N: usize>(a: &[V<S>; N], b: &[V<S>; N]) -> V<S> {
    let mut sum = (a[0] * b[0]).rounded();
    for i in 1..N {
        sum += a[i] * b[i];
    }
    sum
}
