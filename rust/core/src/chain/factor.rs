//! The march of several frequencies side by side: impedance forward, records for the way back.

use super::{
    pieces::Piece,
    tape::{Op, Rows, Tape},
};
use crate::{
    c64,
    element::{Section, Transfer},
    error::CoreError,
    field::Field,
    lanes::{Fuse, LANES, Lanes},
    line::{Beam, Body, Line, Shaft},
    shaft::Twist,
    small::{self, M2},
    waves::Waves,
};

/// Stiffness of a pinned end in N/m: so far above any structure's that the difference is below rounding.
const PINNED: f64 = 1e30;
/// Share of a pivot's terms that must survive cancellation.
const LEAST_SHARE: f64 = 1e-12;

/// Factor of the system at several frequencies. Memory is kept from one set of frequencies to the next.
#[derive(Debug, Clone)]
pub struct Factor<F> {
    /// Per operation: G^-1 (2 x 2, marches only), G^-1 B (2 x 2), and W (2 x others) in row order.
    pub records: Vec<Lanes<F>>,
    /// Why a lane cannot be solved.
    pub failed: [Option<CoreError>; LANES],
    z: Vec<Lanes<F>>,
    right: Vec<Lanes<F>>,
    /// Rows of the front at its widest.
    pub width: usize,
    /// Transfers by slot, each from the first march over its piece to the last.
    transfers: Vec<Transfer<Lanes<F>>>,
    laws: Vec<Lanes<F>>,
    /// Impedance of what runs on without end, by body.
    ends: Vec<(usize, [Option<M2>; LANES])>,
    /// The frequencies at hand, Hz.
    pub frequencies: [f64; LANES],
    /// Squared angular frequencies, rad2/s2.
    pub omega2: [f64; LANES],
}

/// The frequencies, Hz, and the stiffness of each law at each of them, N/m: `laws[lane * n_laws + law]`.
#[derive(Debug, Clone, Copy)]
pub struct Group<'a> {
    /// One frequency a lane.
    pub frequencies: [f64; LANES],
    /// At least one row; lanes beyond the last row repeat it.
    pub laws: &'a [c64],
    /// Numbers in a row.
    pub n_laws: usize,
}

impl<F: Fuse> Factor<F> {
    /// Room for the factor of a tape.
    pub fn new(tape: &Tape) -> Self {
        let zero = [[Lanes::ZERO; 2]; 2];
        let none = Transfer { a: zero, b: zero, c: zero, d: zero };
        Self {
            records: vec![Lanes::ZERO; tape.record_len],
            failed: [const { None }; LANES],
            z: vec![Lanes::ZERO; tape.width * tape.width],
            right: vec![Lanes::ZERO; tape.right.as_ref().map_or(0, |_| tape.width * tape.width)],
            width: tape.width,
            transfers: vec![none; tape.slots.max(tape.right.as_ref().map_or(0, |right| right.slots))],
            laws: Vec::new(),
            ends: Vec::new(),
            frequencies: [0.0; LANES],
            omega2: [0.0; LANES],
        }
    }

    /// Marches the impedance along the line. A lane that cannot be solved says so in `failed`; the others stand.
    #[inline(always)]
    pub fn run(&mut self, tape: &Tape, line: &Line, group: &Group<'_>) {
        self.prepare(tape, group);
        if let Some(right) = &tape.right {
            self.run_tape(right, line);
            std::mem::swap(&mut self.z, &mut self.right);
        }
        self.run_tape(tape, line);
    }

