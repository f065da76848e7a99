//! Exact transfer over a length of beam.
//!
//! The state obeys `y' = A y` (see [`crate::waves`]), so `y(l) = exp(A l) y(0)`, and by
//! Cayley-Hamilton `exp(A l) = c0 + c1 A + c2 A^2 + c3 A^3`. The coefficients are summed as power
//! series in the sum and product of lambda squared: no roots, and no cancellation however short
//! the element, where the usual trigonometric dynamic stiffness loses all digits as (k l)^-4.

use crate::{c64, field::Field, small::M2, waves::Waves};

/// Longest element as a multiple of the steepest wave's length scale: digits lost grow as its exponential.
pub const LONGEST: f64 = 4.0;

/// `u' = a u + b f`, `f' = c u + d f`: displacement and rotation u, force and moment f.
#[derive(Debug, Clone, Copy)]
pub struct Transfer<T = c64> {
    /// Displacements from displacements.
    pub a: M2<T>,
    /// Displacements from forces: flexibility.
    pub b: M2<T>,
    /// Forces from displacements: inertia.
    pub c: M2<T>,
    /// Forces from forces.
    pub d: M2<T>,
}

/// A beam's section at one frequency, or at several side by side.
#[derive(Debug, Clone, Copy)]
pub struct Section<T> {
    /// Bending flexibility 1/B, 1/(N m2).
    pub flexibility: T,
    /// Shear compliance 1/S, 1/N.
    pub shear_compliance: T,
    /// `rho A omega^2`, N/m2.
    pub mu: T,
    /// `rho I omega^2`, N.
    pub rotary: T,
}

/// Terms of the power series that an element needs, of `steepest` wave exponent times length.
pub fn terms(steepest: f64) -> usize {
    let mut size = 1.0;
    for n in 1..64 {
        let m = f64::from(2 * n);
        size *= steepest * steepest / ((m - 1.0) * m);
        // The terms of the two waves add up, n of them at order n.
        if size * m < 1e-18 {
            return n as usize;
        }
    }
    64
}

/// Coefficients c0 to c3 for length `l`, `sum` and `product` of lambda squared.
#[inline(always)]
fn coefficients<T: Field>(sum: T, product: T, l: f64, terms: usize) -> [T; 4] {
    let l2 = l * l;
    // Complete homogeneous polynomials h(n-1), h(n-2) of the two lambda squared, times l^(2n).
    let (mut h1, mut h2) = (T::real(l2), T::real(0.0));
    let (s, p) = (sum.scale(l2), product.scale(l2));
    let (mut even, mut odd) = ([T::real(0.0); 2], [T::real(0.0); 2]);
    let mut factorial = 1.0;
    for n in 1..=terms {
        let m = 2.0 * n as f64;
        factorial *= (m - 1.0) * m;
        let (e, o) = (1.0 / factorial, 1.0 / (factorial * (m + 1.0)));
        even[0] = even[0] + h1.scale(e);
        odd[0] = odd[0] + h1.scale(o);
        even[1] = even[1] + h2.scale(e);
        odd[1] = odd[1] + h2.scale(o);
        (h1, h2) = (s * h1 - p * h2, h1.scale(l2));
    }
    let one = T::real(1.0);
    [one - product * even[1], (one - product * odd[1]).scale(l), even[0], odd[0].scale(l)]
}

impl Transfer<c64> {
    /// Transfer over length `l` in m.
    pub fn new(w: &Waves, l: f64) -> Self {
        let section = Section {
            flexibility: w.bending.inv(),
            shear_compliance: w.shear_compliance,
            mu: w.mu,
            rotary: w.rotary,
        };
        Self::over(&section, l, terms(w.steepest() * l))
    }
}

impl<T: Field> Transfer<T> {
    /// Transfer over length `l` in m of a shaft; rotation and moment, which it has not, stay what they are.
    #[inline(always)]
    pub fn of_shaft(compliance: T, mu: T, l: f64, terms: usize) -> Self {
        let (zero, one) = (T::real(0.0), T::real(1.0));
        let squared = -(compliance * mu);
        let [_, _, c2, c3] = coefficients(squared, zero, l, terms);
        let (cosh, length) = (one + squared * c2, T::real(l) + squared * c3);
        Self {
            a: [[cosh, zero], [zero, one]],
            b: [[length * compliance, zero], [zero, zero]],
            c: [[-(length * mu), zero], [zero, zero]],
            d: [[cosh, zero], [zero, one]],
        }
    }

