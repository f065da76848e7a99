//! The march of one frequency: impedance forward, records for the way back.

use super::tape::{Op, Rows, Tape};
use crate::{
    c64,
    element::Transfer,
    error::CoreError,
    line::{Body, Line},
    small::{self, M2},
    waves::Waves,
};

/// Stiffness of a pinned end in N/m: so far above any structure's that the difference is below rounding.
const PINNED: f64 = 1e30;
/// Share of a pivot's terms that must survive cancellation.
const LEAST_SHARE: f64 = 1e-12;

/// Factor of the system at one frequency. Memory is kept from one frequency to the next.
#[derive(Debug, Clone)]
pub struct Factor {
    /// Per operation: G^-1 (2 x 2, marches only), G^-1 B (2 x 2), and W (2 x others) in row order.
    pub records: Vec<c64>,
    z: Vec<c64>,
    width: usize,
    pieces: Vec<Transfer>,
}

impl Factor {
    /// Room for the factor of a tape.
    pub fn new(tape: &Tape) -> Self {
        let z = vec![c64::ZERO; tape.width * tape.width];
        Self { records: vec![c64::ZERO; tape.record_len], z, width: tape.width, pieces: Vec::new() }
    }

    /// Marches the impedance along the line at `frequency` Hz; `laws` holds one complex stiffness per law.
    ///
    /// # Errors
    /// `Singular`, `NonFinite` or `IllConditioned`, naming the body.
    pub fn run(&mut self, tape: &Tape, line: &Line, frequency: f64, laws: &[c64]) -> Result<(), CoreError> {
        let omega = std::f64::consts::TAU * frequency;
        let at = At { frequency, line };
        self.z.fill(c64::ZERO);
        self.pieces.clear();
        for p in &tape.pieces {
            if let Body::Beam(b) = &line.bodies[p.body] {
                self.pieces.push(Transfer::new(&Waves::new(b, omega), p.length));
            }
        }
        for op in &tape.ops {
            match op {
                Op::StartBeam { own, body, endless, pinned } => {
                    self.clear(*own);
                    self.add_end(*own, &line.bodies[*body], omega, [*endless, *pinned], true, *body, &at)?;
                }
                Op::StartMass { own, body } => {
                    self.clear(*own);
                    if let Body::Mass(m) = line.bodies[*body] {
                        self.z[own * self.width + own] = c64::new(-omega * omega * m, 0.0);
                    }
                }
                Op::March { rows, piece } => self.march(rows, *piece, &at)?,
                Op::Join { joint, a, b, law, scale } => {
                    let k = laws[*law] * *scale;
                    if !k.is_finite() {
                        return Err(at.not_finite(format!("stiffness of joint {joint}")));
                    }
                    let w = self.width;
                    self.z[a * w + a] += k;
                    if let Some(b) = *b {
                        self.z[b * w + b] += k;
                        self.z[a * w + b] -= k;
                        self.z[b * w + a] -= k;
                    }
                }
                Op::EndBeam { rows, endless, pinned } => {
                    let ends = [*endless, *pinned];
                    self.add_end(rows.own, &line.bodies[rows.body], omega, ends, false, rows.body, &at)?;
                    let zbb = self.own(rows.own);
                    let (inverse, share) = small::inverse(&zbb).ok_or_else(|| at.pivot(rows.body, &zbb))?;
                    at.check(share, rows.body)?;
                    self.condense(rows, &inverse, 0);
                }
                Op::EndMass { rows } => {
                    let z = self.z[rows.own * self.width + rows.own];
                    if !z.is_finite() || z == c64::ZERO {
                        return Err(at.pivot(rows.body, &[[z; 2]; 2]));
                    }
                    self.condense_mass(rows, z.inv());
                }
                Op::Force { .. } | Op::Sense { .. } => {}
            }
        }
        Ok(())
    }

    fn clear(&mut self, own: usize) {
        let w = self.width;
        for r in [own, own + 1] {
            self.z[r * w..(r + 1) * w].fill(c64::ZERO);
            for i in 0..w {
                self.z[i * w + r] = c64::ZERO;
            }
        }
    }

    fn own(&self, r: usize) -> M2 {
        let (z, w) = (&self.z, self.width);
        [[z[r * w + r], z[r * w + r + 1]], [z[(r + 1) * w + r], z[(r + 1) * w + r + 1]]]
    }

