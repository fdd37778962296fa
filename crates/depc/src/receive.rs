//! The receivers of both ends, which find frames in the received bytes.
//!
//! A byte may be changed, lost, duplicated or late. Each receiver holds a bounded number of bytes and finds the next
//! frame after any garbage. A tick without bytes (40 ms) ends an incomplete frame, which takes 17 ms.

use rcs_core::Plain;

use crate::link::LinkBytes;
use crate::{
    Error, Plate,
    wire::{Control, DataCommand, FRAME_BYTES, Report, Response, START},
};

/// Bytes of the controller's receiver board (ASSUMED; the appendix expects one command in it).
pub const BOARD_BYTES: usize = 64;
const GARBLED_TICKS: u8 = 3; // until garbage gets a NAK on a line that is not quiet
const FRAME_TICKS: u8 = 2; // later bytes may be another command in place of a lost byte

/// A command received by the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// A data command with a correct checksum.
    Data(DataCommand),
    /// Cancel or restart.
    Control(Control),
    /// Bytes that are not a command; the answer is a NAK. The buffer is empty.
    Undecipherable,
}

/// The receiver of the controller, with its buffer (A 2.3 "the buffer on the RS232 board").
///
/// Bytes after a bad byte must not be read as commands: a data frame without its first byte may contain a cancel.
/// Therefore the receiver discards all bytes until the line is quiet; the NAK follows then.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct CommandReceiver {
    bytes: [u8; BOARD_BYTES],
    length: u8,
    /// True if no byte arrived in this tick.
    quiet: bool,
    /// Ticks since a bad byte; 0 for none.
    garbled: u8,
    /// Number of ticks with an incomplete frame at the front.
    begun: u8,
}

impl CommandReceiver {
    /// Adds the bytes of a tick, which may be none. Bytes that do not fit are garbage.
    pub fn accept(&mut self, rx: &LinkBytes) {
        let bytes = rx.as_slice();
        self.quiet = bytes.is_empty();
        for byte in bytes {
            match self.bytes.get_mut(usize::from(self.length)) {
                Some(slot) => {
                    *slot = *byte;
                    self.length = self.length.saturating_add(1);
                }
                None => self.garbled = self.garbled.max(1),
            }
        }
    }

    /// The next command, if complete.
    pub fn take(&mut self) -> Option<Command> {
        if self.garbled > 0 {
            self.clear();
            if self.quiet || self.garbled >= GARBLED_TICKS {
                self.garbled = 0;
                return Some(Command::Undecipherable);
            }
            self.garbled = self.garbled.saturating_add(1);
            return None;
        }
        let held = self.bytes.get(..usize::from(self.length)).unwrap_or_default();
        let first = *held.first()?;
        if first == START {
            return self.data();
        }
        // Several restarts in a row are one restart that the host has repeated. No other bytes may follow, because the
        // host waits for an answer. The late end of a frame may begin with the byte of a cancel.
        let same = held.iter().take_while(|byte| **byte == first).count();
        match Control::from_byte(first) {
            Some(control) if same == held.len() => {
                self.drop_first(same);
                Some(Command::Control(control))
            }
            _ => {
                self.clear();
                self.garbled = 1;
                None
            }
        }
    }

    /// Drop all received bytes.
    pub fn clear(&mut self) {
        self.drop_first(BOARD_BYTES);
    }

    fn data(&mut self) -> Option<Command> {
        let held = self.bytes.get(..usize::from(self.length)).unwrap_or_default();
        let Some(frame) = held.first_chunk::<FRAME_BYTES>() else {
            if self.quiet {
                self.clear();
                return Some(Command::Undecipherable);
            }
            self.begun = self.begun.saturating_add(1);
            if self.begun >= FRAME_TICKS {
                self.clear();
                self.garbled = 1;
            }
            return None;
        };
        // Only restarts may follow. The checksum is also correct if the late end of a frame's first copy comes first.
        let behind = held.get(FRAME_BYTES..).unwrap_or_default();
        let alone = behind.iter().all(|byte| *byte == Control::Restart.byte());
        match DataCommand::parse(frame) {
            Ok(command) if alone => {
                self.drop_first(FRAME_BYTES);
                Some(Command::Data(command))
            }
            _ if behind.is_empty() => {
                self.clear();
                Some(Command::Undecipherable)
            }
            _ => {
                self.clear();
                self.garbled = 1;
                None
            }
        }
    }

