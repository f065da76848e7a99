//! One run of one case and nothing else, to be counted by callgrind: `instructions LAYOUT chain|receptance FREQUENCIES`
//! or `instructions dense ORDER SOLVES`.

use permway_benches::{
    dense::{self, Reused},
    lines,
};
use permway_core::sweep::{Control, Formulation, sweep};
use std::{hint::black_box, process::ExitCode};

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["dense", order, solves] => {
            order.parse().ok().zip(solves.parse().ok()).map(|(n, times)| systems(n, times))
        }
        [layout, formulation, n] => n.parse().ok().and_then(|n| line(layout, formulation, n)),
        _ => None,
    };
    if done == Some(true) {
        return ExitCode::SUCCESS;
    }
    eprintln!(
        "usage: instructions LAYOUT chain|receptance FREQUENCIES, or dense ORDER SOLVES; layouts: {}",
        lines::NAMES
    );
    ExitCode::from(2)
}

fn systems(n: usize, times: usize) -> bool {
    let ((matrix, load), mut solver) = (dense::system(n), Reused::new(n));
    for _ in 0..times {
        black_box(solver.solve(black_box(&matrix), &load));
    }
    true
}

fn line(layout: &str, formulation: &str, n: usize) -> Option<bool> {
    let case = lines::layout(layout)?;
    let formulation = match formulation {
        "chain" => Formulation::Chain,
        "receptance" => Formulation::Receptance,
        _ => return None,
    };
    let (frequencies, laws) = (lines::frequencies(n), case.law_table(n));
    let answer = sweep(&case.request(&frequencies, &laws, formulation, 1), &Control::default()).ok()?;
    Some(black_box(answer).failures.is_empty())
}
