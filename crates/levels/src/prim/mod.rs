//! Prim (V.1): takes a motion command apart into trajectory points, one every 40 ms.

pub mod motion;
