//! Lines as a railway has them: where both formulations answer they agree in four digits, as they promise; points give
//! no energy; force and sensor may change places.
#![no_main]

use libfuzzer_sys::{Corpus, fuzz_target};
use permway_core::{
    c64,
    line::{Body, Line},
    sweep::{Answer, Control, Formulation, Request, sweep},
};
use permway_fuzz::{Draw, Drawn};

/// Digits that an answer without an error promises (`IllConditioned`), of the greater of the two places' own receptances.
const AGREES: f64 = 1e-3;

/// Receptance, m/N, of a point that is held: pins are stiff in the one formulation and rigid in the other.
const HELD: f64 = 1e-25;

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let Ok(mut drawn) = Draw::sound(bytes).request() else { return Corpus::Reject };
    // Modes are another model of the beam than the chain's.
    if drawn.line.bodies.iter().any(|b| matches!(b, Body::Beam(b) if b.modes.is_some())) {
        return Corpus::Reject;
    }
    // Every point is pushed and listened at.
    drawn.forces.append(&mut drawn.sensors);
    drawn.sensors = drawn.forces.clone();
    let (Some(chain), Some(dense)) = (answer(&drawn, Formulation::Chain), answer(&drawn, Formulation::Receptance))
    else {
        return Corpus::Reject;
    };
    let n = drawn.forces.len();
    for (i, f) in drawn.frequencies.iter().enumerate() {
        if [&chain, &dense].iter().any(|a| a.failures.iter().any(|(k, _)| *k == i)) {
            continue;
        }
        let (h, g) = (&chain.sensors[i * n * n..][..n * n], &dense.sensors[i * n * n..][..n * n]);
        for s in 0..n {
            for r in 0..n {
                let (one, other) = (h[s * n + r], g[s * n + r]);
                let size = h[s * n + s].norm().max(h[r * n + r].norm());
                if size < HELD {
                    continue;
                }
                let said =
                    || format!("{f} Hz, points {s}, {r}: chain {one}, dense {other} m/N of {size}; {drawn:?}");
                assert!((one - other).norm() <= AGREES * size, "formulations: {}", said());
                assert!((one - h[r * n + s]).norm() <= AGREES * size, "reciprocity: {}", said());
            }
            let own = h[s * n + s];
            assert!(own.im <= AGREES * own.norm() + HELD, "energy: {f} Hz, point {s}: {own}; {drawn:?}");
        }
    }
    Corpus::Keep
});

fn answer(drawn: &Drawn, formulation: Formulation) -> Option<Answer> {
    let line: &Line = &drawn.line;
    let laws: &[c64] = &drawn.laws;
    let request = Request {
        line,
        frequencies: &drawn.frequencies,
        laws,
        n_laws: drawn.n_laws,
        forces: &drawn.forces,
        sensors: &drawn.sensors,
        formulation,
        joints: false,
        threads: 1,
    };
    sweep(&request, &Control::default()).ok()
}
