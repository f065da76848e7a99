//! Expected spectra: arrays checked, the interpreter released, arrays out.

use crate::convert::{self, TablesError};
use num_complex::Complex;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use permway_core::welch::{self, Weights};
use pyo3::prelude::*;

/// A sparse array of weights, row by row: pointers, columns and values.
type Rows<'py> = (PyReadonlyArray1<'py, i32>, PyReadonlyArray1<'py, i32>, PyReadonlyArray1<'py, f64>);

fn weights<'a>(rows: &'a Rows<'_>) -> PyResult<Weights<'a>> {
    Ok(Weights { pointers: rows.0.as_slice()?, columns: rows.1.as_slice()?, values: rows.2.as_slice()? })
}

/// Values at solved lines, (line, channel, wheel), interpolated by the rows of `weights` and summed over wheels that
/// each are late, (row, wheel). Returns shape (row, channel). Raises TablesError, a ValueError, for tables that do not
/// fit together. All arrays must be contiguous.
#[pyfunction]
pub fn spread<'py>(
    py: Python<'py>,
    rows: Rows<'py>,
    values: PyReadonlyArray3<'py, Complex<f64>>,
    late: PyReadonlyArray2<'py, Complex<f64>>,
) -> PyResult<Bound<'py, PyArray2<Complex<f64>>>> {
    let (weights, channels) = (weights(&rows)?, values.as_array().shape()[1]);
    let found: Bound<'py, PyArray2<_>> = convert::zeros(py, [weights.rows(), channels])?;
    let (values, late) = (values.as_slice()?, late.as_slice()?);
    let mut memory = found.readwrite();
    let out = memory.as_slice_mut()?;
    py.detach(|| welch::spread(weights, values, channels, late, out))
        .map_err(|e| TablesError::new_err(e.to_string()))?;
    drop(memory);
    Ok(found)
}

/// Products of what channels read, (place, channel), with each other's conjugates, weighed by the rows of `smear`.
/// Returns shape (row, pair), the upper triangle of channels against channels row by row. Raises TablesError, a
/// ValueError, for tables that do not fit together. All arrays must be contiguous.
#[pyfunction]
pub fn cross_spectra<'py>(
    py: Python<'py>,
    smear: Rows<'py>,
    fine: PyReadonlyArray2<'py, Complex<f64>>,
) -> PyResult<Bound<'py, PyArray2<Complex<f64>>>> {
    let (weights, channels) = (weights(&smear)?, fine.as_array().ncols());
    let pairs = channels.saturating_mul(channels.saturating_add(1)) / 2;
    let found: Bound<'py, PyArray2<_>> = convert::zeros(py, [weights.rows(), pairs])?;
    let fine = fine.as_slice()?;
    let mut memory = found.readwrite();
    let out = memory.as_slice_mut()?;
    py.detach(|| welch::cross_spectra(weights, fine, channels, out))
        .map_err(|e| TablesError::new_err(e.to_string()))?;
    drop(memory);
    Ok(found)
}
