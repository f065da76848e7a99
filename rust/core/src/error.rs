//! What can go wrong in the core, with the numbers.

use thiserror::Error;

/// Why a line was refused, or could not be solved at one frequency.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CoreError {
    /// The description of the line or of the request is not usable.
    #[error("{0}")]
    Invalid(String),
    /// A pivot vanished: some body can move without resistance at this frequency.
    #[error("singular at {frequency} Hz: {place} can move without resistance")]
    Singular {
        /// Frequency in Hz.
        frequency: f64,
        /// Body or joint at which the elimination broke down.
        place: String,
    },
    /// Infinity or not-a-number appeared.
    #[error("not finite at {frequency} Hz: {place}")]
    NonFinite {
        /// Frequency in Hz.
        frequency: f64,
        /// What was not finite.
        place: String,
    },
    /// The answer would carry fewer than about four correct digits.
    #[error("badly conditioned at {frequency} Hz: {place}, relative error about {estimate:.1e}")]
    IllConditioned {
        /// Frequency in Hz.
        frequency: f64,
        /// Where the digits were lost.
        place: String,
        /// Estimated relative error of the answer.
        estimate: f64,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
