//! The dense complex solve, by faer, with a guard against lost digits.

use crate::{c64, error::CoreError};
use faer::{
    Mat, Par,
    dyn_stack::{MemBuffer, MemStack},
    linalg::lu::partial_pivoting::{factor, solve},
    prelude::default,
};

/// Estimated relative error above which an answer is refused.
const WORST: f64 = 1e-5;

/// Solves `matrix x = load`; refused when rounding in the matrix's own entries would spoil the answer.
///
/// # Errors
/// `Singular`, `NonFinite` or `IllConditioned` with the frequency, Hz.
pub fn solve_dense(matrix: &Mat<c64>, load: &Mat<c64>, frequency: f64) -> Result<Mat<c64>, CoreError> {
    let (n, f) = (load.nrows(), load.ncols());
    if n == 0 || f == 0 {
        return Ok(load.clone());
    }
    let mut factor = matrix.clone();
    let (mut forward, mut backward) = (vec![0usize; n], vec![0usize; n]);
    let need = factor::lu_in_place_scratch::<usize, c64>(n, n, Par::Seq, default())
        .or(solve::solve_in_place_scratch::<usize, c64>(n, f, Par::Seq));
    let mut scratch = MemBuffer::new(need);
    let (_, rows) = factor::lu_in_place(
        factor.as_mut(),
        &mut forward,
        &mut backward,
        Par::Seq,
        MemStack::new(&mut scratch),
        default(),
    );
    // L and U stay in one matrix: two more would be faulted in page by page at every solve.
    let mut lu = |mut x: Mat<c64>| {
        let stack = MemStack::new(&mut scratch);
        solve::solve_in_place(factor.as_ref(), factor.as_ref(), rows, x.as_mut(), Par::Seq, stack);
        x
    };
    let mut x = lu(load.clone());
    let place = || "the joints".to_string();
    if !finite(&x) {
        // faer's elimination divides by a vanished pivot without a word.
        return Err(if finite(matrix) && finite(load) {
            CoreError::Singular { frequency, place: place() }
        } else {
            CoreError::NonFinite { frequency, place: place() }
        });
    }
    x += lu(load - matrix * &x);
    // Each entry is 1 + K G with rounding errors of its terms; what they do to the answer.
    let worst = |c: usize| (0..n).map(|r| x[(r, c)].norm()).fold(0.0, f64::max);
    let size = |m: &Mat<c64>| Mat::from_fn(m.nrows(), m.ncols(), |r, c| m[(r, c)].norm_sqr().sqrt());
    let (sizes, x_sizes) = (size(matrix), size(&x));
    let rows = &sizes * &x_sizes + &x_sizes;
    let error = Mat::from_fn(n, f, |r, c| c64::new(f64::EPSILON * rows[(r, c)], 0.0));
    let error = lu(error);
    for c in 0..f {
        let (size, off) = (worst(c), (0..n).map(|r| error[(r, c)].norm()).fold(0.0, f64::max));
        let estimate = off / size;
        if size > 0.0 && (estimate.is_nan() || estimate > WORST) {
            return Err(CoreError::IllConditioned { frequency, place: place(), estimate });
        }
    }
    Ok(x)
}

/// Whether every entry is finite; faer's norms pass over NaN.
fn finite(m: &Mat<c64>) -> bool {
    (0..m.ncols()).all(|j| (0..m.nrows()).all(|i| m[(i, j)].is_finite()))
}