    fn set(&mut self, r: usize, m: &M2) {
        for (i, row) in m.iter().enumerate() {
            let at = (r + i) * self.width + r;
            self.z[at..at + 2].copy_from_slice(row);
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn add_end(
        &mut self,
        own: usize,
        body: &Body,
        omega: f64,
        [endless, pinned]: [bool; 2],
        left: bool,
        index: usize,
        at: &At<'_>,
    ) -> Result<(), CoreError> {
        let Body::Beam(beam) = body else { return Ok(()) };
        let w = self.width;
        if endless {
            let zeros = [[c64::ZERO; 2]; 2];
            let k = Waves::new(beam, omega).half_infinite(left).ok_or_else(|| at.pivot(index, &zeros))?;
            let sum = small::add(&self.own(own), &k);
            self.set(own, &sum);
        } else if pinned {
            self.z[own * w + own] += PINNED;
        }
        Ok(())
    }

    /// The beam advances: u' = A u + B f, f' = C u + D f with f = Z u (Pestel and Leckie 1963, ch. 3).
    fn march(&mut self, rows: &Rows, piece: usize, at: &At<'_>) -> Result<(), CoreError> {
        let t = self.pieces[piece];
        let (own, w) = (rows.own, self.width);
        let zbb = self.own(own);
        let g = small::add(&t.a, &small::mul(&t.b, &zbb));
        let (gi, share) = small::inverse(&g).ok_or_else(|| at.pivot(rows.body, &g))?;
        at.check(share, rows.body)?;
        let gb = small::mul(&gi, &t.b);
        let r = rows.record;
        for k in 0..4 {
            self.records[r + k] = gi[k / 2][k % 2];
        }
        let zo: Vec<[c64; 2]> = self.condense(rows, &gb, 4);
        let mut znew = small::mul(&small::add(&t.c, &small::mul(&t.d, &zbb)), &gi);
        let mean = (znew[0][1] + znew[1][0]) * 0.5;
        znew[0][1] = mean;
        znew[1][0] = mean;
        self.set(own, &znew);
        // Symplectic transfer: the coupling to the others only turns, Z'bo = G^-T Zbo.
        for (&o, z) in rows.others.iter().zip(&zo) {
            for (j, v) in [gi[0][0] * z[0] + gi[1][0] * z[1], gi[0][1] * z[0] + gi[1][1] * z[1]].iter().enumerate()
            {
                self.z[(own + j) * w + o] = *v;
                self.z[o * w + own + j] = *v;
            }
        }
        Ok(())
    }

    /// Records `q` and W = q Zbo at `skip`, takes Zob W off the others, and returns Zbo as it was.
    fn condense(&mut self, rows: &Rows, q: &M2, skip: usize) -> Vec<[c64; 2]> {
        let (own, w, n) = (rows.own, self.width, rows.others.len());
        let r = rows.record + skip;
        for k in 0..4 {
            self.records[r + k] = q[k / 2][k % 2];
        }
        let zo: Vec<[c64; 2]> =
            rows.others.iter().map(|&o| [self.z[own * w + o], self.z[(own + 1) * w + o]]).collect();
        for (k, z) in zo.iter().enumerate() {
            self.records[r + 4 + k] = q[0][0] * z[0] + q[0][1] * z[1];
            self.records[r + 4 + n + k] = q[1][0] * z[0] + q[1][1] * z[1];
        }
        for (i, &oi) in rows.others.iter().enumerate() {
            for (k, &ok) in rows.others.iter().enumerate().take(i + 1) {
                let d = zo[i][0] * self.records[r + 4 + k] + zo[i][1] * self.records[r + 4 + n + k];
                self.z[oi * w + ok] -= d;
                if i != k {
                    self.z[ok * w + oi] = self.z[oi * w + ok];
                }
            }
        }
        zo
    }

    fn condense_mass(&mut self, rows: &Rows, q: c64) {
        let (own, w) = (rows.own, self.width);
        self.records[rows.record] = q;
        for (k, &o) in rows.others.iter().enumerate() {
            self.records[rows.record + 1 + k] = q * self.z[own * w + o];
        }
        for &oi in &rows.others {
            for (k, &ok) in rows.others.iter().enumerate() {
                let d = self.z[oi * w + own] * self.records[rows.record + 1 + k];
                self.z[oi * w + ok] -= d;
            }
        }
    }
}

/// Where the march is, for messages.
struct At<'a> {
    frequency: f64,
    line: &'a Line,
}

impl At<'_> {
    fn pivot(&self, body: usize, m: &M2) -> CoreError {
        let place = self.line.name(body);
        if m.iter().flatten().all(|v| v.is_finite()) {
            CoreError::Singular { frequency: self.frequency, place }
        } else {
            CoreError::NonFinite { frequency: self.frequency, place }
        }
    }

    fn not_finite(&self, place: String) -> CoreError {
        CoreError::NonFinite { frequency: self.frequency, place }
    }

    fn check(&self, share: f64, body: usize) -> Result<(), CoreError> {
        if share < LEAST_SHARE {
            let estimate = f64::EPSILON / share;
            let place = self.line.name(body);
            return Err(CoreError::IllConditioned { frequency: self.frequency, place, estimate });
        }
        Ok(())
    }
}
