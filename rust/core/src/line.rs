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
    /// Viscous losses beside each of the four, as force or moment per velocity: of bending, N m2 s; of shear, N s; per
    /// length against the motion, N s/m2; per length against the rotation, N s.
    pub dashpots: [f64; 4],
    /// First and last coordinate in m; infinite for a beam without end.
    pub interval: [f64; 2],
    /// What holds the two ends; of no meaning for an infinite one.
    pub ends: [End; 2],
    /// Number of modes for the receptance formulation; `None` for the closed form.
    pub modes: Option<usize>,
}

/// What of a beam's section stands in its equations at one frequency: stiffness and inertia with their viscous losses.
#[derive(Debug, Clone, Copy)]
pub struct Properties {
    /// Bending stiffness, N m2.
    pub bending: c64,
    /// Shear stiffness, N; `None` for an Euler-Bernoulli beam.
    pub shear: Option<c64>,
    /// Mass per length, kg/m.
    pub mass: c64,
    /// Rotary inertia per length, kg m.
    pub rotary: c64,
}

/// A uniform body along the line whose places move up and down as it shears or twists: `S w'' = -f`, no bending.
///
/// A body that rolls about its axis moves by w = y phi at the distance y from it: S = G J / y^2, m = rho I_p / y^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaft {
    /// Complex stiffness S against w', N.
    pub stiffness: c64,
    /// Mass per length, kg/m.
    pub mass: f64,
    /// First and last coordinate in m; infinite for a shaft without end.
    pub interval: [f64; 2],
    /// What holds the two ends; of no meaning for an infinite one.
    pub ends: [End; 2],
}

/// Something that moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Body {
    /// A beam along the line.
    Beam(Beam),
    /// A shaft along the line.
    Shaft(Shaft),
    /// A point mass in kg.
    Mass(f64),
}

/// A length of a body where its section is another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Index of the body.
    pub body: usize,
    /// The section, of the body's kind; its interval is the stretch's, its ends have no meaning.
    pub section: Body,
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
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Line {
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The joints.
    pub joints: Vec<Joint>,
    /// Names of the bodies, for messages.
    pub names: Vec<String>,
    /// Where sections change, by body and then from left to right; none reaches infinity.
    pub stretches: Vec<Stretch>,
}

/// Two places closer than this are one, in m.
pub const SAME_PLACE: f64 = 1e-9;

impl Body {
    /// First and last coordinate, m; `None` for a mass.
    pub fn interval(&self) -> Option<[f64; 2]> {
        match self {
            Self::Beam(b) => Some(b.interval),
            Self::Shaft(s) => Some(s.interval),
            Self::Mass(_) => None,
        }
    }

    /// What holds the two ends.
    pub fn ends(&self) -> [End; 2] {
        match self {
            Self::Beam(b) => b.ends,
            Self::Shaft(s) => s.ends,
            Self::Mass(_) => [End::Free; 2],
        }
    }

    fn check(&self, name: &str) -> Result<(), CoreError> {
        match self {
            Self::Beam(beam) => beam.check(name),
            Self::Shaft(shaft) => shaft.check(name),
            Self::Mass(m) if m.is_finite() && *m > 0.0 => Ok(()),
            Self::Mass(_) => Err(CoreError::Invalid(format!("{name}: mass must be positive"))),
        }
    }
}

/// Whether an interval has a length. NaN has none.
fn has_length(interval: [f64; 2]) -> bool {
    interval[1].partial_cmp(&interval[0]) == Some(std::cmp::Ordering::Greater)
}

impl Shaft {
    fn check(&self, name: &str) -> Result<(), CoreError> {
        let bad = |what: &str| Err(CoreError::Invalid(format!("{name}: {what}")));
        if !(self.stiffness.is_finite() && self.stiffness.re > 0.0) {
            return bad("stiffness must be finite with a positive real part");
        }
        if !(self.mass.is_finite() && self.mass > 0.0) {
            return bad("mass per length must be positive");
        }
        if !has_length(self.interval) {
            return bad("the interval must have a positive length");
        }
        Ok(())
    }
}

