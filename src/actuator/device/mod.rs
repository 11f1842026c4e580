//! The physics of a real actuator beyond the paper: load, losses, stiffening, electrical port.
//!
//! * [`parameters`]: what describes it, nondimensional;
//! * [`damped`]: the paper's equation with damping;
//! * [`elasticity`]: neo-Hookean, Gent and Yeoh;
//! * [`equation`]: its equation of motion and its first-order states;
//! * [`motion`]: these as a system for the integrator;
//! * [`energy`]: what is stored, lost and supplied.

pub mod damped;
pub mod elasticity;
pub mod energy;
pub mod equation;
pub mod geometry;
pub mod motion;
pub mod parameters;

pub use damped::DampedMotion;
pub use elasticity::{Elasticity, Locking};
pub use energy::{Exchanged, Stored};
pub use equation::LocalDevice;
pub use motion::DeviceMotion;
pub use parameters::{Branch, Breakdown, Damping, Device, Permittivity, Port, Source, Spring};
