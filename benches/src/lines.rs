//! The layouts whose sweeps are measured.

use permway_core::{
    c64,
    line::{Beam, Body, End, Joint, Line, Point},
    sweep::{Formulation, Request},
};

/// Length of a span in m.
const SPAN: f64 = 32.0;
/// Spacing of fasteners on it in m, and their number.
const SPACING: f64 = 0.625;
const FASTENERS: usize = 51;

/// Names that [`layout`] knows; the number of spans is free.
pub const NAMES: &str =
    "rail, sleepers, viaduct-modes, viaduct-N (N spans), regular-N and irregular-N (a rail on N supports)";

/// A line with all that a request needs but the frequencies.
#[derive(Debug, Clone)]
pub struct Case {
    /// Bodies and joints.
    pub line: Line,
    /// Complex stiffness of each law, N/m, at every frequency.
    pub laws: Vec<c64>,
    /// Where a unit force acts; the sensors are at the same places.
    pub points: Vec<Point>,
    /// Spans; 1 for a line without.
    pub spans: usize,
}

impl Case {
    /// The laws at `n` frequencies, as a request wants them.
    pub fn law_table(&self, n: usize) -> Vec<c64> {
        self.laws.repeat(n)
    }

    /// A force and a sensor at the middle of the line only.
    pub fn at_middle(mut self) -> Self {
        let (first, last) = self.rail_joints();
        self.points = vec![Point { body: 0, x: 0.5 * (first + last) }];
        self
    }

    /// Forces and sensors at the first and at the last fastener: everything between is kept for the way back.
    pub fn at_ends(mut self) -> Self {
        let (first, last) = self.rail_joints();
        self.points = [first, last].map(|x| Point { body: 0, x }).to_vec();
        self
    }

    fn rail_joints(&self) -> (f64, f64) {
        let on_rail = self.line.joints.iter().filter(|j| j.a == 0).map(|j| j.x);
        (on_rail.clone().fold(f64::INFINITY, f64::min), on_rail.fold(f64::NEG_INFINITY, f64::max))
    }

    /// A sweep over `frequencies`.
    pub fn request<'a>(
        &'a self,
        frequencies: &'a [f64],
        laws: &'a [c64],
        formulation: Formulation,
        threads: usize,
    ) -> Request<'a> {
        Request {
            line: &self.line,
            frequencies,
            laws,
            n_laws: self.laws.len(),
            forces: &self.points,
            sensors: &self.points,
            formulation,
            joints: false,
            threads,
        }
    }
}

/// `n` frequencies from 1 to 3000 Hz, evenly on a logarithmic scale.
pub fn frequencies(n: usize) -> Vec<f64> {
    (0..n).map(|i| 3000_f64.powf(i as f64 / n.saturating_sub(1).max(1) as f64)).collect()
}

/// A layout by name.
pub fn layout(name: &str) -> Option<Case> {
    match name {
        "rail" => Some(rail_on_supports()),
        "sleepers" => Some(rail_on_sleepers()),
        "viaduct-modes" => Some(viaduct(1, Some(60))),
        _ => {
            let (kind, number) = name.rsplit_once('-')?;
            let n = number.parse().ok().filter(|n| *n > 0)?;
            match kind {
                "viaduct" => Some(viaduct(n, None)),
                "regular" => Some(rail_on_many(n, 0.0)),
                "irregular" => Some(rail_on_many(n, 0.05)),
                _ => None,
            }
        }
    }
}

fn rail(young: f64, shear: f64, moment: f64, area: f64, loss: f64) -> Body {
    let loss = c64::new(1.0, loss);
    Body::Beam(Beam {
        bending: loss * (young * moment),
        shear: Some(loss * (0.4 * shear * area)),
        mass: 7850.0 * area,
        rotary: 7850.0 * moment,
        dashpots: [0.0; 4],
        interval: [f64::NEG_INFINITY, f64::INFINITY],
        ends: [End::Free; 2],
        modes: None,
    })
}

fn uic60() -> Body {
    rail(2.1e11, 8.1e10, 3038.3e-8, 76.70e-4, 0.02)
}

/// A UIC60 rail without end on 241 pads 0.6 m apart, driven at the middle one.
pub fn rail_on_supports() -> Case {
    let joints =
        (-120..=120).map(|i| Joint { x: 0.6 * f64::from(i), a: 0, b: None, law: 0, scale: 1.0 }).collect();
    let line = Line { bodies: vec![uic60()], joints, names: vec!["rail".into()], ..Line::default() };
    Case { line, laws: vec![c64::new(300e6, 75e6)], points: vec![Point { body: 0, x: 0.0 }], spans: 1 }
}

/// The same rail on `n` pads, 0.6 m apart but for up to `off` m either way, no two spacings alike unless `off` is 0; driven
/// at the middle one.
pub fn rail_on_many(n: usize, off: f64) -> Case {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let place = |i: usize| 0.6 * i as f64 + off * (2.0 * (GOLDEN * (i * i) as f64).fract() - 1.0);
    let at = |i: usize| Joint { x: place(i), a: 0, b: None, law: 0, scale: 1.0 };
    let (bodies, names) = (vec![uic60()], vec!["rail".into()]);
    let line = Line { bodies, joints: (0..n).map(at).collect(), names, ..Line::default() };
    Case { line, laws: vec![c64::new(300e6, 75e6)], points: vec![Point { body: 0, x: place(n / 2) }], spans: 1 }
}

