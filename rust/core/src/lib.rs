//! The mechanics of permway, without Python in it.
//!
//! A [`Line`](line::Line) is bodies (beams, shafts and masses) tied by joints. Two formulations give its
//! harmonic response to unit forces: [`receptance`] joins Green's functions of the beams in one
//! dense system per frequency, [`chain`] marches an exact impedance along the line. [`sweep`]
//! runs either over many frequencies on several threads.
//!
//! SI units, `exp(+i omega t)`, displacement positive down, receptance in m/N.

pub mod chain;
pub mod dense;
pub mod dual;
pub mod element;
pub mod energy;
pub mod error;
pub mod field;
pub mod green;
pub mod lanes;
pub mod line;
pub mod modes;
pub mod parts;
pub mod receptance;
pub mod sensitivity;
pub mod shaft;
pub mod small;
pub mod sweep;
pub mod waves;
pub mod welch;

/// Complex number of the whole core; the same type as faer's `c64`.
#[allow(non_camel_case_types)]
pub type c64 = num_complex::Complex<f64>;
