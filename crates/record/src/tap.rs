/// Receives the channels and messages of a log while it is written, in the writer's thread and in the order of
/// their times. The tap ends with the log. The writer waits for it, so a slow tap delays the log, but not the tick.
pub trait Tap: Send {
    fn channel(&mut self, id: u16, channel: &Channel<'_>);

    /// A message of a channel, and its time in nanoseconds since 1970.
    fn message(&mut self, channel: u16, time: u64, data: &[u8]);

    /// All messages of a tick, possibly none, have been written. `time` is as above.
    fn tick(&mut self, time: u64) {
        let _ = time;
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel<'a> {
    pub topic: &'a str,
    pub encoding: &'a str, // `protobuf`, `cdr`
    pub schema_name: &'a str,
    pub schema_encoding: &'a str, // `protobuf`, `ros2msg`
    pub schema: &'a [u8],
}
