//! The wave of a uniform shaft: `V = S w'`, `V' = -mu w`, with `mu = m omega^2`.
//!
//! A shaft has no rotation of its own and no moment: in the tables of beams those two stand idle.

use crate::{c64, line::Shaft};

/// A shaft at one frequency.
#[derive(Debug, Clone, Copy)]
pub struct Twist {
    /// Stiffness against w', N.
    pub stiffness: c64,
    /// `m omega^2`, N/m2.
    pub mu: f64,
}

impl Twist {
    /// The shaft at angular frequency `omega`, rad/s.
    pub fn new(shaft: &Shaft, omega: f64) -> Self {
        Self { stiffness: shaft.stiffness, mu: shaft.mass * omega * omega }
    }

    /// The exponent of the wave that decays, or travels, towards +x.
    pub fn exponent(&self) -> c64 {
        // exp(+i omega t) and exp(-i k x): a loss turns k into the lower half plane.
        -c64::I * (self.mu / self.stiffness).sqrt()
    }

    /// Force over displacement of the half-infinite shaft that ends here, towards either side, N/m.
    pub fn half_infinite(&self) -> c64 {
        -self.stiffness * self.exponent()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::End;

    /// Through the end of half a shaft goes the power that its losses need: the impedance is passive.
    #[test]
    fn waves_leave() {
        for loss in [0.0, 1e-6, 0.3, 2.0] {
            let shaft = Shaft {
                stiffness: c64::new(3e9, 3e9 * loss),
                mass: 700.0,
                interval: [f64::NEG_INFINITY, f64::INFINITY],
                ends: [End::Free; 2],
            };
            let twist = Twist::new(&shaft, 900.0);
            let (l, z) = (twist.exponent(), twist.half_infinite());
            assert!((twist.stiffness * l * l + twist.mu).norm() < 1e-12 * twist.mu);
            assert!(l.re <= 0.0 && l.im < 0.0 && z.im > 0.0, "{l} {z}");
        }
    }
}
