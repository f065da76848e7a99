//! Minimum times: on a shared machine the least of many repetitions is what the code costs.

use std::time::Instant;

/// Least time in ms of `repeat` calls, after one that warms up.
pub fn least_ms(repeat: usize, mut call: impl FnMut()) -> f64 {
    call();
    (0..repeat)
        .map(|_| {
            let start = Instant::now();
            call();
            start.elapsed().as_secs_f64() * 1e3
        })
        .fold(f64::INFINITY, f64::min)
}

/// Peak resident memory of this process in KiB, where the system tells it.
pub fn peak_memory_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
