//! Products of two responses integrated over a length of beam: what derivatives by its section are made of.
//!
//! With the state y = (displacement, rotation, force, moment) and `y' = A y`, the response obeys
//! `dH/dp = integral y_s' P y_f` with P = dA/dp turned symmetric: (moment)^2 for the bending flexibility, (force)^2
//! for the shear compliance, (displacement)^2 for `rho A omega^2`, (rotation)^2 for `rho I omega^2`. Over a length
//! with transfer T the integral is `y_s(0)' N y_f(0)`, `N = -T' J dT/dp` with the symplectic J, without quadrature.

use crate::{
    c64,
    dual::{Dual, SLOPES},
    element::{Section, Transfer},
    field::Field,
    shaft::Twist,
    small::{self, M2},
    waves::Waves,
};

/// A 4 x 4 matrix over the state, row by row.
pub type M4<T> = [[T; 4]; 4];

/// The integrals over one length of beam: by bending flexibility, shear compliance, mass and rotary inertia times
/// omega squared.
pub fn over_length<T: Field>(section: &Section<T>, length: f64, terms: usize) -> [M4<T>; SLOPES] {
    let inputs = Section {
        flexibility: Dual::input(section.flexibility, 0),
        shear_compliance: Dual::input(section.shear_compliance, 1),
        mu: Dual::input(section.mu, 2),
        rotary: Dual::input(section.rotary, 3),
    };
    of_transfer(&Transfer::over(&inputs, length, terms))
}

/// The integrals over one length of shaft, of which the first and the last are none.
pub fn over_shaft<T: Field>(compliance: T, mu: T, length: f64, terms: usize) -> [M4<T>; SLOPES] {
    of_transfer(&Transfer::of_shaft(Dual::input(compliance, 1), Dual::input(mu, 2), length, terms))
}

fn of_transfer<T: Field>(t: &Transfer<Dual<T>>) -> [M4<T>; SLOPES] {
    // Rows of T, and of J dT/dp = [[dc, dd], [-da, -db]]; loops, for spelled out they would be much code.
    let rows = [
        [t.a[0][0], t.a[0][1], t.b[0][0], t.b[0][1]],
        [t.a[1][0], t.a[1][1], t.b[1][0], t.b[1][1]],
        [t.c[0][0], t.c[0][1], t.d[0][0], t.d[0][1]],
        [t.c[1][0], t.c[1][1], t.d[1][0], t.d[1][1]],
    ];
    let mut out = [[[T::real(0.0); 4]; 4]; SLOPES];
    for (p, n) in out.iter_mut().enumerate() {
        for (i, line) in n.iter_mut().enumerate() {
            for (j, sum) in line.iter_mut().enumerate() {
                // Symmetric: the lower triangle is taken twice.
                let (i, j) = (i.max(j), i.min(j));
                for k in 0..2 {
                    *sum = *sum - rows[k][i].value * rows[k + 2][j].slopes[p]
                        + rows[k + 2][i].value * rows[k][j].slopes[p];
                }
            }
        }
    }
    out
}

/// The integrals over a half-infinite beam, over displacement and rotation of its end; `None` where its waves merge.
pub fn over_half_infinite(waves: &Waves, left: bool) -> Option<[M2; SLOPES]> {
    let exponents = waves.exponents();
    let states = exponents.map(|l| {
        let [rotation, force, moment] = waves.state(l);
        [moment, force, c64::ONE, rotation]
    });
    let r = |i: usize| states[i][3];
    let turn = if left { -1.0 } else { 1.0 };
    let shares = small::inverse(&[[c64::ONE, c64::ONE], [r(0) * turn, r(1) * turn]])?.0;
    Some(std::array::from_fn(|p| {
        let q = |i: usize, j: usize| -states[i][p] * states[j][p] / (exponents[i] + exponents[j]);
        let q = [[q(0, 0), q(0, 1)], [q(1, 0), q(1, 1)]];
        let half = small::mul(&q, &shares);
        let turned = [[shares[0][0], shares[1][0]], [shares[0][1], shares[1][1]]];
        small::mul(&turned, &half)
    }))
}

