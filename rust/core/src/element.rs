//! Exact transfer over a length of beam.
//!
//! The state obeys `y' = A y` (see [`crate::waves`]), so `y(l) = exp(A l) y(0)`, and by
//! Cayley-Hamilton `exp(A l) = c0 + c1 A + c2 A^2 + c3 A^3`. The coefficients are summed as power
//! series in the sum and product of lambda squared: no roots, and no cancellation however short
//! the element, where the usual trigonometric dynamic stiffness loses all digits as (k l)^-4.

use crate::{c64, small::M2, waves::Waves};

/// Longest element as a multiple of the steepest wave's length scale: digits lost grow as its exponential.
pub const LONGEST: f64 = 4.0;

/// `u' = a u + b f`, `f' = c u + d f`: displacement and rotation u, force and moment f.
#[derive(Debug, Clone, Copy)]
pub struct Transfer {
    /// Displacements from displacements.
    pub a: M2,
    /// Displacements from forces: flexibility.
    pub b: M2,
    /// Forces from displacements: inertia.
    pub c: M2,
    /// Forces from forces.
    pub d: M2,
}

/// Coefficients c0 to c3 for length `l`, `sum` and `product` of lambda squared.
fn coefficients(sum: c64, product: c64, l: f64) -> [c64; 4] {
    let l2 = l * l;
    // Complete homogeneous polynomials h(n-1), h(n-2) of the two lambda squared, times l^(2n).
    let (mut h1, mut h2) = (c64::new(l2, 0.0), c64::ZERO);
    let (s, p) = (sum * l2, product * (l2 * l2));
    let (mut even, mut odd) = ([c64::ZERO; 2], [c64::ZERO; 2]);
    let mut factorial = 1.0;
    let scale = s.norm().max(p.norm().sqrt()).max(1.0);
    let mut size = 1.0;
    for n in 1..40 {
        let m = f64::from(2 * n);
        factorial *= (m - 1.0) * m;
        even[0] += h1 / factorial;
        odd[0] += h1 / (factorial * (m + 1.0));
        even[1] += h2 / factorial;
        odd[1] += h2 / (factorial * (m + 1.0));
        size *= scale * 2.0 / ((m - 1.0) * m);
        if size < 1e-18 {
            break;
        }
        (h1, h2) = (s * h1 - product * l2 * h2, h1 * l2);
    }
    let c2 = even[0];
    let c3 = odd[0] * l;
    let c0 = 1.0 - product * even[1];
    let c1 = l * (1.0 - product * odd[1]);
    [c0, c1, c2, c3]
}

impl Transfer {
    /// Transfer over length `l` in m.
    pub fn new(w: &Waves, l: f64) -> Self {
        let (sum, product) = w.sum_and_product();
        let [c0, c1, c2, c3] = coefficients(sum, product, l);
        let (b, s, mu, j) = (w.bending.inv(), w.shear_compliance, w.mu, w.rotary);
        let (ms, jb) = (s * mu, b * j);
        let cross = c1 - c3 * (jb + ms);
        Self {
            a: [[c0 - c2 * ms, cross], [c3 * b * mu, c0 - c2 * jb]],
            b: [[c1 * s - c3 * (b + s * ms), c2 * b], [-c2 * b, (c1 - c3 * jb) * b]],
            c: [[-(c1 - c3 * ms) * mu, -c2 * mu], [c2 * mu, -c1 * j + c3 * (jb * j + mu)]],
            d: [[c0 - c2 * ms, -c3 * b * mu], [-cross, c0 - c2 * jb]],
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
