//! Least time per frequency of a sweep on one thread, and peak memory, as JSON:
//! `line rail|viaduct|viaduct-modes chain|receptance FREQUENCIES [--repeat TIMES]`.

use permway_benches::{
    lines,
    timing::{least_ms, peak_memory_kib},
};
use permway_core::sweep::{Control, Formulation, sweep};
use std::{hint::black_box, process::ExitCode};

const USAGE: &str = "usage: line rail|viaduct|viaduct-modes chain|receptance FREQUENCIES [--repeat TIMES]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
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

fn run(arguments: &[String]) -> Result<String, String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (line, formulation, n, repeat) = match words[..] {
        [line, formulation, n] => (line, formulation, n, "10"),
        [line, formulation, n, "--repeat", repeat] => (line, formulation, n, repeat),
        _ => return Err("wrong arguments".into()),
    };
    let positive = |text: &str| match text.parse::<usize>() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err(format!("'{text}' is not a positive integer")),
    };
    let (n, repeat) = (positive(n)?, positive(repeat)?);
    let case = match line {
        "rail" => lines::rail_on_supports(),
        "viaduct" => lines::viaduct(None),
        "viaduct-modes" => lines::viaduct(Some(60)),
        other => return Err(format!("'{other}' is no line")),
    };
    let chosen = match formulation {
        "chain" => Formulation::Chain,
        "receptance" => Formulation::Receptance,
        other => return Err(format!("'{other}' is no formulation")),
    };
    let (frequencies, laws) = (lines::frequencies(n), case.law_table(n));
    let request = case.request(&frequencies, &laws, chosen, false);
    let answer = sweep(&request, &Control::default()).map_err(|e| e.to_string())?;
    let ms = least_ms(repeat, || {
        black_box(sweep(black_box(&request), &Control::default()).is_ok());
    });
    let (joints, per) = (case.line.joints.len(), ms / n as f64);
    let values = answer.sensors.len() / n;
    let direct: Vec<String> =
        answer.sensors.iter().step_by(values).map(|v| format!("[{:e}, {:e}]", v.re, v.im)).collect();
    let memory = peak_memory_kib().map_or("null".into(), |kib| kib.to_string());
    Ok(format!(
        "{{\"line\": \"{line}\", \"formulation\": \"{formulation}\", \"joints\": {joints}, \
         \"ms_per_frequency\": {per:.6}, \"peak_memory_kib\": {memory}, \"direct_m_per_N\": [{}]}}",
        direct.join(", ")
    ))
}
