//! The host's end with explicit inputs from the line.

use super::*;
use crate::wire::{NO_FUNCTION, Report};

const HOME: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };
const HOME_FRAME: [u8; 16] = [0x03, 0, 0, 0, 0, 0xE7, 0x68, 0xFD, 0x85, 0xDC, 0xD8, 0x34, 0xB7, 0, 0, 0x73];

fn position(function: [u8; 2]) -> Intent {
    Intent::Position(DataCommand { function, plate: HOME })
}

fn tick(host: &mut Host, rx: &[u8], intent: &Intent) -> (HostEvent, Vec<u8>) {
    let (mut line, mut tx) = (LinkBytes::default(), LinkBytes::default());
    assert_eq!(line.extend(rx), rx.len());
    let event = host.receive(&line, true);
    host.transmit(intent, &mut tx);
    (event, tx.as_slice().to_vec())
}

fn report() -> [u8; 16] {
    let mut frame = [0xA5; 16];
    Report { plate: HOME }.emit(&mut frame);
    frame
}

fn running() -> Host {
    let mut host = Host::new(ANSWER_TICKS);
    assert_eq!(tick(&mut host, &report(), &Intent::Idle), (HostEvent::Started, vec![]));
    assert_eq!((host.position(), host.can_send()), (HOME, true));
    host
}

#[test]
fn one_frame_is_sent_per_tick() {
    let mut host = running();
    assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)).1, HOME_FRAME);
    for _ in 0..10 {
        let (event, tx) = tick(&mut host, &[0x06], &position(NO_FUNCTION));
        assert_eq!((event, tx.as_slice()), (HostEvent::Acknowledged, &HOME_FRAME[..]));
    }
    assert_eq!((host.counters().frames, host.counters().acknowledged), (11, 10));
}

#[test]
fn at_most_one_frame_is_outstanding() {
    let mut host = running();
    tick(&mut host, &[], &position(NO_FUNCTION));
    assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)).1, []);
    assert!(!host.can_send());
}

#[test]
fn nak_repeats_the_same_bytes_up_to_the_limit() {
    let mut host = running();
    let other = Intent::Position(DataCommand { function: NO_FUNCTION, plate: Plate::default() });
    tick(&mut host, &[], &position(NO_FUNCTION));
    for _ in 0..MOST_RETRIES {
        assert_eq!(tick(&mut host, &[0x15], &other), (HostEvent::None, HOME_FRAME.to_vec()));
    }
    assert_eq!(tick(&mut host, &[0x15], &other), (HostEvent::Lost, vec![0x05]));
    assert_eq!(host.fault(), LinkFault::NotTransmitted);
    assert_eq!((host.counters().retries, host.counters().naks), (3, 4));
}

#[test]
fn unsent_bytes_of_the_port_are_lost_and_reported() {
    let mut host = running();
    assert_eq!(host.unsent(), HostEvent::None, "the line was empty");
    tick(&mut host, &[], &position([7, 9]));
    assert_eq!(host.unsent(), HostEvent::Lost);
    assert_eq!((host.fault(), host.lost_function()), (LinkFault::NotTransmitted, [7, 9]));
    // A later answer does not belong to this command.
    assert_eq!(tick(&mut host, &[0x06], &position(NO_FUNCTION)), (HostEvent::None, vec![0x05]));
    assert_eq!(tick(&mut host, &report(), &Intent::Idle).0, HostEvent::Started);
    host.clear_fault();
    // A restart that the port does not send is repeated. At the time limit it is the reported fault.
    host.set_silence_limit(4);
    tick(&mut host, &[], &Intent::Restart);
    for attempt in 1..=4 {
        assert_eq!(host.fault(), LinkFault::None, "attempt {attempt}");
        assert_eq!(host.unsent(), HostEvent::None);
        assert_eq!(tick(&mut host, &[], &Intent::Idle).1, [0x05]);
    }
    assert_eq!(host.fault(), LinkFault::NotTransmitted);
    // One report answers the only restart that was sent.
    assert_eq!(tick(&mut host, &report(), &Intent::Idle).0, HostEvent::Started);
    tick(&mut host, &[], &Intent::Cancel);
    assert_eq!(host.unsent(), HostEvent::None);
    assert_eq!(tick(&mut host, &[], &Intent::Idle).1, [0x18]);
}

