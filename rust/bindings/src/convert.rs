//! Tables of plain arrays to the core's line and points.

use num_complex::Complex;
use numpy::{PyArray, PyReadonlyArray1, PyReadonlyArray2};
use permway_core::{
    line::{Beam, Body, End, Joint, Line, Point, Shaft, Stretch},
    sensitivity::Sensitivity,
};
use pyo3::{create_exception, exceptions::PyValueError, prelude::*};

create_exception!(_core, TablesError, PyValueError, "Tables that do not fit together, or describe no line.");

/// Columns of a table of beams, one row each.
#[derive(FromPyObject)]
pub struct Beams<'py> {
    #[pyo3(item("bending"))]
    bending: PyReadonlyArray1<'py, Complex<f64>>,
    #[pyo3(item("shear"))]
    shear: PyReadonlyArray1<'py, Complex<f64>>,
    #[pyo3(item("mass"))]
    mass: PyReadonlyArray1<'py, f64>,
    #[pyo3(item("rotary"))]
    rotary: PyReadonlyArray1<'py, f64>,
    #[pyo3(item("dashpots"))]
    dashpots: PyReadonlyArray2<'py, f64>,
    #[pyo3(item("interval"))]
    interval: PyReadonlyArray2<'py, f64>,
    #[pyo3(item("pinned"))]
    pinned: PyReadonlyArray2<'py, bool>,
    #[pyo3(item("modes"))]
    modes: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("stretches"))]
    stretches: Stretches<'py>,
}

/// Columns of a table of lengths where a beam or shaft has another section.
#[derive(FromPyObject)]
pub struct Stretches<'py> {
    #[pyo3(item("body"))]
    body: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("bending"))]
    bending: PyReadonlyArray1<'py, Complex<f64>>,
    #[pyo3(item("shear"))]
    shear: PyReadonlyArray1<'py, Complex<f64>>,
    #[pyo3(item("mass"))]
    mass: PyReadonlyArray1<'py, f64>,
    #[pyo3(item("rotary"))]
    rotary: PyReadonlyArray1<'py, f64>,
    #[pyo3(item("dashpots"))]
    dashpots: PyReadonlyArray2<'py, f64>,
    #[pyo3(item("interval"))]
    interval: PyReadonlyArray2<'py, f64>,
}

/// Columns of a table of joints.
#[derive(FromPyObject)]
pub struct Joints<'py> {
    #[pyo3(item("x"))]
    x: PyReadonlyArray1<'py, f64>,
    #[pyo3(item("upper"))]
    upper: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("lower"))]
    lower: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("law"))]
    law: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("scale"))]
    scale: PyReadonlyArray1<'py, f64>,
}

/// Columns of a table of places on bodies.
#[derive(FromPyObject)]
pub struct Points<'py> {
    #[pyo3(item("body"))]
    body: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("x"))]
    x: PyReadonlyArray1<'py, f64>,
}

/// What is to be derived: columns over the joints, then indices of forces.
#[derive(FromPyObject)]
pub struct Derived<'py> {
    #[pyo3(item("groups"))]
    groups: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("weights"))]
    weights: PyReadonlyArray1<'py, f64>,
    #[pyo3(item("n_groups"))]
    n_groups: usize,
    #[pyo3(item("bodies"))]
    bodies: bool,
    #[pyo3(item("sensors"))]
    sensors: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("forces"))]
    forces: PyReadonlyArray1<'py, i64>,
    #[pyo3(item("own"))]
    own: bool,
}

/// The same, owned.
pub struct Wanted {
    groups: Vec<Option<usize>>,
    weights: Vec<f64>,
    n_groups: usize,
    bodies: bool,
    sensors: Vec<usize>,
    forces: Vec<usize>,
    own: bool,
}

impl Wanted {
    /// As the core wants it.
    pub fn sensitivity(&self) -> Sensitivity<'_> {
        Sensitivity {
            groups: &self.groups,
            weights: &self.weights,
            n_groups: self.n_groups,
            bodies: self.bodies,
            sensors: &self.sensors,
            forces: &self.forces,
            own: self.own,
        }
    }
}

