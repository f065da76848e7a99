//! Loads forward, displacements backward, over the factor of several frequencies.

use super::{
    factor::Factor,
    pieces::Piece,
    tape::{Op, Rows, Tape},
};
use crate::{
    c64,
    lanes::{Fuse, Lanes},
};

/// Where the answers of the lanes go, one after the other; row-major, one column per force.
#[derive(Debug)]
pub struct Response<'a> {
    /// Receptance, lanes x sensors x forces, m/N.
    pub sensors: &'a mut [c64],
    /// Extension of the joints (upper less lower body), lanes x joints x forces, m/N; may be empty.
    pub joints: &'a mut [c64],
    /// Derivatives, lanes x parameters x sensors x forces; may be empty.
    pub derivatives: &'a mut [c64],
    /// Extension of each joint by a unit tension in itself, lanes x joints; may be empty.
    pub own: &'a mut [c64],
    /// Number of sensors.
    pub n_sensors: usize,
    /// Number of forces.
    pub n_forces: usize,
    /// Lanes that are wanted.
    pub used: usize,
}

/// What else is read on the way back: told every displacement, one column per force.
pub trait Watch<F: Fuse> {
    /// Whether anything is: then the way back goes through the whole line.
    fn reads(&self) -> bool;
    /// A joint between two rows of the front, or a row and the ground.
    fn joint(&mut self, joint: usize, front: &[Lanes<F>], a: usize, b: Option<usize>, columns: usize);
    /// A length of beam: the front at its start, and the loads there, a pair per column (none if nothing is loaded).
    fn length(&mut self, at: &Length<'_, F>, columns: usize);
    /// The end of a beam that runs on to infinity, on the left or on the right.
    fn endless(&mut self, body: usize, left: bool, ends: &[Lanes<F>], columns: usize);
    /// A mass.
    fn mass(&mut self, body: usize, displacement: &[Lanes<F>], columns: usize);
}

/// The start of a length of beam on the way back.
#[derive(Debug)]
pub struct Length<'a, F> {
    /// The piece.
    pub piece: &'a Piece,
    /// Whether this is the first time on the way back that this piece is met.
    pub fresh: bool,
    /// Its rows.
    pub rows: &'a Rows,
    /// The front.
    pub front: &'a [Lanes<F>],
    /// Impedance at the front: own rows (three numbers), then coupling to the others (2 x others).
    pub impedance: &'a [Lanes<F>],
    /// Loads at the front.
    pub loads: &'a [Lanes<F>],
}

/// Something, or nothing more: decided when it runs, for the way back is compiled once for each kind of processor.
impl<F: Fuse, W: Watch<F>> Watch<F> for Option<W> {
    #[inline(always)]
    fn reads(&self) -> bool {
        self.is_some()
    }
    #[inline(always)]
    fn joint(&mut self, joint: usize, front: &[Lanes<F>], a: usize, b: Option<usize>, columns: usize) {
        if let Some(watch) = self {
            watch.joint(joint, front, a, b, columns);
        }
    }
    #[inline(always)]
    fn length(&mut self, at: &Length<'_, F>, columns: usize) {
        if let Some(watch) = self {
            watch.length(at, columns);
        }
    }
    #[inline(always)]
    fn endless(&mut self, body: usize, left: bool, ends: &[Lanes<F>], columns: usize) {
        if let Some(watch) = self {
            watch.endless(body, left, ends, columns);
        }
    }
    #[inline(always)]
    fn mass(&mut self, body: usize, displacement: &[Lanes<F>], columns: usize) {
        if let Some(watch) = self {
            watch.mass(body, displacement, columns);
        }
    }
}

/// Loads and displacements at the front, kept from one set of frequencies to the next.
#[derive(Debug, Clone)]
pub struct Loads<F> {
    front: Vec<Lanes<F>>,
    saved: Vec<Lanes<F>>,
}

impl<F: Fuse> Loads<F> {
    /// Room for so many forces.
    pub fn new(tape: &Tape, forces: usize) -> Self {
        Self { front: vec![Lanes::ZERO; tape.width * forces], saved: Vec::new() }
    }

