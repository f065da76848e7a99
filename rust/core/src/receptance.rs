//! The receptance formulation, the paper's equations (4) to (16).
//!
//! The paper writes the displacements at the joints as unknowns, (14). With the joint forces
//! `F = K d` of (12) as unknowns the same equations need one unknown per joint:
//! `(I + K G) F = K d0`, where `d0` is the extension that the loads alone would give, and G the
//! extension per joint force. It stands for a lost joint (K = 0) as well as for a stiff one.

use crate::{
    c64,
    dense::solve_dense,
    error::CoreError,
    green::{Distances, Green},
    line::{Body, Line, Point, SAME_PLACE},
    modes::Modes,
    parts::Parts,
};
use faer::Mat;

/// A line compiled for the dense formulation: the points of each body.
#[derive(Debug, Clone)]
pub struct Dense {
    places: Vec<Vec<f64>>,
    distances: Vec<Distances>,
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
                Body::Shaft(_) | Body::Mass(_) => None,
            })
            .collect();
        let distances = places.iter().map(|xs| Distances::new(xs)).collect();
        Self { places, distances, modes, joints, forces, sensors }
    }

    /// Receptances between all points of all bodies at angular frequency `omega`.
    fn bodies(&self, line: &Line, omega: f64) -> Result<Vec<Mat<c64>>, CoreError> {
        let one = |(i, body): (usize, &Body)| -> Result<Mat<c64>, CoreError> {
            let xs = &self.places[i];
            let n = xs.len();
            let uniform = !line.stretches.iter().any(|s| s.body == i);
            let beam = match body {
                Body::Mass(m) => return Ok(Mat::from_fn(n, n, |_, _| c64::new(-1.0 / (omega * omega * m), 0.0))),
                Body::Beam(beam) if uniform => beam,
                Body::Beam(_) | Body::Shaft(_) => return Parts::new(line, i, omega)?.between_all(xs),
            };
            if let Some(modes) = &self.modes[i] {
                return Ok(modes.receptance(omega));
            }
            let green = Green::new(beam, omega)?;
            Ok(green.between_all(xs, &self.distances[i]))
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
        let tension = solve_dense(&matrix, &load, frequency)?;
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