    #[inline(always)]
    fn run_tape(&mut self, tape: &Tape, line: &Line) {
        for op in &tape.ops {
            match op {
                Op::StartBeam { own, body, endless, pinned } => {
                    self.clear(*own);
                    if matches!(line.bodies[*body], Body::Shaft(_)) {
                        // Its idle rotation must not be free to turn.
                        self.z[(own + 1) * self.width + own + 1] = Lanes::real(1.0);
                    }
                    self.add_end(line, *own, *body, [*endless, *pinned], true);
                }
                Op::StartMass { own, body, weightless } => {
                    self.clear(*own);
                    if let (Body::Mass(m), false) = (line.bodies[*body], *weightless) {
                        for i in 0..LANES {
                            let omega = std::f64::consts::TAU * self.frequencies[i];
                            self.z[own * self.width + own].re[i] = -omega * omega * m;
                        }
                    }
                }
                Op::March { rows, piece, first, .. } => {
                    let piece = &tape.pieces[*piece];
                    if *first {
                        self.transfer(line, piece);
                    }
                    if tape.states {
                        self.keep_impedance(rows);
                    }
                    self.march(line, rows, piece.slot);
                }
                Op::Join { a, b, law, scale, .. } => {
                    let k = self.laws[*law].scale(*scale);
                    let (aa, w) = (a * self.width + a, self.width);
                    self.z[aa] = self.z[aa] + k;
                    if let Some(b) = *b {
                        let ab = at(w, *a, b);
                        self.z[b * w + b] = self.z[b * w + b] + k;
                        self.z[ab] = self.z[ab] - k;
                    }
                }
                Op::EndBeam { rows, endless, pinned } => {
                    self.add_end(line, rows.own, rows.body, [*endless, *pinned], false);
                    let zbb = self.own(rows.own);
                    let inverse = self.invert(line, rows.body, &zbb);
                    self.condense(rows, &inverse, 0);
                }
                Op::EndMass { rows } => self.end_mass(line, rows),
                Op::Meet { rows } => self.meet(rows),
                Op::Force { .. } | Op::Sense { .. } => {}
            }
        }
    }

    #[inline(always)]
    fn prepare(&mut self, tape: &Tape, group: &Group<'_>) {
        self.failed = [const { None }; LANES];
        self.frequencies = group.frequencies;
        self.omega2 = group.frequencies.map(|f| (std::f64::consts::TAU * f).powi(2));
        self.ends.clear();
        let rows = group.laws.len().checked_div(group.n_laws).unwrap_or(0);
        self.laws.clear();
        for law in 0..group.n_laws {
            let values = Lanes::gather(|i| group.laws[i.min(rows - 1) * group.n_laws + law]);
            self.check_law(tape, law, &values);
            self.laws.push(values);
        }
    }

    /// Computes the transfer over a piece, before the first march over it: kept for all pieces of a line whose spacings
    /// differ, they would not fit the cache.
    #[inline(always)]
    fn transfer(&mut self, line: &Line, p: &Piece) {
        self.transfers[p.slot] = match line.section(p.body, p.stretch) {
            Body::Beam(beam) => Transfer::over(&section(beam, &self.frequencies), p.length, p.terms),
            Body::Shaft(shaft) => shaft_transfer(shaft, &self.omega2, p.length, p.terms),
            Body::Mass(_) => return,
        };
    }

    /// Notes the lanes in which a law that some joint has is not finite.
    fn check_law(&mut self, tape: &Tape, law: usize, values: &Lanes<F>) {
        for lane in 0..LANES {
            if !values.lane(lane).is_finite() {
                let right = tape.right.iter().flat_map(|t| &t.ops);
                let joint = tape.ops.iter().chain(right).find_map(|op| match op {
                    Op::Join { joint, law: l, .. } if *l == law => Some(*joint),
                    _ => None,
                });
                if let Some(joint) = joint {
                    self.not_finite(lane, &format!("stiffness of joint {joint}"));
                }
            }
        }
    }

    #[inline(always)]
    fn clear(&mut self, own: usize) {
        for r in [own, own + 1] {
            for i in 0..self.width {
                let place = at(self.width, r, i);
                self.z[place] = Lanes::ZERO;
            }
        }
    }

    #[inline(always)]
    fn own(&self, r: usize) -> M2<Lanes<F>> {
        let (z, w) = (&self.z, self.width);
        let cross = z[(r + 1) * w + r];
        [[z[r * w + r], cross], [cross, z[(r + 1) * w + r + 1]]]
    }

