//! Receptance as a sum over modes, the paper's equations (6), (8) and (10).

use crate::{
    c64,
    line::{Beam, End},
};
use faer::Mat;

/// Modes of a finite Euler-Bernoulli beam at given points.
#[derive(Debug, Clone)]
pub struct Modes {
    /// Squared natural angular frequencies over the bending stiffness's real part, and shapes at the points.
    pub modes: Vec<Mode>,
    /// Loss factor of the bending stiffness.
    pub loss: f64,
}

/// One mode, mass-normalised.
#[derive(Debug, Clone)]
pub struct Mode {
    /// Squared natural angular frequency, rad2/s2.
    pub omega2: f64,
    /// Shape at the points, kg^-1/2.
    pub shape: Vec<f64>,
}

impl Modes {
    /// The first `count` bending modes at `points`; a free-free beam has two rigid ones before them.
    pub fn new(beam: &Beam, count: usize, points: &[f64]) -> Self {
        let length = beam.interval[1] - beam.interval[0];
        let norm = (beam.mass * length).sqrt().recip();
        let xi: Vec<f64> = points.iter().map(|x| (x - beam.interval[0]) / length).collect();
        let shape = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { xi.iter().map(|&x| f(x) * norm).collect() };
        let mut modes = Vec::new();
        if beam.ends == [End::Free; 2] {
            modes.push(Mode { omega2: 0.0, shape: shape(&|_| 1.0) });
            modes.push(Mode { omega2: 0.0, shape: shape(&|x| 12f64.sqrt() * (x - 0.5)) });
        }
        for n in 1..=count {
            let (beta, f): (f64, Box<dyn Fn(f64) -> f64>) = match beam.ends {
                [End::Free, End::Free] => (free_root(n), Box::new(free_shape(free_root(n)))),
                [End::Pinned, End::Pinned] => {
                    let b = n as f64 * std::f64::consts::PI;
                    (b, Box::new(move |x| std::f64::consts::SQRT_2 * (b * x).sin()))
                }
                _ => (hinged_root(n), Box::new(hinged_shape(hinged_root(n), beam.ends[0] == End::Pinned))),
            };
            let omega2 = beam.bending.re / beam.mass * (beta / length).powi(4);
            modes.push(Mode { omega2, shape: shape(&*f) });
        }
        if beam.ends[0] != beam.ends[1] {
            let pinned_left = beam.ends[0] == End::Pinned;
            let rigid = |x: f64| 3f64.sqrt() * if pinned_left { x } else { 1.0 - x };
            modes.insert(0, Mode { omega2: 0.0, shape: shape(&rigid) });
        }
        Self { modes, loss: beam.bending.im / beam.bending.re }
    }

    /// Receptances between all points at angular frequency `omega`, m/N.
    pub fn receptance(&self, omega: f64) -> Mat<c64> {
        let (points, count) = (self.modes.first().map_or(0, |m| m.shape.len()), self.modes.len());
        let shapes = Mat::from_fn(points, count, |i, m| c64::new(self.modes[m].shape[i], 0.0));
        let inverse = |m: &Mode| c64::new(m.omega2 - omega * omega, m.omega2 * self.loss).inv();
        let weights: Vec<c64> = self.modes.iter().map(inverse).collect();
        let weighted = Mat::from_fn(count, points, |m, j| weights[m] * self.modes[m].shape[j]);
        shapes * weighted
    }
}

/// Root n of `cos b cosh b = 1`, n from 1, by Newton's method on `cos b = 1 / cosh b`.
fn free_root(n: usize) -> f64 {
    let mut b = (n as f64 + 0.5) * std::f64::consts::PI;
    for _ in 0..8 {
        let (f, d) = (b.cos() - b.cosh().recip(), -b.sin() + b.tanh() / b.cosh());
        b -= f / d;
    }
    b
}

/// Root n of `tan b = tanh b`, n from 1 (free at one end, pinned at the other).
fn hinged_root(n: usize) -> f64 {
    let mut b = (n as f64 + 0.25) * std::f64::consts::PI;
    for _ in 0..8 {
        let (t, h) = (b.tan(), b.tanh());
        b -= (t - h) / (t * t + h * h);
    }
    b
}

/// Free-free shape of mean square one, in exponentials that do not overflow.
fn free_shape(b: f64) -> impl Fn(f64) -> f64 {
    let e = (-b).exp();
    let half = (1.0 - e * e) / 2.0 - b.sin() * e;
    // sigma = (cosh b - cos b) / (sinh b - sin b); (1 - sigma) e^b without cancellation.
    let rest = (-e - b.sin() + b.cos()) / half;
    let sigma = 1.0 - rest * e;
    move |x| {
        let grow = 0.5 * rest * (b * (x - 1.0)).exp();
        let decay = 0.5 * (1.0 + sigma) * (-b * x).exp();
        (b * x).cos() - sigma * (b * x).sin() + grow + decay
    }
}

/// Pinned-free shape of mean square one; mirrored if the pin is at the right.
fn hinged_shape(b: f64, pinned_left: bool) -> impl Fn(f64) -> f64 {
    let ratio = b.sin() / (1.0 - (-2.0 * b).exp());
    let norm = std::f64::consts::SQRT_2 / (1.0 - (b.sin() / b.sinh()).powi(2)).sqrt();
    move |x| {
        let x = if pinned_left { x } else { 1.0 - x };
        let sinh = ((b * (x - 1.0)).exp() - (-b * (x + 1.0)).exp()) * ratio;
        norm * ((b * x).sin() + sinh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beam(ends: [End; 2]) -> Beam {
        Beam {
            bending: c64::new(3e7, 3e6),
            shear: None,
            mass: 600.0,
            rotary: 0.0,
            dashpots: [0.0; 4],
            interval: [2.0, 10.0],
            ends,
            modes: None,
        }
    }

    /// Shapes are orthonormal in the mass, whatever the ends.
    #[test]
    fn orthonormal() {
        let (n, b) = (4000, [End::Free, End::Pinned]);
        let x: Vec<f64> = (0..n).map(|i| 2.0 + 8.0 * (i as f64 + 0.5) / n as f64).collect();
        for ends in [[b[0], b[0]], [b[1], b[1]], [b[0], b[1]], [b[1], b[0]]] {
            let m = Modes::new(&beam(ends), 30, &x).modes;
            for i in 0..m.len() {
                for j in 0..=i {
                    let dot: f64 =
                        m[i].shape.iter().zip(&m[j].shape).map(|(a, b)| a * b).sum::<f64>() * 600.0 * 8.0
                            / n as f64;
                    let expected = if i == j { 1.0 } else { 0.0 };
                    assert!((dot - expected).abs() < 2e-3, "{ends:?} {i} {j}: {dot}");
                }
            }
        }
    }
}
