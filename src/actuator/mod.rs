//! The physics of the actuator, nondimensional as in the paper: A. P. Singh,
//! G. Shmuel, A. K. Sharma, "Nonlinear dynamics of miniaturized dielectric
//! elastomer actuators with surface effects". Equation numbers refer to it.
//!
//! * [`parameters`]: what describes an actuator;
//! * [`coefficients`]: parameters folded into the numbers of the equation;
//! * [`drive`]: voltage and prestress as functions of time;
//! * [`motion`]: the equation of motion (Eq. 16) and its energy (Eq. 18);
//! * [`device`]: a real actuator: load, losses, stiffening, electrical port;
//! * [`ensemble`]: many of them side by side;
//! * [`scales`]: the only place with SI units.

pub mod coefficients;
pub mod device;
pub mod drive;
pub mod ensemble;
mod harmonic;
pub mod motion;
pub mod parameters;
pub mod scales;

pub use coefficients::Coefficients;
pub use drive::Drive;
pub use ensemble::Ensemble;
pub use motion::Motion;
pub use parameters::Parameters;