/// What is to be derived; a group of -1 stands for none.
pub fn derived(table: &Derived<'_>) -> PyResult<Wanted> {
    let places = |column: &PyReadonlyArray1<'_, i64>, what| {
        column.as_array().iter().map(|i| index(*i, what)).collect::<PyResult<Vec<_>>>()
    };
    if table.n_groups > MOST_GROUPS {
        let n = table.n_groups;
        return Err(TablesError::new_err(format!("derived: {n} groups are more than {MOST_GROUPS}")));
    }
    Ok(Wanted {
        groups: table
            .groups
            .as_array()
            .iter()
            .map(|g| index_or_none(*g, "derived: group", "no group"))
            .collect::<PyResult<_>>()?,
        weights: table.weights.as_array().to_vec(),
        n_groups: table.n_groups,
        bodies: table.bodies,
        sensors: places(&table.sensors, "derived: sensor")?,
        forces: places(&table.forces, "derived: force")?,
        own: table.own,
    })
}

/// Most modes of one beam: more are a slip, and would be summed for hours.
const MOST_MODES: i64 = 100_000;

/// Most groups of joints: more than any line has joints, and so few that counting their members takes little.
const MOST_GROUPS: usize = 10_000_000;

/// Memory for an answer, zero: of pages that the system has zeroed already, touched by the threads that fill them.
///
/// numpy is asked as from Python, for an array too large is then an error, where its C interface ends in a panic.
pub fn zeros<'py, D, const N: usize>(
    py: Python<'py>,
    shape: [usize; N],
) -> PyResult<Bound<'py, PyArray<Complex<f64>, D>>>
where
    D: numpy::ndarray::Dimension,
{
    let made = py.import("numpy")?.call_method1("zeros", (shape.to_vec(), "complex128"));
    let made = made.map_err(|e| TablesError::new_err(format!("no room for an answer of shape {shape:?}: {e}")))?;
    Ok(made.cast_into()?)
}

/// Checks that the columns of a table have one length.
fn same_length(table: &str, lengths: &[usize]) -> PyResult<usize> {
    let n = lengths.first().copied().unwrap_or(0);
    if lengths.iter().all(|l| *l == n) {
        return Ok(n);
    }
    Err(TablesError::new_err(format!("{table}: the columns have different lengths {lengths:?}")))
}

fn index(value: i64, what: &str) -> PyResult<usize> {
    usize::try_from(value).map_err(|_| TablesError::new_err(format!("{what} {value} must not be negative")))
}

/// An index, or -1 for none; any other negative number is a slip, and would be solved as another line.
fn index_or_none(value: i64, what: &str, none: &str) -> PyResult<Option<usize>> {
    if value == -1 {
        return Ok(None);
    }
    usize::try_from(value).map(Some).map_err(|_| {
        TablesError::new_err(format!("{what} {value} must not be negative; -1 alone stands for {none}"))
    })
}

/// A beam; a shear stiffness of zero stands for Euler-Bernoulli, a bending stiffness of zero for a shaft.
fn slender(
    [bending, shear]: [Complex<f64>; 2],
    [mass, rotary]: [f64; 2],
    dashpots: [f64; 4],
    interval: [f64; 2],
    ends: [End; 2],
    modes: Option<usize>,
) -> Body {
    if bending == Complex::ZERO {
        return Body::Shaft(Shaft { stiffness: shear, mass, interval, ends });
    }
    let shear = (shear != Complex::ZERO).then_some(shear);
    Body::Beam(Beam { bending, shear, mass, rotary, dashpots, interval, ends, modes })
}

