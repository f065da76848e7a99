//! Lines and requests drawn from a fuzzer's bytes.
//!
//! [`Draw::absurd`] gives numbers of any kind, [`Draw::sound`] such as a railway has: with them a line is whatever
//! bytes make of it, and everything that a caller could hand to the core can be reached.

use arbitrary::{Result, Unstructured};
use permway_core::{
    c64,
    line::{Beam, Body, End, Joint, Line, Point, Shaft, Stretch},
};

/// Places in m lie within this of zero, on a grid fine enough to meet each other and to miss each other narrowly.
const EXTENT: i32 = 64;

/// Numbers that break careless arithmetic.
const SPECIAL: [f64; 14] = [
    0.0,
    -0.0,
    -1.0,
    1.0,
    1e-9,
    1e9,
    1e300,
    -1e300,
    1e-300,
    f64::MIN_POSITIVE,
    f64::EPSILON,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// A source of lines.
pub struct Draw<'a> {
    bytes: Unstructured<'a>,
    /// Whether numbers may be of any kind; indices may then lead nowhere, too.
    absurd: bool,
}

/// A whole request: a line, frequencies in Hz, stiffnesses (frequency x law, N/m), forces, sensors.
#[derive(Debug)]
pub struct Drawn {
    pub line: Line,
    pub frequencies: Vec<f64>,
    pub laws: Vec<c64>,
    pub n_laws: usize,
    pub forces: Vec<Point>,
    pub sensors: Vec<Point>,
}

impl<'a> Draw<'a> {
    /// Numbers of any kind.
    pub fn absurd(bytes: &'a [u8]) -> Self {
        Self { bytes: Unstructured::new(bytes), absurd: true }
    }

    /// Numbers as a railway has them.
    pub fn sound(bytes: &'a [u8]) -> Self {
        Self { bytes: Unstructured::new(bytes), absurd: false }
    }

    /// A whole request.
    ///
    /// # Errors
    /// If the bytes end too soon.
    pub fn request(&mut self) -> Result<Drawn> {
        let bodies: Vec<Body> = self.some(1, 4, Self::body)?;
        let n_laws = self.bytes.int_in_range(1..=3)?;
        let joints = self.some(0, 8, |d| d.joint(&bodies, n_laws))?;
        let stretches = self.stretches(&bodies)?;
        let forces = self.some(1, 2, |d| d.point(&bodies))?;
        let sensors = self.some(1, 2, |d| d.point(&bodies))?;
        let frequencies = self.some(1, 9, |d| d.logarithmic(0.1, 2000.0))?;
        let laws = (0..n_laws * frequencies.len()).map(|_| self.lossy(1e4, 1e9)).collect::<Result<_>>()?;
        let line = Line { bodies, joints, stretches, names: Vec::new() };
        Ok(Drawn { line, frequencies, laws, n_laws, forces, sensors })
    }

    /// A flag.
    ///
    /// # Errors
    /// If the bytes end too soon.
    pub fn flag(&mut self) -> Result<bool> {
        self.bytes.arbitrary()
    }

    /// One of `n`, or of absurd draws now and then none of them.
    ///
    /// # Errors
    /// If the bytes end too soon.
    pub fn index(&mut self, n: usize) -> Result<usize> {
        let beyond = usize::from(self.absurd && self.bytes.ratio(1, 16)?);
        self.bytes.int_in_range(0..=(n + beyond).saturating_sub(1))
    }

    fn some<T>(
        &mut self,
        least: usize,
        most: usize,
        mut one: impl FnMut(&mut Self) -> Result<T>,
    ) -> Result<Vec<T>> {
        let count = self.bytes.int_in_range(least..=most)?;
        (0..count).map(|_| one(self)).collect()
    }

    /// A positive number between two, even in its logarithm.
    fn logarithmic(&mut self, low: f64, high: f64) -> Result<f64> {
        if self.absurd && self.bytes.ratio(1, 12)? {
            return if self.flag()? { self.bytes.arbitrary() } else { self.bytes.choose(&SPECIAL).copied() };
        }
        let share = f64::from(self.bytes.arbitrary::<u16>()?) / f64::from(u16::MAX);
        Ok(low * (high / low).powf(share))
    }

    /// A stiffness with a loss factor from 0.005 to 1: without any, poles make every comparison meaningless.
    fn lossy(&mut self, low: f64, high: f64) -> Result<c64> {
        let real = self.logarithmic(low, high)?;
        Ok(c64::new(real, real * self.logarithmic(0.005, 1.0)?))
    }

    /// Viscous losses from next to nothing to those of critical damping at some 10 Hz.
    fn dashpots(&mut self) -> Result<[f64; 4]> {
        Ok([
            self.logarithmic(1.0, 1e9)?,
            self.logarithmic(1.0, 1e7)?,
            self.logarithmic(1.0, 1e6)?,
            self.logarithmic(1.0, 1e6)?,
        ])
    }

