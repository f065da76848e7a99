//! What Welch's method expects of a source that several channels hear: the two loops over its fine grid.
//!
//! Both are sums of long rows in real weights, so they are compiled for several kinds of processor, the widest chosen
//! when they run.

use crate::{
    c64,
    chain::Vectors,
    error::CoreError,
    lanes::{Fuse, Plain},
};

/// Numbers that go through a sum side by side: three of the widest registers.
const WIDE: usize = 24;

/// A sparse matrix of real weights, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Weights<'a> {
    /// Where each row begins among the values, and where the last one ends.
    pub pointers: &'a [i32],
    /// The column of each value.
    pub columns: &'a [i32],
    /// The values.
    pub values: &'a [f64],
}

impl Weights<'_> {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.pointers.len().saturating_sub(1)
    }

    /// Checks that every place that a row names is there.
    ///
    /// # Errors
    ///
    /// Of a table that does not fit together, or that names a column beyond the last.
    pub fn check(&self, columns: usize) -> Result<(), CoreError> {
        let invalid = |what: String| Err(CoreError::Invalid(format!("weights: {what}")));
        if self.columns.len() != self.values.len() {
            return invalid(format!("{} columns for {} values", self.columns.len(), self.values.len()));
        }
        let ends = self.pointers.first() == Some(&0)
            && self.pointers.last().and_then(|&end| usize::try_from(end).ok()) == Some(self.values.len());
        if !ends || self.pointers.windows(2).any(|pair| pair[0] > pair[1]) {
            return invalid("pointers must ascend from 0 to the number of values".into());
        }
        match self.columns.iter().find(|&&c| usize::try_from(c).map_or(true, |c| c >= columns)) {
            Some(column) => invalid(format!("column {column} of {columns}")),
            None => Ok(()),
        }
    }

    #[inline(always)]
    #[allow(clippy::cast_sign_loss)] // `check` has seen that none is below zero.
    fn row(&self, row: usize) -> (&[i32], &[f64]) {
        let range = self.pointers[row] as usize..self.pointers[row + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }
}

/// What channels read on a fine grid: values at solved lines, interpolated, and summed over wheels that each are late.
///
/// `values` has shape (lines, channels, wheels), `late` (rows of `spread`, wheels); `out`, all of which is written,
/// (rows of `spread`, channels).
///
/// # Errors
///
/// For tables that do not fit together.
pub fn spread(
    weights: Weights<'_>,
    values: &[c64],
    channels: usize,
    late: &[c64],
    out: &mut [c64],
) -> Result<(), CoreError> {
    let rows = weights.rows();
    let wheels = late.len().checked_div(rows).unwrap_or(0);
    let width = channels * wheels;
    if width == 0
        || late.len() != rows * wheels
        || !values.len().is_multiple_of(width)
        || out.len() != rows * channels
    {
        return Err(CoreError::Invalid(format!(
            "spread: {} values and {} lags for {channels} channels on {rows} places",
            values.len(),
            late.len()
        )));
    }
    weights.check(values.len() / width)?;
    widest(
        #[inline(always)]
        || spread_all(weights, values, wheels, late, out),
    );
    Ok(())
}

#[inline(always)]
fn spread_all(weights: Weights<'_>, values: &[c64], wheels: usize, late: &[c64], out: &mut [c64]) {
    let channels = out.len() / weights.rows();
    let width = channels * wheels;
    let mut there = vec![c64::ZERO; width];
    let places = out.chunks_exact_mut(channels).zip(late.chunks_exact(wheels));
    for (row, (reads, late)) in places.enumerate() {
        let (columns, shares) = weights.row(row);
        there.fill(c64::ZERO);
        for (&column, &share) in columns.iter().zip(shares) {
            #[allow(clippy::cast_sign_loss)]
            let at = column as usize * width;
            for (sum, value) in there.iter_mut().zip(&values[at..at + width]) {
                sum.re += share * value.re;
                sum.im += share * value.im;
            }
        }
        for (read, moved) in reads.iter_mut().zip(there.chunks_exact(wheels)) {
            *read = moved.iter().zip(late).map(|(a, b)| a * b).sum();
        }
    }
}

/// Products of what channels read with each other's conjugates, smeared by a window.
///
/// `fine` has shape (columns of `smear`, channels); `out`, all of which is written, (rows of `smear`, pairs), with the
/// upper triangle of channels against channels row by row.
///
/// # Errors
///
/// For tables that do not fit together.
pub fn cross_spectra(smear: Weights<'_>, fine: &[c64], channels: usize, out: &mut [c64]) -> Result<(), CoreError> {
    let pairs = channels * (channels + 1) / 2;
    if channels == 0 || !fine.len().is_multiple_of(channels) || out.len() != smear.rows() * pairs {
        return Err(CoreError::Invalid(format!(
            "cross spectra: {} values, {channels} channels, {} rows, room for {} pairs",
            fine.len(),
            smear.rows(),
            out.len()
        )));
    }
    smear.check(fine.len() / channels)?;
    widest(
        #[inline(always)]
        || smeared(smear, &products(fine, channels), pairs, out),
    );
    Ok(())
}

/// Products by place, real and imaginary parts in turn, each row filled up to a multiple of `WIDE`.
#[inline(always)]
fn products(fine: &[c64], channels: usize) -> Vec<[f64; WIDE]> {
    let groups = (channels * (channels + 1)).div_ceil(WIDE);
    let mut found = vec![[0.0; WIDE]; groups * (fine.len() / channels)];
    for (row, reads) in found.chunks_exact_mut(groups).zip(fine.chunks_exact(channels)) {
        let mut slots = row.as_flattened_mut().chunks_exact_mut(2);
        for (first, one) in reads.iter().enumerate() {
            for (other, slot) in reads[first..].iter().zip(&mut slots) {
                let product = one * other.conj();
                slot[0] = product.re;
                slot[1] = product.im;
            }
        }
    }
    found
}