/// The integrals over a half-infinite shaft, over the displacement of its end.
pub fn over_half_infinite_shaft(twist: &Twist) -> [M2; SLOPES] {
    let l = twist.exponent();
    let force = twist.stiffness * l;
    [c64::ZERO, force * force, c64::ONE, c64::ZERO].map(|p| [[-p / (l + l), c64::ZERO], [c64::ZERO; 2]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::terms;

    const LENGTH: f64 = 0.6;

    fn section() -> Section<c64> {
        Section {
            flexibility: c64::new(1.5e-7, -3e-9),
            shear_compliance: c64::new(4e-9, -1e-10),
            mu: c64::new(60.0 * 1.6e7, 0.0),
            rotary: c64::new(0.24 * 1.6e7, 0.0),
        }
    }

    fn march(x: f64, y: [c64; 4]) -> [c64; 4] {
        let t = Transfer::over(&section(), x, terms(12.0 * x));
        let row = |m: &M2, n: &M2, i: usize| m[i][0] * y[0] + m[i][1] * y[1] + n[i][0] * y[2] + n[i][1] * y[3];
        [row(&t.a, &t.b, 0), row(&t.a, &t.b, 1), row(&t.c, &t.d, 0), row(&t.c, &t.d, 1)]
    }

    /// Gauss-Legendre quadrature of the products, three points in each of many parts.
    #[test]
    fn integrals_over_a_length_are_those_of_quadrature() {
        let starts = [
            [c64::new(1e-3, 2e-4), c64::new(1e-3, 0.0), c64::new(2e3, -1e3), c64::new(-400.0, 1.0)],
            [c64::new(-2e-3, 0.0), c64::new(3e-4, 1e-4), c64::new(5e2, 2e2), c64::new(1e3, -300.0)],
        ];
        let exact = over_length(&section(), LENGTH, terms(12.0 * LENGTH));
        let parts = 200;
        let h = LENGTH / f64::from(parts);
        let mut sums = [c64::ZERO; SLOPES];
        for part in 0..parts {
            for (at, weight) in [(-0.6_f64.sqrt(), 5.0), (0.0, 8.0), (0.6_f64.sqrt(), 5.0)] {
                let x = h * (f64::from(part) + 0.5 + 0.5 * at);
                let (s, f) = (march(x, starts[0]), march(x, starts[1]));
                for (sum, k) in sums.iter_mut().zip([3, 2, 0, 1]) {
                    *sum += s[k] * f[k] * (weight * h / 18.0);
                }
            }
        }
        for (n, sum) in exact.iter().zip(sums) {
            let mut form = c64::ZERO;
            for i in 0..4 {
                for j in 0..4 {
                    form += starts[0][i] * n[i][j] * starts[1][j];
                }
            }
            assert!((form - sum).norm() < 1e-9 * sum.norm(), "{form} {sum}");
        }
    }

    /// The impedance of a half-infinite beam changes by these integrals; mirrored, the coupling changes sign.
    #[test]
    fn integrals_to_infinity_are_the_slopes_of_the_impedance() {
        let base = Waves {
            bending: c64::new(6.4e6, 6.4e4),
            shear_compliance: c64::new(4e-9, -1e-10),
            mu: c64::new(60.0 * 1.6e7, 0.0),
            rotary: c64::new(0.24 * 1.6e7, 0.0),
        };
        for left in [false, true] {
            let exact = over_half_infinite(&base, left).unwrap();
            let moved = |p: usize, h: f64| {
                let mut w = base;
                match p {
                    0 => w.bending = (w.bending.inv() * (1.0 + h)).inv(),
                    1 => w.shear_compliance *= 1.0 + h,
                    2 => w.mu *= 1.0 + h,
                    _ => w.rotary *= 1.0 + h,
                }
                w.half_infinite(left).unwrap()
            };
            let size = [base.bending.inv(), base.shear_compliance, base.mu, base.rotary];
            for (p, exact) in exact.iter().enumerate() {
                let (up, down) = (moved(p, 1e-5), moved(p, -1e-5));
                for (k, exact) in exact.iter().flatten().enumerate() {
                    let slope = (up[k / 2][k % 2] - down[k / 2][k % 2]) / (2e-5 * size[p]);
                    // The response's derivative is minus the impedance's.
                    assert!((slope + exact).norm() < 1e-8 * exact.norm(), "{p} {k} {slope} {exact}");
                }
            }
        }
    }
}
