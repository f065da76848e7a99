//! A dense complex system with one right side, solved by faer's LU with partial pivoting.

use faer::{
    Conj, Mat, Par,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{lu::partial_pivoting as lu, solvers::Solve},
    prelude::default,
};
use permway_core::c64;

/// A full matrix of order `n` and a right side, entries even in the square of side 2, the same on every machine.
pub fn system(n: usize) -> (Mat<c64>, Mat<c64>) {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    // xorshift64*, Vigna 2016.
    let mut next = || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let mut entry = |_, _| c64::new(next(), next());
    (Mat::from_fn(n, n, &mut entry), Mat::from_fn(n, 1, &mut entry))
}

/// Solves as one writes it with faer, memory taken anew.
pub fn solve(matrix: &Mat<c64>, load: &Mat<c64>) -> Mat<c64> {
    matrix.partial_piv_lu().solve(load)
}

/// Largest entry of `matrix x - load` over that of `load`.
pub fn residual(matrix: &Mat<c64>, x: &Mat<c64>, load: &Mat<c64>) -> f64 {
    (matrix * x - load).norm_max() / load.norm_max()
}

/// The same elimination in memory that stays.
pub struct Reused {
    lu: Mat<c64>,
    x: Mat<c64>,
    forward: Vec<usize>,
    backward: Vec<usize>,
    scratch: MemBuffer,
}

impl Reused {
    /// Room for order `n` and one right side.
    pub fn new(n: usize) -> Self {
        let factor = lu::factor::lu_in_place_scratch::<usize, c64>(n, n, Par::Seq, default());
        let solve = lu::solve::solve_in_place_scratch::<usize, c64>(n, 1, Par::Seq);
        Self {
            lu: Mat::zeros(n, n),
            x: Mat::zeros(n, 1),
            forward: vec![0; n],
            backward: vec![0; n],
            scratch: MemBuffer::new(factor.or(solve)),
        }
    }

    /// Copies the system, factors and solves it.
    pub fn solve(&mut self, matrix: &Mat<c64>, load: &Mat<c64>) -> &Mat<c64> {
        self.lu.copy_from(matrix);
        self.x.copy_from(load);
        let stack = MemStack::new(&mut self.scratch);
        let (_, permutation) = lu::factor::lu_in_place(
            self.lu.as_mut(),
            &mut self.forward,
            &mut self.backward,
            Par::Seq,
            stack,
            default(),
        );
        lu::solve::solve_in_place_with_conj(
            self.lu.as_ref(),
            self.lu.as_ref(),
            permutation,
            Conj::No,
            self.x.as_mut(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
        &self.x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_solve_the_system() {
        for n in [1, 7, 100, 153] {
            let (matrix, load) = system(n);
            assert!(residual(&matrix, &solve(&matrix, &load), &load) < 1e-11);
            assert!(residual(&matrix, Reused::new(n).solve(&matrix, &load), &load) < 1e-11);
        }
    }
}