#[inline(always)]
fn smeared(smear: Weights<'_>, products: &[[f64; WIDE]], pairs: usize, out: &mut [c64]) {
    let groups = (2 * pairs).div_ceil(WIDE);
    for (row, expected) in out.chunks_exact_mut(pairs).enumerate() {
        let (columns, weights) = smear.row(row);
        for (group, slots) in expected.chunks_mut(WIDE / 2).enumerate() {
            let mut sum = [0.0; WIDE];
            for (&column, &weight) in columns.iter().zip(weights) {
                #[allow(clippy::cast_sign_loss)]
                let product = &products[column as usize * groups + group];
                for (total, value) in sum.iter_mut().zip(product) {
                    *total = Plain::fma(weight, *value, *total);
                }
            }
            for (slot, parts) in slots.iter_mut().zip(sum.chunks_exact(2)) {
                *slot = c64::new(parts[0], parts[1]);
            }
        }
    }
}

/// Runs work by the widest vector instructions that this processor has.
#[inline(always)]
fn widest(work: impl FnOnce()) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
        fn by_avx512(work: impl FnOnce()) {
            work();
        }
        #[target_feature(enable = "avx2,fma")]
        fn by_avx2(work: impl FnOnce()) {
            work();
        }
        match Vectors::here() {
            Vectors::Avx512 => {
                // SAFETY: this processor was found to have the features.
                #[allow(unsafe_code)]
                return unsafe { by_avx512(work) };
            }
            Vectors::Avx2 => {
                // SAFETY: as above.
                #[allow(unsafe_code)]
                return unsafe { by_avx2(work) };
            }
            Vectors::Portable => {}
        }
    }
    work();
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn number(i: usize) -> c64 {
        let t = i as f64;
        c64::new((0.7 * t).sin() + 0.2, (1.3 * t).cos())
    }

    const POINTERS: [i32; 4] = [0, 2, 3, 6];
    const COLUMNS: [i32; 6] = [0, 2, 1, 0, 1, 3];
    const VALUES: [f64; 6] = [0.5, -0.25, 2.0, 1.0, 0.125, 3.0];

    fn weights<'a>() -> Weights<'a> {
        Weights { pointers: &POINTERS, columns: &COLUMNS, values: &VALUES }
    }

    fn dense(row: usize, column: usize) -> f64 {
        (POINTERS[row]..POINTERS[row + 1])
            .map(|i| i as usize)
            .filter(|&i| COLUMNS[i] as usize == column)
            .map(|i| VALUES[i])
            .sum()
    }

    #[test]
    fn what_wheels_do_is_summed_late() {
        let (channels, wheels) = (3, 2);
        let values: Vec<_> = (0..4 * channels * wheels).map(number).collect();
        let late: Vec<_> = (0..3 * wheels).map(|i| number(i + 50)).collect();
        let mut out = vec![c64::ZERO; 3 * channels];
        spread(weights(), &values, channels, &late, &mut out).unwrap();
        for row in 0..3 {
            for channel in 0..channels {
                let mut sum = c64::ZERO;
                for wheel in 0..wheels {
                    for line in 0..4 {
                        let value = values[(line * channels + channel) * wheels + wheel];
                        sum += dense(row, line) * value * late[row * wheels + wheel];
                    }
                }
                assert!((out[row * channels + channel] - sum).norm() < 1e-14 * sum.norm().max(1.0));
            }
        }
    }

    #[test]
    fn pairs_are_smeared_by_the_window() {
        // As many channels as take more than one group of numbers.
        for channels in [1, 2, 6, 9] {
            let fine: Vec<_> = (0..4 * channels).map(number).collect();
            let pairs = channels * (channels + 1) / 2;
            let mut out = vec![c64::ZERO; 3 * pairs];
            cross_spectra(weights(), &fine, channels, &mut out).unwrap();
            for row in 0..3 {
                let mut pair = row * pairs;
                for one in 0..channels {
                    for other in one..channels {
                        let sum: c64 = (0..4)
                            .map(|n| dense(row, n) * fine[n * channels + one] * fine[n * channels + other].conj())
                            .sum();
                        assert!((out[pair] - sum).norm() < 1e-14 * sum.norm().max(1.0));
                        pair += 1;
                    }
                }
            }
        }
    }

    #[test]
    fn tables_that_do_not_fit_are_refused() {
        let fine = vec![c64::ONE; 6];
        let mut out = vec![c64::ZERO; 9];
        // Column 3 of three.
        assert!(cross_spectra(weights(), &fine, 2, &mut out).is_err());
        let short = Weights { values: &VALUES[..5], ..weights() };
        assert!(cross_spectra(short, &[c64::ONE; 8], 2, &mut out).is_err());
        let falling = Weights { pointers: &[0, 4, 3, 6], ..weights() };
        assert!(cross_spectra(falling, &[c64::ONE; 8], 2, &mut out).is_err());
        assert!(cross_spectra(weights(), &[c64::ONE; 8], 2, &mut out[..8]).is_err());
        assert!(spread(weights(), &[c64::ONE; 8], 2, &[c64::ONE; 2], &mut out[..6]).is_err());
    }
}
