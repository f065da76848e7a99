//! What one core can do at most, as JSON, by the registers it has.

use permway_benches::peak::{self, Registers};

fn main() {
    let most = |measure: &dyn Fn() -> f64| (0..9).map(|_| measure()).fold(0.0, f64::max);
    let kinds: Vec<String> = Registers::here()
        .into_iter()
        .map(|kind| {
            format!(
                "{{\"registers\": \"{}\", \"fused_gflops\": {:.2}, \"load_gbytes\": {:.1}, \"update_gbytes\": {:.1}}}",
                kind.name(),
                most(&|| kind.gflops()),
                most(&|| kind.gbytes(false)),
                most(&|| kind.gbytes(true)),
            )
        })
        .collect();
    let pair = Registers::here().first().map_or(f64::NAN, |kind| most(&|| kind.pair_gflops()));
    println!(
        "{{\"clock_GHz\": {:.3}, \"pair_gflops\": {pair:.2}, \"kinds\": [{}]}}",
        most(&peak::gigahertz),
        kinds.join(", ")
    );
}
