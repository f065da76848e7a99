//! Waves of a uniform beam.
//!
//! State of a cross-section: displacement w, rotation phi, and the force V and moment M that the
//! part beyond exerts on the part before: `w' = phi + V/S`, `phi' = M/B`, `V' = -mu w`,
//! `M' = -V - J phi`, with B bending and S shear stiffness, `mu = rho A omega^2`,
//! `J = rho I omega^2` (Timoshenko 1921). Euler-Bernoulli is 1/S = 0 and J = 0.

use crate::{
    c64,
    line::Beam,
    small::{self, M2},
};

/// A beam at one frequency.
#[derive(Debug, Clone, Copy)]
pub struct Waves {
    /// Bending stiffness, N m2.
    pub bending: c64,
    /// Shear compliance 1/S, 1/N.
    pub shear_compliance: c64,
    /// `rho A omega^2`, N/m2.
    pub mu: c64,
    /// `rho I omega^2`, N.
    pub rotary: c64,
}

impl Waves {
    /// The beam at angular frequency `omega`, rad/s.
    pub fn new(beam: &Beam, omega: f64) -> Self {
        let section = beam.at(omega);
        Self {
            bending: section.bending,
            shear_compliance: section.shear.map_or(c64::ZERO, |s| s.inv()),
            mu: section.mass * (omega * omega),
            rotary: section.rotary * (omega * omega),
        }
    }

    /// Sum and product of the two values of lambda squared, where waves go as `exp(lambda x)`.
    pub fn sum_and_product(&self) -> (c64, c64) {
        let b = self.bending.inv();
        let sum = -(b * self.rotary + self.shear_compliance * self.mu);
        let product = b * self.mu * (self.shear_compliance * self.rotary - 1.0);
        (sum, product)
    }

    /// The two exponents of the waves that decay, or travel, towards +x.
    pub fn exponents(&self) -> [c64; 2] {
        let (sum, product) = self.sum_and_product();
        let root = (sum * sum - 4.0 * product).sqrt();
        // The larger of the two by sum, the other by product: no cancellation near the cut-on.
        let big = if (sum + root).norm() > (sum - root).norm() { sum + root } else { sum - root } / 2.0;
        [big, product / big].map(|z| {
            let l = z.sqrt();
            // Undamped travelling waves: exp(+i omega t) and -i k x leave towards +x.
            let grows = if l.re.abs() > 1e-13 * l.norm() { l.re > 0.0 } else { l.im > 0.0 };
            if grows { -l } else { l }
        })
    }

    /// Rotation, force and moment of the wave `w = exp(lambda x)` at x = 0.
    pub fn state(&self, lambda: c64) -> [c64; 3] {
        let force = -self.mu / lambda;
        let rotation = lambda - force * self.shear_compliance;
        [rotation, force, self.bending * lambda * rotation]
    }

    /// Impedance (force and moment over displacement and rotation) of the half-infinite beam that
    /// ends here and runs towards -x (`left`) or +x.
    pub fn half_infinite(&self, left: bool) -> Option<M2> {
        let [l1, l2] = self.exponents();
        let ([r1, v1, m1], [r2, v2, m2]) = (self.state(l1), self.state(l2));
        let one = c64::ONE;
        let inverse = small::inverse(&[[one, one], [r1, r2]])?.0;
        let k = small::mul(&[[-v1, -v2], [-m1, -m2]], &inverse);
        // Mirrored, rotation and force change sign: the coupling terms do.
        Some(if left { [[k[0][0], -k[0][1]], [-k[1][0], k[1][1]]] } else { k })
    }

    /// Largest modulus of the exponents, 1/m.
    pub fn steepest(&self) -> f64 {
        let [a, b] = self.exponents();
        a.norm().max(b.norm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::End;

    fn rail() -> Beam {
        Beam {
            bending: c64::new(210e9 * 3038.3e-8, 0.0),
            shear: Some(c64::new(0.4 * 81e9 * 76.7e-4, 0.0)),
            mass: 7850.0 * 76.7e-4,
            rotary: 7850.0 * 3038.3e-8,
            dashpots: [0.0; 4],
            interval: [f64::NEG_INFINITY, f64::INFINITY],
            ends: [End::Free; 2],
            modes: None,
        }
    }

    /// A half wave in the bay, UIC60; the printed values belong to 60.20 kg/m (rho A is 60.21).
    #[test]
    fn pinned_pinned_frequencies() {
        for (bay, expected) in [(0.600, 1067.93), (0.625, 1000.88), (0.650, 939.76)] {
            let wave = |f: f64| {
                let rail = Beam { mass: 60.2, ..rail() };
                let l = Waves::new(&rail, std::f64::consts::TAU * f).exponents();
                l.iter().map(|l| -l.im).fold(0.0, f64::max) * bay - std::f64::consts::PI
            };
            let (mut low, mut high) = (100.0, 2000.0);
            for _ in 0..60 {
                let mid = 0.5 * (low + high);
                if wave(mid) > 0.0 { high = mid } else { low = mid }
            }
            assert!((low - expected).abs() < 0.006, "{bay}: {low}");
        }
    }

    #[test]
    fn exponents_solve_the_dispersion_relation() {
        for f in [1.0, 100.0, 3000.0, 6000.0] {
            let w = Waves::new(&rail(), std::f64::consts::TAU * f);
            let (s, p) = w.sum_and_product();
            for l in w.exponents() {
                let z = l * l;
                assert!((z * z - s * z + p).norm() < 1e-12 * (z * z).norm().max(p.norm()));
                assert!(l.re < 0.0 || (l.re.abs() < 1e-9 * l.norm() && l.im < 0.0));
            }
        }
    }
}
