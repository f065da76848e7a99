//! Derivatives of responses, summed while the displacements come back along the line.

use super::{
    factor::Factor,
    pieces::Piece,
    solve::{Length, Watch},
    tape::Tape,
};
use crate::{
    c64,
    element::Section,
    energy::{M4, over_half_infinite, over_half_infinite_shaft, over_length, over_shaft},
    field::Field,
    lanes::{Fuse, LANES, Lanes},
    line::{Body, Line},
    sensitivity::{OF_A_BEAM, Sensitivity},
    shaft::Twist,
    waves::Waves,
};

/// Sums of one thread, kept from one set of frequencies to the next.
#[derive(Debug, Clone)]
pub struct Sums<F> {
    /// Sums, each sensors x forces.
    values: Vec<Lanes<F>>,
    /// Where the sum of each parameter stands; a group of one joint needs none.
    slots: Vec<Option<usize>>,
    /// Sensors x forces of one joint.
    single: Vec<Lanes<F>>,
    /// By slot: of a piece, by the parameters of its beam.
    pieces: Vec<[M4<Lanes<F>>; OF_A_BEAM]>,
    /// Index of each body's first parameter.
    first: Vec<usize>,
    /// State at the start of a length, per column.
    states: Vec<[Lanes<F>; 4]>,
    /// Extension of a joint, per column.
    extensions: Vec<Lanes<F>>,
}

impl<F: Fuse> Sums<F> {
    /// Room for what is asked.
    pub fn new(wanted: &Sensitivity<'_>, line: &Line, tape: &Tape, columns: usize) -> Self {
        let (of_bodies, n_of_bodies) = Sensitivity::first_of_each(line);
        let mut members = vec![0_usize; wanted.n_groups];
        wanted.groups.iter().flatten().for_each(|g| members[*g] += 1);
        let summed = members.iter().map(|m| *m != 1);
        let bodies = std::iter::repeat_n(true, if wanted.bodies { n_of_bodies } else { 0 });
        let mut next = 0;
        let slots = summed.chain(bodies).map(|summed| {
            summed.then(|| {
                next += wanted.pairs();
                next - wanted.pairs()
            })
        });
        let slots: Vec<Option<usize>> = slots.collect();
        let slots_of_pieces = if wanted.bodies { tape.slots } else { 0 };
        Self {
            values: vec![Lanes::ZERO; next],
            slots,
            single: vec![Lanes::ZERO; wanted.pairs()],
            pieces: vec![[[[Lanes::ZERO; 4]; 4]; OF_A_BEAM]; slots_of_pieces],
            first: of_bodies.into_iter().map(|i| wanted.n_groups + i).collect(),
            states: vec![[Lanes::ZERO; 4]; columns],
            extensions: vec![Lanes::ZERO; columns],
        }
    }

