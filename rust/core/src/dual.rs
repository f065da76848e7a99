//! Numbers that carry their slopes: derivatives of a formula by four of its inputs, exactly.

use crate::field::Field;
use std::ops::{Add, Mul, Neg, Sub};

/// Inputs by which is derived.
pub const SLOPES: usize = 4;

/// A number and its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Dual<T> {
    /// The number.
    pub value: T,
    /// Its derivative by each input.
    pub slopes: [T; SLOPES],
}

impl<T: Field> Dual<T> {
    /// The input of that index.
    #[inline(always)]
    pub fn input(value: T, index: usize) -> Self {
        let mut slopes = [T::real(0.0); SLOPES];
        slopes[index] = T::real(1.0);
        Self { value, slopes }
    }

    #[inline(always)]
    fn map(self, value: T, slope: impl Fn(T) -> T) -> Self {
        Self { value, slopes: self.slopes.map(slope) }
    }

    #[inline(always)]
    fn both(self, other: Self, value: T, slope: impl Fn(T, T) -> T) -> Self {
        let mut slopes = self.slopes;
        for (mine, theirs) in slopes.iter_mut().zip(other.slopes) {
            *mine = slope(*mine, theirs);
        }
        Self { value, slopes }
    }
}

impl<T: Field> Add for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.both(b, self.value + b.value, |x, y| x + y)
    }
}

impl<T: Field> Sub for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.both(b, self.value - b.value, |x, y| x - y)
    }
}

impl<T: Field> Mul for Dual<T> {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl)] // The slope of a product is a sum.
    fn mul(self, b: Self) -> Self {
        self.both(b, self.value * b.value, |x, y| x * b.value + self.value * y)
    }
}

impl<T: Field> Neg for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(-self.value, |x| -x)
    }
}

impl<T: Field> Field for Dual<T> {
    #[inline(always)]
    fn real(value: f64) -> Self {
        Self { value: T::real(value), slopes: [T::real(0.0); SLOPES] }
    }

    #[inline(always)]
    fn scale(self, by: f64) -> Self {
        self.map(self.value.scale(by), |x| x.scale(by))
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        let inverse = self.value.inverse();
        self.map(inverse, |x| -(x * inverse * inverse))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::c64;

    #[test]
    fn slopes_are_differences_in_the_limit() {
        let at = [c64::new(0.7, 0.2), c64::new(-1.1, 0.4)];
        let formula = |x: Dual<c64>, y: Dual<c64>| (x * y - x.scale(3.0)).inverse() + y * y * -x;
        let exact = formula(Dual::input(at[0], 0), Dual::input(at[1], 3));
        for (k, index) in [0, 3].into_iter().enumerate() {
            let moved = |h: f64| {
                let mut p = at;
                p[k] += h;
                formula(Dual::input(p[0], 0), Dual::input(p[1], 3)).value
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((difference - exact.slopes[index]).norm() < 1e-9);
        }
        assert_eq!(exact.slopes[1], c64::ZERO);
    }
}