#[test]
fn without_an_answer_the_link_restarts_and_no_command_is_repeated() {
    let mut host = running();
    tick(&mut host, &[], &position([7, 9]));
    assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)), (HostEvent::None, vec![]));
    assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)), (HostEvent::None, vec![]));
    assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)), (HostEvent::Lost, vec![0x05]));
    assert_eq!((host.fault(), host.lost_function()), (LinkFault::NotResponding, [7, 9]));
    // Late answers are discarded, but late reports are not.
    assert_eq!(tick(&mut host, &[0x06, 0x15, 0x41], &position(NO_FUNCTION)).1, []);
    assert_eq!(host.state(), HostState::Starting);
    assert_eq!(tick(&mut host, &report(), &Intent::Idle).0, HostEvent::Started);
    assert_eq!(host.fault(), LinkFault::NotResponding);
    host.clear_fault();
    assert_eq!(host.fault(), LinkFault::None);
}

#[test]
fn unanswered_start_is_repeated_once_per_second_until_the_time_limit() {
    let mut host = Host::new(ANSWER_TICKS);
    let mut sent = Vec::new();
    for number in 1..=u32::from(SILENCE_LIMIT_TICKS) {
        assert_eq!((host.fault(), host.is_silent()), (LinkFault::None, number > 25), "tick {number}");
        if tick(&mut host, &[], &Intent::Idle).1 == [0x05] {
            sent.push(number);
        }
    }
    assert_eq!(sent[..4], [4, 29, 54, 79]);
    assert_eq!((host.fault(), host.counters().restarts), (LinkFault::NotResponding, 60));
    // RESTART resets the time limit, but the silence continues; the answer to the previous 05 is sufficient.
    host.clear_fault();
    assert_eq!(tick(&mut host, &[], &Intent::Restart).1, []);
    assert_eq!((host.fault(), host.is_silent()), (LinkFault::None, true));
    tick(&mut host, &report(), &Intent::Idle); // as after the end of Hold: one report for all restarts
    for _ in 0..ANSWER_TICKS {
        tick(&mut host, &[], &Intent::Idle);
    }
    assert_eq!(tick(&mut host, &[], &Intent::Idle).0, HostEvent::Started);
}

#[test]
fn configured_time_limit_ends_a_silence() {
    let mut host = running();
    host.set_silence_limit(50);
    tick(&mut host, &[], &position(NO_FUNCTION));
    for _ in 0..3 {
        tick(&mut host, &[], &Intent::Idle);
    }
    assert_eq!(host.fault(), LinkFault::NotResponding);
    host.clear_fault();
    let blamed = (1..200).find(|_| {
        tick(&mut host, &[], &Intent::Idle);
        host.fault() != LinkFault::None
    });
    assert_eq!((blamed, host.has_dtr()), (Some(50), true));
}

#[test]
fn wrong_report_is_requested_again_at_once() {
    let mut host = running();
    assert_eq!(host.counters().checksum_errors, 0);
    assert_eq!(tick(&mut host, &[], &Intent::Restart).1, [0x05]);
    let mut wrong = report();
    wrong[8] ^= 0x40;
    assert_eq!(tick(&mut host, &wrong, &Intent::Idle), (HostEvent::None, vec![0x05]));
    assert_eq!((host.counters().checksum_errors, host.fault()), (1, LinkFault::None));
    assert_eq!(tick(&mut host, &report(), &Intent::Idle).0, HostEvent::Started);
}

#[test]
fn unrequested_report_is_an_error_of_depc() {
    let mut host = running();
    tick(&mut host, &[], &position(NO_FUNCTION));
    assert_eq!(tick(&mut host, &report(), &Intent::Idle), (HostEvent::Lost, vec![0x05]));
    assert_eq!(host.fault(), LinkFault::DepcError);
    let mut host = running();
    let mut wrong = report();
    wrong[15] ^= 1;
    assert_eq!(tick(&mut host, &wrong, &Intent::Idle).0, HostEvent::Lost);
    assert_eq!(host.fault(), LinkFault::Checksum);
}

#[test]
fn a_report_outside_the_coding_is_discarded() {
    let mut host = Host::new(ANSWER_TICKS);
    let mut frame = [0; 16];
    Report { plate: Plate { words: [0, 0, 0, 0, -1, 0] } }.emit(&mut frame);
    assert_eq!(tick(&mut host, &frame, &Intent::Idle).0, HostEvent::None);
    assert_eq!(host.state(), HostState::Starting);
}

