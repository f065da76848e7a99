#![allow(clippy::unwrap_used)]
//! Sweeps over many frequencies: both formulations, threads, failures, cancelling.

mod common;

use common::{irregular, laws, line, points};
use permway_core::{
    c64,
    chain::{Engine, Group, Job, Response, Tape, Wanted},
    error::CoreError,
    lanes::LANES,
    line::{Body, Joint, Line, Point},
    sweep::{Answer, Control, Formulation, Request, sweep},
};
use std::sync::atomic::Ordering;

fn run(line: &Line, frequencies: &[f64], formulation: Formulation, threads: usize) -> Answer {
    let (laws, points) = (laws(frequencies), points());
    let request = Request {
        line,
        frequencies,
        laws: &laws,
        n_laws: 2,
        forces: &points,
        sensors: &points,
        formulation,
        joints: true,
        threads,
    };
    sweep(&request, &Control::default()).unwrap()
}

#[test]
fn formulations_agree() {
    let frequencies = [1.0, 7.3, 55.0, 200.0, 1000.0, 3000.0];
    let (chain, dense) = (
        run(&line(), &frequencies, Formulation::Chain, 2),
        run(&line(), &frequencies, Formulation::Receptance, 1),
    );
    assert!(chain.failures.is_empty() && dense.failures.is_empty(), "{:?}", chain.failures);
    for (i, f) in frequencies.iter().enumerate() {
        let part = i * 36..(i + 1) * 36;
        let (c, d) = (&chain.sensors[part.clone()], &dense.sensors[part]);
        for (k, (c, v)) in c.iter().zip(d).enumerate() {
            // A transfer is measured by the direct receptances at its two ends.
            let scale = (d[k / 6 * 7].norm() * d[k % 6 * 7].norm()).sqrt();
            assert!((c - v).norm() <= 1e-11 * scale, "{f} Hz: {c} {v}");
        }
        let size = dense.joints.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let part = i * chain.joints.len() / 6..(i + 1) * chain.joints.len() / 6;
        for (c, d) in chain.joints[part.clone()].iter().zip(&dense.joints[part]) {
            assert!((c - d).norm() <= 1e-9 * size, "{f} Hz: {c} {d}");
        }
    }
}

/// Lengths that are all different are marched over in memory for two transfers, one a body, whatever the line's length.
#[test]
fn transfers_of_irregular_lengths_share_memory() {
    for n in [20, 400] {
        let line = irregular(n);
        let middle = [Point { body: 0, x: 0.3 * n as f64 }];
        for wanted in [Wanted::Sensors, Wanted::Everywhere, Wanted::States] {
            let tape = Tape::new(&line, &middle, &middle, 500.0, wanted);
            let halves = [Some(&tape), tape.right.as_deref()];
            let pieces: usize = halves.into_iter().flatten().map(|t| t.pieces.len()).sum();
            assert!(2 * pieces > 5 * n, "{pieces} lengths of {n} joints");
            assert!(halves.into_iter().flatten().all(|t| t.slots <= 2), "{:?}", tape.slots);
        }
    }
}

#[test]
fn formulations_agree_on_irregular_spacing() {
    let (line, frequencies) = (irregular(30), [1.0, 55.0, 480.0, 2000.0]);
    let points: Vec<Point> = [(0, 1.3), (0, 8.0), (1, 4.4)].map(|(body, x)| Point { body, x }).to_vec();
    let laws = laws(&frequencies);
    let run = |formulation| {
        let request = Request {
            line: &line,
            frequencies: &frequencies,
            laws: &laws,
            n_laws: 2,
            forces: &points,
            sensors: &points,
            formulation,
            joints: false,
            threads: 1,
        };
        sweep(&request, &Control::default()).unwrap().sensors
    };
    let (chain, dense) = (run(Formulation::Chain), run(Formulation::Receptance));
    for (k, (c, d)) in chain.iter().zip(&dense).enumerate() {
        let at = |place: usize| dense[k / 9 * 9 + 4 * place].norm();
        let scale = (at(k % 9 / 3) * at(k % 3)).sqrt();
        assert!((c - d).norm() <= 1e-11 * scale, "{k}: {c} {d}");
    }
}

