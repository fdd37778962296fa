//! What is around the processes in the tests of this package: each device and each neighbour once, as an automaton.
//! Unit tests script what it does, and the searches of `pairs` try everything that it may do.

pub mod air;
pub mod emove;
pub mod jaws;
pub mod line;
pub mod ring;
pub mod rotary;
pub mod t3i;
pub mod worker;