#[test]
fn a_report_closed_by_the_next_one_is_discarded() {
    let mut frame = [0; 16];
    Report { plate: Plate { words: [1, 2, 3, 4, 9000, -114] } }.emit(&mut frame);
    let without_ff = [&frame[..13], &frame[14..]].concat();
    assert_eq!(frame[13], 0xFF);
    assert!(Report::parse(&[&without_ff[..], &[0xFF]].concat()).is_ok());
    let mut host = Host::new(ANSWER_TICKS);
    assert_eq!(tick(&mut host, &without_ff, &Intent::Idle).0, HostEvent::None);
    assert_eq!(tick(&mut host, &frame, &Intent::Idle).0, HostEvent::None);
    assert_eq!(host.state(), HostState::Starting);
}

#[test]
fn a_function_is_lost_only_with_its_command() {
    let mut host = running();
    tick(&mut host, &[], &position([1, 2]));
    assert_eq!(tick(&mut host, &[0x06], &Intent::Restart).0, HostEvent::Acknowledged);
    assert_eq!(host.lost_function(), NO_FUNCTION, "it has run");
    assert_eq!(tick(&mut host, &report(), &position([3, 4])).0, HostEvent::Started);
    tick(&mut host, &[], &Intent::Restart);
    assert_eq!(host.lost_function(), [3, 4]);
    assert_eq!(tick(&mut host, &report(), &position(NO_FUNCTION)).0, HostEvent::Started);
    tick(&mut host, &[], &Intent::Restart);
    assert_eq!(host.lost_function(), [3, 4], "it is that of the last command with one");
}

#[test]
fn limited_points_are_counted() {
    let mut host = running();
    host.count_limited();
    host.count_limited();
    assert_eq!(host.counters().limited, 2);
}

#[test]
fn dtr_is_watched() {
    let mut host = running();
    assert_eq!(host.receive(&LinkBytes::default(), false), HostEvent::Lost);
    assert_eq!((host.state(), host.fault()), (HostState::Down, LinkFault::NotResponding));
    let mut tx = LinkBytes::default();
    assert!(!host.transmit(&Intent::Restart, &mut tx));
    assert_eq!(tx.length, 0);
    assert_eq!(tick(&mut host, &report(), &Intent::Idle).0, HostEvent::Started);
}

#[test]
fn controller_without_dtr_fails_after_three_answer_times() {
    let mut host = Host::new(ANSWER_TICKS);
    let blamed = (1..100).find(|_| {
        host.receive(&LinkBytes::default(), false);
        host.fault() != LinkFault::None
    });
    assert_eq!(blamed, Some(u16::from(START_ATTEMPTS) * ANSWER_TICKS));
}

#[test]
fn transmit_reports_whether_it_has_sent_the_intent() {
    let sent = |host: &mut Host, intent: &Intent| {
        let mut tx = LinkBytes::default();
        host.receive(&LinkBytes::default(), true);
        (host.transmit(intent, &mut tx), usize::from(tx.length))
    };
    let mut host = running();
    assert_eq!(sent(&mut host, &Intent::Idle), (false, 0));
    assert_eq!(sent(&mut host, &position(NO_FUNCTION)), (true, FRAME_BYTES));
    for _ in 1..ANSWER_TICKS {
        assert_eq!(sent(&mut host, &position(NO_FUNCTION)), (false, 0), "one is outstanding");
    }
    assert_eq!(sent(&mut host, &position(NO_FUNCTION)), (false, 1), "a restart is due");
    let mut host = running();
    assert_eq!(sent(&mut host, &Intent::Restart), (true, 1));
    let mut host = running();
    assert_eq!(sent(&mut host, &Intent::Cancel), (true, 1));
    for _ in 1..ANSWER_TICKS {
        assert_eq!(sent(&mut host, &Intent::Idle), (false, 0));
    }
    assert_eq!(sent(&mut host, &Intent::Idle), (false, 1), "the cancel again");
}

#[test]
fn cancel_is_repeated_until_it_is_acknowledged() {
    let mut host = running();
    assert_eq!(tick(&mut host, &[], &Intent::Cancel).1, [0x18]);
    assert_eq!(tick(&mut host, &[0x15], &Intent::Idle).1, [0x18]);
    assert_eq!(tick(&mut host, &[0x06], &Intent::Idle).1, []);
    assert_eq!(host.state(), HostState::Ended);
}

#[test]
fn a_full_line_is_reported_as_full() {
    let mut host = running();
    let mut tx = LinkBytes::default();
    tx.extend(&[0; 60]);
    host.receive(&LinkBytes::default(), true);
    assert!(!host.transmit(&position(NO_FUNCTION), &mut tx));
    assert_eq!((host.fault(), host.state()), (LinkFault::NotTransmitted, HostState::Starting));
}

