//! Several complex numbers side by side, one frequency in each lane of the processor's registers.
//!
//! The loops over lanes have a fixed length and no branches, so that they become vector instructions
//! wherever the calling function is compiled for a processor that has them (see [`crate::chain`]).

use crate::{c64, field::Field};
use std::{
    marker::PhantomData,
    ops::{Add, Mul, Neg, Sub},
};

/// Frequencies that go through the elimination side by side.
pub const LANES: usize = 8;

/// How a product and a sum are taken: a type, so that it is chosen when a function is compiled.
pub trait Fuse: Copy + Send + Sync + 'static {
    /// `a b + c`.
    fn fma(a: f64, b: f64, c: f64) -> f64;
}

/// By one instruction; slow on a processor without it.
#[derive(Debug, Clone, Copy)]
pub struct Fused;

/// By two instructions, on any processor.
#[derive(Debug, Clone, Copy)]
pub struct Plain;

impl Fuse for Fused {
    #[inline(always)]
    fn fma(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

impl Fuse for Plain {
    #[inline(always)]
    fn fma(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

/// A complex number in each lane.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct Lanes<F> {
    /// Real parts.
    pub re: [f64; LANES],
    /// Imaginary parts.
    pub im: [f64; LANES],
    fuse: PhantomData<F>,
}

/// Each lane by a formula in the lane's number.
macro_rules! each {
    ($lane:ident => $value:expr) => {{
        let mut out = [0.0; LANES];
        for ($lane, slot) in out.iter_mut().enumerate() {
            *slot = $value;
        }
        out
    }};
}

impl<F: Fuse> Lanes<F> {
    /// Zero in all lanes.
    pub const ZERO: Self = Self { re: [0.0; LANES], im: [0.0; LANES], fuse: PhantomData };

    /// From real and imaginary parts.
    #[inline(always)]
    pub fn new(re: [f64; LANES], im: [f64; LANES]) -> Self {
        Self { re, im, fuse: PhantomData }
    }

    /// One number a lane.
    #[inline(always)]
    pub fn gather(value: impl Fn(usize) -> c64) -> Self {
        let mut out = Self::ZERO;
        for i in 0..LANES {
            let v = value(i);
            out.re[i] = v.re;
            out.im[i] = v.im;
        }
        out
    }

    /// The number in one lane.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> c64 {
        c64::new(self.re[i], self.im[i])
    }

    /// `self + a b`.
    #[inline(always)]
    pub fn plus(self, a: Self, b: Self) -> Self {
        Self::new(
            each!(i => F::fma(-a.im[i], b.im[i], F::fma(a.re[i], b.re[i], self.re[i]))),
            each!(i => F::fma(a.im[i], b.re[i], F::fma(a.re[i], b.im[i], self.im[i]))),
        )
    }

    /// `self - a b`.
    #[inline(always)]
    pub fn minus(self, a: Self, b: Self) -> Self {
        Self::new(
            each!(i => F::fma(a.im[i], b.im[i], F::fma(-a.re[i], b.re[i], self.re[i]))),
            each!(i => F::fma(-a.im[i], b.re[i], F::fma(-a.re[i], b.im[i], self.im[i]))),
        )
    }

    /// Squared modulus.
    #[inline(always)]
    pub fn norm_sqr(&self) -> [f64; LANES] {
        each!(i => F::fma(self.re[i], self.re[i], self.im[i] * self.im[i]))
    }
}

impl<F: Fuse> Add for Lanes<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(each!(i => self.re[i] + b.re[i]), each!(i => self.im[i] + b.im[i]))
    }
}

impl<F: Fuse> Sub for Lanes<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(each!(i => self.re[i] - b.re[i]), each!(i => self.im[i] - b.im[i]))
    }
}

impl<F: Fuse> Mul for Lanes<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self::new(
            each!(i => F::fma(self.re[i], b.re[i], -(self.im[i] * b.im[i]))),
            each!(i => F::fma(self.re[i], b.im[i], self.im[i] * b.re[i])),
        )
    }
}

impl<F: Fuse> Neg for Lanes<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(each!(i => -self.re[i]), each!(i => -self.im[i]))
    }
}

impl<F: Fuse> Field for Lanes<F> {
    #[inline(always)]
    fn real(value: f64) -> Self {
        Self::new([value; LANES], [0.0; LANES])
    }

    #[inline(always)]
    fn scale(self, by: f64) -> Self {
        Self::new(each!(i => self.re[i] * by), each!(i => self.im[i] * by))
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        let size = self.norm_sqr();
        Self::new(each!(i => self.re[i] / size[i]), each!(i => -self.im[i] / size[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<F: Fuse>() {
        let a = Lanes::<F>::gather(|i| c64::new(1.0 + i as f64, -0.5 * i as f64));
        let b = Lanes::<F>::gather(|i| c64::new(0.3 - i as f64, 2.0));
        let c = Lanes::<F>::gather(|i| c64::new(-1.0, i as f64));
        for i in 0..LANES {
            let (x, y, z) = (a.lane(i), b.lane(i), c.lane(i));
            let near = |l: Lanes<F>, v: c64| assert!((l.lane(i) - v).norm() <= 1e-15 * (1.0 + v.norm()));
            near(a * b, x * y);
            near(a + b, x + y);
            near(a - b, x - y);
            near(c.plus(a, b), z + x * y);
            near(c.minus(a, b), z - x * y);
            near(b.inverse(), y.inv());
            near(-a.scale(3.0), -3.0 * x);
        }
    }

    #[test]
    fn lanes_are_complex_numbers() {
        check::<Fused>();
        check::<Plain>();
    }
}
