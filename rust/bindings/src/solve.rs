//! One sweep: the interpreter released, Ctrl-C and progress answered while it runs.

use crate::convert::{self, Beams, Derived, Joints, Points, TablesError};
use num_complex::Complex;
use numpy::{PyArray2, PyArray3, PyArray4, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use permway_core::{
    error::CoreError,
    sensitivity::Sensitivity,
    sweep::{Control, Formulation, Request, sweep_into},
};
use pyo3::{
    exceptions::{PyKeyboardInterrupt, PyRuntimeError},
    prelude::*,
};
use std::{
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

/// Receptance, joint extension, derivatives, own flexibility of the joints (each None unless asked for), and failures
/// as (index, kind, message).
type Solved<'py> = (
    Bound<'py, PyArray3<Complex<f64>>>,
    Option<Bound<'py, PyArray3<Complex<f64>>>>,
    Option<Bound<'py, PyArray4<Complex<f64>>>>,
    Option<Bound<'py, PyArray2<Complex<f64>>>>,
    Vec<(usize, &'static str, String)>,
);

/// How often a running sweep looks for Ctrl-C, and reports progress.
const TICK: Duration = Duration::from_millis(50);

/// More threads than any machine has processors are a slip.
const MOST_THREADS: usize = 1024;

/// Harmonic response of a line to unit forces.
///
/// Bodies are the beams and shafts, then the masses; a lower body of -1 is the ground, a shear stiffness of 0
/// an Euler-Bernoulli beam, a bending stiffness of 0 a shaft, 0 modes the closed form. `stretches`, a table
/// within that of the beams, says where sections change. `laws` has shape (frequency, law), N/m.
/// Returns receptance in m/N, shape (frequency, sensor, force); joint extension, shape (frequency,
/// joint, force), or None; on request (`derived`) derivatives of the receptance between forces, shape (frequency,
/// parameter, sensor, force), and each joint's extension by a unit tension in itself, shape (frequency, joint); and the
/// frequencies that failed as (index, kind, message), NaN in the
/// arrays. `progress(done, total)` is called now and then, and at the end; an exception from it
/// stops the sweep. Raises TablesError, a ValueError, for tables that do not fit together.
#[pyfunction]
#[pyo3(signature = (*, formulation, frequencies, names, beams, masses, joints, laws, forces, sensors, extensions, threads, progress, derived=None))]
#[allow(clippy::too_many_arguments)]
pub fn solve_line<'py>(
    py: Python<'py>,
    formulation: &str,
    frequencies: PyReadonlyArray1<'py, f64>,
    names: Vec<String>,
    beams: Beams<'py>,
    masses: PyReadonlyArray1<'py, f64>,
    joints: Joints<'py>,
    laws: PyReadonlyArray2<'py, Complex<f64>>,
    forces: Points<'py>,
    sensors: Points<'py>,
    extensions: bool,
    threads: usize,
    progress: Option<Bound<'py, PyAny>>,
    derived: Option<Derived<'py>>,
) -> PyResult<Solved<'py>> {
    let formulation = match formulation {
        "chain" => Formulation::Chain,
        "receptance" => Formulation::Receptance,
        other => {
            return Err(TablesError::new_err(format!("formulation {other:?}: use \"chain\" or \"receptance\"")));
        }
    };
    if !(1..=MOST_THREADS).contains(&threads) {
        return Err(TablesError::new_err(format!("threads {threads}: use 1 to {MOST_THREADS}")));
    }
    let line = convert::line(names, &beams, &masses, &joints)?;
    let (forces, sensors) = (convert::points("forces", &forces)?, convert::points("sensors", &sensors)?);
    let frequencies = frequencies.as_array().to_vec();
    let n_laws = laws.as_array().ncols();
    let rows = laws.as_array().nrows();
    if rows != frequencies.len() {
        return Err(TablesError::new_err(format!("laws: {rows} rows for {} frequencies", frequencies.len())));
    }
    let laws: Vec<_> = laws.as_array().iter().copied().collect();
    let request = Request {
        line: &line,
        frequencies: &frequencies,
        laws: &laws,
        n_laws,
        forces: &forces,
        sensors: &sensors,
        formulation,
        joints: extensions,
        threads,
    };
    let derived = derived.as_ref().map(convert::derived).transpose()?;
    let wanted = derived.as_ref().map(convert::Wanted::sensitivity);
    let progress = progress.map(Bound::unbind);
    let (n, f, joints) = (frequencies.len(), forces.len(), line.joints.len());
    let (parameters, rows, columns) =
        wanted.as_ref().map_or((0, 0, 0), |w| (w.parameters(&line), w.sensors.len(), w.forces.len()));
    let own = wanted.as_ref().is_some_and(|w| w.own);
    let values: Bound<'py, PyArray3<_>> = convert::zeros(py, [n, sensors.len(), f])?;
    let extension: Bound<'py, PyArray3<_>> = convert::zeros(py, [n, if extensions { joints } else { 0 }, f])?;
    let derivatives: Bound<'py, PyArray4<_>> = convert::zeros(py, [n, parameters, rows, columns])?;
    let flexibility: Bound<'py, PyArray2<_>> = convert::zeros(py, [n, if own { joints } else { 0 }])?;
    let failures = {
        let (mut a, mut b, mut c, mut d) =
            (values.readwrite(), extension.readwrite(), derivatives.readwrite(), flexibility.readwrite());
        let memory = [a.as_slice_mut()?, b.as_slice_mut()?, c.as_slice_mut()?, d.as_slice_mut()?];
        py.detach(|| watched(&request, wanted.as_ref(), memory, progress.as_ref()))?
    };
    if let Some(progress) = &progress {
        progress.call1(py, (n, n))?;
    }
    let failures = failures.iter().map(|(i, e)| (*i, kind(e), e.to_string())).collect();
    let derivatives = wanted.is_some().then_some(derivatives);
    Ok((values, extensions.then_some(extension), derivatives, own.then_some(flexibility), failures))
}

