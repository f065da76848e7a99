//! Receptance of one body made of several uniform parts: a beam whose section changes, or a shaft.
//!
//! In each part the response is a sum of exact solutions, and what goes on across a change of section (displacement,
//! rotation, force, moment) and what the ends demand make one linear system for their amplitudes. A part that is long
//! against its waves takes those that decay from its two ends; in a short one they would all but cancel, and the
//! solutions that start with a unit of each of the state at its left end, from [`Transfer`]'s power series, stand for them.

use crate::{
    c64,
    element::{Transfer, terms},
    error::CoreError,
    line::{Body, End, Line, SAME_PLACE},
    shaft::Twist,
    waves::Waves,
};
use faer::{Mat, linalg::solvers::Solve};

/// Longest part, as a multiple of the steepest wave's length scale, that is taken as short.
const SHORT: f64 = 2.0;

/// Displacement, rotation, force and moment; a shaft has the first and the third.
type State = [c64; 4];

/// What of the state goes on across a change of section.
const OF_A_BEAM: [usize; 4] = [0, 1, 2, 3];
const OF_A_SHAFT: [usize; 2] = [0, 2];

/// A body at one frequency.
#[derive(Debug, Clone)]
pub struct Parts {
    parts: Vec<Part>,
    rows: &'static [usize],
    /// Of each finite end: which of the state vanish there.
    ends: [Option<[usize; 2]>; 2],
    omega: f64,
}

#[derive(Debug, Clone)]
struct Part {
    interval: [f64; 2],
    section: Section,
    /// Exponent and state of each wave that decays towards +x, or `None` for a short part.
    waves: Option<Vec<(c64, State)>>,
}

#[derive(Debug, Clone, Copy)]
enum Section {
    Beam(Waves),
    Shaft(Twist),
}

impl Section {
    fn waves(&self) -> Vec<(c64, State)> {
        match self {
            Self::Beam(w) => {
                let state = |l: c64| {
                    let [rotation, force, moment] = w.state(l);
                    (l, [c64::ONE, rotation, force, moment])
                };
                w.exponents().map(state).to_vec()
            }
            Self::Shaft(t) => {
                let l = t.exponent();
                vec![(l, [c64::ONE, c64::ZERO, t.stiffness * l, c64::ZERO])]
            }
        }
    }

    fn transfer(&self, length: f64) -> Transfer {
        match self {
            Self::Beam(w) => Transfer::new(w, length),
            Self::Shaft(t) => {
                let mu = c64::new(t.mu, 0.0);
                Transfer::of_shaft(t.stiffness.inv(), mu, length, terms(t.exponent().norm() * length))
            }
        }
    }
}

/// The state beyond a length that starts with a unit of one of the state.
fn column(t: &Transfer, j: usize) -> State {
    let (u, f, j) = if j < 2 { (&t.a, &t.c, j) } else { (&t.b, &t.d, j - 2) };
    [u[0][j], u[1][j], f[0][j], f[1][j]]
}

/// The state seen from the other side: rotation and force change sign.
fn mirrored([w, rotation, force, moment]: State) -> State {
    [w, -rotation, -force, moment]
}

fn scaled(by: c64, state: State) -> State {
    state.map(|v| by * v)
}

impl Part {
    fn new(interval: [f64; 2], section: Section) -> Self {
        let waves = section.waves();
        let steepest = waves.iter().map(|(l, _)| l.norm()).fold(0.0, f64::max);
        let short = steepest * (interval[1] - interval[0]) < SHORT;
        Self { interval, section, waves: (!short).then_some(waves) }
    }

    /// States at x of the part's solutions.
    fn solutions(&self, rows: &[usize], x: f64) -> Vec<State> {
        let [from, to] = self.interval;
        let Some(waves) = &self.waves else {
            let t = self.section.transfer((x - from).max(0.0));
            return rows.iter().map(|&j| column(&t, j)).collect();
        };
        let right = waves.iter().filter(|_| from.is_finite());
        let right = right.map(|(l, state)| scaled((l * (x - from)).exp(), *state));
        let left = waves.iter().filter(|_| to.is_finite());
        right.chain(left.map(|(l, state)| scaled((l * (to - x)).exp(), mirrored(*state)))).collect()
    }

    /// State at x by a unit force at y, of one solution of the part; behind the force or before it.
    fn forced(&self, y: f64, x: f64, behind: bool) -> State {
        let distance = (x - y).abs();
        let mut sum = [c64::ZERO; 4];
        let mut add = |by: c64, state: State| {
            for (s, v) in sum.iter_mut().zip(state) {
                *s += by * v;
            }
        };
        match &self.waves {
            // Nothing before the force; behind it what a jump of the force by -1 makes.
            None if behind => add(-c64::ONE, column(&self.section.transfer(distance), 2)),
            None => {}
            // At the force the rotation vanishes, and half of the jump goes to each side.
            Some(waves) => {
                let shares = match waves[..] {
                    [(_, first), (_, second)] => {
                        let det = first[1] * second[2] - second[1] * first[2];
                        vec![second[1] / det * 0.5, -first[1] / det * 0.5]
                    }
                    _ => waves.iter().map(|(_, s)| -0.5 / s[2]).collect(),
                };
                for ((l, state), share) in waves.iter().zip(shares) {
                    add(share * (l * distance).exp(), if behind { *state } else { mirrored(*state) });
                }
            }
        }
        sum
    }
}

