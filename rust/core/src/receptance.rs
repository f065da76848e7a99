//! The receptance formulation, the paper's equations (4) to (16).
//!
//! The paper writes the displacements at the joints as unknowns, (14). With the joint forces
//! `F = K d` of (12) as unknowns the same equations need one unknown per joint:
//! `(I + K G) F = K d0`, where `d0` is the extension that the loads alone would give, and G the
//! extension per joint force. It stands for a lost joint (K = 0) as well as for a stiff one.

use crate::{
    c64,
    error::CoreError,
    green::Green,
    line::{Body, Line, Point, SAME_PLACE},
    modes::Modes,
};
use faer::{Mat, linalg::solvers::Solve};

/// Estimated relative error above which an answer is refused.
const WORST: f64 = 1e-5;

/// A line compiled for the dense formulation: the points of each body.
#[derive(Debug, Clone)]
pub struct Dense {
    places: Vec<Vec<f64>>,
    modes: Vec<Option<Modes>>,
    joints: Vec<Ends>,
    forces: Vec<Place>,
    sensors: Vec<Place>,
}

/// A body and the index of a point on it.
type Place = (usize, usize);

#[derive(Debug, Clone)]
struct Ends {
    a: Place,
    b: Option<Place>,
    law: usize,
    scale: f64,
}

impl Dense {
    /// Collects the points of a checked line.
    pub fn new(line: &Line, forces: &[Point], sensors: &[Point]) -> Self {
        let mut places: Vec<Vec<f64>> = vec![Vec::new(); line.bodies.len()];
        let mut place = |body: usize, x: f64| -> Place {
            let xs = &mut places[body];
            if matches!(line.bodies[body], Body::Mass(_)) && !xs.is_empty() {
                return (body, 0);
            }
            let found = xs.iter().position(|p| (p - x).abs() <= SAME_PLACE);
            (
                body,
                found.unwrap_or_else(|| {
                    xs.push(x);
                    xs.len() - 1
                }),
            )
        };
        let joints = line
            .joints
            .iter()
            .map(|j| Ends { a: place(j.a, j.x), b: j.b.map(|b| place(b, j.x)), law: j.law, scale: j.scale })
            .collect();
        let forces = forces.iter().map(|p| place(p.body, p.x)).collect();
        let sensors = sensors.iter().map(|p| place(p.body, p.x)).collect();
        let modes = line
            .bodies
            .iter()
            .zip(&places)
            .map(|(b, xs)| match b {
                Body::Beam(b) => b.modes.map(|n| Modes::new(b, n, xs)),
                Body::Mass(_) => None,
            })
            .collect();
        Self { places, modes, joints, forces, sensors }
    }

    /// Receptances between all points of all bodies at angular frequency `omega`.
    fn bodies(&self, line: &Line, omega: f64) -> Result<Vec<Mat<c64>>, CoreError> {
        let one = |(i, body): (usize, &Body)| -> Result<Mat<c64>, CoreError> {
            let xs = &self.places[i];
            let n = xs.len();
            let beam = match body {
                Body::Mass(m) => return Ok(Mat::from_fn(n, n, |_, _| c64::new(-1.0 / (omega * omega * m), 0.0))),
                Body::Beam(beam) => beam,
            };
            let mut g = Mat::zeros(n, n);
            let fill = |g: &mut Mat<c64>, f: &dyn Fn(usize, usize) -> c64| {
                for r in 0..n {
                    for c in 0..=r {
                        g[(r, c)] = f(r, c);
                        g[(c, r)] = g[(r, c)];
                    }
                }
            };
            if let Some(modes) = &self.modes[i] {
                fill(&mut g, &|r, c| modes.between(r, c, omega));
            } else {
                let green = Green::new(beam, omega)?;
                let waves: Vec<_> = xs.iter().map(|&x| green.at(x)).collect();
                fill(&mut g, &|r, c| green.between(xs[r], xs[c], &waves[r], &waves[c]));
            }
            Ok(g)
        };
        line.bodies.iter().enumerate().map(one).collect()
    }

