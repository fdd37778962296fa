//! The dump: one line per frame, with time and direction. A pause separates frames.

use std::time::{Duration, Instant};

use depc::wire::{Control, FRAME_BYTES, Response, START};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameDirection {
    Sent,
    Received,
}

/// Prints the bytes of the line, if the dump is on.
pub struct Dump {
    on: bool,
    on_stderr: bool, // true if standard output is used for the JSON object
    begun: Instant,
    /// Received bytes that are not printed yet, with the times of the first and the last of them.
    pending: Vec<u8>,
    first: Instant,
    last: Instant,
}

/// A longer pause ends a frame: the time of five bytes at 9600 baud.
const PAUSE: Duration = Duration::from_millis(5);

impl Dump {
    #[must_use]
    pub fn new(on: bool, json: bool) -> Self {
        let now = Instant::now();
        Self { on, on_stderr: json, begun: now, pending: Vec::new(), first: now, last: now }
    }

    pub fn show(&mut self, now: Instant, way: FrameDirection, bytes: &[u8]) {
        if !self.on || bytes.is_empty() {
            return;
        }
        if way == FrameDirection::Sent {
            self.flush();
            self.print(now, way, bytes);
            return;
        }
        if now.saturating_duration_since(self.last) > PAUSE {
            self.flush();
        }
        if self.pending.is_empty() {
            self.first = now;
        }
        self.last = now;
        self.pending.extend(bytes);
    }

    pub fn flush(&mut self) {
        if !self.pending.is_empty() {
            self.print(self.first, FrameDirection::Received, &self.pending);
            self.pending.clear();
        }
    }

    fn print(&self, at: Instant, way: FrameDirection, bytes: &[u8]) {
        let line = line(at.saturating_duration_since(self.begun).as_secs_f64(), way, bytes);
        if self.on_stderr {
            os_io::stderr_line!("{line}");
        } else {
            os_io::stdout_line!("{line}");
        }
    }
}

/// `   1.234567 > 03 00 ...  data`: seconds, direction (`>` to the robot), bytes, and their meaning as far as known.
fn line(seconds: f64, way: FrameDirection, bytes: &[u8]) -> String {
    let arrow = match way {
        FrameDirection::Sent => '>',
        FrameDirection::Received => '<',
    };
    let hex: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    format!("{seconds:11.6} {arrow} {:47}  {}", hex.join(" "), name(way, bytes)).trim_end().to_owned()
}

fn name(way: FrameDirection, bytes: &[u8]) -> &'static str {
    match (way, bytes) {
        (FrameDirection::Sent, [START, ..]) if bytes.len() == FRAME_BYTES => "data",
        (FrameDirection::Sent, [byte]) => match Control::from_byte(*byte) {
            Some(Control::Restart) => "restart",
            Some(Control::Cancel) => "cancel",
            None => "",
        },
        (FrameDirection::Received, [byte]) => match Response::from_byte(*byte) {
            Some(Response::Ack) => "ACK",
            Some(Response::Nak) => "NAK",
            None => "",
        },
        (FrameDirection::Received, [0xFF, 0xFF, START, ..]) if bytes.len() == FRAME_BYTES => "report",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_time_direction_and_name() {
        assert_eq!(
            line(1.25, FrameDirection::Received, &[0x06]),
            "   1.250000 < 06                                               ACK"
        );
        let data = [3, 0, 0, 0, 0, 0xE7, 0x68, 0xFD, 0x85, 0xDC, 0xD8, 0x34, 0xB7, 0, 0, 0x73];
        assert_eq!(
            line(0.0, FrameDirection::Sent, &data),
            "   0.000000 > 03 00 00 00 00 E7 68 FD 85 DC D8 34 B7 00 00 73  data"
        );
        assert_eq!(name(FrameDirection::Sent, &[5]), "restart");
        assert_eq!(name(FrameDirection::Received, &data), "", "a report begins otherwise");
        assert!(line(0.0, FrameDirection::Received, &[0x41]).ends_with("41"));
    }
}
