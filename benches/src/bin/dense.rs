//! Least time of a dense complex solve by faer, as JSON: `dense 100 200 500 1000 --repeat 30`.

use permway_benches::{
    dense::{self, Reused},
    timing::least_ms,
};
use std::{hint::black_box, process::ExitCode};

fn main() -> ExitCode {
    let mut orders = Vec::new();
    let mut repeat = 30;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let number = if argument == "--repeat" { arguments.next().unwrap_or_default() } else { argument.clone() };
        match number.parse::<usize>() {
            Ok(number) if number > 0 && argument == "--repeat" => repeat = number,
            Ok(number) if number > 0 => orders.push(number),
            _ => {
                eprintln!("'{number}': a positive integer is needed; usage: dense ORDER... [--repeat TIMES]");
                return ExitCode::from(2);
            }
        }
    }
    let rows: Vec<String> = orders
        .iter()
        .map(|&n| {
            let (matrix, load) = dense::system(n);
            let mut solver = Reused::new(n);
            let fresh = least_ms(repeat, || {
                black_box(dense::solve(black_box(&matrix), &load));
            });
            let reused = least_ms(repeat, || {
                black_box(solver.solve(black_box(&matrix), &load));
            });
            let residual = dense::residual(&matrix, solver.solve(&matrix, &load), &load);
            format!(
                "{{\"n\": {n}, \"fresh_ms\": {fresh:.6}, \"reused_ms\": {reused:.6}, \"residual\": {residual:.2e}}}"
            )
        })
        .collect();
    println!("[{}]", rows.join(", "));
    ExitCode::SUCCESS
}
