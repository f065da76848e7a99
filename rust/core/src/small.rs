//! Two-by-two complex matrices: the displacement and rotation of one beam at one place.

use crate::{c64, field::Field};

/// A 2 x 2 matrix in row order.
pub type M2<T = c64> = [[T; 2]; 2];

/// `a b`.
#[inline(always)]
pub fn mul<T: Field>(a: &M2<T>, b: &M2<T>) -> M2<T> {
    [
        [a[0][0] * b[0][0] + a[0][1] * b[1][0], a[0][0] * b[0][1] + a[0][1] * b[1][1]],
        [a[1][0] * b[0][0] + a[1][1] * b[1][0], a[1][0] * b[0][1] + a[1][1] * b[1][1]],
    ]
}

/// `a + b`.
#[inline(always)]
pub fn add<T: Field>(a: &M2<T>, b: &M2<T>) -> M2<T> {
    [[a[0][0] + b[0][0], a[0][1] + b[0][1]], [a[1][0] + b[1][0], a[1][1] + b[1][1]]]
}

/// The inverse, and the share of the determinant's terms that survived cancellation (1 is best, 0 is singular).
///
/// Returns `None` for an exactly singular or non-finite matrix.
pub fn inverse(a: &M2) -> Option<(M2, f64)> {
    let (p, q) = (a[0][0] * a[1][1], a[0][1] * a[1][0]);
    let det = p - q;
    let size = p.norm() + q.norm();
    if !det.is_finite() || det == c64::ZERO || size == 0.0 {
        return None;
    }
    let r = det.inv();
    Some(([[a[1][1] * r, -a[0][1] * r], [-a[1][0] * r, a[0][0] * r]], det.norm() / size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_identity() {
        let a = [[c64::new(2.0, 1.0), c64::new(-1.0, 0.5)], [c64::new(0.3, 0.0), c64::new(1.0, -2.0)]];
        let (b, share) = inverse(&a).unwrap();
        let i = mul(&a, &b);
        assert!((i[0][0] - 1.0).norm() < 1e-15 && i[0][1].norm() < 1e-15);
        assert!(i[1][0].norm() < 1e-15 && (i[1][1] - 1.0).norm() < 1e-15);
        assert!(share > 0.5 && share <= 1.0);
    }

    #[test]
    fn singular_matrix_has_no_inverse() {
        let a = [[c64::new(1.0, 0.0), c64::new(2.0, 0.0)], [c64::new(2.0, 0.0), c64::new(4.0, 0.0)]];
        assert!(inverse(&a).is_none());
    }
}
