//! What formulas are written in: numbers of every kind, and zeros of functions.
//!
//! * [`number`]: what an equation may do with a number, so that one formula serves all kinds;
//! * [`lanes`]: numbers in SIMD registers, with their [`sine`];
//! * [`jet`]: numbers that carry their derivatives along;
//! * [`legendre`]: sums of Legendre polynomials;
//! * [`double_double`]: numbers of twice the precision;
//! * [`roots`]: zeros and minima of a function of one number.

pub mod double_double;
pub mod jet;
pub mod lanes;
pub mod legendre;
pub mod number;
pub mod roots;
pub mod sine;
