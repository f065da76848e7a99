//! The march compiled for several kinds of processor, the best chosen when it runs.

use super::{
    factor::{Factor, Group},
    gradient::Sums,
    own::Flexibility,
    solve::{Loads, Response},
    tape::Tape,
};
use crate::{
    error::CoreError,
    lanes::{Fuse, Fused, LANES, Plain},
    line::Line,
    sensitivity::Sensitivity,
};

/// What is solved.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    /// The line compiled.
    pub tape: &'a Tape,
    /// The line itself.
    pub line: &'a Line,
    /// The frequencies, and the laws at them.
    pub group: &'a Group<'a>,
    /// Derivatives wanted beside the response; the same as the engine was made for.
    pub derived: Option<&'a Sensitivity<'a>>,
}

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
    sums: Option<Sums<F>>,
    own: Option<Flexibility<F>>,
}

impl<F: Fuse> Work<F> {
    fn new(tape: &Tape, forces: usize, derived: Option<(&Sensitivity<'_>, &Line)>) -> Self {
        Self {
            factor: Factor::new(tape),
            loads: Loads::new(tape, forces),
            sums: derived.filter(|(s, line)| !s.is_empty(line)).map(|(s, l)| Sums::new(s, l, tape, forces)),
            own: derived.filter(|(s, _)| s.own).map(|_| Flexibility::new(tape)),
        }
    }

    #[inline(always)]
    fn run(&mut self, job: &Job<'_>, out: &mut Response<'_>) {
        let Job { tape, line, group, derived } = *job;
        self.factor.run(tape, line, group);
        let mut gradient = match (&mut self.sums, derived) {
            (Some(sums), Some(wanted)) => {
                let derivatives = (std::mem::take(&mut out.derivatives), out.used);
                Some(sums.begin(wanted, line, &self.factor, derivatives))
            }
            _ => None,
        };
        self.loads.respond(tape, &mut self.factor, out, &mut gradient);
        if let Some(gradient) = gradient {
            out.derivatives = gradient.write();
        }
        if let Some(own) = &mut self.own {
            own.run(tape, &self.factor, out.own, out.used);
        }
        self.loads.finite(&mut self.factor, out);
    }
}

// All of the march is compiled into each of the three functions below. A module for each lets the compiler work at them
// side by side: it divides a crate by modules.

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use super::{Fused, Job, Response, Work};

    #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
    pub fn run(w: &mut Work<Fused>, job: &Job<'_>, out: &mut Response<'_>) {
        w.run(job, out);
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Fused, Job, Response, Work};

    #[target_feature(enable = "avx2,fma")]
    pub fn run(w: &mut Work<Fused>, job: &Job<'_>, out: &mut Response<'_>) {
        w.run(job, out);
    }
}

mod portable {
    use super::{Job, PortableFuse, Response, Work};

    #[inline(never)]
    pub fn run(w: &mut Work<PortableFuse>, job: &Job<'_>, out: &mut Response<'_>) {
        w.run(job, out);
    }
}

/// Vector instructions that the march uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vectors {
    /// Eight numbers at once.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// Four numbers at once.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// What every processor of the architecture has.
    Portable,
}

impl Vectors {
    /// The widest of this processor.
    #[must_use]
    pub fn here() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let fused = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let wide = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq");
            if fused {
                return if wide { Self::Avx512 } else { Self::Avx2 };
            }
        }
        Self::Portable
    }

    /// Name and width for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "AVX-512, 512 bits",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "AVX2, 256 bits",
            Self::Portable => "portable",
        }
    }
}

impl Engine {
    /// Room for a tape, so many forces, and what is derived.
    pub fn new(tape: &Tape, forces: usize, derived: Option<(&Sensitivity<'_>, &Line)>) -> Self {
        match Vectors::here() {
            #[cfg(target_arch = "x86_64")]
            Vectors::Avx512 => Self(Kind::Avx512(Work::new(tape, forces, derived))),
            #[cfg(target_arch = "x86_64")]
            Vectors::Avx2 => Self(Kind::Avx2(Work::new(tape, forces, derived))),
            Vectors::Portable => Self::portable(tape, forces, derived),
        }
    }

    /// The code that every processor of the architecture runs.
    pub fn portable(tape: &Tape, forces: usize, derived: Option<(&Sensitivity<'_>, &Line)>) -> Self {
        Self(Kind::Portable(Work::new(tape, forces, derived)))
    }

    /// Answers a group of frequencies; returns why lanes failed, whose answers are of no meaning.
    pub fn run(&mut self, job: &Job<'_>, out: &mut Response<'_>) -> &[Option<CoreError>; LANES] {
        match &mut self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(w) => {
                // SAFETY: `new` chose this kind after it found the features on this processor.
                #[allow(unsafe_code)]
                unsafe {
                    avx512::run(w, job, out);
                }
                &w.factor.failed
            }
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(w) => {
                // SAFETY: as above.
                #[allow(unsafe_code)]
                unsafe {
                    avx2::run(w, job, out);
                }
                &w.factor.failed
            }
            Kind::Portable(w) => {
                portable::run(w, job, out);
                &w.factor.failed
            }
        }
    }
}