    /// What lies beyond an end of a beam: the beam itself without end, or a pin.
    fn add_end(&mut self, line: &Line, own: usize, body: usize, [endless, pinned]: [bool; 2], left: bool) {
        let w = self.width;
        if pinned && !endless {
            self.z[own * w + own] = self.z[own * w + own] + Lanes::real(PINNED);
        }
        if !endless {
            return;
        }
        let known = self.ends.iter().position(|(b, _)| *b == body).unwrap_or_else(|| {
            let lanes = self.frequencies.map(|f| half_infinite(&line.bodies[body], std::f64::consts::TAU * f));
            self.ends.push((body, lanes));
            self.ends.len() - 1
        });
        // Mirrored, rotation and force change sign: the coupling does.
        let turn = if left { -1.0 } else { 1.0 };
        for i in 0..LANES {
            match self.ends[known].1[i] {
                Some(k) => {
                    for (place, v) in [(own * w + own, k[0][0]), ((own + 1) * w + own, k[1][0] * turn)] {
                        self.z[place].re[i] += v.re;
                        self.z[place].im[i] += v.im;
                    }
                    let place = (own + 1) * w + own + 1;
                    self.z[place].re[i] += k[1][1].re;
                    self.z[place].im[i] += k[1][1].im;
                }
                None => self.fail(line, body, i, &[[c64::ZERO; 2]; 2]),
            }
        }
    }

    /// Records the impedance at the front as far as it concerns the beam.
    #[inline(always)]
    fn keep_impedance(&mut self, rows: &Rows) {
        let (own, w, n) = (rows.own, self.width, rows.others.len());
        let zbb = self.own(own);
        let r = rows.record + 8 + 2 * n;
        (self.records[r], self.records[r + 1], self.records[r + 2]) = (zbb[0][0], zbb[1][0], zbb[1][1]);
        for (k, &o) in rows.others.iter().enumerate() {
            self.records[r + 3 + k] = self.z[at(w, own, o)];
            self.records[r + 3 + n + k] = self.z[at(w, own + 1, o)];
        }
    }

    /// The beam advances: u' = A u + B f, f' = C u + D f with f = Z u (Pestel and Leckie 1963, ch. 3).
    #[inline(always)]
    fn march(&mut self, line: &Line, rows: &Rows, slot: usize) {
        let (own, w) = (rows.own, self.width);
        let zbb = self.own(own);
        let t = &self.transfers[slot];
        let g = plus(&t.a, &t.b, &zbb);
        let forces = plus(&t.c, &t.d, &zbb);
        let b = t.b;
        let gi = self.invert(line, rows.body, &g);
        let gb = small::mul(&gi, &b);
        for k in 0..4 {
            self.records[rows.record + k] = gi[k / 2][k % 2];
        }
        self.condense(rows, &gb, 4);
        let new = small::mul(&forces, &gi);
        self.z[own * w + own] = new[0][0];
        self.z[(own + 1) * w + own] = (new[0][1] + new[1][0]).scale(0.5);
        self.z[(own + 1) * w + own + 1] = new[1][1];
        // Symplectic transfer: the coupling to the others only turns, Z'bo = G^-T Zbo.
        for &o in rows.others.iter() {
            let (first, second) = (at(w, own, o), at(w, own + 1, o));
            let (z0, z1) = (self.z[first], self.z[second]);
            self.z[first] = (gi[0][0] * z0).plus(gi[1][0], z1);
            self.z[second] = (gi[0][1] * z0).plus(gi[1][1], z1);
        }
    }

