//! A line compiled to the operations of one march from left to right.

use super::pieces::{Piece, Pieces};
use crate::{
    element::{LONGEST, terms},
    line::{Body, End, Line, Point, SAME_PLACE},
    shaft::Twist,
    waves::Waves,
};
use std::sync::Arc;

/// Degrees of freedom of one body in the front, and of the others beside it.
#[derive(Debug, Clone)]
pub struct Rows {
    /// First row of the body.
    pub own: usize,
    /// Rows of all other bodies in the front; operations between which none enters or leaves share them.
    pub others: Arc<[usize]>,
    /// Where the operation's record lies in the factor.
    pub record: usize,
    /// The body, for messages.
    pub body: usize,
}

/// One operation of the march.
#[derive(Debug, Clone)]
pub enum Op {
    /// A beam or shaft enters: row, body, whether it comes from infinity, whether its end is pinned.
    StartBeam { own: usize, body: usize, endless: bool, pinned: bool },
    /// A mass enters; weightless where its other half, marched from the other side, brings the weight.
    StartMass { own: usize, body: usize, weightless: bool },
    /// The beam advances by a piece: whether no operation before, and none after, advances by the same one.
    March { rows: Rows, piece: usize, first: bool, last: bool },
    /// A joint between two rows, or a row and the ground.
    Join { joint: usize, a: usize, b: Option<usize>, law: usize, scale: f64 },
    /// A unit force acts on a row.
    Force { row: usize, index: usize },
    /// A sensor reads a row.
    Sense { row: usize, index: usize },
    /// A beam or shaft leaves: whether it runs on to infinity, whether its end is pinned.
    EndBeam { rows: Rows, endless: bool, pinned: bool },
    /// A mass leaves.
    EndMass { rows: Rows },
    /// All that lies to the right joins: rows of this front and of the one marched from the right, and whether
    /// they are rotations, whose sign a mirror turns.
    Meet { rows: Vec<(usize, usize, bool)> },
}

/// What is wanted of the way back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The displacements at the sensors.
    Sensors,
    /// The displacements everywhere: joints and masses too.
    Everywhere,
    /// The forces in the beams besides.
    States,
}

/// Most elements that waves too short for the lengths between joints may add; more would fill the memory.
pub const MOST_ADDED: usize = 250_000;

/// Record of an operation that nothing will read again.
const SCRATCH: usize = usize::MAX;

/// The operations, the distinct pieces, and the sizes they need.
#[derive(Debug, Clone, Default)]
pub struct Tape {
    /// Operations in order from left to right.
    pub ops: Vec<Op>,
    /// Distinct pieces of beam.
    pub pieces: Vec<Piece>,
    /// Places for what is computed of a piece once, from its first march to its last.
    pub slots: usize,
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
    /// Whether the records of lengths of beam hold the impedance at their start too.
    pub states: bool,
    /// What lies beyond the last force and sensor, marched from the right end leftwards.
    pub right: Option<Box<Tape>>,
    /// Whether the line has more elements than can be marched over, and this tape no meaning.
    pub too_long: bool,
}

impl Tape {
    /// Whether this tape or what lies beyond it has no meaning.
    #[must_use]
    pub fn is_too_long(&self) -> bool {
        self.too_long || self.right.as_ref().is_some_and(|right| right.is_too_long())
    }
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
    /// Bodies in the front, ascending.
    live: Vec<usize>,
    /// Rows of the others beside each live body, once asked for.
    others: Vec<Option<Arc<[usize]>>>,
}

impl Front {
    fn take(&mut self, slots: usize, body: usize) -> usize {
        // Beams take row pairs; masses take a pair too and use its first row, to keep pairs whole.
        let own = self.free.pop().unwrap_or_else(|| {
            self.next += 2;
            self.next - 2
        });
        self.forget_others();
        self.rows[body] = (own..own + slots).collect();
        if let Err(place) = self.live.binary_search(&body) {
            self.live.insert(place, body);
        }
        own
    }

    /// Takes a body out that no longer reaches the present place.
    fn leave(&mut self, body: usize) {
        self.forget_others();
        let own = self.rows[body][0];
        self.rows[body].clear();
        self.live.retain(|other| *other != body);
        self.free.push(own);
    }

    fn forget_others(&mut self) {
        for body in &self.live {
            self.others[*body] = None;
        }
    }

    fn others(&mut self, body: usize) -> Arc<[usize]> {
        let (live, rows) = (&self.live, &self.rows);
        let list = || live.iter().filter(|i| **i != body).flat_map(|i| rows[*i].iter().copied()).collect();
        self.others[body].get_or_insert_with(list).clone()
    }
}

struct Compiler<'a> {
    line: &'a Line,
    highest: f64,
    front: Front,
    place: Vec<f64>,
    tape: Tape,
    pieces: Pieces,
    /// Of each body's own section, then of each stretch's, once asked for.
    steepest: Vec<Option<f64>>,
    /// Whether the march goes from the right end leftwards, places then being mirrored.
    mirrored: bool,
    /// Whether records will be read again.
    keep: bool,
    /// Length of the longest record that will not.
    scratch: usize,
    /// Elements beyond one for each length between joints.
    added: usize,
    /// Bodies that reach both sides of the place where the two marches meet.
    crossing: Vec<bool>,
}