    /// Begins a set of frequencies.
    #[inline(always)]
    pub fn begin<'a, 'o>(
        &'a mut self,
        wanted: &'a Sensitivity<'a>,
        line: &'a Line,
        factor: &Factor<F>,
        out: (&'o mut [c64], usize),
    ) -> Gradient<'a, 'o, F> {
        self.values.fill(Lanes::ZERO);
        let (frequencies, omega2) = (factor.frequencies, factor.omega2);
        Gradient { sums: self, wanted, line, frequencies, omega2, out: out.0, used: out.1 }
    }
}

/// Bending stiffness, shear stiffness, mass and rotary inertia of a section; 0 for what it has not. Without viscous losses,
/// which stay what they are when these change.
fn properties(body: &Body) -> [c64; OF_A_BEAM] {
    let real = |v| c64::new(v, 0.0);
    match body {
        Body::Beam(b) => [b.bending, b.shear.unwrap_or(c64::ZERO), real(b.mass), real(b.rotary)],
        Body::Shaft(s) => [c64::ZERO, s.stiffness, real(s.mass), c64::ZERO],
        Body::Mass(_) => [c64::ZERO; OF_A_BEAM],
    }
}

/// By how much a property here moves with that of the body.
fn share(here: &Body, base: &Body, property: usize) -> c64 {
    let (here, base) = (properties(here)[property], properties(base)[property]);
    if base == c64::ZERO || here == base { c64::ONE } else { here / base }
}

/// The integrals over a piece by the properties of its body. One frequency at a time, and once for all kinds of processor:
/// where spacings are alike pieces are few, and the code is long.
#[inline(never)]
fn over_piece(here: &Body, base: &Body, omega: f64, length: f64, terms: usize) -> [M4<c64>; OF_A_BEAM] {
    let mut n = match here {
        Body::Beam(b) => {
            let waves = Waves::new(b, omega);
            let section = Section {
                flexibility: waves.bending.inv(),
                shear_compliance: waves.shear_compliance,
                mu: waves.mu,
                rotary: waves.rotary,
            };
            over_length(&section, length, terms)
        }
        Body::Shaft(s) => over_shaft(s.stiffness.inv(), c64::new(omega * omega * s.mass, 0.0), length, terms),
        Body::Mass(_) => [[[c64::ZERO; 4]; 4]; OF_A_BEAM],
    };
    for (k, (matrix, slope)) in n.iter_mut().zip(chain_rule(here, omega)).enumerate() {
        let by = slope * share(here, base, k);
        matrix.iter_mut().flatten().for_each(|v| *v *= by);
    }
    n
}

/// Sets one lane.
#[inline(never)]
fn fill<F: Fuse>(n: &mut [M4<Lanes<F>>; OF_A_BEAM], lane: usize, from: &[M4<c64>; OF_A_BEAM]) {
    for (to, from) in n.iter_mut().flatten().flatten().zip(from.iter().flatten().flatten()) {
        to.re[lane] = from.re;
        to.im[lane] = from.im;
    }
}

/// From the parameters of the integrals (1/B, 1/S, mu, J) to those of a section (B, S, mass, rotary).
fn chain_rule(body: &Body, omega: f64) -> [c64; OF_A_BEAM] {
    let (bending, shear) = match body {
        Body::Beam(b) => (b.at(omega).bending, b.at(omega).shear.unwrap_or(c64::ZERO)),
        Body::Shaft(s) => (c64::ZERO, s.stiffness),
        Body::Mass(_) => (c64::ZERO, c64::ZERO),
    };
    let omega2 = omega * omega;
    let stiff = |k: c64| if k == c64::ZERO { k } else { -(k * k).inv() };
    [stiff(bending), stiff(shear), c64::new(omega2, 0.0), c64::new(omega2, 0.0)]
}

/// Derivatives of one set of frequencies while they are summed.
#[derive(Debug)]
pub struct Gradient<'a, 'o, F> {
    sums: &'a mut Sums<F>,
    wanted: &'a Sensitivity<'a>,
    line: &'a Line,
    frequencies: [f64; LANES],
    omega2: [f64; LANES],
    out: &'o mut [c64],
    used: usize,
}

impl<'o, F: Fuse> Gradient<'_, 'o, F> {
    /// Writes each lane's sums into its own block, and gives the memory back.
    #[inline(always)]
    pub fn write(self) -> &'o mut [c64] {
        let (pairs, n) = (self.wanted.pairs(), self.out.len() / self.used.max(1));
        for (parameter, slot) in self.sums.slots.iter().enumerate() {
            if let Some(slot) = slot {
                scatter(&self.sums.values[*slot..slot + pairs], self.out, parameter * pairs, n, self.used);
            }
        }
        self.out
    }

    /// The integrals over a piece, before its first march on the way back.
    fn integrate(&mut self, p: &Piece) {
        let (here, base) = (self.line.section(p.body, p.stretch), &self.line.bodies[p.body]);
        let of_piece = &mut self.sums.pieces[p.slot];
        for (lane, frequency) in self.frequencies.iter().enumerate() {
            let omega = std::f64::consts::TAU * frequency;
            fill(of_piece, lane, &over_piece(here, base, omega, p.length, p.terms));
        }
    }

    /// Where the sum of a body's parameter stands.
    #[inline(always)]
    fn block(&mut self, body: usize, parameter: usize) -> &mut [Lanes<F>] {
        let start = self.sums.slots[self.sums.first[body] + parameter].unwrap_or(0);
        &mut self.sums.values[start..start + self.wanted.pairs()]
    }
}

/// Whether a body has that property: Euler-Bernoulli beams and shafts have not all four.
#[inline(always)]
fn has(body: &Body, property: usize) -> bool {
    match body {
        Body::Beam(beam) => beam.shear.is_some() || property == 0 || property == 2,
        Body::Shaft(_) => property == 1 || property == 2,
        Body::Mass(_) => false,
    }
}

impl<F: Fuse> Watch<F> for Gradient<'_, '_, F> {
    #[inline(always)]
    fn reads(&self) -> bool {
        true
    }

    #[inline(always)]
    fn joint(&mut self, joint: usize, front: &[Lanes<F>], a: usize, b: Option<usize>, columns: usize) {
        let Some(group) = self.wanted.groups[joint] else { return };
        let e = &mut self.sums.extensions;
        e.copy_from_slice(&front[a * columns..(a + 1) * columns]);
        if let Some(b) = b {
            for (e, below) in e.iter_mut().zip(&front[b * columns..(b + 1) * columns]) {
                *e = *e - *below;
            }
        }
        let (weight, forces, pairs) = (self.wanted.weights[joint], self.wanted.forces, self.wanted.pairs());
        let e = &self.sums.extensions;
        let block = match self.sums.slots[group] {
            Some(slot) => &mut self.sums.values[slot..slot + pairs],
            None => {
                self.sums.single.fill(Lanes::ZERO);
                &mut self.sums.single[..]
            }
        };
        for (row, s) in block.chunks_exact_mut(forces.len().max(1)).zip(self.wanted.sensors) {
            let at_sensor = e[*s].scale(weight);
            for (sum, f) in row.iter_mut().zip(forces) {
                *sum = sum.minus(at_sensor, e[*f]);
            }
        }
        if self.sums.slots[group].is_none() {
            let n = self.out.len() / self.used.max(1);
            scatter(&self.sums.single, self.out, group * pairs, n, self.used);
        }
    }