impl Beam {
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
        if !has_length(self.interval) {
            return bad("the interval must have a positive length");
        }
        if self.modes.is_some() && (self.shear.is_some() || !self.is_finite()) {
            return bad("modes are for finite Euler-Bernoulli beams");
        }
        if self.dashpots.iter().any(|d| !(d.is_finite() && *d >= 0.0)) {
            return bad("viscous losses must not be negative");
        }
        if self.modes.is_some() && self.dashpots != [0.0; 4] {
            return bad("modes are for beams without viscous losses");
        }
        if self.shear.is_none() && self.rotary != 0.0 {
            return bad("rotary inertia needs a shear stiffness");
        }
        Ok(())
    }

    /// The section at angular frequency `omega`, rad/s.
    pub fn at(&self, omega: f64) -> Properties {
        let [bending, shear, motion, rotation] = self.dashpots;
        Properties {
            bending: self.bending + c64::new(0.0, omega * bending),
            shear: self.shear.map(|s| s + c64::new(0.0, omega * shear)),
            // A dashpot's force i omega c w is that of the mass -i c / omega.
            mass: c64::new(self.mass, -motion / omega),
            rotary: c64::new(self.rotary, -rotation / omega),
        }
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
            body.check(&self.name(i))?;
        }
        self.check_stretches()?;
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

    /// The section of a body in its stretch, or the body's own.
    pub fn section(&self, body: usize, stretch: Option<usize>) -> &Body {
        stretch.map_or(&self.bodies[body], |k| &self.stretches[k].section)
    }

    /// The stretch of a body that holds x.
    pub fn stretch_at(&self, body: usize, x: f64) -> Option<usize> {
        let from = |s: &Stretch| s.section.interval().map_or(f64::NAN, |i| i[0]);
        let after = self.stretches.partition_point(|s| s.body < body || (s.body == body && from(s) <= x));
        let last = after.checked_sub(1)?;
        let Stretch { body: of, section } = self.stretches[last];
        (of == body && section.interval()?[1] > x).then_some(last)
    }

    /// The uniform parts of a body, from left to right: where, and in which stretch.
    pub fn parts(&self, body: usize) -> Vec<([f64; 2], Option<usize>)> {
        let Some([from, to]) = self.bodies[body].interval() else { return Vec::new() };
        let (mut parts, mut at) = (Vec::new(), from);
        for (k, s) in self.stretches.iter().enumerate().filter(|(_, s)| s.body == body) {
            let Some([a, b]) = s.section.interval() else { continue };
            // Slivers are rounding.
            if a - at > SAME_PLACE {
                parts.push(([at, a], None));
            } else if let Some((before, _)) = parts.last_mut() {
                before[1] = a;
            }
            parts.push(([if parts.is_empty() { from.max(at) } else { a }, b], Some(k)));
            at = b;
        }
        if to - at > SAME_PLACE {
            parts.push(([at, to], None));
        }
        parts
    }

    fn check_stretches(&self) -> Result<(), CoreError> {
        let mut before = (0, f64::NEG_INFINITY);
        for s in &self.stretches {
            let bad = |what: &str| Err(CoreError::Invalid(format!("{}: {what}", self.name(s.body))));
            let whole = match (self.bodies.get(s.body), &s.section) {
                (Some(Body::Beam(b)), Body::Beam(section)) if b.shear.is_some() == section.shear.is_some() => {
                    if b.modes.is_some() {
                        return bad("modes are for uniform beams");
                    }
                    b.interval
                }
                (Some(Body::Shaft(b)), Body::Shaft(_)) => b.interval,
                _ => return bad("another section must be of the body's own kind"),
            };
            s.section.check(&self.name(s.body))?;
            let Some([from, to]) = s.section.interval() else { continue };
            if !(from.is_finite() && to.is_finite()) {
                return bad("another section must not reach infinity");
            }
            if to - from <= SAME_PLACE || from < whole[0] - SAME_PLACE || to > whole[1] + SAME_PLACE {
                return bad("another section must have a length on the body");
            }
            if s.body < before.0 || (s.body == before.0 && from < before.1) {
                return bad("other sections must come by body and from left to right, without overlap");
            }
            before = (s.body, to);
        }
        Ok(())
    }

    fn check_place(&self, body: usize, x: f64) -> Result<(), String> {
        if !x.is_finite() {
            return Err("the place is not finite".into());
        }
        let Some(found) = self.bodies.get(body) else { return Err(format!("there is no body {body}")) };
        match found.interval() {
            Some([from, to]) if !(x >= from - SAME_PLACE && x <= to + SAME_PLACE) => {
                Err(format!("off {}, which runs from {from} to {to} m", self.name(body)))
            }
            _ => Ok(()),
        }
    }
}