    /// Records `q` and W = q Zbo at `skip`, and takes Zob W off the others.
    #[inline(always)]
    fn condense(&mut self, rows: &Rows, q: &M2<Lanes<F>>, skip: usize) {
        let (own, w, n) = (rows.own, self.width, rows.others.len());
        let r = rows.record + skip;
        for k in 0..4 {
            self.records[r + k] = q[k / 2][k % 2];
        }
        let (first, second) = (r + 4, r + 4 + n);
        for (k, &o) in rows.others.iter().enumerate() {
            let (z0, z1) = (self.z[at(w, own, o)], self.z[at(w, own + 1, o)]);
            self.records[first + k] = (q[0][0] * z0).plus(q[0][1], z1);
            self.records[second + k] = (q[1][0] * z0).plus(q[1][1], z1);
        }
        for (i, &oi) in rows.others.iter().enumerate() {
            let (z0, z1) = (self.z[at(w, own, oi)], self.z[at(w, own + 1, oi)]);
            for (k, &ok) in rows.others[..=i].iter().enumerate() {
                let place = at(w, oi, ok);
                self.z[place] =
                    self.z[place].minus(z0, self.records[first + k]).minus(z1, self.records[second + k]);
            }
        }
    }

    /// Adds the impedance of all that lies to the right; in the mirror a rotation changes sign.
    #[inline(always)]
    fn meet(&mut self, rows: &[(usize, usize, bool)]) {
        for (i, &(l, r, turns)) in rows.iter().enumerate() {
            for &(lk, rk, turns_k) in &rows[..=i] {
                let (place, from) = (at(self.width, l, lk), at(self.width, r, rk));
                let z = self.right[from];
                self.z[place] = if turns == turns_k { self.z[place] + z } else { self.z[place] - z };
            }
        }
    }

    #[inline(always)]
    fn end_mass(&mut self, line: &Line, rows: &Rows) {
        let (own, w) = (rows.own, self.width);
        let z = self.z[own * w + own];
        let size = z.norm_sqr();
        for (i, size) in size.iter().enumerate() {
            if !(*size > 0.0 && size.is_finite()) {
                self.fail(line, rows.body, i, &[[z.lane(i), c64::ZERO], [c64::ZERO, c64::ONE]]);
            }
        }
        let q = z.inverse();
        self.records[rows.record] = q;
        for (k, &o) in rows.others.iter().enumerate() {
            self.records[rows.record + 1 + k] = q * self.z[at(w, own, o)];
        }
        for (i, &oi) in rows.others.iter().enumerate() {
            let z0 = self.z[at(w, own, oi)];
            for (k, &ok) in rows.others[..=i].iter().enumerate() {
                let place = at(w, oi, ok);
                self.z[place] = self.z[place].minus(z0, self.records[rows.record + 1 + k]);
            }
        }
    }

    /// The inverse, every lane checked.
    #[inline(always)]
    fn invert(&mut self, line: &Line, body: usize, m: &M2<Lanes<F>>) -> M2<Lanes<F>> {
        let (p, q) = (m[0][0] * m[1][1], m[0][1] * m[1][0]);
        let det = p - q;
        let (size, p2, q2) = (det.norm_sqr(), p.norm_sqr(), q.norm_sqr());
        let mut fine = true;
        for i in 0..LANES {
            // Written so that NaN is not fine.
            fine &= size[i] > LEAST_SHARE * LEAST_SHARE * (p2[i] + q2[i]) && size[i] < f64::INFINITY;
        }
        if !fine {
            for i in 0..LANES {
                self.fail(
                    line,
                    body,
                    i,
                    &[[m[0][0].lane(i), m[0][1].lane(i)], [m[1][0].lane(i), m[1][1].lane(i)]],
                );
            }
        }
        let r = det.inverse();
        [[m[1][1] * r, -(m[0][1] * r)], [-(m[1][0] * r), m[0][0] * r]]
    }

    /// Notes that something about a lane is not finite.
    #[cold]
    pub fn not_finite(&mut self, lane: usize, what: &str) {
        let frequency = self.frequencies[lane];
        self.failed[lane] = Some(CoreError::NonFinite { frequency, place: what.into() });
    }

