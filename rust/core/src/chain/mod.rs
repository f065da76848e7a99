//! The chain formulation: an exact impedance marched along the line.
//!
//! The front holds every body that reaches the present place: its state is the symmetric matrix Z
//! that gives the forces needed at the front to move it, everything to the left included. A joint
//! adds to Z; a length of beam transforms the two rows of that beam; a body that ends is
//! condensed. This is block elimination of the block tridiagonal system of exact (spectral)
//! elements, done beam by beam so that only two-by-two matrices are inverted, and in mixed form
//! (flexibility in series, stiffness in parallel) so that short elements lose no digits. The cost
//! is linear in the number of joints; nothing is truncated.
//!
//! What lies right of the last force and sensor is marched from the right end leftwards, and the
//! two fronts meet there: only between the first and the last force or sensor is anything kept for
//! the way back.
//!
//! [`tape`] compiles a line to a list of operations that all frequencies share ([`pieces`] finds the
//! lengths between joints that are alike), [`factor`] runs it forward for several frequencies side by side, [`solve`] runs loads forward and displacements
//! backward; [`gradient`] sums derivatives on that way back, and [`own`] finds each joint's own flexibility. [`engine`] chooses the code for the processor at hand.

mod engine;
mod factor;
mod gradient;
mod own;
mod pieces;
mod solve;
mod tape;

pub use engine::{Engine, Job, Vectors};
pub use factor::Group;
pub use solve::Response;
pub use tape::{MOST_ADDED, Tape, Wanted};
