//! Loads forward, displacements backward, over the factor of one frequency.

use super::{
    factor::Factor,
    tape::{Op, Rows, Tape},
};
use crate::{c64, error::CoreError};

/// Where one frequency's answer goes; row-major, one column per force.
#[derive(Debug)]
pub struct Response<'a> {
    /// Receptance, sensors x forces, m/N.
    pub sensors: &'a mut [c64],
    /// Extension of the joints (upper less lower body), joints x forces, m/N; may be empty.
    pub joints: &'a mut [c64],
}

/// Answers `forces` unit forces at once.
///
/// # Errors
/// `NonFinite` if the answer is not finite.
pub fn respond(
    tape: &Tape,
    factor: &Factor,
    forces: usize,
    frequency: f64,
    out: &mut Response<'_>,
) -> Result<(), CoreError> {
    let mut s =
        Sweep { f: forces, rec: &factor.records, front: vec![c64::ZERO; tape.width * forces], saved: vec![] };
    for op in &tape.ops {
        match op {
            Op::StartBeam { own, .. } => s.front[own * forces..(own + 2) * forces].fill(c64::ZERO),
            Op::StartMass { own, .. } => s.front[own * forces..(own + 1) * forces].fill(c64::ZERO),
            // The forces at the front are Z u + g, and a load lessens what the right must supply.
            Op::Force { row, index } => s.front[row * forces + index] -= 1.0,
            Op::March { rows, .. } => s.forward(rows, 2, true),
            Op::EndBeam { rows, .. } => s.forward(rows, 2, false),
            Op::EndMass { rows } => s.forward(rows, 1, false),
            Op::Join { .. } | Op::Sense { .. } => {}
        }
    }
    s.front.fill(c64::ZERO);
    for op in tape.ops.iter().rev() {
        match op {
            Op::March { rows, .. } => s.backward(rows, 2, true),
            Op::EndBeam { rows, .. } => s.backward(rows, 2, false),
            Op::EndMass { rows } => s.backward(rows, 1, false),
            Op::Sense { row, index } => {
                out.sensors[index * forces..(index + 1) * forces]
                    .copy_from_slice(&s.front[row * forces..(row + 1) * forces]);
            }
            Op::Join { joint, a, b, .. } if !out.joints.is_empty() => {
                for k in 0..forces {
                    let below = b.map_or(c64::ZERO, |b| s.front[b * forces + k]);
                    out.joints[joint * forces + k] = s.front[a * forces + k] - below;
                }
            }
            _ => {}
        }
    }
    let finite = out.sensors.iter().chain(out.joints.iter()).all(|v| v.is_finite());
    if finite { Ok(()) } else { Err(CoreError::NonFinite { frequency, place: "the response".into() }) }
}

struct Sweep<'a> {
    f: usize,
    rec: &'a [c64],
    front: Vec<c64>,
    saved: Vec<c64>,
}

impl Sweep<'_> {
    /// g'o = go - W^T gb and g'b = G^-T gb; a body that ends keeps nothing.
    fn forward(&mut self, rows: &Rows, size: usize, marches: bool) {
        let (f, own, n) = (self.f, rows.own, rows.others.len());
        let g = self.front[own * f..(own + size) * f].to_vec();
        let w = rows.record + size * size * if marches { 2 } else { 1 };
        for (k, &o) in rows.others.iter().enumerate() {
            for c in 0..f {
                let d: c64 = (0..size).map(|i| self.rec[w + i * n + k] * g[i * f + c]).sum();
                self.front[o * f + c] -= d;
            }
        }
        if marches {
            let gi = &self.rec[rows.record..rows.record + 4];
            for c in 0..f {
                self.front[own * f + c] = gi[0] * g[c] + gi[2] * g[f + c];
                self.front[(own + 1) * f + c] = gi[1] * g[c] + gi[3] * g[f + c];
            }
        }
        self.saved.extend_from_slice(&g);
    }

    /// ub = G^-1 u'b - W uo - q gb.
    fn backward(&mut self, rows: &Rows, size: usize, marches: bool) {
        let (f, own, n) = (self.f, rows.own, rows.others.len());
        let g = self.saved.split_off(self.saved.len() - size * f);
        let q = rows.record + if marches { size * size } else { 0 };
        let w = q + size * size;
        let old = self.front[own * f..(own + size) * f].to_vec();
        for i in 0..size {
            for c in 0..f {
                let mut u = c64::ZERO;
                for j in 0..size {
                    u -= self.rec[q + i * size + j] * g[j * f + c];
                    if marches {
                        u += self.rec[rows.record + i * size + j] * old[j * f + c];
                    }
                }
                for (k, &o) in rows.others.iter().enumerate() {
                    u -= self.rec[w + i * n + k] * self.front[o * f + c];
                }
                self.front[(own + i) * f + c] = u;
            }
        }
    }
}
