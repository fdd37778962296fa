//! Frames and receivers: any bytes, in ticks of any length.
//!
//! What the codec accepts it writes again to the byte; both receivers stay bounded, and understand a sound frame after two
//! quiet ticks.

#![no_main]

use depc::{
    Plate,
    receive::{Command, CommandReceiver, Reply, ReplyReceiver},
    wire::{DataCommand, Report},
};
use interfaces::device::LinkBytes;
use libfuzzer_sys::fuzz_target;

const HOME: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };

/// The bytes of a tick: a length, then so many.
fn tick<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, bytes) = rest.split_first()?;
    let (now, later) = bytes.split_at(bytes.len().min(usize::from(*length % 65)));
    *rest = later;
    Some(now)
}

fn link(bytes: &[u8]) -> LinkBytes {
    let mut link = LinkBytes::default();
    link.extend(bytes);
    link
}

fn codec(bytes: &[u8]) {
    let mut again = [0xA5; 16];
    if let Ok(report) = Report::parse(bytes) {
        report.emit(&mut again);
        assert_eq!(again, bytes);
    }
    if let Ok(command) = DataCommand::parse(bytes) {
        command.emit(&mut again);
        assert_eq!(again, bytes);
    }
}

fuzz_target!(|data: &[u8]| {
    codec(data);
    let (mut commands, mut replies) = (CommandReceiver::default(), ReplyReceiver::default());
    let mut rest = data;
    while let Some(bytes) = tick(&mut rest) {
        codec(bytes);
        commands.accept(&link(bytes));
        let mut taken = 0;
        while commands.take().is_some() {
            taken += 1;
            assert!(taken <= 5, "more commands in a tick than bytes can hold");
        }
        if bytes.is_empty() {
            replies.idle();
        }
        for byte in bytes {
            replies.push(*byte);
        }
    }
    for _ in 0..2 {
        commands.accept(&LinkBytes::default());
        while commands.take().is_some() {}
        replies.idle();
    }
    let mut frame = [0; 16];
    let command = DataCommand { function: [0, 0], plate: HOME };
    command.emit(&mut frame);
    commands.accept(&link(&frame));
    assert_eq!(commands.take(), Some(Command::Data(command)));
    Report { plate: HOME }.emit(&mut frame);
    assert_eq!(frame.iter().filter_map(|byte| replies.push(*byte)).last(), Some(Reply::Report(HOME)));
});
