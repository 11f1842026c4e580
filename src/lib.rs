//! FMI 2.0 unit, for co-simulation and model exchange, of a miniaturized
//! dielectric elastomer actuator.
//!
//! The modules in the order in which data flows through them:
//!
//! 1. [`solver`]: the integrator of a second-order equation of motion;
//! 2. [`actuator`]: the physics, Eq. 16 of the paper, folded and driven;
//! 3. [`pull_in`]: the voltages beyond which the actuator collapses;
//! 4. [`scene`]: what a host sets; [`view`]: what it reads;
//! 5. [`sweep`]: many scenes at once, and [`sensitivity`]: how a motion depends on
//!    its parameters, both for who needs no host;
//! 6. [`variables`]: the table that gives both their names and limits;
//! 7. [`description`]: the table as `modelDescription.xml`;
//! 8. [`slave`]: phases, checks and communication steps of an instance;
//! 9. [`abi`]: the C functions of FMI 2.0, the only room with unsafe code.
//!
//! Life of an instance: `fmi2Instantiate` makes a [`slave::Instance`] with the
//! start values of the table; setters change its [`scene::Scene`]; at the end of
//! initialization a [`slave::Run`] folds the scene into a motion and follows it,
//! `fmi2DoStep` by `fmi2DoStep`; getters compute what is read, through a
//! [`view::View`]; `fmi2FreeInstance` drops it all.

#[cfg(feature = "fmi")]
pub mod abi;
pub mod actuator;
pub mod description;
pub mod model;
pub mod nondimensional;
pub mod pull_in;
pub mod scene;
pub mod sensitivity;
mod shortest;
pub mod slave;
pub mod solver;
pub mod sweep;
pub mod variables;
pub mod view;
