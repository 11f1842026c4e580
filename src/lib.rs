//! The motion of a miniaturized dielectric elastomer actuator, and its FMI 2.0 unit for
//! co-simulation and model exchange.
//!
//! The modules in the order in which data flows through them:
//!
//! 1. [`arithmetic`]: what formulas are written in: lanes of numbers, derivatives, double-double;
//! 2. [`solver`]: integrators of second-order equations of motion;
//! 3. [`ensemble`]: many motions at once, one in each SIMD lane;
//! 4. [`actuator`]: the physics: equation of motion (Eq. 16 of the paper), energy, voltage;
//! 5. [`pull_in`]: the voltages beyond which the actuator collapses;
//! 6. [`model`]: what a model has to say, and what its table of variables is made of;
//! 7. [`nondimensional`]: the model of the paper: its table, what a host sets, what a host reads;
//! 8. [`si`]: the model of the real actuator in SI units;
//! 9. [`sweep`]: many scenes at once; [`sensitivity`]: derivatives of a motion with respect to its
//!    parameters. Both need no host;
//! 10. [`description`]: a table as `modelDescription.xml`;
//! 11. [`instance`]: phases, checks and communication steps of an instance;
//! 12. `fmi2`: the C functions of FMI 2.0, the only room with unsafe code (feature `fmi`).
//!
//! Life of an instance: `fmi2Instantiate` makes an [`instance::Instance`] with the start values of
//! the table. Setters change its scene, for example [`nondimensional::scene::Scene`]. At the end of
//! initialization an [`instance::Run`] begins the motion of the scene; each `fmi2DoStep` continues it. Getters compute a result through a
//! [`model::View`]. `fmi2FreeInstance` frees everything.
//!
//! The paper is Akhil Pratap Singh, Gal Shmuel and Atul Kumar Sharma, *Nonlinear dynamics of
//! miniaturized dielectric elastomer actuators with surface effects*.

pub mod actuator;
pub mod arithmetic;
pub mod description;
pub mod ensemble;
#[cfg(feature = "fmi")]
pub mod fmi2;
pub mod instance;
pub mod model;
pub mod nondimensional;
pub mod pull_in;
pub mod sensitivity;
mod shortest;
pub mod si;
pub mod solver;
pub mod sweep;
