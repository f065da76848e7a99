//! faer's LU with partial pivoting and one right side, complex, one thread, by order.

#![allow(missing_docs, reason = "criterion's macros make public items without documentation")]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use permway_benches::dense::{self, Reused};
use std::time::Duration;

fn dense_solve(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("dense");
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(800));
    for n in [100, 153, 200, 500, 1000] {
        let (matrix, load) = dense::system(n);
        group.bench_function(BenchmarkId::new("fresh", n), |b| b.iter(|| dense::solve(&matrix, &load)));
        let mut solver = Reused::new(n);
        group.bench_function(BenchmarkId::new("reused", n), |b| {
            b.iter(|| {
                solver.solve(&matrix, &load);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, dense_solve);
criterion_main!(benches);
