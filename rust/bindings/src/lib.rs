//! The Python border: arrays in, arrays out, errors. No physics.

mod convert;
mod solve;
mod welch;

use pyo3::prelude::pymodule;

/// Compiled core of permway: the harmonic response of a line, and expected spectra.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::solve::solve_line;
    #[pymodule_export]
    use crate::welch::{cross_spectra, spread};

    #[pymodule_init]
    fn init(m: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        m.add("TablesError", m.py().get_type::<crate::convert::TablesError>())?;
        m.add("__version__", env!("CARGO_PKG_VERSION"))?;
        m.add("vectors", permway_core::chain::Vectors::here().name())
    }
}
