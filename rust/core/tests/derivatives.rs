#![allow(clippy::unwrap_used)]
//! Derivatives against differences, and the laws that they obey.

mod common;

use common::{irregular, laws, points, varied as line, viscous};
use permway_core::{
    c64,
    line::{Body, Joint, Line, Point},
    sensitivity::Sensitivity,
    sweep::{Answer, Control, Formulation, Request, sweep, sweep_with},
};

const FREQUENCIES: [f64; 11] = [1.0, 3.3, 7.3, 21.0, 55.0, 130.0, 200.0, 480.0, 1000.0, 2000.0, 3000.0];
const PORTS: usize = 6;

fn request<'a>(line: &'a Line, laws: &'a [c64], ports: &'a [Point]) -> Request<'a> {
    Request {
        line,
        frequencies: &FREQUENCIES,
        laws,
        n_laws: 2,
        forces: ports,
        sensors: ports,
        formulation: Formulation::Chain,
        joints: false,
        threads: 2,
    }
}

fn response(line: &Line, laws: &[c64]) -> Vec<c64> {
    let (points, control) = (points(), Control::default());
    let answer = sweep(&request(line, laws, &points), &control).unwrap();
    assert!(answer.failures.is_empty());
    answer.sensors
}

/// Derivatives by every joint alone and every property of a body, between all ports.
fn derived(line: &Line) -> Answer {
    let n = line.joints.len();
    let groups: Vec<Option<usize>> = (0..n).map(Some).collect();
    let (weights, all): (Vec<f64>, Vec<usize>) = (vec![1.0; n], (0..PORTS).collect());
    let wanted = Sensitivity {
        groups: &groups,
        weights: &weights,
        n_groups: n,
        bodies: true,
        sensors: &all,
        forces: &all,
        own: true,
    };
    let (laws, points) = (laws(&FREQUENCIES), points());
    let answer = sweep_with(&request(line, &laws, &points), Some(&wanted), &Control::default()).unwrap();
    assert!(answer.failures.is_empty());
    answer
}

/// Largest difference at a frequency from a central difference of sixth order, by the largest derivative there.
fn worst(line: &Line, answer: &Answer, parameter: usize, change: impl Fn(&mut Line, f64), size: f64) -> f64 {
    let moved = |h: f64| {
        let mut line = line.clone();
        change(&mut line, h);
        response(&line, &laws(&FREQUENCIES))
    };
    let h = 1e-3;
    let [a, b, c, d, e, g] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0].map(|step| moved(step * h));
    let parameters = answer.derivatives.len() / FREQUENCIES.len() / (PORTS * PORTS);
    let mut worst = 0.0_f64;
    for f in 0..FREQUENCIES.len() {
        let exact = |k: usize| answer.derivatives[(f * parameters + parameter) * PORTS * PORTS + k] * size;
        let difference = |k: usize| {
            let k = f * PORTS * PORTS + k;
            (g[k] - a[k] + (b[k] - e[k]) * 9.0 + (d[k] - c[k]) * 45.0) / (60.0 * h)
        };
        let largest = (0..PORTS * PORTS).map(|k| exact(k).norm()).fold(0.0, f64::max);
        // A parameter that does nothing has no derivative to compare; differences of responses are only so exact.
        let respond = (0..PORTS * PORTS).map(|k| a[f * PORTS * PORTS + k].norm()).fold(0.0, f64::max);
        for k in 0..PORTS * PORTS {
            worst = worst.max((exact(k) - difference(k)).norm() / (largest + 1e-3 * respond));
        }
    }
    worst
}

#[test]
fn derivatives_by_joints_are_those_of_differences() {
    let (line, n) = (line(), line().joints.len());
    let answer = derived(&line);
    for j in (0..n).step_by(3) {
        let law = line.joints[j].law;
        // By the scale at a stiffness that varies with frequency: compare frequency by frequency.
        let laws = laws(&FREQUENCIES);
        let mut scaled = answer.clone();
        let per = scaled.derivatives.len() / FREQUENCIES.len();
        for (i, block) in scaled.derivatives.chunks_mut(per).enumerate() {
            block.iter_mut().for_each(|v| *v *= laws[i * 2 + law]);
        }
        let change = |line: &mut Line, h: f64| line.joints[j].scale *= 1.0 + h;
        let found = worst(&line, &scaled, j, change, line.joints[j].scale);
        assert!(found < 2e-7, "joint {j}: {found}");
    }
}

#[test]
fn derivatives_by_bodies_are_those_of_differences() {
    derivatives_by_the_bodies_of(&line());
}

/// Viscous losses stay what they are when stiffness and mass change.
#[test]
fn derivatives_by_bodies_with_viscous_losses_are_those_of_differences() {
    derivatives_by_the_bodies_of(&viscous());
}

