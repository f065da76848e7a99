//! A line: bodies along x, joints that tie them, points where one pushes or listens.

use crate::{c64, error::CoreError};

/// What holds the end of a finite beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Neither force nor moment.
    Free,
    /// No displacement, no moment.
    Pinned,
}

/// A uniform beam. Without shear stiffness it is an Euler-Bernoulli beam, with it a Timoshenko beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Complex bending stiffness E I (1 + i eta), N m2.
    pub bending: c64,
    /// Complex shear stiffness kappa G A (1 + i eta), N; `None` for an Euler-Bernoulli beam.
    pub shear: Option<c64>,
    /// Mass per length rho A, kg/m.
    pub mass: f64,
    /// Rotary inertia per length rho I, kg m; 0 for an Euler-Bernoulli beam.
    pub rotary: f64,
    /// First and last coordinate in m; infinite for a beam without end.
    pub interval: [f64; 2],
    /// What holds the two ends; of no meaning for an infinite one.
    pub ends: [End; 2],
    /// Number of modes for the receptance formulation; `None` for the closed form.
    pub modes: Option<usize>,
}

/// Something that moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Body {
    /// A beam along the line.
    Beam(Beam),
    /// A point mass in kg.
    Mass(f64),
}

/// A spring of complex stiffness `scale * law(frequency)` between two bodies, or a body and the ground, at x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Place along the line in m.
    pub x: f64,
    /// Index of the upper body.
    pub a: usize,
    /// Index of the lower body; `None` for the ground.
    pub b: Option<usize>,
    /// Row of the law table.
    pub law: usize,
    /// Factor on the law.
    pub scale: f64,
}

/// A place on a body: of a unit force, or of a sensor of displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Index of the body.
    pub body: usize,
    /// Place along the line in m; for a mass, where it is joined.
    pub x: f64,
}

/// Bodies and joints along x.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The joints.
    pub joints: Vec<Joint>,
    /// Names of the bodies, for messages.
    pub names: Vec<String>,
}

/// Two places closer than this are one, in m.
pub const SAME_PLACE: f64 = 1e-9;

impl Beam {
    /// Whether x lies on the beam.
    pub fn holds(&self, x: f64) -> bool {
        x >= self.interval[0] - SAME_PLACE && x <= self.interval[1] + SAME_PLACE
    }

    fn check(&self, name: &str) -> Result<(), CoreError> {
        let bad = |what: &str| Err(CoreError::Invalid(format!("{name}: {what}")));
        if !(self.bending.is_finite() && self.bending.re > 0.0) {
            return bad("bending stiffness must be finite with a positive real part");
        }
        if self.shear.is_some_and(|s| !(s.is_finite() && s.re > 0.0)) {
            return bad("shear stiffness must be finite with a positive real part");
        }
        if !(self.mass.is_finite() && self.mass > 0.0) {
            return bad("mass per length must be positive");
        }
        if !(self.rotary.is_finite() && self.rotary >= 0.0) {
            return bad("rotary inertia must not be negative");
        }
        // Written so that NaN fails too.
        if self.interval[1].partial_cmp(&self.interval[0]) != Some(std::cmp::Ordering::Greater) {
            return bad("the interval must have a positive length");
        }
        if self.modes.is_some() && (self.shear.is_some() || !self.is_finite()) {
            return bad("modes are for finite Euler-Bernoulli beams");
        }
        if self.shear.is_none() && self.rotary != 0.0 {
            return bad("rotary inertia needs a shear stiffness");
        }
        Ok(())
    }

    /// Whether both ends are at a finite place.
    pub fn is_finite(&self) -> bool {
        self.interval[0].is_finite() && self.interval[1].is_finite()
    }
}

impl Line {
    /// The name of body `i`.
    pub fn name(&self, i: usize) -> String {
        self.names.get(i).cloned().unwrap_or_else(|| format!("body {i}"))
    }

    /// Checks the line against itself, and the points and the number of laws against the line.
    ///
    /// # Errors
    /// `Invalid` naming the body, joint or point at fault.
    pub fn check(&self, laws: usize, forces: &[Point], sensors: &[Point]) -> Result<(), CoreError> {
        for (i, body) in self.bodies.iter().enumerate() {
            match body {
                Body::Beam(beam) => beam.check(&self.name(i))?,
                Body::Mass(m) if m.is_finite() && *m > 0.0 => {}
                Body::Mass(_) => {
                    return Err(CoreError::Invalid(format!("{}: mass must be positive", self.name(i))));
                }
            }
        }
        for (i, j) in self.joints.iter().enumerate() {
            let bad = |what: &str| CoreError::Invalid(format!("joint {i} at x = {} m: {what}", j.x));
            if j.law >= laws {
                return Err(bad("its law is not in the table"));
            }
            if !j.scale.is_finite() {
                return Err(bad("its scale is not finite"));
            }
            if j.b == Some(j.a) {
                return Err(bad("it joins a body to itself"));
            }
            for body in [Some(j.a), j.b].into_iter().flatten() {
                self.check_place(body, j.x).map_err(|e| bad(&e))?;
            }
        }
        for (kind, points) in [("force", forces), ("sensor", sensors)] {
            for (i, p) in points.iter().enumerate() {
                self.check_place(p.body, p.x)
                    .map_err(|e| CoreError::Invalid(format!("{kind} {i} at x = {} m: {e}", p.x)))?;
            }
        }
        Ok(())
    }

    fn check_place(&self, body: usize, x: f64) -> Result<(), String> {
        if !x.is_finite() {
            return Err("the place is not finite".into());
        }
        match self.bodies.get(body) {
            None => Err(format!("there is no body {body}")),
            Some(Body::Beam(b)) if !b.holds(x) => {
                let [from, to] = b.interval;
                Err(format!("off {}, which runs from {from} to {to} m", self.name(body)))
            }
            Some(_) => Ok(()),
        }
    }
}
