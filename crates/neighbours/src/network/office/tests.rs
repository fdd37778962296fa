//! Desk and counter without a network: the line ends in a channel.

use std::sync::mpsc;

use super::*;
use crate::mailbox::{HWSC_COMMAND, HWSC_STATUS};

/// A line that ends in a channel.
struct Wire(mpsc::Sender<Frame>);

impl Outlet for Wire {
    fn send(&mut self, frame: &Frame) -> io::Result<()> {
        self.0.send(frame.clone()).map_err(|_| io::ErrorKind::BrokenPipe.into())
    }

    fn close(&mut self) {}
}

impl Counter {
    /// For tests: a neighbour comes; what is sent to him.
    pub(crate) fn come(&self) -> mpsc::Receiver<Frame> {
        let (send, receive) = mpsc::channel();
        self.attach(Box::new(Wire(send)), None).unwrap();
        receive
    }
}

fn came(desk: &Desk) -> (Counter, mpsc::Receiver<Frame>) {
    let counter = desk.counter();
    let line = counter.come();
    (counter, line)
}

fn mailgram(place: Place, data: &[u8]) -> Frame {
    let mut mailbox = Mailbox::initialized(place);
    mailbox.write(data).unwrap();
    Frame::of(&mailbox)
}

#[test]
fn in_fast_clock_the_tick_waits_for_what_answers_it() {
    let mut desk = Desk::new(Role::Workstation, ClockKind::Fast);
    let (counter, line) = came(&desk);
    let echo = thread::spawn(move || {
        // Answers each pulse by a command that says its number.
        for frame in line.iter() {
            if let Some(tick) = frame.as_pulse().unwrap() {
                counter.deliver(&mailgram(HWSC_COMMAND, &tick.to_le_bytes())).unwrap();
                counter.deliver(&frame).unwrap();
                if tick == 100 {
                    return;
                }
            }
        }
    });
    for tick in 1..=100_u64 {
        desk.outgoing(HWSC_STATUS).write(&[1]).unwrap();
        let presence = desk.exchange(tick);
        assert_eq!(presence, Presence { here: true, new: tick == 1, came: true });
        assert_eq!(desk.incoming(HWSC_COMMAND).data(), tick.to_le_bytes());
    }
    echo.join().unwrap();
}

#[test]
fn on_the_grid_nobody_is_waited_for() {
    let mut desk = Desk::new(Role::Workstation, ClockKind::Real);
    let (counter, line) = came(&desk);
    assert_eq!(desk.exchange(1), Presence { here: true, new: true, came: true });
    assert_eq!(desk.exchange(2), Presence { here: true, new: false, came: true });
    counter.deliver(&mailgram(HWSC_COMMAND, b"go")).unwrap();
    desk.exchange(3);
    assert_eq!(desk.incoming(HWSC_COMMAND).data(), b"go");
    drop(line);
}

#[test]
fn a_mailbox_that_somebody_has_is_left_for_the_next_tick() {
    let mut desk = Desk::new(Role::Workstation, ClockKind::Real);
    let (counter, _line) = came(&desk);
    desk.exchange(1);
    counter.deliver(&mailgram(HWSC_COMMAND, b"go")).unwrap();
    let shared = Arc::clone(&desk.shared);
    let held = locked(&shared.incoming[0]);
    desk.exchange(2);
    assert_eq!(desk.incoming(HWSC_COMMAND).data(), b"");
    drop(held);
    desk.exchange(3);
    assert_eq!(desk.incoming(HWSC_COMMAND).data(), b"go");
}

#[test]
fn who_comes_again_finds_his_mailboxes_initialized_and_gets_all_that_is_for_him() {
    let mut desk = Desk::new(Role::Workstation, ClockKind::Real);
    let (counter, _line) = came(&desk);
    counter.deliver(&mailgram(HWSC_COMMAND, b"go")).unwrap();
    desk.outgoing(HWSC_STATUS).write(b"status").unwrap();
    desk.exchange(1);
    let (send, second) = mpsc::channel();
    let occupied = desk.counter().attach(Box::new(Wire(send)), Some(&Frame::welcome(&[])));
    assert!(matches!(occupied, Err(AttachError::Occupied(Role::Workstation))));
    assert_eq!(second.recv().unwrap(), Frame::last_words("workstation is connected already"));
    let cut = Parting::Left("the cable was cut".to_owned());
    counter.detach(cut.clone());
    assert!(!desk.exchange(2).here);
    let (_, line) = came(&desk);
    assert_eq!(desk.exchange(3), Presence { here: true, new: true, came: true });
    assert_eq!(desk.incoming(HWSC_COMMAND).mailgram(), 0);
    let first = line.recv_timeout(Duration::from_secs(60)).unwrap();
    assert_eq!((first.address(), first.data()), (HWSC_STATUS.address, &b"status"[..]));
    let news: Vec<_> = std::iter::from_fn(|| desk.news()).collect();
    let (came, gone) = (News::Came(Role::Workstation), News::Gone(Role::Workstation, cut));
    assert_eq!(news, [came.clone(), gone, came]);
}

