//! What the benches measure: dense complex systems, and lines with a request to sweep.

pub mod dense;
pub mod lines;
pub mod timing;
