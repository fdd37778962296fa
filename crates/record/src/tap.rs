//! Another receiver of the messages of a log while it is written.

/// Receives the channels and messages of a log while it is written, in the writer's thread and in the order of
/// their times. It ends with the log. The writer waits for it: a slow tap delays the log, but not the tick.
pub trait Tap: Send {
    fn channel(&mut self, id: u16, channel: &Channel<'_>);

    /// A message of a channel, with its time in nanoseconds since 1970.
    fn message(&mut self, channel: u16, time: u64, data: &[u8]);

    /// All messages of a tick have been written, possibly none; its time as above.
    fn tick(&mut self, time: u64) {
        let _ = time;
    }
}

/// Description of a channel of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel<'a> {
    pub topic: &'a str,
    /// Encoding of the messages: `protobuf`, `cdr`.
    pub encoding: &'a str,
    pub schema_name: &'a str,
    /// Encoding of the schema: `protobuf`, `ros2msg`.
    pub schema_encoding: &'a str,
    pub schema: &'a [u8],
}