/// As long as the network of a run that has ended is still there.
#[test]
fn who_comes_too_late_hears_that_the_run_is_over() {
    let desk = Desk::new(Role::Workstation, ClockKind::Fast);
    let (counter, first) = came(&desk);
    drop(desk);
    assert_eq!(first.try_iter().last(), Some(Frame::last_words(OVER)));
    let (send, line) = mpsc::channel();
    let late = counter.attach(Box::new(Wire(send)), Some(&Frame::welcome(&[])));
    assert!(matches!(late, Err(AttachError::Over)));
    assert_eq!(line.try_iter().collect::<Vec<_>>(), [Frame::last_words(OVER)]);
}

#[test]
fn a_tick_that_waits_goes_on_when_the_neighbour_is_gone() {
    let mut desk = Desk::new(Role::Workstation, ClockKind::Fast);
    let (counter, line) = came(&desk);
    let leaver = thread::spawn(move || {
        while line.recv().unwrap().as_pulse().unwrap().is_none() {}
        counter.detach(Parting::Left("enough".to_owned()));
    });
    assert_eq!(desk.exchange(1), Presence { here: false, new: true, came: true });
    leaver.join().unwrap();
    assert!(!desk.exchange(2).here);
}

/// Nobody can say then whether he would have answered.
#[test]
fn a_tick_that_waits_goes_on_when_the_run_is_to_end() {
    let interrupted = Arc::new(AtomicBool::new(false));
    let mut desk = Desk::new(Role::Workstation, ClockKind::Fast).until(Arc::clone(&interrupted));
    let (counter, line) = came(&desk);
    let silent = thread::spawn(move || {
        while line.recv().unwrap().as_pulse().unwrap().is_none() {}
        counter.deliver(&mailgram(HWSC_COMMAND, b"PAUSE")).unwrap();
        interrupted.store(true, Ordering::Relaxed);
        line
    });
    assert_eq!(desk.exchange(1), Presence { here: true, new: true, came: true });
    assert_eq!(desk.incoming(HWSC_COMMAND).data(), b"PAUSE");
    assert!(desk.exchange(2).here);
    drop(silent.join().unwrap());
}

/// A run whose workstation controller has been there at some time is over when it is not.
#[test]
fn who_comes_and_goes_between_two_ticks_has_come() {
    let mut desk = Desk::new(Role::Workstation, ClockKind::Fast);
    assert!(!desk.exchange(1).came);
    let (counter, _line) = came(&desk);
    counter.detach(Parting::Left("enough".to_owned()));
    assert_eq!(desk.exchange(2), Presence { here: false, new: false, came: true });
}

#[test]
fn at_a_desk_that_is_closed_nobody_is_there_and_nobody_is_waited_for() {
    for clock in [ClockKind::Fast, ClockKind::Real] {
        let mut desk = Desk::new(Role::DataSystem, clock);
        let (_counter, line) = came(&desk);
        let closer = desk.closer();
        let porter = thread::spawn(move || {
            // He never answers.
            while line.recv().unwrap().as_pulse().unwrap().is_none() {}
            closer.close();
            line
        });
        let tick = (1..).find(|&tick| !desk.exchange(tick).here).unwrap();
        assert!(clock == ClockKind::Real || tick == 1);
        assert!(!desk.exchange(tick + 1).here);
        drop(porter.join().unwrap());
    }
}

#[test]
fn frames_for_others_mailboxes_are_refused() {
    let desk = Desk::new(Role::Workstation, ClockKind::Real);
    let error = desk.counter().deliver(&mailgram(HWSC_STATUS, b"all is well")).unwrap_err().to_string();
    assert!(error.starts_with("the address of mailbox HWSC to RCS Command at F6000 or "), "{error}");
    assert!(error.ends_with("found F6200"), "{error}");
}

#[test]
fn who_answers_no_pulse_is_late_and_nobody_answers_before_he_is_asked() {
    let mut desk = Desk::new(Role::Workstation, ClockKind::Real);
    let (counter, line) = came(&desk);
    assert!(!counter.is_late(Duration::ZERO), "nothing was asked");
    let pulse = || line.iter().find_map(|frame| frame.as_pulse().unwrap()).unwrap();
    desk.exchange(7);
    assert_eq!(pulse(), 7);
    assert!(counter.is_late(Duration::ZERO) && !counter.is_late(Duration::from_secs(60)));
    let early = counter.deliver(&Frame::pulse(8)).unwrap_err().to_string();
    assert_eq!(early, "an answer to a pulse up to 7 was expected, found one to 8");
    counter.deliver(&Frame::pulse(7)).unwrap();
    assert!(!counter.is_late(Duration::ZERO));
    // An answer that was given before answers nothing.
    desk.exchange(8);
    assert_eq!(pulse(), 8);
    counter.deliver(&Frame::pulse(7)).unwrap();
    assert!(counter.is_late(Duration::ZERO));
}
