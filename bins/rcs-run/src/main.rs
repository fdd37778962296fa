//! The RCS-II/T3 controller.
fn main() {}