    fn drop_first(&mut self, count: usize) {
        self.begun = 0;
        let length = usize::from(self.length);
        let count = count.min(length);
        self.bytes.rotate_left(count);
        let left = length.saturating_sub(count);
        self.bytes.iter_mut().skip(left).for_each(|byte| *byte = 0);
        self.length = u8::try_from(left).unwrap_or(u8::MAX);
    }
}

/// A reply received by the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reply {
    /// ACK or NAK.
    Response(Response),
    /// A report with a correct checksum.
    Report(Plate),
    /// A report with an incorrect checksum.
    BadChecksum,
    /// A byte that belongs to no reply.
    Garbage,
}

/// The receiver of the host; it holds one report.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ReplyReceiver {
    bytes: [u8; FRAME_BYTES],
    length: u8,
}

impl ReplyReceiver {
    /// Add one byte.
    pub fn push(&mut self, byte: u8) -> Option<Reply> {
        if self.length == 0
            && let Some(response) = Response::from_byte(byte)
        {
            return Some(Reply::Response(response));
        }
        if let Some(slot) = self.bytes.get_mut(usize::from(self.length)) {
            *slot = byte;
            self.length = self.length.saturating_add(1);
        }
        if !self.may_begin(0) {
            // A third FF keeps the last two; any other byte ends the search and may be an answer after noise.
            self.resynchronise();
            let answer = Response::from_byte(byte).filter(|_| self.length == 0);
            return Some(answer.map_or(Reply::Garbage, Reply::Response));
        }
        if usize::from(self.length) < FRAME_BYTES {
            return None;
        }
        let report = Report::parse(&self.bytes);
        match report {
            Ok(Report { plate }) => {
                self.clear();
                Some(Reply::Report(plate))
            }
            Err(Error::BadChecksum { .. }) => {
                self.resynchronise();
                Some(Reply::BadChecksum)
            }
            Err(_) => {
                self.resynchronise();
                Some(Reply::Garbage)
            }
        }
    }

    /// Process a tick without bytes: drop an incomplete frame. Returns true if there was one.
    pub fn idle(&mut self) -> bool {
        let begun = self.length > 0;
        self.clear();
        begun
    }