/// The same on sleepers of 162 kg, each on ballast.
pub fn rail_on_sleepers() -> Case {
    let (mut bodies, mut joints, mut names) = (vec![uic60()], Vec::new(), vec!["rail".to_string()]);
    for i in 0..241 {
        let (x, sleeper) = (0.6 * (f64::from(i) - 120.0), bodies.len());
        bodies.push(Body::Mass(162.0));
        names.push(format!("sleeper {i}"));
        joints.push(Joint { x, a: 0, b: Some(sleeper), law: 0, scale: 1.0 });
        joints.push(Joint { x, a: sleeper, b: None, law: 1, scale: 1.0 });
    }
    Case {
        line: Line { bodies, joints, names, ..Line::default() },
        laws: vec![c64::new(300e6, 75e6), c64::new(50e6, 50e6)],
        points: vec![Point { body: 0, x: 0.0 }],
        spans: 1,
    }
}

/// The paper's rail, slab, base plate and girder (Table 3, half model) over so many spans: 51 fasteners on each, mortar
/// and sliding springs below them, two bearings. `modes` for the finite beams; `None` for closed forms. Four wheels
/// about the middle of the line.
pub fn viaduct(spans: usize, modes: Option<usize>) -> Case {
    let plate = |young: f64, moment: f64, density: f64, area: f64, interval: [f64; 2]| {
        Body::Beam(Beam {
            bending: c64::new(1.0, 0.1) * (0.5 * young * moment),
            shear: None,
            mass: 0.5 * density * area,
            rotary: 0.0,
            dashpots: [0.0; 4],
            interval,
            ends: [End::Free; 2],
            modes,
        })
    };
    let length = SPAN * spans as f64;
    let mut bodies = vec![
        rail(2.1e11, 7.7e10, 3.217e-5, 7.745e-3, 0.01),
        plate(3.6e10, 1.7e-3, 2500.0, 0.51, [0.0, length]),
        plate(3.0e10, 7.3125e-3, 2500.0, 0.975, [0.0, length]),
    ];
    let mut names = ["rail", "slab", "base"].map(String::from).to_vec();
    let mut joints = Vec::new();
    for span in 0..spans {
        let (start, girder) = (SPAN * span as f64, bodies.len());
        bodies.push(plate(3.6e10, 11.056, 2650.0, 9.089, [start, start + SPAN]));
        names.push(format!("girder {span}"));
        for i in 0..FASTENERS {
            let x = start + 0.5 * SPAN + SPACING * (i as f64 - (FASTENERS / 2) as f64);
            joints.push(Joint { x, a: 0, b: Some(1), law: 0, scale: 1.0 });
            joints.push(Joint { x, a: 1, b: Some(2), law: 1, scale: 0.5 / FASTENERS as f64 });
            joints.push(Joint { x, a: 2, b: Some(girder), law: 2, scale: 0.5 / FASTENERS as f64 });
        }
        joints.extend([start, start + SPAN].map(|x| Joint { x, a: girder, b: None, law: 3, scale: 0.5 }));
    }
    let loss = |k: f64, eta: f64| c64::new(k, k * eta);
    let laws = vec![loss(6e7, 0.12), loss(3.79e11, 0.2), loss(2.1e11, 0.2), loss(6e9, 0.25)];
    let points = [-10.0, -7.5, 7.5, 10.0].map(|x| Point { body: 0, x: 0.5 * length + x }).to_vec();
    Case { line: Line { bodies, joints, names, ..Line::default() }, laws, points, spans }
}

#[cfg(test)]
mod tests {
    use super::*;
    use permway_core::sweep::{Control, sweep};

    #[test]
    fn formulations_agree_on_all_layouts() {
        let frequencies = frequencies(5);
        for name in ["rail", "sleepers", "viaduct-1", "viaduct-2"] {
            let case = layout(name).unwrap();
            let laws = case.law_table(frequencies.len());
            let run = |formulation| {
                sweep(&case.request(&frequencies, &laws, formulation, 1), &Control::default()).unwrap()
            };
            let (chain, dense) = (run(Formulation::Chain), run(Formulation::Receptance));
            assert!(chain.failures.is_empty() && dense.failures.is_empty());
            let n = case.points.len();
            for (i, (c, d)) in chain.sensors.iter().zip(&dense.sensors).enumerate() {
                let direct = i / (n * n) * n * n + i % n * (n + 1);
                assert!((c - d).norm() < 1e-8 * dense.sensors[direct].norm(), "{name} {i}: {c} {d}");
            }
        }
    }

    #[test]
    fn an_unknown_name_is_no_layout() {
        for name in ["", "track", "viaduct", "viaduct-0", "viaduct-x"] {
            assert!(layout(name).is_none(), "{name}");
        }
    }
}