impl Compiler<'_> {
    /// Room for `fixed` numbers and W, which has a row for each of the body's own; and for the impedance, if wanted.
    fn record(&mut self, body: usize, fixed: usize, impedance: bool) -> Rows {
        let others = self.front.others(body);
        let block = self.front.rows[body].len() * others.len();
        let size = fixed + block + if impedance { 3 + block } else { 0 };
        let mut record = SCRATCH;
        if self.keep {
            record = self.tape.record_len;
            self.tape.record_len += size;
        } else {
            self.scratch = self.scratch.max(size);
        }
        Rows { own: self.front.rows[body][0], others, record, body }
    }

    /// The exponent of the steepest wave of a section at the highest frequency, 1/m; worked out once for each section.
    fn steepest_of(&mut self, body: usize, stretch: Option<usize>) -> f64 {
        let (line, omega) = (self.line, std::f64::consts::TAU * self.highest);
        let known = &mut self.steepest[stretch.map_or(body, |k| line.bodies.len() + k)];
        *known.get_or_insert_with(|| match line.section(body, stretch) {
            Body::Beam(beam) => Waves::new(beam, omega).steepest(),
            Body::Shaft(shaft) => Twist::new(shaft, omega).exponent().norm(),
            Body::Mass(_) => 0.0,
        })
    }

    fn advance(&mut self, body: usize, x: f64) {
        let length = x - self.place[body];
        if matches!(self.line.bodies[body], Body::Mass(_)) || length <= SAME_PLACE {
            return;
        }
        // The march stops wherever the section changes, so the middle tells for all of it.
        let middle = self.place[body] + 0.5 * length;
        let stretch = self.line.stretch_at(body, if self.mirrored { -middle } else { middle });
        let steepest = self.steepest_of(body, stretch);
        let mut parts = (steepest * length / LONGEST).ceil().max(1.0);
        if parts - 1.0 > MOST_ADDED.saturating_sub(self.added) as f64 {
            self.tape.too_long = true;
            parts = 1.0;
        }
        self.added += parts as usize - 1;
        let each = length / parts;
        let piece = self.pieces.find(body, stretch, each, || terms(steepest * each));
        for _ in 0..parts as usize {
            let rows = self.record(body, 8, self.tape.states);
            self.tape.ops.push(Op::March { rows, piece, first: false, last: false });
        }
        self.place[body] = x;
    }

    fn start(&mut self, body: usize, x: f64) {
        self.place[body] = x;
        match &self.line.bodies[body] {
            Body::Mass(_) => {
                let own = self.front.take(1, body);
                let weightless = self.mirrored && self.crossing[body];
                self.tape.ops.push(Op::StartMass { own, body, weightless });
            }
            b @ (Body::Beam(_) | Body::Shaft(_)) => {
                let own = self.front.take(2, body);
                let end = usize::from(self.mirrored);
                let endless = b.interval().is_some_and(|i| i[end].is_infinite());
                self.tape.ops.push(Op::StartBeam { own, body, endless, pinned: b.ends()[end] == End::Pinned });
            }
        }
    }

    fn end(&mut self, body: usize) {
        let last = usize::from(!self.mirrored);
        // Where the two marches meet, the other one has brought what lies beyond.
        let beyond = !self.crossing[body];
        let op = match &self.line.bodies[body] {
            Body::Mass(_) => Op::EndMass { rows: self.record(body, 1, false) },
            b @ (Body::Beam(_) | Body::Shaft(_)) => Op::EndBeam {
                rows: self.record(body, 4, false),
                endless: beyond && b.interval().is_some_and(|i| i[last].is_infinite()),
                pinned: beyond && b.ends()[last] == End::Pinned,
            },
        };
        self.tape.ops.push(op);
        self.front.leave(body);
    }

    fn perform(&mut self, event: Event, forces: &[Point], sensors: &[Point]) {
        let row = |front: &Front, body: usize| front.rows[body][0];
        self.keep |= matches!(event, Event::Force(_) | Event::Sense(_));
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

/// A place, what happens there, and the bodies it touches.
type Happening = (f64, Event, [Option<usize>; 2]);

/// All that happens, sorted from left to right.
fn events(line: &Line, forces: &[Point], sensors: &[Point]) -> Vec<Happening> {
    let mut all = Vec::new();
    let own = line.bodies.iter().enumerate();
    for (i, body) in own.chain(line.stretches.iter().map(|s| (s.body, &s.section))) {
        let finite = body.interval().into_iter().flatten().filter(|x| x.is_finite());
        all.extend(finite.map(|x| (x, Event::Touch, [Some(i), None])));
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

impl<'a> Compiler<'a> {
    fn new(line: &'a Line, highest: f64, crossing: Vec<bool>, mirrored: bool, keep: bool) -> Self {
        let n = line.bodies.len();
        let tape = Tape { joints: line.joints.len(), ..Tape::default() };
        let front = Front { rows: vec![vec![]; n], others: vec![None; n], ..Front::default() };
        Self {
            line,
            highest,
            front,
            place: vec![f64::NAN; n],
            tape,
            pieces: Pieces::default(),
            steepest: vec![None; n + line.stretches.len()],
            mirrored,
            keep,
            scratch: 0,
            added: 0,
            crossing,
        }
    }

    /// Marches over what happens, in order; bodies end after their last event, unless they cross.
    fn march(&mut self, events: &[Happening], forces: &[Point], sensors: &[Point]) {
        let mut last = vec![None; self.line.bodies.len()];
        for (k, e) in events.iter().enumerate() {
            for body in e.2.into_iter().flatten() {
                last[body] = Some(k);
            }
        }
        for (k, (x, event, bodies)) in events.iter().enumerate() {
            for body in bodies.iter().flatten().copied() {
                if self.front.rows[body].is_empty() {
                    self.start(body, *x);
                } else {
                    self.advance(body, *x);
                }
            }
            self.perform(*event, forces, sensors);
            for body in bodies.iter().flatten().copied() {
                if last[body] == Some(k) && !self.crossing[body] {
                    self.end(body);
                }
            }
        }
    }

    /// Brings the crossing bodies to where the two marches meet.
    fn gather(&mut self, x: f64) {
        for body in 0..self.crossing.len() {
            if self.crossing[body] {
                self.advance(body, x);
            }
        }
    }

    /// The tape, its records behind the scratch that others share.
    fn finish(self) -> Tape {
        let mut tape = self.tape;
        tape.width = self.front.next;
        tape.record_len += self.scratch;
        (tape.pieces, tape.slots) = self.pieces.placed(&mut tape.ops);
        for op in &mut tape.ops {
            if let Op::March { rows, .. } | Op::EndBeam { rows, .. } | Op::EndMass { rows } = op {
                rows.record = if rows.record == SCRATCH { 0 } else { rows.record + self.scratch };
            }
        }
        let first = |wanted: fn(&Op) -> bool| tape.ops.iter().position(wanted).unwrap_or(tape.ops.len());
        let force = first(|op| matches!(op, Op::Force { .. }));
        let sensor = first(|op| matches!(op, Op::Sense { .. }));
        (tape.first_force, tape.first_sensor) = (force, sensor);
        tape
    }
}

impl Tape {
    /// Compiles a checked line for frequencies up to `highest` Hz.
    ///
    /// Unless more is wanted than the sensors, what lies right of the last force and sensor is marched from the other side: nothing of it, nor of what lies
    /// left of the first, has to be kept for the way back.
    pub fn new(line: &Line, forces: &[Point], sensors: &[Point], highest: f64, wanted: Wanted) -> Self {
        let joints = wanted != Wanted::Sensors;
        let events = events(line, forces, sensors);
        let n = line.bodies.len();
        let read = events.iter().filter(|e| matches!(e.1, Event::Force(_) | Event::Sense(_))).map(|e| e.0);
        let meeting = if joints { f64::INFINITY } else { read.fold(f64::NEG_INFINITY, f64::max) };
        let meeting = if meeting == f64::NEG_INFINITY { f64::INFINITY } else { meeting };
        let split = events.partition_point(|e| e.0 <= meeting);
        let (before, beyond) = events.split_at(split);
        let touched = |part: &[Happening]| {
            let mut seen = vec![false; n];
            part.iter().flat_map(|e| e.2.into_iter().flatten()).for_each(|body| seen[body] = true);
            seen
        };
        let crossing: Vec<bool> = touched(before).into_iter().zip(touched(beyond)).map(|(a, b)| a && b).collect();
        let mut c = Compiler::new(line, highest, crossing.clone(), false, joints);
        c.tape.states = wanted == Wanted::States;
        c.march(before, forces, sensors);
        if beyond.is_empty() {
            return c.finish();
        }
        let mut right = Compiler::new(line, highest, crossing, true, false);
        let mut mirrored: Vec<Happening> = beyond.iter().map(|(x, event, bodies)| (-x, *event, *bodies)).collect();
        mirrored
            .sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.partial_cmp(&b.1).unwrap_or(std::cmp::Ordering::Equal)));
        right.march(&mirrored, forces, sensors);
        right.gather(-meeting);
        c.gather(meeting);
        let mut rows = Vec::new();
        for body in 0..n {
            if c.crossing[body] {
                let pair = c.front.rows[body].iter().zip(&right.front.rows[body]);
                rows.extend(pair.enumerate().map(|(i, (l, r))| (*l, *r, i == 1)));
            }
        }
        c.tape.ops.push(Op::Meet { rows });
        for body in 0..n {
            if c.crossing[body] {
                c.end(body);
            }
        }
        let mut tape = c.finish();
        let right = right.finish();
        tape.width = tape.width.max(right.width);
        tape.record_len = tape.record_len.max(right.record_len);
        tape.right = Some(Box::new(right));
        tape
    }
}
