//! The march compiled for several kinds of processor, the best chosen when it runs.

use super::{
    factor::{Factor, Group},
    solve::{Loads, Response},
    tape::Tape,
};
use crate::{
    error::CoreError,
    lanes::{Fuse, Fused, LANES, Plain},
    line::Line,
};

/// Memory of one thread for one line, and the code that works on it.
#[derive(Debug, Clone)]
pub struct Engine(Kind);

#[derive(Debug, Clone)]
enum Kind {
    /// 512-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx512(Work<Fused>),
    /// 256-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx2(Work<Fused>),
    /// What every processor of the architecture has.
    Portable(Work<PortableFuse>),
}

/// On this architecture every processor fuses products and sums.
#[cfg(target_arch = "aarch64")]
type PortableFuse = Fused;
/// A fused product would be a function call where the processor has none.
#[cfg(not(target_arch = "aarch64"))]
type PortableFuse = Plain;

#[derive(Debug, Clone)]
struct Work<F> {
    factor: Factor<F>,
    loads: Loads<F>,
}

impl<F: Fuse> Work<F> {
    fn new(tape: &Tape, forces: usize) -> Self {
        Self { factor: Factor::new(tape), loads: Loads::new(tape, forces) }
    }

    #[inline(always)]
    fn run(&mut self, tape: &Tape, line: &Line, group: &Group<'_>, out: &mut Response<'_>) {
        self.factor.run(tape, line, group);
        self.loads.respond(tape, &mut self.factor, out);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
fn run_avx512(w: &mut Work<Fused>, tape: &Tape, line: &Line, group: &Group<'_>, out: &mut Response<'_>) {
    w.run(tape, line, group, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(w: &mut Work<Fused>, tape: &Tape, line: &Line, group: &Group<'_>, out: &mut Response<'_>) {
    w.run(tape, line, group, out);
}

impl Engine {
    /// Room for a tape and so many forces.
    pub fn new(tape: &Tape, forces: usize) -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let fused = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let wide = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq");
            if fused && wide {
                return Self(Kind::Avx512(Work::new(tape, forces)));
            }
            if fused {
                return Self(Kind::Avx2(Work::new(tape, forces)));
            }
        }
        Self::portable(tape, forces)
    }

    /// The code that every processor of the architecture runs.
    pub fn portable(tape: &Tape, forces: usize) -> Self {
        Self(Kind::Portable(Work::new(tape, forces)))
    }

    /// Answers a group of frequencies; returns why lanes failed, whose answers are of no meaning.
    pub fn run(
        &mut self,
        tape: &Tape,
        line: &Line,
        group: &Group<'_>,
        out: &mut Response<'_>,
    ) -> &[Option<CoreError>; LANES] {
        match &mut self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(w) => {
                // SAFETY: `new` chose this kind after it found the features on this processor.
                #[allow(unsafe_code)]
                unsafe {
                    run_avx512(w, tape, line, group, out);
                }
                &w.factor.failed
            }
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(w) => {
                // SAFETY: as above.
                #[allow(unsafe_code)]
                unsafe {
                    run_avx2(w, tape, line, group, out);
                }
                &w.factor.failed
            }
            Kind::Portable(w) => {
                w.run(tape, line, group, out);
                &w.factor.failed
            }
        }
    }
}
