//! What the formulas of beams need of a number: one complex number, or several side by side.

use crate::c64;
use std::ops::{Add, Mul, Neg, Sub};

/// A complex number, or several side by side.
pub trait Field: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// A real number.
    fn real(value: f64) -> Self;
    /// The product with a real number.
    fn scale(self, by: f64) -> Self;
    /// The reciprocal.
    fn inverse(self) -> Self;
}

impl Field for c64 {
    fn real(value: f64) -> Self {
        c64::new(value, 0.0)
    }

    fn scale(self, by: f64) -> Self {
        self * by
    }

    fn inverse(self) -> Self {
        self.inv()
    }
}