/// The code for this processor and the code for every processor do the same sums.
#[test]
fn portable_code_agrees() {
    let line = line();
    let points: Vec<Point> = [(0, -3.0), (1, 7.0), (2, 6.3)].map(|(body, x)| Point { body, x }).to_vec();
    let tape = Tape::new(&line, &points, &points, 700.0, Wanted::Sensors);
    let laws: Vec<c64> = (0..LANES).flat_map(|_| [c64::new(6e7, 8e6), c64::new(2e9, 3e8)]).collect();
    let group =
        Group { frequencies: std::array::from_fn(|i| 100.0 * (i + 1) as f64 - 50.0), laws: &laws, n_laws: 2 };
    let mut answers = Vec::new();
    for mut engine in [Engine::new(&tape, 3, None), Engine::portable(&tape, 3, None)] {
        let mut sensors = vec![c64::ZERO; LANES * 9];
        let mut out = Response {
            sensors: &mut sensors,
            joints: &mut [],
            derivatives: &mut [],
            own: &mut [],
            n_sensors: 3,
            n_forces: 3,
            used: LANES,
        };
        let job = Job { tape: &tape, line: &line, group: &group, derived: None };
        assert!(engine.run(&job, &mut out).iter().all(Option::is_none));
        answers.push(sensors);
    }
    for (a, b) in answers[0].iter().zip(&answers[1]) {
        assert!((a - b).norm() <= 1e-11 * b.norm(), "{a} {b}");
    }
}

#[test]
fn threads_change_nothing() {
    let frequencies: Vec<f64> = (1..60).map(|i| f64::from(i) * 7.0).collect();
    let (one, many) =
        (run(&line(), &frequencies, Formulation::Chain, 1), run(&line(), &frequencies, Formulation::Chain, 4));
    assert_eq!(one.sensors, many.sensors);
    assert!(run(&line(), &[], Formulation::Chain, 4).sensors.is_empty());
}

/// A mass that nothing holds is solved by its inertia; one held at resonance without loss is singular.
#[test]
fn singular_frequency_is_reported_and_the_sweep_survives() {
    let (mass, omega) = (1.0, std::f64::consts::TAU);
    let joint = Joint { x: 0.0, a: 0, b: None, law: 0, scale: 1.0 };
    let line = Line {
        bodies: vec![Body::Mass(mass)],
        joints: vec![joint],
        names: vec!["block".into()],
        ..Line::default()
    };
    let point = [Point { body: 0, x: 0.0 }];
    let k = omega * omega;
    let laws = [c64::new(k, 0.0); 2];
    for formulation in [Formulation::Chain, Formulation::Receptance] {
        let request = Request {
            line: &line,
            frequencies: &[1.0, 0.5],
            laws: &laws,
            n_laws: 1,
            forces: &point,
            sensors: &point,
            formulation,
            joints: false,
            threads: 1,
        };
        let answer = sweep(&request, &Control::default()).unwrap();
        let [(0, error)] = &answer.failures[..] else {
            panic!("{formulation:?} {:?} {:?}", answer.failures, answer.sensors)
        };
        let at = match error {
            CoreError::Singular { frequency, .. } | CoreError::IllConditioned { frequency, .. } => *frequency,
            other => panic!("{other}"),
        };
        assert_eq!(at, 1.0);
        assert!((answer.sensors[1] - 1.0 / (0.75 * k)).norm() < 1e-15);
    }
}

#[test]
fn cancelled_sweep_returns_no_answer() {
    let control = Control::default();
    control.cancel.store(true, Ordering::Relaxed);
    let line = line();
    let request = Request {
        line: &line,
        frequencies: &[1.0],
        laws: &[c64::ONE; 2],
        n_laws: 2,
        forces: &[],
        sensors: &[],
        formulation: Formulation::Chain,
        joints: false,
        threads: 1,
    };
    assert_eq!(sweep(&request, &control).unwrap_err(), CoreError::Cancelled);
}
