//! The lines whose sweeps are timed.

use permway_core::{
    c64,
    line::{Beam, Body, End, Joint, Line, Point},
    sweep::{Formulation, Request},
};

/// Spacing of fasteners in m.
const SPACING: f64 = 0.625;

/// A line with all that a request needs but the frequencies.
#[derive(Debug)]
pub struct Case {
    /// Bodies and joints.
    pub line: Line,
    /// Complex stiffness of each law, N/m, at every frequency.
    pub laws: Vec<c64>,
    /// Where a unit force acts; the sensors are at the same places.
    pub points: Vec<Point>,
}

impl Case {
    /// The laws at `n` frequencies, as a request wants them.
    pub fn law_table(&self, n: usize) -> Vec<c64> {
        self.laws.repeat(n)
    }

    /// A sweep over `frequencies` on one thread.
    pub fn request<'a>(
        &'a self,
        frequencies: &'a [f64],
        laws: &'a [c64],
        formulation: Formulation,
        joints: bool,
    ) -> Request<'a> {
        Request {
            line: &self.line,
            frequencies,
            laws,
            n_laws: self.laws.len(),
            forces: &self.points,
            sensors: &self.points,
            formulation,
            joints,
            threads: 1,
        }
    }
}

/// `n` frequencies from 1 to 3000 Hz, evenly on a logarithmic scale.
pub fn frequencies(n: usize) -> Vec<f64> {
    (0..n).map(|i| 3000_f64.powf(i as f64 / n.saturating_sub(1).max(1) as f64)).collect()
}

fn rail(young: f64, shear: f64, moment: f64, area: f64, loss: f64) -> Body {
    let loss = c64::new(1.0, loss);
    Body::Beam(Beam {
        bending: loss * (young * moment),
        shear: Some(loss * (0.4 * shear * area)),
        mass: 7850.0 * area,
        rotary: 7850.0 * moment,
        interval: [f64::NEG_INFINITY, f64::INFINITY],
        ends: [End::Free; 2],
        modes: None,
    })
}

/// A UIC60 rail without end on 241 pads 0.6 m apart, driven at the middle one.
pub fn rail_on_supports() -> Case {
    let joints =
        (-120..=120).map(|i| Joint { x: 0.6 * f64::from(i), a: 0, b: None, law: 0, scale: 1.0 }).collect();
    let line = Line {
        bodies: vec![rail(2.1e11, 8.1e10, 3038.3e-8, 76.70e-4, 0.02)],
        joints,
        names: vec!["rail".into()],
        ..Line::default()
    };
    Case { line, laws: vec![c64::new(300e6, 75e6)], points: vec![Point { body: 0, x: 0.0 }] }
}

/// The paper's rail, slab, base plate and girder (Table 3, half model): 51 fasteners, mortar and sliding springs below
/// them, two bearings. `modes` for the three finite beams; `None` for closed forms. Four wheels.
pub fn viaduct(modes: Option<usize>) -> Case {
    let span = 32.0;
    let plate = |young: f64, moment: f64, density: f64, area: f64| {
        Body::Beam(Beam {
            bending: c64::new(1.0, 0.1) * (0.5 * young * moment),
            shear: None,
            mass: 0.5 * density * area,
            rotary: 0.0,
            interval: [0.0, span],
            ends: [End::Free; 2],
            modes,
        })
    };
    let bodies = vec![
        rail(2.1e11, 7.7e10, 3.217e-5, 7.745e-3, 0.01),
        plate(3.6e10, 1.7e-3, 2500.0, 0.51),
        plate(3.0e10, 7.3125e-3, 2500.0, 0.975),
        plate(3.6e10, 11.056, 2650.0, 9.089),
    ];
    let mut joints = Vec::new();
    for i in 0..51 {
        let x = 0.5 * span + SPACING * f64::from(i - 25);
        joints.push(Joint { x, a: 0, b: Some(1), law: 0, scale: 1.0 });
        joints.push(Joint { x, a: 1, b: Some(2), law: 1, scale: 0.5 / 51.0 });
        joints.push(Joint { x, a: 2, b: Some(3), law: 2, scale: 0.5 / 51.0 });
    }
    joints.extend([0.0, span].map(|x| Joint { x, a: 3, b: None, law: 3, scale: 0.5 }));
    let loss = |k: f64, eta: f64| c64::new(k, k * eta);
    let laws = vec![loss(6e7, 0.12), loss(3.79e11, 0.2), loss(2.1e11, 0.2), loss(6e9, 0.25)];
    let points = [-10.0, -7.5, 7.5, 10.0].map(|x| Point { body: 0, x: 0.5 * span + x }).to_vec();
    Case {
        line: Line {
            bodies,
            joints,
            names: ["rail", "slab", "base", "girder"].map(String::from).to_vec(),
            ..Line::default()
        },
        laws,
        points,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use permway_core::sweep::{Control, sweep};

    #[test]
    fn formulations_agree_on_both_lines() {
        let frequencies = frequencies(5);
        for case in [rail_on_supports(), viaduct(None)] {
            let laws = case.law_table(frequencies.len());
            let run = |formulation| {
                sweep(&case.request(&frequencies, &laws, formulation, false), &Control::default()).unwrap()
            };
            let (chain, dense) = (run(Formulation::Chain), run(Formulation::Receptance));
            assert!(chain.failures.is_empty() && dense.failures.is_empty());
            let n = case.points.len();
            for (i, (c, d)) in chain.sensors.iter().zip(&dense.sensors).enumerate() {
                let direct = i / (n * n) * n * n + i % n * (n + 1);
                assert!((c - d).norm() < 1e-8 * dense.sensors[direct].norm(), "{i}: {c} {d}");
            }
        }
    }
}
