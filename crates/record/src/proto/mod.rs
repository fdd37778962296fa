//! Messages of the log's channels: protobuf for buffers, transforms and log lines, CDR for the two ROS messages with
//! the joints and the description of the cell.
//!
//! * [`wire`]: the wire format;
//! * [`descriptor`]: a record's schema as protobuf descriptors, so that the file describes itself;
//! * [`message`]: conversion of a record's byte image into a protobuf message;
//! * [`typed`]: messages of structs, with texts and lists of any length;
//! * [`foxglove`]: messages that viewers interpret;
//! * [`scene`]: shapes and texts that viewers draw;
//! * [`ros`]: `JointState` and `String`.

pub mod descriptor;
pub mod foxglove;
pub mod message;
pub mod ros;
pub mod scene;
pub mod typed;
pub mod wire;
