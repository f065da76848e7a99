//! Closed-form receptance between two points of a beam, infinite or with ends.
//!
//! The infinite beam's is the paper's equation (4). Ends reflect: to the direct wave come waves
//! that decay from each end, their amplitudes from the end conditions. All exponentials decay, so
//! no length and no frequency overflows.

use crate::{
    c64,
    error::CoreError,
    line::{Beam, End},
    waves::Waves,
};
use faer::{Mat, linalg::solvers::Solve};

/// Receptance of one beam at one frequency.
#[derive(Debug, Clone)]
pub struct Green {
    exponents: [c64; 2],
    direct: [c64; 2],
    /// Coordinates of the finite ends, -1 at the left and +1 at the right.
    ends: Vec<(f64, f64)>,
    /// Symmetric matrix between the decaying waves at the point of response and of force.
    reflection: Mat<c64>,
}

impl Green {
    /// Prepares the beam at angular frequency `omega`, rad/s.
    ///
    /// # Errors
    /// `Singular` or `NonFinite` if the end conditions cannot be met.
    pub fn new(beam: &Beam, omega: f64) -> Result<Self, CoreError> {
        let w = Waves::new(beam, omega);
        let exponents = w.exponents();
        let states = exponents.map(|l| w.state(l));
        // At the force the rotation vanishes and V jumps by the unit force (half to each side).
        let [[r1, v1, _], [r2, v2, _]] = states;
        let det = r1 * v2 - r2 * v1;
        let direct = [r2 / det * 0.5, -r1 / det * 0.5];
        let ends: Vec<_> =
            [(beam.interval[0], -1.0), (beam.interval[1], 1.0)].into_iter().filter(|e| e.0.is_finite()).collect();
        let n = 2 * ends.len();
        // What each end must have zero of a wave (w = 1, moment, force) leaving it, or arriving.
        let conditions = |end: End, j: usize, sign: f64| -> [c64; 2] {
            let [_, v, m] = states[j];
            match end {
                End::Free => [m, v * sign],
                End::Pinned => [m, c64::ONE],
            }
        };
        let kind = |e: usize| if ends[e].1 < 0.0 { beam.ends[0] } else { beam.ends[1] };
        let length = beam.interval[1] - beam.interval[0];
        let mut matrix = Mat::<c64>::zeros(n, n);
        let mut source = Mat::<c64>::zeros(n, n);
        for e in 0..ends.len() {
            for j in 0..2 {
                let leaving = conditions(kind(e), j, 1.0);
                let arriving = conditions(kind(e), j, -1.0);
                for i in 0..2 {
                    matrix[(2 * e + i, 2 * e + j)] = leaving[i];
                    source[(2 * e + i, 2 * e + j)] = arriving[i] * direct[j];
                    if ends.len() == 2 {
                        let other = 2 * (1 - e) + j;
                        matrix[(2 * e + i, other)] = arriving[i] * (exponents[j] * length).exp();
                    }
                }
            }
        }
        // Rows to one size: moments and displacements differ by orders of magnitude.
        for i in 0..n {
            let size = (0..n).map(|j| matrix[(i, j)].norm()).fold(0.0, f64::max);
            for j in 0..n {
                matrix[(i, j)] /= size;
                source[(i, j)] /= size;
            }
        }
        let reflection = if n == 0 { source } else { -matrix.partial_piv_lu().solve(&source) };
        let finite = |m: &Mat<c64>| (0..n).all(|i| (0..n).all(|j| m[(i, j)].is_finite()));
        if !finite(&reflection) || !direct.iter().all(|d| d.is_finite()) {
            let frequency = omega / std::f64::consts::TAU;
            return Err(CoreError::Singular { frequency, place: "the ends of a beam".into() });
        }
        Ok(Self { exponents, direct, ends, reflection })
    }

    /// Amplitudes at x of the waves that decay from the ends.
    pub fn end_waves(&self, x: f64) -> Vec<c64> {
        let wave = |(end, side): &(f64, f64)| self.exponents.map(|l| (l * ((end - x) * side)).exp());
        self.ends.iter().flat_map(wave).collect()
    }

    /// Receptance at distance `d`, the ends' waves at both points given, m/N.
    pub fn between(&self, d: f64, at: &[c64], force: &[c64]) -> c64 {
        let mut g: c64 = (0..2).map(|j| self.direct[j] * (self.exponents[j] * d).exp()).sum();
        for (i, a) in at.iter().enumerate() {
            let reflected: c64 = force.iter().enumerate().map(|(j, f)| self.reflection[(i, j)] * f).sum();
            g += a * reflected;
        }
        g
    }
}