    /// Drop all received bytes.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    fn may_begin(&self, place: usize) -> bool {
        let held = self.bytes.iter().take(usize::from(self.length)).skip(place);
        held.zip(Report::HEAD).all(|(byte, head)| *byte == head)
    }

    fn resynchronise(&mut self) {
        let length = usize::from(self.length);
        let place = (1..length).find(|place| self.may_begin(*place)).unwrap_or(length);
        self.bytes.rotate_left(place.min(FRAME_BYTES));
        let left = length.saturating_sub(place);
        self.bytes.iter_mut().skip(left).for_each(|byte| *byte = 0);
        self.length = u8::try_from(left).unwrap_or_default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::NO_FUNCTION;
    use proptest::prelude::*;

    const HOME: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };

    fn bytes(of: &[u8]) -> LinkBytes {
        let mut link = LinkBytes::default();
        assert_eq!(link.extend(of), of.len());
        link
    }

    fn command() -> [u8; 16] {
        let mut frame = [0xA5; 16];
        DataCommand { function: NO_FUNCTION, plate: HOME }.emit(&mut frame);
        frame
    }

    fn report() -> [u8; 16] {
        let mut frame = [0xA5; 16];
        Report { plate: HOME }.emit(&mut frame);
        frame
    }

    fn tick(receiver: &mut CommandReceiver, of: &[u8]) -> Option<Command> {
        receiver.accept(&bytes(of));
        receiver.take()
    }

    fn all(receiver: &mut ReplyReceiver, of: &[u8]) -> Vec<Reply> {
        of.iter().filter_map(|byte| receiver.push(*byte)).collect()
    }

    #[test]
    fn a_command_may_come_in_two_ticks() {
        let mut receiver = CommandReceiver::default();
        assert_eq!(tick(&mut receiver, &command()[..7]), None);
        assert_eq!(
            tick(&mut receiver, &command()[7..]),
            Some(Command::Data(DataCommand { function: NO_FUNCTION, plate: HOME }))
        );
        assert_eq!(receiver.take(), None);
    }

    #[test]
    fn frame_over_three_ticks_is_discarded() {
        let mut frame = [0; 16]; // it has lost a byte, and the host's restart happens to be that byte
        DataCommand { function: NO_FUNCTION, plate: Plate { words: [1, 2, 3, 4, 9000, 0x055F] } }
            .emit(&mut frame);
        let mut receiver = CommandReceiver::default();
        assert_eq!(tick(&mut receiver, &frame[..9]), None);
        assert_eq!(tick(&mut receiver, &[&frame[9..13], &frame[14..]].concat()), None);
        assert_eq!(tick(&mut receiver, &[0x05]), None);
        assert_eq!(tick(&mut receiver, &[]), Some(Command::Undecipherable));
    }

    #[test]
    fn incomplete_frame_is_answered_in_the_next_tick() {
        let mut receiver = CommandReceiver::default();
        assert_eq!(tick(&mut receiver, &command()[..15]), None);
        assert_eq!(tick(&mut receiver, &[]), Some(Command::Undecipherable));
        assert_eq!(tick(&mut receiver, &[0x05]), Some(Command::Control(Control::Restart)));
    }

    #[test]
    fn a_wrong_checksum_is_answered_at_once() {
        let mut receiver = CommandReceiver::default();
        let mut frame = command();
        frame[4] ^= 0x10;
        assert_eq!(tick(&mut receiver, &frame), Some(Command::Undecipherable));
        assert!(matches!(tick(&mut receiver, &command()), Some(Command::Data(_))));
    }

    #[test]
    fn a_frame_without_its_first_byte_is_not_read_as_commands() {
        let mut frame = [0; 16]; // its function bytes are a cancel and a restart
        DataCommand { function: [0x18, 0x05], plate: Plate { words: [0x1805; 6] } }.emit(&mut frame);
        let mut receiver = CommandReceiver::default();
        receiver.accept(&bytes(&frame[2..]));
        assert_eq!(receiver.take(), None);
        assert_eq!(tick(&mut receiver, &[0x18, 0x05]), None);
        assert_eq!(tick(&mut receiver, &[]), Some(Command::Undecipherable));
        assert_eq!(tick(&mut receiver, &[0x18]), Some(Command::Control(Control::Cancel)));
    }

    #[test]
    fn repeated_restarts_are_one_restart_also_after_a_command() {
        let mut receiver = CommandReceiver::default();
        let mut line = command().to_vec();
        line.extend([0x05; 3]);
        assert!(matches!(tick(&mut receiver, &line), Some(Command::Data(_))));
        assert_eq!(receiver.take(), Some(Command::Control(Control::Restart)));
        assert_eq!(receiver.take(), None);
    }

    #[test]
    fn a_command_followed_by_other_text_is_not_executed() {
        for line in [[&command()[..], &[0x41]].concat(), [&[0x18], &command()[..]].concat(), vec![0x05, 0x18]]
        {
            let mut receiver = CommandReceiver::default();
            assert_eq!(tick(&mut receiver, &line), None);
            assert_eq!(tick(&mut receiver, &[]), Some(Command::Undecipherable));
        }
    }

    #[test]
    fn the_late_end_of_a_frame_before_its_copy_is_not_a_command() {
        // 3 bytes of the first copy, then the second: the first 16 of these 19 have a correct checksum.
        let mut frame = [0; 16];
        DataCommand { function: NO_FUNCTION, plate: Plate { words: [-400, -6000, -800, 0, 9000, 0x03C7] } }
            .emit(&mut frame);
        let mut line = frame[13..].to_vec();
        line.extend(frame);
        assert!(DataCommand::parse(&line[..16]).is_ok());
        let mut receiver = CommandReceiver::default();
        assert_eq!(tick(&mut receiver, &line), None);
        assert_eq!(tick(&mut receiver, &[]), Some(Command::Undecipherable));
    }

    #[test]
    fn bytes_beyond_the_capacity_of_the_board_are_a_fault() {
        let mut receiver = CommandReceiver::default();
        receiver.accept(&bytes(&[0x03; 60]));
        receiver.accept(&bytes(&[0x03; 60]));
        assert_eq!(receiver.take(), None);
        assert_eq!(tick(&mut receiver, &[]), Some(Command::Undecipherable));
    }

    #[test]
    fn a_report_is_found_after_garbage_that_looks_like_one() {
        let mut receiver = ReplyReceiver::default();
        let mut line = vec![0x41, 0xFF, 0xFF, 0x03, 0x06, 0xFF];
        line.extend(report());
        let replies = all(&mut receiver, &line);
        assert_eq!(replies.last(), Some(&Reply::Report(HOME)), "{replies:?}");
        assert!(replies.contains(&Reply::BadChecksum));
        assert_eq!(receiver, ReplyReceiver::default());
    }

    #[test]
    fn one_ff_too_many_does_not_hide_a_report() {
        let mut receiver = ReplyReceiver::default();
        let mut line = vec![0xFF];
        line.extend(report());
        assert_eq!(all(&mut receiver, &line), [Reply::Garbage, Reply::Report(HOME)]);
    }

    #[test]
    fn responses_are_read_between_reports_and_not_in_them() {
        let mut receiver = ReplyReceiver::default();
        let mut frame = [0; 16];
        Report { plate: Plate { words: [0x0615, 0x1506, 0, 0, 0, 0] } }.emit(&mut frame);
        assert_eq!(all(&mut receiver, &frame).len(), 1);
        assert_eq!(receiver.push(0x06), Some(Reply::Response(Response::Ack)));
        assert_eq!(receiver.push(0x15), Some(Reply::Response(Response::Nak)));
    }

    #[test]
    fn an_answer_is_read_after_noise_that_could_start_a_report() {
        for noise in [&[0xFF][..], &[0xFF, 0xFF], &[0x41]] {
            let mut receiver = ReplyReceiver::default();
            let line = [noise, &[0x06]].concat();
            assert_eq!(all(&mut receiver, &line).last(), Some(&Reply::Response(Response::Ack)), "{noise:?}");
            assert_eq!(receiver, ReplyReceiver::default());
        }
    }

    #[test]
    fn incomplete_report_is_dropped() {
        let mut receiver = ReplyReceiver::default();
        assert_eq!(all(&mut receiver, &report()[..9]), []);
        assert!(receiver.idle());
        assert!(!receiver.idle());
        assert_eq!(all(&mut receiver, &report()), [Reply::Report(HOME)]);
    }

    proptest! {
        #[test]
        fn after_any_garbage_and_a_quiet_tick_a_command_is_understood(
            ticks in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..=64), 0..8),
        ) {
            let mut receiver = CommandReceiver::default();
            for line in &ticks {
                receiver.accept(&bytes(line));
                while receiver.take().is_some() {}
            }
            for _ in 0..2 {
                receiver.accept(&LinkBytes::default());
                while receiver.take().is_some() {}
            }
            prop_assert!(matches!(tick(&mut receiver, &command()), Some(Command::Data(_))));
        }

        #[test]
        fn after_any_garbage_a_report_is_found(garbage in proptest::collection::vec(any::<u8>(), 0..100)) {
            let mut receiver = ReplyReceiver::default();
            for byte in garbage {
                receiver.push(byte);
            }
            receiver.idle();
            prop_assert_eq!(all(&mut receiver, &report()), [Reply::Report(HOME)]);
        }
    }
}