    /// Answers all forces at once.
    #[inline(always)]
    pub fn respond<W: Watch<F>>(
        &mut self,
        tape: &Tape,
        factor: &mut Factor<F>,
        out: &mut Response<'_>,
        watch: &mut W,
    ) {
        let f = out.n_forces;
        let wants_joints = !out.joints.is_empty();
        self.front.fill(Lanes::ZERO);
        self.saved.clear();
        // Left of the first force nothing is loaded yet; left of the last thing read nothing is wanted.
        for op in &tape.ops[tape.first_force..] {
            match op {
                Op::StartBeam { own, .. } => self.front[own * f..(own + 2) * f].fill(Lanes::ZERO),
                Op::StartMass { own, .. } => self.front[own * f..(own + 1) * f].fill(Lanes::ZERO),
                // The forces at the front are Z u + g, and a load lessens what the right must supply.
                Op::Force { row, index } => {
                    let load = &mut self.front[row * f + index];
                    for v in &mut load.re {
                        *v -= 1.0;
                    }
                }
                Op::March { rows, .. } => self.forward::<true>(&factor.records, rows, f),
                Op::EndBeam { rows, .. } => self.forward::<false>(&factor.records, rows, f),
                Op::EndMass { rows } => self.forward_mass(&factor.records, rows, f),
                Op::Join { .. } | Op::Sense { .. } | Op::Meet { .. } => {}
            }
        }
        self.front.fill(Lanes::ZERO);
        let reads = watch.reads();
        let first_read = if wants_joints || reads { 0 } else { tape.first_sensor };
        for (k, op) in tape.ops.iter().enumerate().skip(first_read).rev() {
            let loaded = k >= tape.first_force;
            match op {
                Op::March { rows, piece, last, .. } => {
                    let saved = self.backward::<true>(&factor.records, rows, f, loaded);
                    if reads && tape.states {
                        let at = rows.record + 8 + 2 * rows.others.len();
                        let impedance = &factor.records[at..at + 3 + 2 * rows.others.len()];
                        let (front, loads) = (&self.front[..], &self.saved[saved..]);
                        let piece = &tape.pieces[*piece];
                        watch.length(&Length { piece, fresh: *last, rows, front, impedance, loads }, f);
                    }
                    self.saved.truncate(saved);
                }
                Op::EndBeam { rows, endless, .. } => {
                    let saved = self.backward::<false>(&factor.records, rows, f, loaded);
                    self.saved.truncate(saved);
                    if *endless {
                        watch.endless(rows.body, false, &self.front[rows.own * f..(rows.own + 2) * f], f);
                    }
                }
                Op::StartBeam { own, body, endless: true, .. } => {
                    watch.endless(*body, true, &self.front[own * f..(own + 2) * f], f);
                }
                Op::EndMass { rows } => {
                    self.backward_mass(&factor.records, rows, f, loaded);
                    watch.mass(rows.body, &self.front[rows.own * f..(rows.own + 1) * f], f);
                }
                Op::Sense { row, index } => {
                    let stride = out.n_sensors * f;
                    for c in 0..f {
                        scatter(&self.front[row * f + c], out.sensors, index * f + c, stride, out.used);
                    }
                }
                Op::Join { joint, a, b, .. } if wants_joints || reads => {
                    watch.joint(*joint, &self.front, *a, *b, f);
                    if !wants_joints {
                        continue;
                    }
                    let stride = tape.joints * f;
                    for c in 0..f {
                        let mut d = self.front[a * f + c];
                        if let Some(b) = b {
                            d = d - self.front[b * f + c];
                        }
                        scatter(&d, out.joints, joint * f + c, stride, out.used);
                    }
                }
                _ => {}
            }
        }
    }

    /// Marks the lanes whose answers are not finite.
    pub fn finite(&self, factor: &mut Factor<F>, out: &Response<'_>) {
        for values in [&*out.sensors, &*out.joints, &*out.derivatives, &*out.own] {
            let size = values.len() / out.used.max(1);
            for lane in 0..out.used {
                let block = &values[lane * size..(lane + 1) * size];
                if factor.failed[lane].is_none() && !block.iter().all(|v| v.is_finite()) {
                    factor.not_finite(lane, "the response");
                }
            }
        }
    }

