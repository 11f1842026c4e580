//! What the library does, in one program: what is generic is compiled once for all of its tests.
//!
//! `memory.rs` counts what the allocator gives, and needs a program of its own.

mod calls;
mod clocked;
mod description;
mod device;
mod largest;
mod processor_time;
mod pull_in;
mod sensitivity;
mod si;
mod skips;
mod solver;
mod stress;
mod sweep;
