//! The real actuator against multiprecision references, closed forms and the balance of energy.

mod balance;
#[path = "../clocked/mod.rs"]
mod clocked;
mod damped;
mod endpoint_only;
#[path = "../largest/mod.rs"]
mod largest;
mod periods;
mod plain;
mod published;
mod scene;
mod scenes;
mod steady;
mod thresholds;
mod trajectory;