    /// A place on a grid of 0.25 m, or beside it by next to nothing.
    fn place(&mut self) -> Result<f64> {
        if self.absurd && self.bytes.ratio(1, 12)? {
            return self.logarithmic(1e-3, 1e3);
        }
        let at = 0.25 * f64::from(self.bytes.int_in_range(-EXTENT..=EXTENT)?);
        Ok(if self.bytes.ratio(1, 8)? { at + self.bytes.choose(&[1e-10, 1e-8, 1e-6, 1e-3])? } else { at })
    }

    fn interval(&mut self) -> Result<[f64; 2]> {
        let (a, b) = (self.place()?, self.place()?);
        if self.absurd && self.flag()? {
            return Ok([a, b]);
        }
        Ok(if a < b { [a, b] } else { [b, a.max(b + 0.25)] })
    }

    fn end(&mut self) -> Result<End> {
        Ok(if self.flag()? { End::Pinned } else { End::Free })
    }

    fn body(&mut self) -> Result<Body> {
        let endless = [f64::NEG_INFINITY, f64::INFINITY];
        match self.bytes.int_in_range(0..=3)? {
            0 => Ok(Body::Mass(self.logarithmic(1.0, 1e5)?)),
            1 => {
                let interval = if self.flag()? { endless } else { self.interval()? };
                let (stiffness, mass) = (self.lossy(1e6, 1e10)?, self.logarithmic(10.0, 1e4)?);
                Ok(Body::Shaft(Shaft { stiffness, mass, interval, ends: [self.end()?, self.end()?] }))
            }
            kind => {
                let interval = if kind == 3 { endless } else { self.interval()? };
                let timoshenko = self.flag()?;
                let modes = !timoshenko && kind == 2 && self.bytes.ratio(1, 4)?;
                Ok(Body::Beam(Beam {
                    bending: self.lossy(1e5, 1e11)?,
                    shear: if timoshenko { Some(self.lossy(1e7, 1e11)?) } else { None },
                    mass: self.logarithmic(10.0, 2e4)?,
                    rotary: if timoshenko { self.logarithmic(1e-2, 1e4)? } else { 0.0 },
                    dashpots: if modes || self.flag()? { [0.0; 4] } else { self.dashpots()? },
                    interval,
                    ends: [self.end()?, self.end()?],
                    modes: if modes { Some(self.bytes.int_in_range(0..=40)?) } else { None },
                }))
            }
        }
    }

    /// A body, and a place that is on it.
    fn point(&mut self, bodies: &[Body]) -> Result<Point> {
        let body = self.index(bodies.len())?;
        let at = self.place()?;
        let x = match bodies.get(body).and_then(Body::interval) {
            Some([from, to]) if !self.absurd => at.clamp(from, to),
            _ => at,
        };
        Ok(Point { body, x })
    }

    fn joint(&mut self, bodies: &[Body], n_laws: usize) -> Result<Joint> {
        let Point { body: a, x } = self.point(bodies)?;
        let other = if self.flag()? { Some(self.index(bodies.len())?) } else { None };
        // A joint to a body that does not reach so far, or to its own, goes to the ground.
        let reaches = |b: &usize| *b != a && bodies[*b].interval().is_none_or(|[from, to]| from <= x && x <= to);
        let b = if self.absurd { other } else { other.filter(reaches) };
        let law = self.index(n_laws)?;
        Ok(Joint { x, a, b, law, scale: self.logarithmic(0.01, 10.0)? })
    }

    /// Other sections, by body and from left to right; of absurd draws anyhow.
    fn stretches(&mut self, bodies: &[Body]) -> Result<Vec<Stretch>> {
        let mut found = Vec::new();
        for _ in 0..self.bytes.int_in_range(0..=2)? {
            let body = self.index(bodies.len())?;
            let within = self.interval()?;
            let by = self.logarithmic(0.1, 3.0)?;
            let Some(mut section) = bodies.get(body).copied() else { continue };
            let interval = match section.interval() {
                Some([from, to]) if !self.absurd => within.map(|x| x.clamp(from, to)),
                _ => within,
            };
            match &mut section {
                Body::Beam(b) => {
                    (b.interval, b.bending) = (interval, b.bending * by);
                    b.modes = b.modes.filter(|_| self.absurd);
                }
                Body::Shaft(s) => (s.interval, s.stiffness) = (interval, s.stiffness * by),
                Body::Mass(m) => *m *= by,
            }
            found.push(Stretch { body, section });
        }
        if !self.absurd {
            found.retain(|s| s.section.interval().is_some_and(|[from, to]| to - from > 1e-6));
            found.sort_by_key(|s| s.body);
            found.dedup_by_key(|s| s.body);
        }
        Ok(found)
    }
}