    /// Notes why a lane cannot be solved, if it cannot and nothing was noted before.
    #[cold]
    fn fail(&mut self, line: &Line, body: usize, lane: usize, pivot: &M2) {
        if self.failed[lane].is_some() {
            return;
        }
        let (frequency, place) = (self.frequencies[lane], line.name(body));
        self.failed[lane] = match small::inverse(pivot) {
            _ if !pivot.iter().flatten().all(|v| v.is_finite()) => Some(CoreError::NonFinite { frequency, place }),
            None => Some(CoreError::Singular { frequency, place }),
            Some((_, share)) if share < LEAST_SHARE => {
                Some(CoreError::IllConditioned { frequency, place, estimate: f64::EPSILON / share })
            }
            Some(_) => None,
        };
    }
}

/// Impedance of a body that runs on towards +x without end; `None` where its waves merge.
fn half_infinite(body: &Body, omega: f64) -> Option<M2> {
    match body {
        Body::Beam(beam) => Waves::new(beam, omega).half_infinite(false),
        Body::Shaft(shaft) => {
            let z = Twist::new(shaft, omega).half_infinite();
            Some([[z, c64::ZERO], [c64::ZERO; 2]])
        }
        Body::Mass(_) => None,
    }
}

/// Place of the entry (r, c) of a symmetric matrix kept in its lower triangle.
#[inline(always)]
pub fn at(width: usize, r: usize, c: usize) -> usize {
    if r > c { r * width + c } else { c * width + r }
}

/// `a + b z`.
#[inline(always)]
fn plus<F: Fuse>(a: &M2<Lanes<F>>, b: &M2<Lanes<F>>, z: &M2<Lanes<F>>) -> M2<Lanes<F>> {
    [
        [
            a[0][0].plus(b[0][0], z[0][0]).plus(b[0][1], z[1][0]),
            a[0][1].plus(b[0][0], z[0][1]).plus(b[0][1], z[1][1]),
        ],
        [
            a[1][0].plus(b[1][0], z[0][0]).plus(b[1][1], z[1][0]),
            a[1][1].plus(b[1][0], z[0][1]).plus(b[1][1], z[1][1]),
        ],
    ]
}

/// A beam's section at some frequencies, Hz.
#[inline(always)]
pub fn section<F: Fuse>(beam: &Beam, frequencies: &[f64; LANES]) -> Section<Lanes<F>> {
    let omega = frequencies.map(|f| std::f64::consts::TAU * f);
    if beam.dashpots != [0.0; 4] {
        return lossy(beam, &omega);
    }
    let (flexibility, shear) = (beam.bending.inv(), beam.shear.map_or(c64::ZERO, |s| s.inv()));
    let real = |scale: f64| Lanes::new(omega.map(|o| o * o * scale), [0.0; LANES]);
    Section {
        flexibility: Lanes::new([flexibility.re; LANES], [flexibility.im; LANES]),
        shear_compliance: Lanes::new([shear.re; LANES], [shear.im; LANES]),
        mu: real(beam.mass),
        rotary: real(beam.rotary),
    }
}

/// The same with viscous losses, which none of the numbers is real with.
#[inline(never)]
fn lossy<F: Fuse>(beam: &Beam, omega: &[f64; LANES]) -> Section<Lanes<F>> {
    let at = omega.map(|o| Waves::new(beam, o));
    let lanes = |of: fn(&Waves) -> c64| Lanes::new(at.map(|w| of(&w).re), at.map(|w| of(&w).im));
    Section {
        flexibility: lanes(|w| w.bending.inv()),
        shear_compliance: lanes(|w| w.shear_compliance),
        mu: lanes(|w| w.mu),
        rotary: lanes(|w| w.rotary),
    }
}

/// Transfer over a length of shaft at squared angular frequencies.
#[inline(always)]
pub fn shaft_transfer<F: Fuse>(
    shaft: &Shaft,
    omega2: &[f64; LANES],
    length: f64,
    terms: usize,
) -> Transfer<Lanes<F>> {
    let compliance = shaft.stiffness.inv();
    Transfer::of_shaft(
        Lanes::new([compliance.re; LANES], [compliance.im; LANES]),
        Lanes::new(omega2.map(|o| o * shaft.mass), [0.0; LANES]),
        length,
        terms,
    )
}
