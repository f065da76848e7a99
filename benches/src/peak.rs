//! What one core can do at most: fused products and sums, loads and stores of whole registers, and its clock.

use std::{hint::black_box, time::Instant};

/// Numbers in a 512-bit register.
const WIDE: usize = 8;
/// Registers that do not wait for each other: enough to hide the latency of two units.
const CHAINS: usize = 12;
/// Times that all of them are fused, and the operations that makes.
const ROUNDS: usize = 2_000_000;
const FLOPS: f64 = (2 * WIDE * CHAINS * ROUNDS) as f64;
/// Lanes of the kernel that streams: 16 KiB, which the first cache holds.
const STREAM: usize = 2048;

/// Registers that straddle two lines of the cache would cost twice.
#[repr(align(64))]
struct Line([f64; STREAM]);

/// A kernel by the registers that it is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Registers {
    /// 512 bits.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// 256 bits.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// What the target has without being asked.
    Native,
}

impl Registers {
    /// Those of this processor, widest first.
    pub fn here() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        {
            let fused = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let mut all = Vec::new();
            if fused && is_x86_feature_detected!("avx512f") {
                all.push(Self::Avx512);
            }
            if fused {
                all.push(Self::Avx2);
            }
            if !all.is_empty() {
                return all;
            }
        }
        vec![Self::Native]
    }

    /// Name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "AVX-512",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "AVX2",
            Self::Native => "native",
        }
    }

    /// Floating-point operations a second, in 1e9, of products and sums fused in independent registers, on one thread.
    pub fn gflops(self) -> f64 {
        let start = Instant::now();
        self.fuse();
        FLOPS / start.elapsed().as_secs_f64() / 1e9
    }

    /// The same on two threads together: twice as many on two whole cores, fewer where they share.
    pub fn pair_gflops(self) -> f64 {
        let start = Instant::now();
        std::thread::scope(|scope| {
            scope.spawn(|| self.fuse());
            self.fuse();
        });
        2.0 * FLOPS / start.elapsed().as_secs_f64() / 1e9
    }

    fn fuse(self) {
        black_box(match self {
            // SAFETY: `here` gives these kinds only where the processor has the features.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Self::Avx512 => unsafe { fused_avx512(ROUNDS) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Self::Avx2 => unsafe { fused_avx2(ROUNDS) },
            Self::Native => fused(ROUNDS),
        });
    }

    /// Bytes a second, in 1e9, that come from (`store` false) or go back to (true, beside as many loads) the first cache.
    pub fn gbytes(self, store: bool) -> f64 {
        let rounds = 20_000;
        let mut data = Line([1.0; STREAM]);
        let data = &mut data.0;
        let start = Instant::now();
        for _ in 0..rounds {
            match self {
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code)]
                Self::Avx512 => unsafe { stream_avx512(black_box(&mut *data), store) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code)]
                Self::Avx2 => unsafe { stream_avx2(black_box(&mut *data), store) },
                Self::Native => stream(black_box(&mut *data), store),
            }
        }
        (8 * STREAM * rounds) as f64 / start.elapsed().as_secs_f64() / 1e9
    }
}

/// Clock in GHz: sums and turns of integers that wait for each other take one period each.
pub fn gigahertz() -> f64 {
    let (rounds, mut sum) = (50_000_000_u64, 1_u64);
    let step = black_box(3_u64);
    let start = Instant::now();
    for _ in 0..rounds {
        // A turn after each sum keeps the compiler from summing ahead.
        sum = step.wrapping_add(sum).rotate_left(1);
        sum = step.wrapping_add(sum).rotate_left(1);
    }
    black_box(sum);
    4.0 * rounds as f64 / start.elapsed().as_secs_f64() / 1e9
}

#[inline(always)]
fn fused(rounds: usize) -> [[f64; WIDE]; CHAINS] {
    let (a, b) = (black_box([0.999_999; WIDE]), black_box([1e-6; WIDE]));
    let mut sums = black_box([[1.0_f64; WIDE]; CHAINS]);
    for _ in 0..rounds {
        for sum in &mut sums {
            for i in 0..WIDE {
                sum[i] = sum[i].mul_add(a[i], b[i]);
            }
        }
    }
    sums
}

#[inline(always)]
fn stream(data: &mut [f64; STREAM], store: bool) {
    if store {
        for v in data.iter_mut() {
            *v += 1.0;
        }
        return;
    }
    let mut sums = [0.0; 8 * WIDE];
    for block in data.chunks_exact(8 * WIDE) {
        for (sum, v) in sums.iter_mut().zip(block) {
            *sum += v;
        }
    }
    black_box(sums);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
fn fused_avx512(rounds: usize) -> [[f64; WIDE]; CHAINS] {
    fused(rounds)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fused_avx2(rounds: usize) -> [[f64; WIDE]; CHAINS] {
    // Half the chains at a time: sixteen registers hold no more.
    let mut all = [[0.0; WIDE]; CHAINS];
    for part in all.chunks_mut(CHAINS / 2) {
        let (a, b) = (black_box([0.999_999; WIDE]), black_box([1e-6; WIDE]));
        let mut sums = black_box([[1.0_f64; WIDE]; CHAINS / 2]);
        for _ in 0..rounds {
            for sum in &mut sums {
                for i in 0..WIDE {
                    sum[i] = sum[i].mul_add(a[i], b[i]);
                }
            }
        }
        part.copy_from_slice(&sums);
    }
    all
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
fn stream_avx512(data: &mut [f64; STREAM], store: bool) {
    stream(data, store);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn stream_avx2(data: &mut [f64; STREAM], store: bool) {
    stream(data, store);
}
