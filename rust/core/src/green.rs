//! Closed-form receptance between two points of a beam, infinite or with ends.
//!
//! The infinite beam's is the paper's equation (4). Ends reflect: to the direct wave come waves
//! that decay from each end, their amplitudes from the end conditions. All exponentials decay, so
//! no length and no frequency overflows.
//!
//! Where a finite beam is short against its waves these all but cancel: a free one then moves as a
//! rigid body, each wave by (k L)^-2 as much. There the receptance is composed of the solutions that
//! meet the conditions of one end each, from [`Transfer`]'s power series, which lose no digits.

use crate::{
    c64,
    element::Transfer,
    error::CoreError,
    line::{Beam, End},
    small::{self, M2},
    waves::Waves,
};
use faer::{Mat, linalg::solvers::Solve};

/// Longest beam, as a multiple of the steepest wave's length scale, that is composed of end solutions.
const SHORT: f64 = 2.0;

/// Receptance of one beam at one frequency.
#[derive(Debug, Clone)]
pub enum Green {
    /// Direct and reflected waves.
    Waves(Reflected),
    /// Solutions from both ends.
    Short(Composed),
}

impl Green {
    /// Prepares the beam at angular frequency `omega`, rad/s.
    ///
    /// # Errors
    /// `Singular` or `NonFinite` if the end conditions cannot be met.
    pub fn new(beam: &Beam, omega: f64) -> Result<Self, CoreError> {
        let length = beam.interval[1] - beam.interval[0];
        if Waves::new(beam, omega).steepest() * length < SHORT {
            Composed::new(beam, omega).map(Self::Short)
        } else {
            Reflected::new(beam, omega).map(Self::Waves)
        }
    }

    /// What a place contributes to [`Green::between`]: amplitudes there of the waves that decay from the
    /// ends, or displacements there of the solutions from both ends.
    pub fn at(&self, x: f64) -> Vec<c64> {
        match self {
            Self::Waves(g) => g.end_waves(x),
            Self::Short(g) => g.solutions(x),
        }
    }

    /// Receptances between all points `xs`, m/N.
    pub fn between_all(&self, xs: &[f64], distances: &Distances) -> Mat<c64> {
        let n = xs.len();
        let at: Vec<_> = xs.iter().map(|&x| self.at(x)).collect();
        let mut g = Mat::zeros(n, n);
        let mut fill = |f: &dyn Fn(usize, usize) -> c64| {
            for r in 0..n {
                for c in 0..=r {
                    g[(r, c)] = f(r, c);
                    g[(c, r)] = g[(r, c)];
                }
            }
        };
        match self {
            Self::Short(_) => fill(&|r, c| self.between(xs[r], xs[c], &at[r], &at[c])),
            Self::Waves(w) => {
                // Few distances are distinct, and what the ends send back is one product for each force.
                let direct: Vec<_> = distances.distinct.iter().map(|&d| w.direct(d)).collect();
                let reflected: Vec<_> = at.iter().map(|a| w.reflect(a)).collect();
                fill(&|r, c| {
                    let ends: c64 = at[r].iter().zip(&reflected[c]).map(|(a, b)| a * b).sum();
                    direct[distances.index[r * (r + 1) / 2 + c]] + ends
                });
            }
        }
        g
    }

    /// Receptance between `x` and `y`, m/N, given what both contribute.
    pub fn between(&self, x: f64, y: f64, at_x: &[c64], at_y: &[c64]) -> c64 {
        match self {
            Self::Waves(g) => g.between((x - y).abs(), at_x, at_y),
            Self::Short(g) if x < y => g.between(at_x, at_y),
            Self::Short(g) => g.between(at_y, at_x),
        }
    }
}

/// Direct and reflected waves of one beam at one frequency.
#[derive(Debug, Clone)]
pub struct Reflected {
    exponents: [c64; 2],
    direct: [c64; 2],
    /// Coordinates of the finite ends, -1 at the left and +1 at the right.
    ends: Vec<(f64, f64)>,
    /// Symmetric matrix between the decaying waves at the point of response and of force.
    reflection: Mat<c64>,
}