/// Runs the sweep beside a watch that answers signals and reports progress.
fn watched(
    request: &Request<'_>,
    derived: Option<&Sensitivity<'_>>,
    memory: [&mut [Complex<f64>]; 4],
    progress: Option<&Py<PyAny>>,
) -> PyResult<Vec<(usize, CoreError)>> {
    let control = Control::default();
    std::thread::scope(|scope| {
        let watcher = std::thread::current();
        let worker = {
            let control = &control;
            scope.spawn(move || {
                let run = || sweep_into(request, derived, control, memory);
                let answer = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run));
                control.ended.store(true, Ordering::Release);
                watcher.unpark();
                answer
            })
        };
        let mut stop = None;
        let mut due = Instant::now() + TICK;
        while !control.ended.load(Ordering::Acquire) {
            std::thread::park_timeout(due.saturating_duration_since(Instant::now()));
            if stop.is_none() && Instant::now() >= due {
                due = Instant::now() + TICK;
                let done = control.done.load(Ordering::Relaxed);
                let heard = Python::attach(|py| {
                    py.check_signals()?;
                    progress.map_or(Ok(()), |p| p.call1(py, (done, request.frequencies.len())).map(|_| ()))
                });
                if let Err(e) = heard {
                    control.cancel.store(true, Ordering::Relaxed);
                    stop = Some(e);
                }
            }
        }
        let result = worker.join();
        if let Some(e) = stop {
            return Err(e);
        }
        match result {
            Ok(Ok(Ok(answer))) => Ok(answer),
            Ok(Ok(Err(CoreError::Cancelled))) => Err(PyKeyboardInterrupt::new_err("cancelled")),
            Ok(Ok(Err(e))) => Err(TablesError::new_err(e.to_string())),
            Ok(Err(_)) | Err(_) => {
                Err(PyRuntimeError::new_err("the core failed unexpectedly; please report the model"))
            }
        }
    })
}

/// The error's kind as a word that Python compares.
fn kind(e: &CoreError) -> &'static str {
    match e {
        CoreError::Singular { .. } => "singular",
        CoreError::NonFinite { .. } => "not finite",
        CoreError::IllConditioned { .. } => "badly conditioned",
        CoreError::Invalid(_) | CoreError::Cancelled => "invalid",
    }
}
