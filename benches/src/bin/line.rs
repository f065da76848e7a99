//! Least time per frequency of a sweep, and peak memory, as JSON:
//! `line LAYOUT chain|receptance FREQUENCIES [--repeat TIMES] [--threads N] [--points wheels|middle|ends]`.

use permway_benches::{
    lines,
    timing::{least_ms, peak_memory_kib},
};
use permway_core::sweep::{Control, Formulation, sweep};
use std::{hint::black_box, process::ExitCode};

const USAGE: &str = "usage: line LAYOUT chain|receptance FREQUENCIES [--repeat TIMES] [--threads N] \
                     [--points wheels|middle|ends]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match run(&words) {
        Ok(row) => {
            println!("{row}");
            ExitCode::SUCCESS
        }
        Err(what) => {
            eprintln!("{what}\n{USAGE}");
            ExitCode::from(2)
        }
    }
}

fn run(words: &[&str]) -> Result<String, String> {
    let [layout, formulation, n, options @ ..] = words else { return Err("wrong arguments".into()) };
    let (n, mut repeat, mut threads, mut points) = (positive(n)?, 10, 1, "wheels");
    for option in options.chunks(2) {
        match *option {
            ["--repeat", times] => repeat = positive(times)?,
            ["--threads", number] => threads = positive(number)?,
            ["--points", places] => points = places,
            _ => return Err(format!("'{}' is no option, or has no value", option[0])),
        }
    }
    let case = lines::layout(layout).ok_or(format!("'{layout}' is no layout: {}", lines::NAMES))?;
    let case = match points {
        "wheels" => case,
        "middle" => case.at_middle(),
        "ends" => case.at_ends(),
        other => return Err(format!("'{other}' names no points")),
    };
    let chosen = match *formulation {
        "chain" => Formulation::Chain,
        "receptance" => Formulation::Receptance,
        other => return Err(format!("'{other}' is no formulation")),
    };
    let (frequencies, laws) = (lines::frequencies(n), case.law_table(n));
    let request = case.request(&frequencies, &laws, chosen, threads);
    let failed = sweep(&request, &Control::default()).map_err(|e| e.to_string())?.failures.len();
    let ms = least_ms(repeat, || {
        black_box(sweep(black_box(&request), &Control::default()).is_ok());
    });
    let memory = peak_memory_kib().map_or("null".into(), |kib| kib.to_string());
    Ok(format!(
        "{{\"layout\": \"{layout}\", \"formulation\": \"{formulation}\", \"points\": \"{points}\", \
         \"threads\": {threads}, \"spans\": {}, \"joints\": {}, \"frequencies\": {n}, \"failed\": {failed}, \
         \"us_per_frequency\": {:.6}, \"peak_memory_kib\": {memory}}}",
        case.spans,
        case.line.joints.len(),
        1e3 * ms / n as f64,
    ))
}

fn positive(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err(format!("'{text}' is not a positive integer")),
    }
}