fn derivatives_by_the_bodies_of(line: &Line) {
    let answer = derived(line);
    let mut parameter = line.joints.len();
    for (i, body) in line.bodies.iter().enumerate() {
        match *body {
            Body::Shaft(shaft) => {
                for (p, size) in [(1, shaft.stiffness.re), (2, shaft.mass)] {
                    let change = |line: &mut Line, h: f64| {
                        if let Body::Shaft(s) = &mut line.bodies[i] {
                            if p == 1 { s.stiffness += size * h } else { s.mass += size * h }
                        }
                    };
                    let found = worst(line, &answer, parameter + p, change, size);
                    assert!(found < 2e-7, "shaft, property {p}: {found}");
                }
                parameter += 4;
            }
            Body::Mass(m) => {
                let change = |line: &mut Line, h: f64| line.bodies[i] = Body::Mass(m * (1.0 + h));
                let found = worst(line, &answer, parameter, change, m);
                assert!(found < 2e-7, "mass: {found}");
                parameter += 1;
            }
            Body::Beam(beam) => {
                let sizes = [beam.bending.re, beam.shear.map_or(0.0, |s| s.re), beam.mass, beam.rotary];
                for (p, size) in sizes.into_iter().enumerate() {
                    let change = |line: &mut Line, h: f64| {
                        let change = |body: &mut Body, share: f64| {
                            if let Body::Beam(b) = body {
                                match p {
                                    0 => b.bending += size * h * share,
                                    1 => b.shear = b.shear.map(|s| s + size * h * share),
                                    2 => b.mass += size * h * share,
                                    _ => b.rotary += size * h * share,
                                }
                            }
                        };
                        change(&mut line.bodies[i], 1.0);
                        for stretch in line.stretches.iter_mut().filter(|s| s.body == i) {
                            change(&mut stretch.section, if p < 2 { common::WEAK } else { 1.0 });
                        }
                    };
                    let found = worst(line, &answer, parameter + p, change, size);
                    assert!(found < 2e-7, "beam {i}, property {p}: {found}");
                }
                parameter += 4;
            }
        }
    }
}

/// All stiffness and all mass times s make the response 1/s: the sum of p dH/dp over all parameters is -H (Euler).
#[test]
fn derivatives_sum_to_the_response() {
    derivatives_sum_to_that_of(&line());
}

/// Where no two lengths are alike each is integrated in its turn.
#[test]
fn derivatives_sum_to_the_response_on_irregular_spacing() {
    let mut line = irregular(25);
    line.bodies.insert(1, common::line().bodies[1]);
    line.bodies.insert(2, common::line().bodies[2]);
    line.bodies.insert(3, common::line().bodies[3]);
    let moved = |body: usize| if body == 1 { 4 } else { body };
    for joint in &mut line.joints {
        (joint.a, joint.b) = (moved(joint.a), joint.b.map(moved));
    }
    for (i, below) in [(1, 2), (2, 3)] {
        let at = (0..9).map(|k| 1.2 * k as f64 + common::scattered(k + 7 * i, 0.1) + 0.2);
        line.joints.extend(at.map(|x| Joint { x, a: i, b: (below < 3).then_some(below), law: 0, scale: 1.0 }));
    }
    line.joints.push(Joint { x: -3.0, a: 0, b: Some(3), law: 0, scale: 0.5 });
    derivatives_sum_to_that_of(&line);
}

fn derivatives_sum_to_that_of(line: &Line) {
    let answer = derived(line);
    let (laws, n) = (laws(&FREQUENCIES), line.joints.len());
    let h = response(line, &laws);
    let per = answer.derivatives.len() / FREQUENCIES.len();
    for i in 0..FREQUENCIES.len() {
        let block = &answer.derivatives[i * per..(i + 1) * per];
        let mut values: Vec<c64> = line.joints.iter().map(|j| laws[2 * i + j.law] * j.scale).collect();
        for body in &line.bodies {
            match body {
                Body::Mass(m) => values.push(c64::new(*m, 0.0)),
                Body::Shaft(s) => values.extend([c64::ZERO, s.stiffness, c64::new(s.mass, 0.0), c64::ZERO]),
                Body::Beam(b) => values.extend([
                    b.bending,
                    b.shear.unwrap_or(c64::ZERO),
                    c64::new(b.mass, 0.0),
                    c64::new(b.rotary, 0.0),
                ]),
            }
        }
        assert_eq!(values.len() * PORTS * PORTS, block.len(), "{n}");
        for k in 0..PORTS * PORTS {
            let sum: c64 = values.iter().enumerate().map(|(p, v)| v * block[p * PORTS * PORTS + k]).sum();
            let at = |k: usize| h[i * PORTS * PORTS + k];
            let scale = (at(k / PORTS * (PORTS + 1)).norm() * at(k % PORTS * (PORTS + 1)).norm()).sqrt();
            assert!((sum + at(k)).norm() < 1e-9 * scale, "{} Hz: {sum} {}", FREQUENCIES[i], at(k));
        }
    }
}

/// A joint's own flexibility is what two forces at its ends find, and gives its finite change exactly.
#[test]
fn finite_change_of_one_joint() {
    let line = line();
    let answer = derived(&line);
    let (laws, n) = (laws(&FREQUENCIES), line.joints.len());
    let h = response(&line, &laws);
    let everywhere = {
        let points = points();
        let mut r = request(&line, &laws, &points);
        r.joints = true;
        sweep(&r, &Control::default()).unwrap()
    };
    for j in [0, 1, 7, 20, 39, 40, 41, 42] {
        let mut lost = line.clone();
        lost.joints[j].scale = 0.0;
        let changed = response(&lost, &laws);
        for i in 0..FREQUENCIES.len() {
            let delta = -laws[2 * i + line.joints[j].law] * line.joints[j].scale;
            let factor = delta / (1.0 + delta * answer.own[i * n + j]);
            let e = |port: usize| everywhere.joints[(i * n + j) * PORTS + port];
            for k in 0..PORTS * PORTS {
                let expected = changed[i * PORTS * PORTS + k];
                let found = h[i * PORTS * PORTS + k] - e(k / PORTS) * e(k % PORTS) * factor;
                let at = |k: usize| changed[i * PORTS * PORTS + k].norm();
                let scale = (at(k / PORTS * (PORTS + 1)) * at(k % PORTS * (PORTS + 1))).sqrt();
                assert!((found - expected).norm() < 1e-9 * scale, "joint {j}, {} Hz", FREQUENCIES[i]);
            }
        }
    }
}
