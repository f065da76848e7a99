//! Many frequencies, on several threads.
//!
//! Threads live for one sweep: nothing is started at import, nothing has to survive a fork, and
//! several sweeps may run at once.

use crate::{
    c64,
    chain::{self, Engine, Group, MOST_ADDED, Response, Tape, Wanted},
    error::CoreError,
    lanes::LANES,
    line::{Line, Point},
    receptance::Dense,
    sensitivity::Sensitivity,
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
    /// Derivatives, frequency x parameter x sensor x force; empty unless asked for.
    pub derivatives: Vec<c64>,
    /// Extension of each joint by a unit tension in itself, frequency x joint, m/N; empty unless asked for.
    pub own: Vec<c64>,
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
    sweep_with(request, None, control)
}

/// Runs a sweep that gives derivatives beside the response; they need the chain.
///
/// # Errors
/// As [`sweep`].
pub fn sweep_with(
    request: &Request<'_>,
    derived: Option<&Sensitivity<'_>>,
    control: &Control,
) -> Result<Answer, CoreError> {
    request.check()?;
    let n = request.frequencies.len();
    let mut answers = lengths(request, derived).map(|length| vec![c64::ZERO; n * length]);
    let failures = sweep_into(request, derived, control, answers.each_mut().map(Vec::as_mut_slice))?;
    let [sensors, joints, derivatives, own] = answers;
    Ok(Answer { sensors, joints, derivatives, own, failures })
}

/// Numbers per frequency in the answers: sensors, joints, derivatives, own extensions.
pub fn lengths(request: &Request<'_>, derived: Option<&Sensitivity<'_>>) -> [usize; 4] {
    let (s, j, f) = (request.sensors.len(), request.line.joints.len(), request.forces.len());
    let derivatives = derived.map_or(0, |d| d.len(request.line));
    let own = if derived.is_some_and(|d| d.own) { j } else { 0 };
    [s * f, if request.joints { j * f } else { 0 }, derivatives, own]
}

/// Runs a sweep into given memory, a row of [`lengths`] for each frequency; returns what failed.
///
/// # Errors
/// As [`sweep`]; the memory then holds nothing of meaning.
pub fn sweep_into(
    request: &Request<'_>,
    derived: Option<&Sensitivity<'_>>,
    control: &Control,
    answers: [&mut [c64]; 4],
) -> Result<Vec<(usize, CoreError)>, CoreError> {
    request.check()?;
    let (line, n) = (request.line, request.frequencies.len());
    if let Some(wanted) = derived {
        wanted.check(line, request.forces.len())?;
        if request.formulation == Formulation::Receptance {
            return Err(CoreError::Invalid("derivatives are given by the chain formulation only".into()));
        }
    }
    let lengths = lengths(request, derived);
    if answers.iter().zip(lengths).any(|(memory, length)| memory.len() != n * length) {
        return Err(CoreError::Invalid(format!("memory for {n} frequencies of {lengths:?} numbers is needed")));
    }
    let plan = match request.formulation {
        Formulation::Chain => {
            let highest = request.frequencies.iter().copied().fold(0.0, f64::max);
            let wanted = match derived {
                Some(d) if d.bodies => Wanted::States,
                Some(_) => Wanted::Everywhere,
                None if request.joints => Wanted::Everywhere,
                None => Wanted::Sensors,
            };
            let tape = Tape::new(line, request.forces, request.sensors, highest, wanted);
            if tape.is_too_long() {
                let what = format!(
                    "waves at {highest} Hz are too short: the line would need more than {MOST_ADDED} elements"
                );
                return Err(CoreError::Invalid(what));
            }
            Plan::Chain(tape)
        }
        Formulation::Receptance => Plan::Receptance(Dense::new(line, request.forces, request.sensors)),
    };
    let failures = Mutex::new(Vec::new());
    let task = Task { request, derived, plan: &plan, lengths };
    let jobs = Mutex::new(Jobs { next: 0, answers });
    std::thread::scope(|scope| {
        for _ in 1..request.threads.min(n) {
            scope.spawn(|| work(&task, control, &jobs, &failures));
        }
        work(&task, control, &jobs, &failures);
    });
    control.ended.store(true, Ordering::Release);
    if control.cancel.load(Ordering::Relaxed) {
        return Err(CoreError::Cancelled);
    }
    let mut failures = failures.into_inner().unwrap_or_else(PoisonError::into_inner);
    failures.sort_by_key(|(i, _)| *i);
    Ok(failures)
}

