//! Messages of the log's channels: protobuf for buffers, transforms and log lines, CDR for the two ROS
//! messages that carry joints and the description of the cell.
//!
//! * [`wire`]: the wire format;
//! * [`descriptor`]: a record's schema as protobuf descriptors, so that a reader needs only the file;
//! * [`message`]: a record's byte image as a protobuf message;
//! * [`foxglove`]: messages whose meaning viewers know;
//! * [`scene`]: solids and names that viewers draw;
//! * [`ros`]: `JointState` and `String`.

pub mod descriptor;
pub mod foxglove;
pub mod message;
pub mod ros;
pub mod scene;
pub mod wire;
