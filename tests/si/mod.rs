//! The actuator in SI units as a host sees it, without the C functions.

mod at_once;
mod dependencies;
mod derivatives;
mod drive;
mod exchange;
mod field;
mod host;
mod instant;
mod integrator;
mod motion;
mod overflow;
mod presets;
mod refusals;
mod scaling;