#[test]
fn unexpected_and_repeated_acks_have_no_effect() {
    let mut host = running();
    for _ in 0..5 {
        assert_eq!(tick(&mut host, &[0x06], &Intent::Idle), (HostEvent::None, vec![]));
    }
    assert_eq!((host.counters().acknowledged, host.state()), (0, HostState::Ready));
    tick(&mut host, &[], &position(NO_FUNCTION));
    assert_eq!(tick(&mut host, &[0x06, 0x06], &Intent::Idle), (HostEvent::Acknowledged, vec![]));
    assert_eq!(tick(&mut host, &[0x06], &Intent::Idle).0, HostEvent::None);
    assert_eq!((host.counters().acknowledged, host.fault()), (1, LinkFault::None));
}

#[test]
fn late_ack_is_valid_only_within_the_answer_time() {
    let mut host = running();
    tick(&mut host, &[], &position([1, 1]));
    tick(&mut host, &[], &Intent::Idle);
    assert_eq!(tick(&mut host, &[0x06], &Intent::Idle).0, HostEvent::Acknowledged);
    assert_eq!(host.lost_function(), NO_FUNCTION);
    tick(&mut host, &[], &position([1, 2]));
    for _ in 0..2 {
        tick(&mut host, &[], &Intent::Idle);
    }
    assert_eq!(tick(&mut host, &[], &Intent::Idle), (HostEvent::Lost, vec![0x05]));
    assert_eq!(tick(&mut host, &[0x06], &Intent::Idle).0, HostEvent::None);
    assert_eq!((host.lost_function(), host.counters().acknowledged), ([1, 2], 1));
}

#[test]
fn ack_among_noise_is_valid_and_precedes_a_nak() {
    for answer in [&[0x15, 0x06][..], &[0x06, 0x15], &[0x41, 0x06], &[0x06, 0x18]] {
        let mut host = running();
        tick(&mut host, &[], &position(NO_FUNCTION));
        assert_eq!(tick(&mut host, answer, &Intent::Idle), (HostEvent::Acknowledged, vec![]));
    }
}

#[test]
fn a_byte_of_a_broken_report_is_not_an_answer() {
    let mut frame = [0; 16];
    Report { plate: Plate { words: [0x0606, 0x1515, 3, 4, 5, 6] } }.emit(&mut frame);
    let mut host = running();
    tick(&mut host, &[], &position(NO_FUNCTION));
    assert_eq!(tick(&mut host, &frame[1..], &Intent::Idle), (HostEvent::None, vec![]));
    assert_eq!((host.state(), host.counters().acknowledged), (HostState::Waiting, 0));
}

#[test]
fn a_cancel_without_ack_ends_with_dtr_and_the_next_report_starts_over() {
    let mut host = running();
    assert_eq!(tick(&mut host, &[], &Intent::Cancel).1, [0x18]);
    for _ in 0..20 {
        assert_eq!(host.receive(&LinkBytes::default(), false), HostEvent::None);
        let mut tx = LinkBytes::default();
        assert!(!host.transmit(&position(NO_FUNCTION), &mut tx));
        assert_eq!((host.state(), host.fault(), tx.length), (HostState::Ended, LinkFault::None, 0));
    }
    assert_eq!(tick(&mut host, &report(), &position(NO_FUNCTION)), (HostEvent::Started, HOME_FRAME.to_vec()));
}

#[test]
fn the_last_report_to_several_restarts_is_used() {
    let at = |x| {
        let mut frame = [0; 16];
        Report { plate: Plate { words: [x, -6296, -635, -9000, 13495, 0] } }.emit(&mut frame);
        frame
    };
    let mut host = running();
    tick(&mut host, &[], &Intent::Restart);
    for _ in 0..2 * RESTART_TICKS {
        tick(&mut host, &[], &Intent::Idle);
    }
    assert_eq!(host.counters().restarts, 3);
    assert_eq!(tick(&mut host, &at(1), &position(NO_FUNCTION)), (HostEvent::None, vec![]));
    for _ in 0..2 {
        assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)), (HostEvent::None, vec![]));
    }
    assert_eq!(tick(&mut host, &at(2), &position(NO_FUNCTION)), (HostEvent::None, vec![]));
    for _ in 0..ANSWER_TICKS {
        assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)), (HostEvent::None, vec![]));
    }
    assert_eq!(tick(&mut host, &[], &position(NO_FUNCTION)), (HostEvent::Started, HOME_FRAME.to_vec()));
    assert_eq!((host.position().words[0], host.counters().restarts), (2, 3));
}

