//! The real actuator against multiprecision references, closed forms and the balance of energy.

mod balance;
mod damped;
mod endpoint_only;
mod periods;
mod plain;
mod published;
mod scene;
mod scenes;
mod steady;
mod thresholds;
mod trajectory;