impl Parts {
    /// Prepares a body of a checked line at angular frequency `omega`, rad/s.
    ///
    /// # Errors
    /// `Invalid` for a mass, which has no parts.
    pub fn new(line: &Line, body: usize, omega: f64) -> Result<Self, CoreError> {
        let mut parts = Vec::new();
        for (interval, stretch) in line.parts(body) {
            let section = match line.section(body, stretch) {
                Body::Beam(beam) => Section::Beam(Waves::new(beam, omega)),
                Body::Shaft(shaft) => Section::Shaft(Twist::new(shaft, omega)),
                Body::Mass(_) => continue,
            };
            parts.push(Part::new(interval, section));
        }
        let (Some(first), Some(last)) = (parts.first(), parts.last()) else {
            return Err(CoreError::Invalid(format!("{} has no length", line.name(body))));
        };
        let finite = [first.interval[0].is_finite(), last.interval[1].is_finite()];
        let ends = line.bodies[body].ends();
        let shaft = matches!(line.bodies[body], Body::Shaft(_));
        let held = |end: usize| {
            finite[end].then_some(match ends[end] {
                End::Free => [2, 3],
                End::Pinned => [0, 3],
            })
        };
        let ends = [held(0), held(1)];
        Ok(Self { parts, rows: if shaft { &OF_A_SHAFT } else { &OF_A_BEAM }, ends, omega })
    }

    fn part_of(&self, x: f64) -> usize {
        let holds = |p: &Part| x <= p.interval[1] + SAME_PLACE;
        self.parts.iter().position(holds).unwrap_or(self.parts.len() - 1)
    }

    /// Whether a shaft, which has no moment, is held to that entry of the state at its ends.
    fn demanded(&self, end: usize) -> impl Iterator<Item = usize> {
        let rows = self.rows;
        self.ends[end].into_iter().flatten().filter(move |i| rows.contains(i))
    }

    /// Receptances between all points `xs`, m/N.
    ///
    /// # Errors
    /// `Singular` if the conditions cannot be met.
    pub fn between_all(&self, xs: &[f64]) -> Result<Mat<c64>, CoreError> {
        let n = xs.len();
        let of: Vec<usize> = xs.iter().map(|&x| self.part_of(x)).collect();
        let first: Vec<usize> = self
            .parts
            .iter()
            .scan(0, |next, p| {
                let here = *next;
                *next += match &p.waves {
                    None => self.rows.len(),
                    Some(w) => w.len() * p.interval.iter().filter(|x| x.is_finite()).count(),
                };
                Some((here, *next))
            })
            .map(|(here, _)| here)
            .collect();
        let ends = [0, 1].map(|e| self.demanded(e).count());
        let size = ends[0] + ends[1] + self.rows.len() * (self.parts.len() - 1);
        let (mut matrix, mut load) = (Mat::<c64>::zeros(size, size), Mat::<c64>::zeros(size, n));
        let mut row = 0;
        // What a part has of entry `i` of the state at one of its ends, with a sign, into the current row.
        let mut put = |row: usize, p: usize, right: bool, i: usize, sign: f64| {
            let part = &self.parts[p];
            let x = part.interval[usize::from(right)];
            for (k, state) in part.solutions(self.rows, x).iter().enumerate() {
                matrix[(row, first[p] + k)] += state[i] * sign;
            }
            for c in (0..n).filter(|c| of[*c] == p) {
                load[(row, c)] -= part.forced(xs[c], x, right)[i] * sign;
            }
        };
        for i in self.demanded(0) {
            put(row, 0, false, i, 1.0);
            row += 1;
        }
        for p in 1..self.parts.len() {
            for &i in self.rows {
                put(row, p - 1, true, i, 1.0);
                put(row, p, false, i, -1.0);
                row += 1;
            }
        }
        for i in self.demanded(1) {
            put(row, self.parts.len() - 1, true, i, 1.0);
            row += 1;
        }
        let amplitudes = self.solve(matrix, load)?;
        let at: Vec<_> = (0..n).map(|r| self.parts[of[r]].solutions(self.rows, xs[r])).collect();
        let mut g = Mat::zeros(n, n);
        for r in 0..n {
            for c in 0..=r {
                let mut w: c64 =
                    at[r].iter().enumerate().map(|(k, s)| s[0] * amplitudes[(first[of[r]] + k, c)]).sum();
                if of[r] == of[c] {
                    w += self.parts[of[r]].forced(xs[c], xs[r], xs[r] >= xs[c])[0];
                }
                g[(r, c)] = w;
                g[(c, r)] = w;
            }
        }
        Ok(g)
    }