    #[inline(always)]
    fn length(&mut self, at: &Length<'_, F>, columns: usize) {
        let (rows, z, n) = (at.rows, at.impedance, at.rows.others.len());
        if at.fresh {
            self.integrate(at.piece);
        }
        let Sums { states, values, pieces, first, slots, .. } = &mut *self.sums;
        for (c, state) in states.iter_mut().enumerate() {
            let (u0, u1) = (at.front[rows.own * columns + c], at.front[(rows.own + 1) * columns + c]);
            let (mut force, mut moment) = ((z[0] * u0).plus(z[1], u1), (z[1] * u0).plus(z[2], u1));
            if !at.loads.is_empty() {
                force = force + at.loads[2 * c];
                moment = moment + at.loads[2 * c + 1];
            }
            for (k, &o) in rows.others.iter().enumerate() {
                let u = at.front[o * columns + c];
                force = force.plus(z[3 + k], u);
                moment = moment.plus(z[3 + n + k], u);
            }
            *state = [u0, u1, force, moment];
        }
        let (pairs, forces) = (self.wanted.pairs(), self.wanted.forces);
        let body = &self.line.bodies[rows.body];
        for (p, matrix) in pieces[at.piece.slot].iter().enumerate() {
            if !has(body, p) {
                continue;
            }
            let start = slots[first[rows.body] + p].unwrap_or(0);
            let block = &mut values[start..start + pairs];
            for (row, s) in block.chunks_exact_mut(forces.len().max(1)).zip(self.wanted.sensors) {
                let y = &states[*s];
                let mut v = [Lanes::ZERO; 4];
                for (v, line) in v.iter_mut().zip(matrix) {
                    *v = (line[0] * y[0]).plus(line[1], y[1]).plus(line[2], y[2]).plus(line[3], y[3]);
                }
                for (sum, f) in row.iter_mut().zip(forces) {
                    let y = &states[*f];
                    *sum = sum.plus(v[0], y[0]).plus(v[1], y[1]).plus(v[2], y[2]).plus(v[3], y[3]);
                }
            }
        }
    }

    fn endless(&mut self, body: usize, left: bool, ends: &[Lanes<F>], columns: usize) {
        if !self.wanted.bodies {
            return;
        }
        let whole = &self.line.bodies[body];
        let mut matrices = [[[Lanes::<F>::ZERO; 2]; 2]; OF_A_BEAM];
        for i in 0..LANES {
            let omega = std::f64::consts::TAU * self.frequencies[i];
            let parts = match whole {
                Body::Beam(beam) => over_half_infinite(&Waves::new(beam, omega), left),
                Body::Shaft(shaft) => Some(over_half_infinite_shaft(&Twist::new(shaft, omega))),
                Body::Mass(_) => None,
            };
            // Where its waves merge the march itself has failed and said so.
            let Some(parts) = parts else { continue };
            let slopes = chain_rule(whole, omega);
            for (m, (part, slope)) in matrices.iter_mut().zip(parts.iter().zip(slopes)) {
                for k in 0..4 {
                    let v = part[k / 2][k % 2] * slope;
                    (m[k / 2][k % 2].re[i], m[k / 2][k % 2].im[i]) = (v.re, v.im);
                }
            }
        }
        let (forces, sensors) = (self.wanted.forces, self.wanted.sensors);
        for (p, m) in matrices.iter().enumerate() {
            if !has(whole, p) {
                continue;
            }
            let block = self.block(body, p);
            for (row, s) in block.chunks_exact_mut(forces.len().max(1)).zip(sensors) {
                let (s0, s1) = (ends[*s], ends[columns + s]);
                let v = [(m[0][0] * s0).plus(m[1][0], s1), (m[0][1] * s0).plus(m[1][1], s1)];
                for (sum, f) in row.iter_mut().zip(forces) {
                    *sum = sum.plus(v[0], ends[*f]).plus(v[1], ends[columns + f]);
                }
            }
        }
    }

    #[inline(always)]
    fn mass(&mut self, body: usize, displacement: &[Lanes<F>], _: usize) {
        if !self.wanted.bodies {
            return;
        }
        let (forces, sensors) = (self.wanted.forces, self.wanted.sensors);
        let squared = Lanes::new(self.omega2, [0.0; LANES]);
        let block = self.block(body, 0);
        for (row, s) in block.chunks_exact_mut(forces.len().max(1)).zip(sensors) {
            let at_sensor = displacement[*s] * squared;
            for (sum, f) in row.iter_mut().zip(forces) {
                *sum = sum.plus(at_sensor, displacement[*f]);
            }
        }
    }
}

/// Writes each lane's numbers one after the other at `place` of its own block of `n`.
#[inline(always)]
fn scatter<F: Fuse>(from: &[Lanes<F>], to: &mut [c64], place: usize, n: usize, used: usize) {
    for (i, block) in to.chunks_exact_mut(n).take(used).enumerate() {
        for (slot, value) in block[place..place + from.len()].iter_mut().zip(from) {
            *slot = value.lane(i);
        }
    }
}
