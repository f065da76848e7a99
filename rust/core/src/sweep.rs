//! Many frequencies, on several threads.
//!
//! Threads live for one sweep: nothing is started at import, nothing has to survive a fork, and
//! several sweeps may run at once.

use crate::{
    c64,
    chain::{Engine, Group, Response, Tape},
    error::CoreError,
    lanes::LANES,
    line::{Line, Point},
    receptance::Dense,
};
use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};

/// How the response is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formulation {
    /// Exact impedance marched along the line.
    Chain,
    /// Green's functions and one dense system per frequency.
    Receptance,
}

/// What is asked for.
#[derive(Debug, Clone)]
pub struct Request<'a> {
    /// The line.
    pub line: &'a Line,
    /// Frequencies in Hz, positive.
    pub frequencies: &'a [f64],
    /// Complex stiffness per frequency and law, N/m: `laws[i * n_laws + law]`.
    pub laws: &'a [c64],
    /// Number of laws.
    pub n_laws: usize,
    /// Places of unit forces.
    pub forces: &'a [Point],
    /// Places of displacement sensors.
    pub sensors: &'a [Point],
    /// Formulation.
    pub formulation: Formulation,
    /// Whether the extension of every joint is wanted.
    pub joints: bool,
    /// Number of threads, at least 1.
    pub threads: usize,
}

/// What comes back.
#[derive(Debug, Clone, Default)]
pub struct Answer {
    /// Receptance, frequency x sensor x force, m/N.
    pub sensors: Vec<c64>,
    /// Joint extension, frequency x joint x force, m/N; empty unless asked for.
    pub joints: Vec<c64>,
    /// Frequencies that failed, by index; their responses are NaN.
    pub failures: Vec<(usize, CoreError)>,
}

/// Progress and a wish to stop, seen by all threads.
#[derive(Debug, Default)]
pub struct Control {
    /// Set to stop the sweep at the next frequency.
    pub cancel: AtomicBool,
    /// Frequencies done.
    pub done: AtomicUsize,
    /// Set when the last thread has ended.
    pub ended: AtomicBool,
}

/// What a failed frequency leaves.
const NAN: c64 = c64::new(f64::NAN, f64::NAN);

enum Plan {
    Chain(Tape),
    Receptance(Dense),
}

impl Request<'_> {
    fn check(&self) -> Result<(), CoreError> {
        if let Some((i, f)) = self.frequencies.iter().enumerate().find(|(_, f)| !(f.is_finite() && **f > 0.0)) {
            return Err(CoreError::Invalid(format!("frequency {i} is {f} Hz: it must be positive and finite")));
        }
        if self.laws.len() != self.n_laws * self.frequencies.len() {
            return Err(CoreError::Invalid(format!(
                "{} stiffnesses for {} laws at {} frequencies",
                self.laws.len(),
                self.n_laws,
                self.frequencies.len()
            )));
        }
        self.line.check(self.n_laws, self.forces, self.sensors)
    }
}

/// Runs a sweep. A frequency that fails is reported and leaves NaN; the others stand.
///
/// # Errors
/// `Invalid` before anything is computed, `Cancelled` if asked to stop.
pub fn sweep(request: &Request<'_>, control: &Control) -> Result<Answer, CoreError> {
    request.check()?;
    let (s, j, f) = (request.sensors.len(), request.line.joints.len(), request.forces.len());
    let n = request.frequencies.len();
    let (s_len, j_len) = (s * f, if request.joints { j * f } else { 0 });
    let mut answer = Answer { sensors: vec![NAN; n * s_len], joints: vec![NAN; n * j_len], failures: Vec::new() };
    let plan = match request.formulation {
        Formulation::Chain => {
            let highest = request.frequencies.iter().copied().fold(0.0, f64::max);
            Plan::Chain(Tape::new(request.line, request.forces, request.sensors, highest, request.joints))
        }
        Formulation::Receptance => Plan::Receptance(Dense::new(request.line, request.forces, request.sensors)),
    };
    let failures = Mutex::new(Vec::new());
    let jobs = Mutex::new(Jobs { next: 0, sensors: &mut answer.sensors, joints: &mut answer.joints });
    std::thread::scope(|scope| {
        for _ in 1..request.threads.min(n) {
            scope.spawn(|| work(request, &plan, control, &jobs, &failures, (s_len, j_len)));
        }
        work(request, &plan, control, &jobs, &failures, (s_len, j_len));
    });
    control.ended.store(true, Ordering::Release);
    if control.cancel.load(Ordering::Relaxed) {
        return Err(CoreError::Cancelled);
    }
    answer.failures = failures.into_inner().unwrap_or_else(PoisonError::into_inner);
    answer.failures.sort_by_key(|(i, _)| *i);
    Ok(answer)
}

/// What is left to do: the next frequency and the places where answers go.
struct Jobs<'a> {
    next: usize,
    sensors: &'a mut [c64],
    joints: &'a mut [c64],
}

impl<'a> Jobs<'a> {
    /// Hands out the next frequencies, at most `most`: the first one's index and the places of their answers.
    fn take(&mut self, most: usize, total: usize, lengths: (usize, usize)) -> Option<Job<'a>> {
        let (first, count) = (self.next, most.min(total - self.next));
        if count == 0 {
            return None;
        }
        self.next += count;
        Some(Job {
            first,
            count,
            sensors: split(&mut self.sensors, count * lengths.0),
            joints: split(&mut self.joints, count * lengths.1),
        })
    }
}