#[test]
fn a_late_nak_repeats_a_position_but_no_function() {
    for (function, event, sent) in
        [(NO_FUNCTION, HostEvent::None, &HOME_FRAME[..]), ([1, 2], HostEvent::Lost, &[0x05])]
    {
        let mut host = running();
        tick(&mut host, &[], &position(function));
        tick(&mut host, &[], &Intent::Idle);
        assert_eq!(tick(&mut host, &[0x15], &Intent::Idle), (event, sent.to_vec()));
        assert_eq!(host.lost_function(), function);
    }
    let mut host = running(); // in the next tick it can only be the answer to the command
    let frame = tick(&mut host, &[], &position([1, 2])).1;
    assert_eq!(tick(&mut host, &[0x15], &Intent::Idle), (HostEvent::None, frame));
}

#[test]
fn a_late_report_at_the_start_is_used_only_if_it_is_the_last() {
    let mut host = Host::new(ANSWER_TICKS);
    let mut restarts = 0;
    for _ in 0..5 {
        restarts += tick(&mut host, &[], &Intent::Idle).1.len();
    }
    assert_eq!(restarts, 1);
    // The report of the start; the answer to the restart follows.
    assert_eq!(tick(&mut host, &report(), &Intent::Idle), (HostEvent::None, vec![]));
    tick(&mut host, &[], &Intent::Idle);
    assert_eq!(tick(&mut host, &report(), &Intent::Idle), (HostEvent::None, vec![]));
    for _ in 0..ANSWER_TICKS {
        assert_eq!(tick(&mut host, &[], &Intent::Idle), (HostEvent::None, vec![]));
    }
    assert_eq!(tick(&mut host, &[], &Intent::Idle), (HostEvent::Started, vec![]));
}

#[test]
fn a_dtr_pulse_is_not_a_start() {
    let mut host = Host::new(ANSWER_TICKS);
    for tick in 0..2 * START_ATTEMPTS {
        assert_eq!(host.fault(), LinkFault::None, "tick {tick}");
        host.receive(&LinkBytes::default(), tick % 2 == 0);
    }
    assert_eq!(host.fault(), LinkFault::NotResponding);
}

#[test]
fn cancel_with_nak_and_ack_in_one_tick_is_acknowledged() {
    let mut host = running();
    assert_eq!(tick(&mut host, &[], &Intent::Cancel).1, [0x18]);
    assert_eq!(tick(&mut host, &[0x15, 0x06], &Intent::Idle).1, []);
    assert_eq!(host.state(), HostState::Ended);
}

#[test]
fn unanswered_cancel_fails_at_the_time_limit() {
    let mut host = running();
    host.set_silence_limit(30);
    tick(&mut host, &[], &Intent::Cancel);
    let blamed = (1..100).find(|_| {
        tick(&mut host, &[], &Intent::Idle);
        host.fault() != LinkFault::None
    });
    assert_eq!(
        (blamed, host.fault(), host.state()),
        (Some(30), LinkFault::NotResponding, HostState::Cancelling)
    );
}

#[test]
fn function_restarted_after_a_cancel_is_asked_for_its_report() {
    let mut host = running();
    tick(&mut host, &[], &Intent::Cancel);
    for _ in 0..20 {
        host.receive(&LinkBytes::default(), false);
    }
    // DTR is on again, and the report of the starting function is lost.
    for waited in 1..ANSWER_TICKS {
        assert_eq!(
            (tick(&mut host, &[], &Intent::Idle).1, host.state()),
            (vec![], HostState::Ended),
            "{waited}"
        );
    }
    assert_eq!((tick(&mut host, &[], &Intent::Idle).1, host.state()), (vec![0x05], HostState::Starting));
}

#[test]
fn discarded_host_state_has_no_effect() {
    let mut host = running();
    tick(&mut host, &[], &position(NO_FUNCTION));
    for (has_candidate, candidate) in [(true, HOME), (false, Plate::default())] {
        let mut forgets = Host { has_candidate, candidate: HOME, ..host };
        forgets.forget_past();
        let counters = LinkCounters::default();
        assert_eq!(forgets, Host { has_candidate, candidate, counters, ..host });
    }
}
