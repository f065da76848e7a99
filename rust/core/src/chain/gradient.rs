//! Derivatives of responses, summed while the displacements come back along the line.

use super::{
    factor::{Factor, section},
    solve::{Length, Watch},
    tape::Tape,
};
use crate::{
    c64,
    energy::{M4, over_half_infinite, over_length},
    field::Field,
    lanes::{Fuse, LANES, Lanes},
    line::{Body, Line},
    sensitivity::{OF_A_BEAM, Sensitivity},
    small::M2,
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
    /// Of each distinct piece, by the parameters of its beam.
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
        let pieces = Vec::with_capacity(if wanted.bodies { tape.pieces.len() } else { 0 });
        Self {
            values: vec![Lanes::ZERO; next],
            slots,
            single: vec![Lanes::ZERO; wanted.pairs()],
            pieces,
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
        tape: &Tape,
        factor: &Factor<F>,
        out: (&'o mut [c64], usize),
    ) -> Gradient<'a, 'o, F> {
        self.values.fill(Lanes::ZERO);
        let omega2 = factor.frequencies.map(|f| (std::f64::consts::TAU * f).powi(2));
        self.pieces.clear();
        if wanted.bodies {
            for p in &tape.pieces {
                if let Body::Beam(beam) = &line.bodies[p.body] {
                    let s = section(beam, &omega2);
                    let mut n = over_length(&s, p.length, p.terms);
                    for (matrix, factor) in n.iter_mut().zip(chain_rule(&s, &omega2)) {
                        matrix.iter_mut().flatten().for_each(|v| *v = *v * factor);
                    }
                    self.pieces.push(n);
                }
            }
        }
        Gradient { sums: self, wanted, line, frequencies: factor.frequencies, omega2, out: out.0, used: out.1 }
    }
}

/// From the parameters of the integrals (1/B, 1/S, mu, J) to those of a beam (B, S, mass, rotary).
#[inline(always)]
fn chain_rule<F: Fuse>(s: &crate::element::Section<Lanes<F>>, omega2: &[f64; LANES]) -> [Lanes<F>; OF_A_BEAM] {
    let squared = Lanes::new(*omega2, [0.0; LANES]);
    let stiff = |flexible: Lanes<F>| -(flexible * flexible);
    [stiff(s.flexibility), stiff(s.shear_compliance), squared, squared]
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

    /// Where the sum of a body's parameter stands.
    #[inline(always)]
    fn block(&mut self, body: usize, parameter: usize) -> &mut [Lanes<F>] {
        let start = self.sums.slots[self.sums.first[body] + parameter].unwrap_or(0);
        &mut self.sums.values[start..start + self.wanted.pairs()]
    }

    /// Whether a beam has that parameter: Euler-Bernoulli beams have neither shear stiffness nor rotary inertia.
    fn has(&self, body: usize, parameter: usize) -> bool {
        let Body::Beam(beam) = &self.line.bodies[body] else { return false };
        beam.shear.is_some() || parameter == 0 || parameter == 2
    }
}

impl<F: Fuse> Watch<F> for Gradient<'_, '_, F> {
    const READS: bool = true;

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
        let shear = matches!(&self.line.bodies[rows.body], Body::Beam(b) if b.shear.is_some());
        for (p, matrix) in pieces[at.piece].iter().enumerate() {
            if !shear && p % 2 == 1 {
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
        let Body::Beam(beam) = &self.line.bodies[body] else { return };
        if !self.wanted.bodies {
            return;
        }
        let mut matrices = [[[Lanes::<F>::ZERO; 2]; 2]; OF_A_BEAM];
        for i in 0..LANES {
            let waves = Waves::new(beam, std::f64::consts::TAU * self.frequencies[i]);
            // Where its waves merge the march itself has failed and said so.
            let Some(parts) = over_half_infinite(&waves, left) else { continue };
            for (m, part) in matrices.iter_mut().zip(parts) {
                for k in 0..4 {
                    let part: &M2 = &part;
                    m[k / 2][k % 2].re[i] = part[k / 2][k % 2].re;
                    m[k / 2][k % 2].im[i] = part[k / 2][k % 2].im;
                }
            }
        }
        let factors = chain_rule(&section::<F>(beam, &self.omega2), &self.omega2);
        let (forces, sensors) = (self.wanted.forces, self.wanted.sensors);
        for (p, (m, factor)) in matrices.iter().zip(factors).enumerate() {
            if !self.has(body, p) {
                continue;
            }
            let block = self.block(body, p);
            for (row, s) in block.chunks_exact_mut(forces.len().max(1)).zip(sensors) {
                let (s0, s1) = (ends[*s] * factor, ends[columns + s] * factor);
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