/// Lengths of other sections.
fn stretches(table: &Stretches<'_>) -> PyResult<Vec<Stretch>> {
    let (body, interval) = (table.body.as_array(), table.interval.as_array());
    let (bending, shear) = (table.bending.as_array(), table.shear.as_array());
    let (mass, rotary) = (table.mass.as_array(), table.rotary.as_array());
    let dashpots = table.dashpots.as_array();
    let lengths =
        [body.len(), bending.len(), shear.len(), mass.len(), rotary.len(), dashpots.nrows(), interval.nrows()];
    let n = same_length("stretches", &lengths)?;
    if n > 0 && (interval.ncols() != 2 || dashpots.ncols() != 4) {
        return Err(TablesError::new_err("stretches: interval has two columns, dashpots four"));
    }
    (0..n)
        .map(|i| {
            let section = slender(
                [bending[i], shear[i]],
                [mass[i], rotary[i]],
                std::array::from_fn(|k| dashpots[[i, k]]),
                [interval[[i, 0]], interval[[i, 1]]],
                [End::Free; 2],
                None,
            );
            Ok(Stretch { body: index(body[i], "stretches: body")?, section })
        })
        .collect()
}

/// Bodies are the beams and shafts, then the masses.
pub fn line(
    names: Vec<String>,
    beams: &Beams<'_>,
    masses: &PyReadonlyArray1<'_, f64>,
    joints: &Joints<'_>,
) -> PyResult<Line> {
    let (bending, shear) = (beams.bending.as_array(), beams.shear.as_array());
    let (mass, rotary) = (beams.mass.as_array(), beams.rotary.as_array());
    let (interval, pinned, modes) = (beams.interval.as_array(), beams.pinned.as_array(), beams.modes.as_array());
    let dashpots = beams.dashpots.as_array();
    let of_sections = [bending.len(), shear.len(), mass.len(), rotary.len(), dashpots.nrows()];
    let n = same_length("beams", &[&of_sections[..], &[interval.nrows(), pinned.nrows(), modes.len()]].concat())?;
    if n > 0 && (interval.ncols() != 2 || pinned.ncols() != 2 || dashpots.ncols() != 4) {
        return Err(TablesError::new_err("beams: interval and pinned have two columns, dashpots four"));
    }
    if modes.iter().any(|m| !(0..=MOST_MODES).contains(m)) {
        return Err(TablesError::new_err(format!("beams: a number of modes must be 0 to {MOST_MODES}")));
    }
    let end = |p: bool| if p { End::Pinned } else { End::Free };
    let mut bodies = Vec::with_capacity(n);
    for i in 0..n {
        bodies.push(slender(
            [bending[i], shear[i]],
            [mass[i], rotary[i]],
            std::array::from_fn(|k| dashpots[[i, k]]),
            [interval[[i, 0]], interval[[i, 1]]],
            [end(pinned[[i, 0]]), end(pinned[[i, 1]])],
            usize::try_from(modes[i]).ok().filter(|m| *m > 0),
        ));
    }
    bodies.extend(masses.as_array().iter().map(|m| Body::Mass(*m)));
    let (x, upper, lower) = (joints.x.as_array(), joints.upper.as_array(), joints.lower.as_array());
    let (law, scale) = (joints.law.as_array(), joints.scale.as_array());
    let n = same_length("joints", &[x.len(), upper.len(), lower.len(), law.len(), scale.len()])?;
    let joints = (0..n)
        .map(|i| {
            Ok(Joint {
                x: x[i],
                a: index(upper[i], "joints: upper body")?,
                b: index_or_none(lower[i], "joints: lower body", "the ground")?,
                law: index(law[i], "joints: law")?,
                scale: scale[i],
            })
        })
        .collect::<PyResult<_>>()?;
    Ok(Line { bodies, joints, names, stretches: stretches(&beams.stretches)? })
}

/// Places of forces or sensors.
pub fn points(table: &str, points: &Points<'_>) -> PyResult<Vec<Point>> {
    let (body, x) = (points.body.as_array(), points.x.as_array());
    let n = same_length(table, &[body.len(), x.len()])?;
    (0..n).map(|i| Ok(Point { body: index(body[i], table)?, x: x[i] })).collect()
}
