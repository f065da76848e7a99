//! Sweeps of whole lines: every layout by the chain, the smaller by receptance too, one and two threads.
//! Throughput is frequencies per second.

#![allow(missing_docs, reason = "criterion's macros make public items without documentation")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use permway_benches::lines;
use permway_core::sweep::{Control, Formulation, sweep};
use std::time::Duration;

/// Layout, formulation, frequencies.
const CASES: [(&str, Formulation, usize); 8] = [
    ("rail", Formulation::Chain, 512),
    ("sleepers", Formulation::Chain, 512),
    ("viaduct-1", Formulation::Chain, 512),
    ("viaduct-10", Formulation::Chain, 128),
    ("viaduct-100", Formulation::Chain, 64),
    ("rail", Formulation::Receptance, 8),
    ("viaduct-1", Formulation::Receptance, 8),
    ("viaduct-modes", Formulation::Receptance, 8),
];

fn line_sweep(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("line");
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(800));
    for (name, formulation, n) in CASES {
        let Some(case) = lines::layout(name) else { continue };
        let (frequencies, laws) = (lines::frequencies(n), case.law_table(n));
        group.throughput(Throughput::Elements(n as u64));
        for threads in [1, 2] {
            let id = BenchmarkId::new(format!("{name}/{formulation:?}"), format!("threads {threads}"));
            group.bench_function(id, |b| {
                b.iter(|| sweep(&case.request(&frequencies, &laws, formulation, threads), &Control::default()));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, line_sweep);
criterion_main!(benches);