impl Reflected {
    fn new(beam: &Beam, omega: f64) -> Result<Self, CoreError> {
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
            return Err(singular(omega));
        }
        Ok(Self { exponents, direct, ends, reflection })
    }

    /// Amplitudes at x of the waves that decay from the ends.
    fn end_waves(&self, x: f64) -> Vec<c64> {
        let wave = |(end, side): &(f64, f64)| self.exponents.map(|l| (l * ((end - x) * side)).exp());
        self.ends.iter().flat_map(wave).collect()
    }

    /// Receptance at distance `d`, the ends' waves at both points given, m/N.
    fn between(&self, d: f64, at: &[c64], force: &[c64]) -> c64 {
        let ends: c64 = at.iter().zip(self.reflect(force)).map(|(a, b)| a * b).sum();
        self.direct(d) + ends
    }

    /// Receptance of the beam without ends at distance `d`, m/N (paper, equation (4)).
    fn direct(&self, d: f64) -> c64 {
        (0..2).map(|j| self.direct[j] * (self.exponents[j] * d).exp()).sum()
    }

    /// What the ends send back of a force whose waves at them are `force`: its product with the waves at the point
    /// of response is their share of the receptance, m/N.
    fn reflect(&self, force: &[c64]) -> Vec<c64> {
        let n = force.len();
        (0..n).map(|i| (0..n).map(|j| self.reflection[(i, j)] * force[j]).sum()).collect()
    }
}

/// Distances between the points of a body: with equal spacing there are few distinct ones.
#[derive(Debug, Clone)]
pub struct Distances {
    distinct: Vec<f64>,
    /// For each pair (r, c) with c <= r, at r (r + 1) / 2 + c, its place among the distinct.
    index: Vec<usize>,
}

impl Distances {
    /// Of the points `xs`, m.
    pub fn new(xs: &[f64]) -> Self {
        let pairs = || (0..xs.len()).flat_map(|r| (0..=r).map(move |c| (xs[r] - xs[c]).abs()));
        let mut distinct: Vec<f64> = pairs().collect();
        distinct.sort_by(f64::total_cmp);
        // Distances that differ by rounding of the coordinates are one.
        distinct.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        let find = |d: f64| {
            let after = distinct.partition_point(|v| *v < d);
            let near = |i: usize| distinct.get(i).map_or(f64::INFINITY, |v| (v - d).abs());
            if after > 0 && near(after - 1) < near(after) { after - 1 } else { after }
        };
        let index = pairs().map(find).collect();
        Self { distinct, index }
    }
}

fn singular(omega: f64) -> CoreError {
    CoreError::Singular { frequency: omega / std::f64::consts::TAU, place: "the ends of a beam".into() }
}

/// The two solutions that meet the conditions of each end, of one beam at one frequency.
///
/// For a unit force at y the beam moves as a left solution before it and as a right one behind it.
/// The form `u1 f2 - f1 u2` of two solutions is the same at every place, and vanishes for two of the
/// same end, so `w(x) = -R(x) M^-1 L(y)`, x > y, with M the form of every left and right solution.
#[derive(Debug, Clone)]
pub struct Composed {
    waves: Waves,
    interval: [f64; 2],
    ends: [End; 2],
    /// -M^-1, right solutions by left ones.
    coupling: M2,
}

impl Composed {
    fn new(beam: &Beam, omega: f64) -> Result<Self, CoreError> {
        let waves = Waves::new(beam, omega);
        let across = Transfer::new(&waves, beam.interval[1] - beam.interval[0]);
        // At the left end, where the left solutions have a unit of what that end leaves free.
        let form = |free: usize, [u, f]: [[c64; 2]; 2]| match (beam.ends[0], free) {
            (End::Free, i) => f[i],
            (End::Pinned, 0) => f[1],
            (End::Pinned, _) => -u[0],
        };
        let right = [0, 1].map(|j| {
            let ([w, rotation], [force, moment]) = arrive(&across, beam.ends[1], j);
            // Seen from the right the beam is mirrored: rotation and force change sign.
            [[w, -rotation], [-force, moment]]
        });
        let m = [0, 1].map(|i| [form(i, right[0]), form(i, right[1])]);
        let (inverse, _) = small::inverse(&m).ok_or_else(|| singular(omega))?;
        let coupling = inverse.map(|row| row.map(|v| -v));
        Ok(Self { waves, interval: beam.interval, ends: beam.ends, coupling })
    }

