//! A line compiled to the operations of one march from left to right.

use crate::{
    element::{LONGEST, terms},
    error::CoreError,
    line::{Beam, Body, End, Line, Point, SAME_PLACE},
    waves::Waves,
};

/// A length of a beam for which the transfer is computed once per frequency.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// Index of the body.
    pub body: usize,
    /// Length in m.
    pub length: f64,
    /// Terms of the series that it needs at the highest frequency.
    pub terms: usize,
}

/// Degrees of freedom of one body in the front, and of the others beside it.
#[derive(Debug, Clone)]
pub struct Rows {
    /// First row of the body.
    pub own: usize,
    /// Rows of all other bodies in the front.
    pub others: Vec<usize>,
    /// Where the operation's record lies in the factor.
    pub record: usize,
    /// The body, for messages.
    pub body: usize,
}

/// One operation of the march.
#[derive(Debug, Clone)]
pub enum Op {
    /// A beam enters: row, body, whether it comes from infinity, whether its end is pinned.
    StartBeam { own: usize, body: usize, endless: bool, pinned: bool },
    /// A mass enters.
    StartMass { own: usize, body: usize },
    /// The beam advances by a piece.
    March { rows: Rows, piece: usize },
    /// A joint between two rows, or a row and the ground.
    Join { joint: usize, a: usize, b: Option<usize>, law: usize, scale: f64 },
    /// A unit force acts on a row.
    Force { row: usize, index: usize },
    /// A sensor reads a row.
    Sense { row: usize, index: usize },
    /// A beam leaves: whether it runs on to infinity, whether its end is pinned.
    EndBeam { rows: Rows, endless: bool, pinned: bool },
    /// A mass leaves.
    EndMass { rows: Rows },
}

/// The operations, the distinct pieces, and the sizes they need.
#[derive(Debug, Clone, Default)]
pub struct Tape {
    /// Operations in order from left to right.
    pub ops: Vec<Op>,
    /// Distinct pieces of beam.
    pub pieces: Vec<Piece>,
    /// Rows of the front at its widest.
    pub width: usize,
    /// Complex numbers a factor holds.
    pub record_len: usize,
    /// Number of joints of the line.
    pub joints: usize,
    /// Index of the first operation that loads; the number of operations if none does.
    pub first_force: usize,
    /// Index of the first operation that reads; the number of operations if none does.
    pub first_sensor: usize,
}

/// What happens at a place on a body; ordered as it must be done there.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
enum Event {
    Touch,
    Join(usize),
    Force(usize),
    Sense(usize),
}

#[derive(Default)]
struct Front {
    free: Vec<usize>,
    next: usize,
    rows: Vec<Vec<usize>>,
}

impl Front {
    fn take(&mut self, slots: usize, body: usize) -> usize {
        // Beams take row pairs; masses take a pair too and use its first row, to keep pairs whole.
        let own = self.free.pop().unwrap_or_else(|| {
            self.next += 2;
            self.next - 2
        });
        self.rows[body] = (own..own + slots).collect();
        own
    }

    fn others(&self, body: usize) -> Vec<usize> {
        self.rows.iter().enumerate().filter(|(i, _)| *i != body).flat_map(|(_, r)| r.iter().copied()).collect()
    }
}

struct Compiler<'a> {
    line: &'a Line,
    highest: f64,
    front: Front,
    place: Vec<f64>,
    tape: Tape,
}

