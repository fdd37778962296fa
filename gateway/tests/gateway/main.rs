//! The acceptance of the gateway, with processes: a run, its gateway, and neighbours connected through it.
//!
//! They need `rcs-run` and `rcs-neighbour`: `cargo build --release --workspace` in the repository.

mod attacks;
mod browser;
mod certificates;
mod claims;
mod crowds;
mod cuts;
mod line;
mod native;
mod operators;
mod page;
mod script;
mod shop;
mod status;
