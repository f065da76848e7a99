//! A sweep of whole lines in both formulations, one thread; throughput is frequencies per second.

#![allow(missing_docs, reason = "criterion's macros make public items without documentation")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use permway_benches::lines::{self, Case};
use permway_core::sweep::{Control, Formulation, sweep};

fn one(criterion: &mut Criterion, name: &str, case: &Case, formulation: Formulation, n: usize) {
    let mut group = criterion.benchmark_group("line");
    let (frequencies, laws) = (lines::frequencies(n), case.law_table(n));
    group.throughput(Throughput::Elements(n as u64)).sample_size(20);
    group.bench_function(BenchmarkId::new(name, format!("{formulation:?}")), |b| {
        b.iter(|| sweep(&case.request(&frequencies, &laws, formulation, false), &Control::default()));
    });
    group.finish();
}

fn line_sweep(criterion: &mut Criterion) {
    let (rail, closed, modal) = (lines::rail_on_supports(), lines::viaduct(None), lines::viaduct(Some(60)));
    one(criterion, "rail_241_supports", &rail, Formulation::Chain, 200);
    one(criterion, "rail_241_supports", &rail, Formulation::Receptance, 10);
    one(criterion, "viaduct_51_fasteners", &closed, Formulation::Chain, 200);
    one(criterion, "viaduct_51_fasteners", &closed, Formulation::Receptance, 10);
    one(criterion, "viaduct_51_fasteners_60_modes", &modal, Formulation::Receptance, 10);
}

criterion_group!(benches, line_sweep);
criterion_main!(benches);