    /// Displacements at x of the two left and the two right solutions.
    fn solutions(&self, x: f64) -> Vec<c64> {
        let from = |end: usize| {
            let transfer = Transfer::new(&self.waves, (x - self.interval[end]).abs());
            [0, 1].map(|j| arrive(&transfer, self.ends[end], j).0[0])
        };
        [from(0), from(1)].concat()
    }

    fn between(&self, before: &[c64], behind: &[c64]) -> c64 {
        (0..2).map(|i| behind[2 + i] * (self.coupling[i][0] * before[0] + self.coupling[i][1] * before[1])).sum()
    }
}

/// Displacements and forces beyond a length that starts with unit `j` of what its end leaves free:
/// displacement and rotation of a free end, rotation and force of a pinned one.
fn arrive(t: &Transfer, end: End, j: usize) -> ([c64; 2], [c64; 2]) {
    let column = |m: &M2, j: usize| [m[0][j], m[1][j]];
    match (end, j) {
        (End::Free, j) => (column(&t.a, j), column(&t.c, j)),
        (End::Pinned, 0) => (column(&t.a, 1), column(&t.c, 1)),
        (End::Pinned, _) => (column(&t.b, 0), column(&t.d, 0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where both forms hold they agree, for either theory and all ends.
    #[test]
    fn forms_agree() {
        let ends = [End::Free, End::Pinned];
        for (shear, rotary) in [(None, 0.0), (Some(c64::new(2e9, 2e7)), 40.0)] {
            for pair in [[0, 0], [0, 1], [1, 0], [1, 1]] {
                let beam = Beam {
                    bending: c64::new(3e7, 3e5),
                    shear,
                    mass: 600.0,
                    rotary,
                    dashpots: [0.0; 4],
                    interval: [1.0, 4.0],
                    ends: pair.map(|i| ends[i]),
                    modes: None,
                };
                let omega = 60.0;
                let short = Green::Short(Composed::new(&beam, omega).unwrap());
                let waves = Green::Waves(Reflected::new(&beam, omega).unwrap());
                for (x, y) in [(1.0, 1.0), (1.3, 3.9), (3.9, 1.3), (2.2, 2.2), (4.0, 1.1)] {
                    let [a, b] = [&short, &waves].map(|g| g.between(x, y, &g.at(x), &g.at(y)));
                    assert!((a - b).norm() <= 1e-12 * b.norm() + 1e-20, "{pair:?} {x} {y}: {a} {b}");
                }
            }
        }
    }

    /// A short free beam moves as a rigid body: G = -(1/m + 12 a b / (m l^2)) / omega^2.
    #[test]
    fn rigid_body_limit() {
        let beam = Beam {
            bending: c64::new(1.5e11, 3e9),
            shear: None,
            mass: 5e4,
            rotary: 0.0,
            dashpots: [0.0; 4],
            interval: [0.0, 2.0],
            ends: [End::Free; 2],
            modes: None,
        };
        let omega = 1e-3;
        let g = Green::new(&beam, omega).unwrap();
        for (x, y) in [(0.0, 0.0), (0.2, 1.7), (1.0, 0.5)] {
            let rigid = -(1.0 + 3.0 * (x - 1.0) * (y - 1.0)) / (1e5 * omega * omega);
            let value = g.between(x, y, &g.at(x), &g.at(y));
            assert!((value - rigid).norm() < 1e-13 * rigid.abs(), "{value} {rigid}");
        }
    }
}
