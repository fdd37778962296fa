//! The environment of the processes in the tests of this package: each device and each neighbour once, as an
//! automaton. Unit tests script its behaviour, and the searches of `pairs` try every possible one.

pub mod air;
pub mod emove;
pub mod jaws;
pub mod line;
pub mod ring;
pub mod rotary;
pub mod t3i;
pub mod worker;
