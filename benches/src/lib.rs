//! What the benches measure: dense complex systems, lines with a request to sweep, and the processor's own peak.

pub mod dense;
pub mod lines;
pub mod peak;
pub mod timing;