    /// g'o = go - W^T gb and g'b = G^-T gb; a body that ends keeps nothing.
    #[inline(always)]
    fn forward<const MARCHES: bool>(&mut self, records: &[Lanes<F>], rows: &Rows, f: usize) {
        let (own, n) = (rows.own, rows.others.len());
        let gi = &records[rows.record..];
        let w = &gi[if MARCHES { 8 } else { 4 }..];
        for c in 0..f {
            let (g0, g1) = (self.front[own * f + c], self.front[(own + 1) * f + c]);
            for (k, &o) in rows.others.iter().enumerate() {
                let at = o * f + c;
                self.front[at] = self.front[at].minus(w[k], g0).minus(w[n + k], g1);
            }
            if MARCHES {
                self.front[own * f + c] = (gi[0] * g0).plus(gi[2], g1);
                self.front[(own + 1) * f + c] = (gi[1] * g0).plus(gi[3], g1);
            }
            self.saved.push(g0);
            self.saved.push(g1);
        }
    }

    /// ub = G^-1 u'b - W uo - q gb. Returns where the loads begin that it read, for the caller to drop.
    #[inline(always)]
    fn backward<const MARCHES: bool>(
        &mut self,
        records: &[Lanes<F>],
        rows: &Rows,
        f: usize,
        loaded: bool,
    ) -> usize {
        let (own, n) = (rows.own, rows.others.len());
        let gi = &records[rows.record..];
        let q = &gi[if MARCHES { 4 } else { 0 }..];
        let w = &q[4..];
        let saved = self.saved.len() - if loaded { 2 * f } else { 0 };
        for c in 0..f {
            let (mut u0, mut u1) = (Lanes::ZERO, Lanes::ZERO);
            if MARCHES {
                let (v0, v1) = (self.front[own * f + c], self.front[(own + 1) * f + c]);
                u0 = (gi[0] * v0).plus(gi[1], v1);
                u1 = (gi[2] * v0).plus(gi[3], v1);
            }
            if loaded {
                let (g0, g1) = (self.saved[saved + 2 * c], self.saved[saved + 2 * c + 1]);
                u0 = u0.minus(q[0], g0).minus(q[1], g1);
                u1 = u1.minus(q[2], g0).minus(q[3], g1);
            }
            for (k, &o) in rows.others.iter().enumerate() {
                let u = self.front[o * f + c];
                u0 = u0.minus(w[k], u);
                u1 = u1.minus(w[n + k], u);
            }
            self.front[own * f + c] = u0;
            self.front[(own + 1) * f + c] = u1;
        }
        saved
    }

    #[inline(always)]
    fn forward_mass(&mut self, records: &[Lanes<F>], rows: &Rows, f: usize) {
        let w = &records[rows.record + 1..];
        for c in 0..f {
            let g = self.front[rows.own * f + c];
            for (k, &o) in rows.others.iter().enumerate() {
                let at = o * f + c;
                self.front[at] = self.front[at].minus(w[k], g);
            }
            self.saved.push(g);
        }
    }

    #[inline(always)]
    fn backward_mass(&mut self, records: &[Lanes<F>], rows: &Rows, f: usize, loaded: bool) {
        let (q, w) = (records[rows.record], &records[rows.record + 1..]);
        let saved = self.saved.len() - if loaded { f } else { 0 };
        for c in 0..f {
            let mut u = Lanes::ZERO;
            if loaded {
                u = u.minus(q, self.saved[saved + c]);
            }
            for (k, &o) in rows.others.iter().enumerate() {
                u = u.minus(w[k], self.front[o * f + c]);
            }
            self.front[rows.own * f + c] = u;
        }
        self.saved.truncate(saved);
    }
}

/// Writes each lane's number into its own block.
#[inline(always)]
fn scatter<F: Fuse>(from: &Lanes<F>, to: &mut [c64], place: usize, stride: usize, used: usize) {
    for i in 0..used {
        to[i * stride + place] = from.lane(i);
    }
}
