//! Messages of the log's channels: protobuf for buffers, transforms and log lines, CDR for the two ROS messages.

pub mod descriptor;
pub mod foxglove;
pub mod message;
pub mod ros;
pub mod scene;
pub mod typed;
pub mod wire;
