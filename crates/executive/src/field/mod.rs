//! Devices behind Modbus couplers, over TCP.
//!
//! ```text
//!   run ── Orders, once per tick ──► latest ──► thread of the device: couplers::Session
//!       ◄─ Report ─────────────────◄ latest ◄──   │ one request at a time
//!                                                 ▼
//!                                               link ── TCP ── coupler, or station
//! ```
//!
//! * [`device`]: a device with its thread, which keeps the grid of the run's clock by itself;
//! * [`latest`]: the newest value from one thread to another, without waiting;
//! * [`link`]: the connection to a coupler;
//! * [`lock`]: one process of this machine at a time writes a device;
//! * [`neighbour`]: whether the system can deliver old packets after a loss of its link;
//! * [`station`]: a server with an emulated coupler.

pub mod device;
pub mod latest;
pub mod link;
pub mod lock;
pub mod neighbour;
pub mod station;

pub use self::{
    device::{Device, DeviceError},
    link::TcpLink,
    lock::Lock,
    station::{Clients, Station, StationError},
};
