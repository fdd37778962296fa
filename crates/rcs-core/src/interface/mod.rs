//! The buffers between processes, and between the controller and its devices: chapters V and VI.

pub mod device;
