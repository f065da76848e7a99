#![allow(dead_code)]
//! A line that the tests share.

use permway_core::{
    c64,
    line::{Beam, Body, End, Joint, Line, Point, Shaft, Stretch},
};

pub fn beam(bending: f64, shear: Option<f64>, mass: f64, interval: [f64; 2], end: End) -> Body {
    let loss = c64::new(1.0, 0.02);
    Body::Beam(Beam {
        bending: loss * bending,
        shear: shear.map(|s| loss * s),
        mass,
        rotary: if shear.is_some() { 0.25 } else { 0.0 },
        dashpots: [0.0; 4],
        interval,
        ends: [end; 2],
        modes: None,
    })
}

/// Rail, slab and girder with unevenly placed joints, and a mass between two of them.
pub fn line() -> Line {
    let endless = [f64::NEG_INFINITY, f64::INFINITY];
    let bodies = vec![
        beam(6.7e6, Some(2.4e8), 60.8, endless, End::Free),
        beam(3e7, None, 640.0, [-0.2, 12.3], End::Free),
        beam(2e11, None, 12000.0, [-1.0, 13.0], End::Pinned),
        Body::Mass(130.0),
    ];
    let mut joints = Vec::new();
    for i in 0..20 {
        let x = 0.625 * f64::from(i);
        joints.push(Joint { x, a: 0, b: Some(1), law: 0, scale: 1.0 });
        joints.push(Joint { x: x + 0.001, a: 1, b: Some(2), law: 1, scale: 1.0 });
    }
    joints.push(Joint { x: -3.0, a: 0, b: Some(3), law: 0, scale: 0.5 });
    joints.push(Joint { x: -3.0, a: 3, b: None, law: 0, scale: 0.7 });
    joints.push(Joint { x: 5.0, a: 2, b: None, law: 0, scale: 30.0 });
    Line {
        bodies,
        joints,
        names: ["rail", "slab", "girder", "block"].map(String::from).to_vec(),
        ..Line::default()
    }
}

/// Stiffness where the varied line is weak, over that elsewhere.
pub const WEAK: f64 = 0.55;

/// The same with weak stretches of rail and girder, and an endless shaft beside.
pub fn varied() -> Line {
    let mut line = line();
    for (body, interval) in [(0, [3.0, 3.4]), (2, [5.5, 7.1])] {
        let mut section = line.bodies[body];
        if let Body::Beam(b) = &mut section {
            b.interval = interval;
            b.bending *= WEAK;
            b.shear = b.shear.map(|s| s * WEAK);
        }
        line.stretches.push(Stretch { body, section });
    }
    let shaft = Shaft {
        stiffness: c64::new(3e8, 1.5e7),
        mass: 90.0,
        interval: [f64::NEG_INFINITY, f64::INFINITY],
        ends: [End::Free; 2],
    };
    line.bodies.push(Body::Shaft(shaft));
    line.names.push("shaft".into());
    for i in 0..5 {
        let x = 1.3 * f64::from(i);
        line.joints.push(Joint { x, a: 0, b: Some(4), law: 0, scale: 0.2 });
        line.joints.push(Joint { x, a: 4, b: None, law: 0, scale: 0.1 });
    }
    line
}

/// The same with viscous losses beside the others, of their size at some 10 Hz to some 200 Hz.
pub fn viscous() -> Line {
    let mut line = varied();
    let dashpots = |b: &Beam| {
        let shear = b.shear.map_or(0.0, |s| s.re);
        [2e-4 * b.bending.re, 3e-4 * shear, 2.0 * b.mass, 0.01 * b.mass]
    };
    let beams = line.bodies.iter_mut().chain(line.stretches.iter_mut().map(|s| &mut s.section));
    for body in beams {
        if let Body::Beam(b) = body {
            b.dashpots = dashpots(b);
        }
    }
    line
}

/// Stiffness of the line's two laws.
pub fn laws(frequencies: &[f64]) -> Vec<c64> {
    frequencies.iter().flat_map(|f| [c64::new(6e7, 8e6 + f * 1e4), c64::new(2e9, 3e8)]).collect()
}

/// Places on all its bodies, beyond its ends and between joints too.
pub fn points() -> Vec<Point> {
    [(0, -3.0), (0, 4.1), (1, 7.0), (2, 6.3), (0, 40.0), (3, -3.0)].map(|(body, x)| Point { body, x }).to_vec()
}

/// Irregular places: `off` times a number from -1 to 1 that no two `i` share.
pub fn scattered(i: usize, off: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    off * (2.0 * (GOLDEN * (i * i) as f64).fract() - 1.0)
}

/// A rail without end, and a shaft beside it, on `n` springs each, no two lengths between them alike.
pub fn irregular(n: usize) -> Line {
    let endless = [f64::NEG_INFINITY, f64::INFINITY];
    let shaft = Shaft { stiffness: c64::new(3e8, 1.5e7), mass: 90.0, interval: endless, ends: [End::Free; 2] };
    let bodies = vec![beam(6.7e6, Some(2.4e8), 60.8, endless, End::Free), Body::Shaft(shaft)];
    let joints = (0..n).flat_map(|i| {
        let x = 0.6 * i as f64 + scattered(i, 0.05);
        let low = Joint { x: x + 0.2 + scattered(i + n, 0.05), a: 1, b: None, law: 1, scale: 0.01 };
        [Joint { x, a: 0, b: Some(1), law: 0, scale: 1.0 }, low]
    });
    Line {
        bodies,
        joints: joints.collect(),
        names: ["rail", "shaft"].map(String::from).to_vec(),
        ..Line::default()
    }
}