    /// Transfer over length `l` in m, by so many terms of the series.
    #[inline(always)]
    pub fn over(section: &Section<T>, l: f64, terms: usize) -> Self {
        let Section { flexibility: b, shear_compliance: s, mu, rotary: j } = *section;
        let (ms, jb) = (s * mu, b * j);
        let sum = -(jb + ms);
        let product = b * mu * (s * j - T::real(1.0));
        let [c0, c1, c2, c3] = coefficients(sum, product, l, terms);
        let cross = c1 - c3 * (jb + ms);
        let (c2b, c2mu) = (c2 * b, c2 * mu);
        let c3bmu = c3 * b * mu;
        Self {
            a: [[c0 - c2 * ms, cross], [c3bmu, c0 - c2 * jb]],
            b: [[c1 * s - c3 * (b + s * ms), c2b], [-c2b, (c1 - c3 * jb) * b]],
            c: [[-(c1 - c3 * ms) * mu, -c2mu], [c2mu, c3 * (jb * j + mu) - c1 * j]],
            d: [[c0 - c2 * ms, -c3bmu], [-cross, c0 - c2 * jb]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        line::{Beam, End},
        small,
    };

    fn waves(f: f64, shear: bool) -> Waves {
        let beam = Beam {
            bending: c64::new(6.4e6, 6.4e4),
            shear: shear.then_some(c64::new(2.5e8, 2.5e6)),
            mass: 60.2,
            rotary: if shear { 0.24 } else { 0.0 },
            dashpots: [0.0; 4],
            interval: [0.0, 1.0],
            ends: [End::Free; 2],
            modes: None,
        };
        Waves::new(&beam, std::f64::consts::TAU * f)
    }

    fn difference(a: &M2, b: &M2) -> f64 {
        (0..4).map(|i| (a[i / 2][i % 2] - b[i / 2][i % 2]).norm() / b[i / 2][i % 2].norm()).fold(0.0, f64::max)
    }

    /// A wave transfers to itself times its exponential.
    #[test]
    fn waves_pass_through() {
        for (f, l, shear) in [(1.0, 0.6, true), (300.0, 0.6, true), (3000.0, 0.5, true), (50.0, 1.0, false)] {
            let w = waves(f, shear);
            let t = Transfer::new(&w, l);
            for lambda in w.exponents() {
                let [r, v, m] = w.state(lambda);
                let (u, g) = ([c64::ONE, r], [v, m]);
                let e = (lambda * l).exp();
                for i in 0..2 {
                    let du = t.a[i][0] * u[0] + t.a[i][1] * u[1] + t.b[i][0] * g[0] + t.b[i][1] * g[1];
                    assert!((du - e * u[i]).norm() < 1e-11 * u[i].norm(), "{f} Hz: {du} {}", e * u[i]);
                    let dg = t.c[i][0] * u[0] + t.c[i][1] * u[1] + t.d[i][0] * g[0] + t.d[i][1] * g[1];
                    assert!((dg - e * g[i]).norm() < 1e-11 * g[i].norm());
                }
            }
        }
    }

    /// A shaft's wave passes through; what it has not stays.
    #[test]
    fn wave_of_a_shaft_passes_through() {
        for (mu, l) in [(3.0, 0.4), (4e8, 1.5), (1e-3, 20.0)] {
            let (stiffness, mu) = (c64::new(2.4e8, 2.4e6), c64::new(mu, 0.0));
            let lambda = -c64::I * (mu / stiffness).sqrt();
            let t = Transfer::of_shaft(stiffness.inv(), mu, l, terms(lambda.norm() * l));
            let (force, e) = (stiffness * lambda, (lambda * l).exp());
            assert!((t.a[0][0] + t.b[0][0] * force - e).norm() < 1e-14);
            assert!((t.c[0][0] + t.d[0][0] * force - e * force).norm() < 1e-14 * force.norm());
            assert!(t.a[1][1] == c64::ONE && t.d[1][1] == c64::ONE && t.b[1][1] == c64::ZERO);
        }
    }

    /// Two halves make a whole, to the last digits, for a very short element too.
    #[test]
    fn halves_compose() {
        for l in [1e-4, 0.05, 0.7] {
            let w = waves(500.0, true);
            let (half, whole) = (Transfer::new(&w, l / 2.0), Transfer::new(&w, l));
            let b = small::add(&small::mul(&half.a, &half.b), &small::mul(&half.b, &half.d));
            let c = small::add(&small::mul(&half.c, &half.a), &small::mul(&half.d, &half.c));
            assert!(difference(&b, &whole.b) < 1e-14);
            assert!(difference(&c, &whole.c) < 1e-13);
        }
    }
}