    /// Solves for the amplitudes, rows brought to one size, once refined.
    fn solve(&self, mut matrix: Mat<c64>, mut load: Mat<c64>) -> Result<Mat<c64>, CoreError> {
        let (size, n) = (load.nrows(), load.ncols());
        if size == 0 || n == 0 {
            return Ok(load);
        }
        for i in 0..size {
            let largest = (0..size).map(|j| matrix[(i, j)].norm()).fold(0.0, f64::max);
            (0..size).for_each(|j| matrix[(i, j)] /= largest);
            (0..n).for_each(|j| load[(i, j)] /= largest);
        }
        let lu = matrix.partial_piv_lu();
        let mut x = lu.solve(&load);
        x += lu.solve(&load - &matrix * &x);
        if (0..n).all(|c| (0..size).all(|r| x[(r, c)].is_finite())) {
            return Ok(x);
        }
        let frequency = self.omega / std::f64::consts::TAU;
        Err(CoreError::Singular { frequency, place: "the ends of a beam".into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        green::{Distances, Green},
        line::{Beam, Shaft, Stretch},
    };

    const ENDLESS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    fn beam(interval: [f64; 2], ends: [End; 2]) -> Beam {
        Beam {
            bending: c64::new(3e7, 3e5),
            shear: Some(c64::new(2e9, 2e7)),
            mass: 600.0,
            rotary: 40.0,
            dashpots: [0.0; 4],
            interval,
            ends,
            modes: None,
        }
    }

    /// Stretches of the same section change nothing, short or long, at low frequency or high.
    #[test]
    fn cut_into_equal_parts_a_beam_is_uniform() {
        let (free, pinned) = (End::Free, End::Pinned);
        for (interval, ends) in [
            ([1.0, 7.0], [free, free]),
            ([1.0, 7.0], [pinned, free]),
            ([1.0, 7.0], [pinned, pinned]),
            ([1.0, f64::INFINITY], [free, free]),
            (ENDLESS, [free, free]),
        ] {
            let whole = beam(interval, ends);
            let stretch =
                |from, to| Stretch { body: 0, section: Body::Beam(Beam { interval: [from, to], ..whole }) };
            let stretches = vec![stretch(1.0, 1.7), stretch(1.7, 1.71), stretch(5.0, 6.5)];
            let line = Line { bodies: vec![Body::Beam(whole)], stretches, ..Line::default() };
            assert!(line.check(0, &[], &[]).is_ok());
            let mut xs = vec![1.3, 1.7, 1.705, 3.0, 5.0, 6.0, 6.5, 6.9];
            if ends == [free; 2] {
                xs.extend([1.0, 7.0]);
            }
            for omega in [6.0, 60.0, 1500.0, 20_000.0] {
                let cut = Parts::new(&line, 0, omega).unwrap().between_all(&xs).unwrap();
                let whole = Green::new(&whole, omega).unwrap().between_all(&xs, &Distances::new(&xs));
                for r in 0..xs.len() {
                    for c in 0..xs.len() {
                        let size = (whole[(r, r)].norm() * whole[(c, c)].norm()).sqrt();
                        let error = (cut[(r, c)] - whole[(r, c)]).norm() / size;
                        assert!(error < 1e-11, "{ends:?} {omega} {} {}: {error}", xs[r], xs[c]);
                    }
                }
            }
        }
    }

    /// `exp(-i k |x|) / (2 i k S)`, and a free one by images of it at the ends.
    #[test]
    fn shaft_is_its_closed_form() {
        let stiffness = c64::new(2e9, 4e7);
        for interval in [ENDLESS, [0.0, 5.0], [0.0, f64::INFINITY]] {
            let shaft = Shaft { stiffness, mass: 800.0, interval, ends: [End::Free; 2] };
            let line = Line { bodies: vec![Body::Shaft(shaft)], ..Line::default() };
            let xs = [0.0, 0.7, 3.1, 5.0];
            for omega in [10.0, 3000.0] {
                let k = (800.0 * omega * omega / stiffness).sqrt();
                let direct = |d: f64| (-c64::I * k * d).exp() / (2.0 * c64::I * k * stiffness);
                let g = Parts::new(&line, 0, omega).unwrap().between_all(&xs).unwrap();
                for (r, x) in xs.iter().enumerate() {
                    for (c, y) in xs.iter().enumerate() {
                        let (d, s) = ((x - y).abs(), x + y);
                        let closed = match (interval[0].is_finite(), interval[1].is_finite()) {
                            (false, _) => direct(d),
                            (true, false) => direct(d) + direct(s),
                            (true, true) => {
                                let terms = direct(d) + direct(s) + direct(10.0 - s) + direct(10.0 - d);
                                terms / (1.0 - (-c64::I * k * 10.0).exp())
                            }
                        };
                        assert!((g[(r, c)] - closed).norm() < 1e-12 * g[(0, 0)].norm(), "{omega} {x} {y}");
                    }
                }
            }
        }
    }
}