/// Frequencies for one thread, and where their answers go.
struct Job<'a> {
    first: usize,
    count: usize,
    sensors: &'a mut [c64],
    joints: &'a mut [c64],
}

/// Takes the first `n` items off a slice that is being handed out.
fn split<'a>(slice: &mut &'a mut [c64], n: usize) -> &'a mut [c64] {
    let (head, tail) = std::mem::take(slice).split_at_mut(n);
    *slice = tail;
    head
}

/// One thread's share: takes the next frequencies until none is left.
fn work(
    request: &Request<'_>,
    plan: &Plan,
    control: &Control,
    jobs: &Mutex<Jobs<'_>>,
    failures: &Mutex<Vec<(usize, CoreError)>>,
    lengths: (usize, usize),
) {
    let mut solver = Solver::new(request, plan);
    let total = request.frequencies.len();
    while !control.cancel.load(Ordering::Relaxed) {
        let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).take(solver.group(), total, lengths);
        let Some(mut job) = job else { return };
        let errors = solver.run(request, &mut job);
        for (lane, error) in errors {
            job.sensors[lane * lengths.0..(lane + 1) * lengths.0].fill(NAN);
            job.joints[lane * lengths.1..(lane + 1) * lengths.1].fill(NAN);
            failures.lock().unwrap_or_else(PoisonError::into_inner).push((job.first + lane, error));
        }
        control.done.fetch_add(job.count, Ordering::Relaxed);
    }
}

/// A plan with the memory that one thread needs to run it.
enum Solver<'a> {
    Chain(&'a Tape, Box<Engine>),
    Receptance(&'a Dense),
}

impl<'a> Solver<'a> {
    fn new(request: &Request<'_>, plan: &'a Plan) -> Self {
        match plan {
            Plan::Chain(tape) => Self::Chain(tape, Box::new(Engine::new(tape, request.forces.len()))),
            Plan::Receptance(dense) => Self::Receptance(dense),
        }
    }

    /// Frequencies that it takes at once.
    fn group(&self) -> usize {
        match self {
            Self::Chain(..) => LANES,
            Self::Receptance(_) => 1,
        }
    }

    /// Runs a job; returns the frequencies that failed, counted from the job's first.
    fn run(&mut self, request: &Request<'_>, job: &mut Job<'_>) -> Vec<(usize, CoreError)> {
        let (n, last) = (request.n_laws, job.first + job.count - 1);
        let laws = &request.laws[job.first * n..(last + 1) * n];
        match self {
            Self::Receptance(dense) => {
                let frequency = request.frequencies[job.first];
                let result = dense.respond(request.line, frequency, laws, job.sensors, job.joints);
                result.err().map(|e| (0, e)).into_iter().collect()
            }
            Self::Chain(tape, engine) => {
                // Lanes that are left over repeat the last frequency.
                let frequencies = std::array::from_fn(|i| request.frequencies[(job.first + i).min(last)]);
                let group = Group { frequencies, laws, n_laws: n };
                let mut out = Response {
                    sensors: &mut *job.sensors,
                    joints: &mut *job.joints,
                    n_sensors: request.sensors.len(),
                    n_forces: request.forces.len(),
                    used: job.count,
                };
                let failed = engine.run(tape, request.line, &group, &mut out);
                failed.iter().take(job.count).enumerate().filter_map(|(i, e)| Some((i, e.clone()?))).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::{Beam, Body, End, Joint};

    fn beam(bending: f64, shear: Option<f64>, mass: f64, interval: [f64; 2], end: End) -> Body {
        let loss = c64::new(1.0, 0.02);
        Body::Beam(Beam {
            bending: loss * bending,
            shear: shear.map(|s| loss * s),
            mass,
            rotary: if shear.is_some() { 0.25 } else { 0.0 },
            interval,
            ends: [end; 2],
            modes: None,
        })
    }

    /// Rail, slab and girder with unevenly placed joints, and a mass between two of them.
    fn line() -> Line {
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

    fn run(line: &Line, frequencies: &[f64], formulation: Formulation, threads: usize) -> Answer {
        let laws: Vec<c64> =
            frequencies.iter().flat_map(|f| [c64::new(6e7, 8e6 + f * 1e4), c64::new(2e9, 3e8)]).collect();
        let points: Vec<Point> = [(0, -3.0), (0, 4.1), (1, 7.0), (2, 6.3), (0, 40.0), (3, -3.0)]
            .map(|(body, x)| Point { body, x })
            .to_vec();
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

    /// The code for this processor and the code for every processor do the same sums.
    #[test]
    fn portable_code_agrees() {
        let line = line();
        let points: Vec<Point> = [(0, -3.0), (1, 7.0), (2, 6.3)].map(|(body, x)| Point { body, x }).to_vec();
        let tape = Tape::new(&line, &points, &points, 700.0, false);
        let laws: Vec<c64> = (0..LANES).flat_map(|_| [c64::new(6e7, 8e6), c64::new(2e9, 3e8)]).collect();
        let group =
            Group { frequencies: std::array::from_fn(|i| 100.0 * (i + 1) as f64 - 50.0), laws: &laws, n_laws: 2 };
        let mut answers = Vec::new();
        for mut engine in [Engine::new(&tape, 3), Engine::portable(&tape, 3)] {
            let mut sensors = vec![c64::ZERO; LANES * 9];
            let mut out =
                Response { sensors: &mut sensors, joints: &mut [], n_sensors: 3, n_forces: 3, used: LANES };
            assert!(engine.run(&tape, &line, &group, &mut out).iter().all(Option::is_none));
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
}
