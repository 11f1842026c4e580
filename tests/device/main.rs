//! The real actuator against multiprecision references, closed forms and the balance of energy.

mod periods;
mod scene;
mod scenes;