/// What all threads work at, and how many numbers a frequency has in each of the answers.
struct Task<'a> {
    request: &'a Request<'a>,
    derived: Option<&'a Sensitivity<'a>>,
    plan: &'a Plan,
    lengths: [usize; 4],
}

/// What is left to do: the next frequency and the places where answers go.
struct Jobs<'a> {
    next: usize,
    answers: [&'a mut [c64]; 4],
}

impl<'a> Jobs<'a> {
    /// Hands out the next frequencies, at most `most`: the first one's index and the places of their answers.
    fn take(&mut self, most: usize, total: usize, lengths: &[usize; 4]) -> Option<Job<'a>> {
        let (first, count) = (self.next, most.min(total - self.next));
        if count == 0 {
            return None;
        }
        self.next += count;
        let mut lengths = lengths.iter();
        let answers =
            self.answers.each_mut().map(|slice| split(slice, count * lengths.next().copied().unwrap_or(0)));
        Some(Job { first, count, answers })
    }
}

/// Frequencies for one thread, and where their answers go: sensors, joints, derivatives, own flexibilities.
struct Job<'a> {
    first: usize,
    count: usize,
    answers: [&'a mut [c64]; 4],
}

/// Takes the first `n` items off a slice that is being handed out.
fn split<'a>(slice: &mut &'a mut [c64], n: usize) -> &'a mut [c64] {
    let (head, tail) = std::mem::take(slice).split_at_mut(n);
    *slice = tail;
    head
}

/// One thread's share: takes the next frequencies until none is left.
fn work(task: &Task<'_>, control: &Control, jobs: &Mutex<Jobs<'_>>, failures: &Mutex<Vec<(usize, CoreError)>>) {
    let mut solver = Solver::new(task);
    let total = task.request.frequencies.len();
    while !control.cancel.load(Ordering::Relaxed) {
        let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).take(solver.group(), total, &task.lengths);
        let Some(mut job) = job else { return };
        let errors = solver.run(task, &mut job);
        for (lane, error) in errors {
            for (values, length) in job.answers.iter_mut().zip(task.lengths) {
                values[lane * length..(lane + 1) * length].fill(NAN);
            }
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
    fn new(task: &Task<'a>) -> Self {
        match task.plan {
            Plan::Chain(tape) => {
                let derived = task.derived.map(|d| (d, task.request.line));
                Self::Chain(tape, Box::new(Engine::new(tape, task.request.forces.len(), derived)))
            }
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
    fn run(&mut self, task: &Task<'_>, job: &mut Job<'_>) -> Vec<(usize, CoreError)> {
        let request = task.request;
        let (n, last) = (request.n_laws, job.first + job.count - 1);
        let laws = &request.laws[job.first * n..(last + 1) * n];
        let [sensors, joints, derivatives, own] = &mut job.answers;
        match self {
            Self::Receptance(dense) => {
                let frequency = request.frequencies[job.first];
                let result = dense.respond(request.line, frequency, laws, sensors, joints);
                result.err().map(|e| (0, e)).into_iter().collect()
            }
            Self::Chain(tape, engine) => {
                // Lanes that are left over repeat the last frequency.
                let frequencies = std::array::from_fn(|i| request.frequencies[(job.first + i).min(last)]);
                let group = Group { frequencies, laws, n_laws: n };
                let mut out = Response {
                    sensors,
                    joints,
                    derivatives,
                    own,
                    n_sensors: request.sensors.len(),
                    n_forces: request.forces.len(),
                    used: job.count,
                };
                let chain = chain::Job { tape, line: request.line, group: &group, derived: task.derived };
                let failed = engine.run(&chain, &mut out);
                failed.iter().take(job.count).enumerate().filter_map(|(i, e)| Some((i, e.clone()?))).collect()
            }
        }
    }
}
