//! Extension of every joint by a unit tension in itself: what its finite change needs (Sherman and Morrison 1950).
//!
//! The flexibility of the front, all of the line included, goes back along the records as the covariance does in a
//! smoother: `u_b = M u' - q g` with M = [G^-1, -W]. The cost is that of the march.

use super::{
    factor::{Factor, at},
    tape::{Op, Rows, Tape},
};
use crate::{
    c64,
    lanes::{Fuse, Lanes},
};

/// The flexibility at the front, in its lower triangle; kept from one set of frequencies to the next.
#[derive(Debug, Clone)]
pub struct Flexibility<F> {
    c: Vec<Lanes<F>>,
    width: usize,
    /// New rows of a body: two by the others.
    rows: [Vec<Lanes<F>>; 2],
}

impl<F: Fuse> Flexibility<F> {
    /// Room for the front of a tape.
    pub fn new(tape: &Tape) -> Self {
        let w = tape.width;
        Self { c: vec![Lanes::ZERO; w * w], width: w, rows: [vec![Lanes::ZERO; w], vec![Lanes::ZERO; w]] }
    }

    /// Writes the extension of each joint per unit tension, lanes x joints, m/N.
    #[inline(always)]
    pub fn run(&mut self, tape: &Tape, factor: &Factor<F>, out: &mut [c64], used: usize) {
        let w = self.width;
        for op in tape.ops.iter().rev() {
            match op {
                Op::Join { joint, a, b, .. } => {
                    let mut e = self.c[a * w + a];
                    if let Some(b) = b {
                        let cross = self.c[at(w, *a, *b)];
                        e = e - cross - cross + self.c[b * w + b];
                    }
                    for i in 0..used {
                        out[i * tape.joints + joint] = e.lane(i);
                    }
                }
                Op::March { rows, .. } => self.back::<2, true>(rows, &factor.records[rows.record..]),
                Op::EndBeam { rows, .. } => self.back::<2, false>(rows, &factor.records[rows.record..]),
                Op::EndMass { rows } => self.back::<1, false>(rows, &factor.records[rows.record..]),
                _ => {}
            }
        }
    }

    /// The rows of a body before a march over a length (`MARCHES`), or where it enters from its end.
    #[inline(always)]
    fn back<const ROWS: usize, const MARCHES: bool>(&mut self, rows: &Rows, record: &[Lanes<F>]) {
        let (own, w, n) = (rows.own, self.width, rows.others.len());
        let (gi, q) = (record, &record[if MARCHES { 4 } else { 0 }..]);
        let coupling = &q[ROWS * ROWS..];
        // R = G^-1 C'bo - W C'oo, and the rows of a body that enters have no G^-1 C'bo.
        for r in 0..ROWS {
            for (k, &o) in rows.others.iter().enumerate() {
                let mut v = Lanes::ZERO;
                if MARCHES {
                    v = (gi[2 * r] * self.c[at(w, own, o)]).plus(gi[2 * r + 1], self.c[at(w, own + 1, o)]);
                }
                for (j, &other) in rows.others.iter().enumerate() {
                    v = v.minus(coupling[r * n + j], self.c[at(w, o, other)]);
                }
                self.rows[r][k] = v;
            }
        }
        // M = G^-1 C'bb - W C'ob, then Cbb = M G^-T - R W' + q.
        let mut block = [[Lanes::ZERO; ROWS]; ROWS];
        for (r, line) in block.iter_mut().enumerate() {
            let mut m = [Lanes::ZERO; 2];
            if MARCHES {
                for (c, m) in m.iter_mut().enumerate() {
                    *m = (gi[2 * r] * self.c[at(w, own, own + c)])
                        .plus(gi[2 * r + 1], self.c[at(w, own + 1, own + c)]);
                    for (j, &other) in rows.others.iter().enumerate() {
                        *m = m.minus(coupling[r * n + j], self.c[at(w, own + c, other)]);
                    }
                }
            }
            for (c, slot) in line[..=r].iter_mut().enumerate() {
                let mut v = q[r * ROWS + c];
                if MARCHES {
                    v = v.plus(m[0], gi[2 * c]).plus(m[1], gi[2 * c + 1]);
                }
                for k in 0..n {
                    v = v.minus(self.rows[r][k], coupling[c * n + k]);
                }
                *slot = v;
            }
        }
        for (r, line) in block.iter().enumerate() {
            for (c, v) in line[..=r].iter().enumerate() {
                self.c[at(w, own + r, own + c)] = *v;
            }
            for (k, &o) in rows.others.iter().enumerate() {
                self.c[at(w, own + r, o)] = self.rows[r][k];
            }
        }
    }
}