    /// Solves one frequency: receptances (sensors x forces) and joint extensions (joints x forces, or empty).
    ///
    /// # Errors
    /// `Singular`, `NonFinite` or `IllConditioned` with the frequency.
    pub fn respond(
        &self,
        line: &Line,
        frequency: f64,
        laws: &[c64],
        sensors: &mut [c64],
        joints: &mut [c64],
    ) -> Result<(), CoreError> {
        let g = self.bodies(line, std::f64::consts::TAU * frequency)?;
        let between = |p: Place, q: Place| if p.0 == q.0 { g[p.0][(p.1, q.1)] } else { c64::ZERO };
        // Displacement at p, extension of joint j, by a force at q.
        let extension = |j: &Ends, q: Place| between(j.a, q) - j.b.map_or(c64::ZERO, |b| between(b, q));
        let (n, f) = (self.joints.len(), self.forces.len());
        let k: Vec<c64> = self.joints.iter().map(|j| laws[j.law] * j.scale).collect();
        if let Some(i) = k.iter().position(|k| !k.is_finite()) {
            return Err(CoreError::NonFinite { frequency, place: format!("stiffness of joint {i}") });
        }
        // Extension of joint r by a unit tension of joint c (up on a, down on b).
        let coupling = |r: usize, c: usize| {
            let (jr, jc) = (&self.joints[r], &self.joints[c]);
            extension(jr, jc.a) - jc.b.map_or(c64::ZERO, |b| extension(jr, b))
        };
        let matrix = Mat::from_fn(n, n, |r, c| {
            let identity = if r == c { c64::ONE } else { c64::ZERO };
            identity + k[r] * coupling(r, c)
        });
        let load = Mat::from_fn(n, f, |r, c| k[r] * extension(&self.joints[r], self.forces[c]));
        let tension = solve(&matrix, &load, frequency)?;
        for (s, &at) in self.sensors.iter().enumerate() {
            for (c, &force) in self.forces.iter().enumerate() {
                let mut u = between(at, force);
                for (r, j) in self.joints.iter().enumerate() {
                    u -= extension(j, at) * tension[(r, c)];
                }
                sensors[s * f + c] = u;
            }
        }
        if !joints.is_empty() {
            for r in 0..n {
                for c in 0..f {
                    // The extension itself, so that it stands for a lost joint too.
                    let mut d = extension(&self.joints[r], self.forces[c]);
                    for i in 0..n {
                        d -= coupling(r, i) * tension[(i, c)];
                    }
                    joints[r * f + c] = d;
                }
            }
        }
        if sensors.iter().chain(joints.iter()).all(|v| v.is_finite()) {
            Ok(())
        } else {
            Err(CoreError::NonFinite { frequency, place: "the response".into() })
        }
    }
}

/// Dense solve; refused when rounding in the matrix's own entries would spoil the answer.
fn solve(matrix: &Mat<c64>, load: &Mat<c64>, frequency: f64) -> Result<Mat<c64>, CoreError> {
    let (n, f) = (load.nrows(), load.ncols());
    if n == 0 || f == 0 {
        return Ok(load.clone());
    }
    let lu = matrix.partial_piv_lu();
    let mut x = lu.solve(load);
    let place = || "the joints".to_string();
    if !finite(&x) {
        // faer's elimination divides by a vanished pivot without a word.
        return Err(if finite(matrix) && finite(load) {
            CoreError::Singular { frequency, place: place() }
        } else {
            CoreError::NonFinite { frequency, place: place() }
        });
    }
    x += lu.solve(load - matrix * &x);
    // Each entry is 1 + K G with rounding errors of its terms; what they do to the answer.
    let worst = |c: usize| (0..n).map(|r| x[(r, c)].norm()).fold(0.0, f64::max);
    let error = Mat::from_fn(n, f, |r, c| {
        let row: f64 = (0..n).map(|k| matrix[(r, k)].norm() * x[(k, c)].norm()).sum();
        c64::new(f64::EPSILON * (row + x[(r, c)].norm()), 0.0)
    });
    let error = lu.solve(error);
    for c in 0..f {
        let (size, off) = (worst(c), (0..n).map(|r| error[(r, c)].norm()).fold(0.0, f64::max));
        let estimate = off / size;
        if size > 0.0 && (estimate.is_nan() || estimate > WORST) {
            return Err(CoreError::IllConditioned { frequency, place: place(), estimate });
        }
    }
    Ok(x)
}

/// Whether every entry is finite; faer's norms pass over NaN.
fn finite(m: &Mat<c64>) -> bool {
    (0..m.ncols()).all(|j| (0..m.nrows()).all(|i| m[(i, j)].is_finite()))
}
