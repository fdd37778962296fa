//! The host's end against a controller that says anything at any time.
//!
//! It sends one frame or one byte a tick at most, and only what it was asked to or a restart; a position counts as reached
//! only in a tick that starts the link or brings an acknowledgement; and on a line that is sound again it starts.

#![no_main]

use depc::{
    Plate,
    host::{ANSWER_TICKS, Host, HostEvent, HostState, Intent},
    wire::{DataCommand, Report},
};
use interfaces::device::LinkBytes;
use libfuzzer_sys::fuzz_target;

const HOME: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };

fn intent(byte: u8, number: u8) -> Intent {
    match byte & 0x07 {
        0 => Intent::Idle,
        1 => Intent::Restart,
        2 => Intent::Cancel,
        _ => Intent::Position(DataCommand { function: [0, number], plate: HOME }),
    }
}

fn check_sent(sent: &[u8]) {
    match sent {
        [] | [0x05] | [0x18] => {}
        frame => assert!(DataCommand::parse(frame).is_ok_and(|command| command.plate == HOME)),
    }
}

fuzz_target!(|data: &[u8]| {
    let mut host = Host::new(ANSWER_TICKS);
    let mut rest = data;
    let mut number = 0_u8;
    // A tick: what is wanted and the DTR, a length, bytes.
    while let [control, length, bytes @ ..] = rest {
        let (now, later) = bytes.split_at(bytes.len().min(usize::from(*length % 65)));
        rest = later;
        number = number.wrapping_add(1);
        let mut rx = LinkBytes::default();
        rx.extend(now);
        let before = host.position();
        let event = host.receive(&rx, control & 0x08 == 0);
        if host.position() != before {
            assert!(matches!(event, HostEvent::Started | HostEvent::Acknowledged | HostEvent::Lost));
            assert!(!now.is_empty() || event == HostEvent::Started);
        }
        let mut tx = LinkBytes::default();
        host.transmit(&intent(*control, number), &mut tx);
        check_sent(tx.as_slice());
        assert!(host.state() != HostState::Down || tx.length == 0);
        let counters = host.counters();
        assert!(counters.acknowledged <= counters.frames && counters.retries <= counters.naks);
    }
    let mut frame = [0; 16];
    Report { plate: HOME }.emit(&mut frame);
    let (mut report, mut tx) = (LinkBytes::default(), LinkBytes::default());
    report.extend(&frame);
    host.receive(&LinkBytes::default(), true);
    host.transmit(&Intent::Restart, &mut tx);
    assert_eq!(tx.as_slice(), [0x05]);
    // At once, or, if other reports may be on their way, when none has come for longer than the time for an answer.
    let mut event = host.receive(&report, true);
    for _ in 0..=ANSWER_TICKS {
        host.transmit(&Intent::Idle, &mut LinkBytes::default());
        event = event.max(host.receive(&LinkBytes::default(), true));
    }
    assert!(matches!(event, HostEvent::Started));
    assert_eq!((host.position(), host.can_send()), (HOME, true));
});