impl Compiler<'_> {
    /// Room for `fixed` numbers and W, which has a row for each of the body's own.
    fn record(&mut self, body: usize, fixed: usize) -> Rows {
        let record = self.tape.record_len;
        let others = self.front.others(body);
        self.tape.record_len += fixed + self.front.rows[body].len() * others.len();
        Rows { own: self.front.rows[body][0], others, record, body }
    }

    fn piece(&mut self, body: usize, length: f64, steepest: f64) -> usize {
        // Lengths that differ by rounding of the coordinates are one piece.
        let same = |p: &Piece| p.body == body && (p.length - length).abs() < 1e-12;
        self.tape.pieces.iter().position(same).unwrap_or_else(|| {
            self.tape.pieces.push(Piece { body, length, terms: terms(steepest * length) });
            self.tape.pieces.len() - 1
        })
    }

    fn advance(&mut self, body: usize, x: f64) {
        let Body::Beam(beam) = &self.line.bodies[body] else { return };
        let length = x - self.place[body];
        if length <= SAME_PLACE {
            return;
        }
        let steepest = Waves::new(beam, std::f64::consts::TAU * self.highest).steepest();
        let parts = (steepest * length / LONGEST).ceil().max(1.0);
        let piece = self.piece(body, length / parts, steepest);
        for _ in 0..parts as usize {
            let rows = self.record(body, 8);
            self.tape.ops.push(Op::March { rows, piece });
        }
        self.place[body] = x;
    }

    fn start(&mut self, body: usize, x: f64) {
        self.place[body] = x;
        match &self.line.bodies[body] {
            Body::Mass(_) => {
                let own = self.front.take(1, body);
                self.tape.ops.push(Op::StartMass { own, body });
            }
            Body::Beam(b) => {
                let own = self.front.take(2, body);
                let endless = b.interval[0].is_infinite();
                self.tape.ops.push(Op::StartBeam { own, body, endless, pinned: b.ends[0] == End::Pinned });
            }
        }
    }

    fn end(&mut self, body: usize) {
        let op = match &self.line.bodies[body] {
            Body::Mass(_) => Op::EndMass { rows: self.record(body, 1) },
            Body::Beam(b) => Op::EndBeam {
                rows: self.record(body, 4),
                endless: b.interval[1].is_infinite(),
                pinned: b.ends[1] == End::Pinned,
            },
        };
        self.tape.ops.push(op);
        let own = self.front.rows[body][0];
        self.front.rows[body].clear();
        self.front.free.push(own);
    }

    fn perform(&mut self, event: Event, forces: &[Point], sensors: &[Point]) {
        let row = |front: &Front, body: usize| front.rows[body][0];
        let op = match event {
            Event::Touch => return,
            Event::Join(i) => {
                let j = self.line.joints[i];
                let (a, b) = (row(&self.front, j.a), j.b.map(|b| row(&self.front, b)));
                Op::Join { joint: i, a, b, law: j.law, scale: j.scale }
            }
            Event::Force(i) => Op::Force { row: row(&self.front, forces[i].body), index: i },
            Event::Sense(i) => Op::Sense { row: row(&self.front, sensors[i].body), index: i },
        };
        self.tape.ops.push(op);
    }
}

/// All events as (place, event, bodies touched), sorted from left to right.
fn events(line: &Line, forces: &[Point], sensors: &[Point]) -> Vec<(f64, Event, [Option<usize>; 2])> {
    let mut all = Vec::new();
    for (i, body) in line.bodies.iter().enumerate() {
        if let Body::Beam(Beam { interval, .. }) = body {
            all.extend(interval.iter().filter(|x| x.is_finite()).map(|&x| (x, Event::Touch, [Some(i), None])));
        }
    }
    all.extend(line.joints.iter().enumerate().map(|(i, j)| (j.x, Event::Join(i), [Some(j.a), j.b])));
    all.extend(forces.iter().enumerate().map(|(i, p)| (p.x, Event::Force(i), [Some(p.body), None])));
    all.extend(sensors.iter().enumerate().map(|(i, p)| (p.x, Event::Sense(i), [Some(p.body), None])));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Places closer than SAME_PLACE become one, so that what happens there has one order.
    let mut at = f64::NEG_INFINITY;
    for e in &mut all {
        if e.0 - at > SAME_PLACE {
            at = e.0;
        }
        e.0 = at;
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.partial_cmp(&b.1).unwrap_or(std::cmp::Ordering::Equal)));
    all
}

impl Tape {
    /// Compiles a checked line for frequencies up to `highest` Hz.
    ///
    /// # Errors
    /// `Invalid` if a force or sensor sits on a mass that nothing joins.
    pub fn new(line: &Line, forces: &[Point], sensors: &[Point], highest: f64) -> Result<Self, CoreError> {
        let events = events(line, forces, sensors);
        let n = line.bodies.len();
        // First and last event of each body.
        let mut last = vec![None; n];
        for (k, e) in events.iter().enumerate() {
            for body in e.2.into_iter().flatten() {
                last[body] = Some(k);
            }
        }
        let tape = Tape { joints: line.joints.len(), ..Tape::default() };
        let front = Front { rows: vec![vec![]; n], ..Front::default() };
        let mut c = Compiler { line, highest, front, place: vec![f64::NAN; n], tape };
        for (k, (x, event, bodies)) in events.iter().enumerate() {
            for body in bodies.iter().flatten().copied() {
                if c.front.rows[body].is_empty() {
                    c.start(body, *x);
                } else {
                    c.advance(body, *x);
                }
            }
            c.perform(*event, forces, sensors);
            for body in bodies.iter().flatten().copied() {
                if last[body] == Some(k) {
                    c.end(body);
                }
            }
        }
        let mut tape = c.tape;
        tape.width = c.front.next;
        let first = |wanted: fn(&Op) -> bool| tape.ops.iter().position(wanted).unwrap_or(tape.ops.len());
        let (force, sensor) =
            (first(|op| matches!(op, Op::Force { .. })), first(|op| matches!(op, Op::Sense { .. })));
        (tape.first_force, tape.first_sensor) = (force, sensor);
        Ok(tape)
    }
}
