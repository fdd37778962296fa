//! What neighbours send: frames of any bytes, and mailboxes with any data.
//!
//! What is read is written as bytes that read the same; a mailbox takes a mailgram whole or not at all; a command that is
//! refused changes nothing.

#![no_main]

use std::time::Instant;

use libfuzzer_sys::fuzz_target;
use neighbours::{
    data_system::{command as das_command, statement, status as das_status},
    mailbox::{HWSC_COMMAND, Mailbox},
    pedestal::{
        cell::{OrdersLayout, SensorsLayout},
        command::CommandLayout,
        gripper::GripperLayout,
        status as pedestal_status,
        table::TableLayout,
    },
    vision::{Areas, Picture, request},
    workstation::{
        Gate,
        cell::{self, CellStatus},
        command, status,
    },
};
use sessions::network::{
    ClockKind, Role,
    frame::Frame,
    session::{Event, Session},
};

/// Every layout, whichever mailbox it is meant for.
fn layouts(data: &[u8]) {
    if let Ok(read) = command::decode(data) {
        let written = command::encode(&read).expect("what was read can be written");
        assert_eq!(command::decode(&written), Ok(read));
    }
    if let Ok(read) = CellStatus::decode(data) {
        assert_eq!(CellStatus::decode(&read.encode()).as_ref(), Ok(&read));
    }
    if let Ok(line) = cell::decode_line(data)
        && let Ok(text) = line.text
    {
        assert_eq!(cell::decode_line(&cell::encode_line(line.number, text)), Ok(line));
    }
    if let Ok(read) = das_status::Status::decode(data) {
        assert_eq!(das_status::Status::decode(&read.encode()).as_ref(), Ok(&read));
    }
    if let Ok(read) = das_command::decode(data) {
        // Why a statement is none is for people.
        let _ = statement::parse(read.statement).map_err(|error| error.to_string());
    }
    if let Ok(read) = request::decode(data) {
        assert_eq!(request::encode(&read), data);
    }
    if let Ok(read) = Areas::decode(data) {
        assert_eq!(read.encode().expect("what was read can be written"), data);
    }
    if let Ok(read) = Picture::decode(data) {
        assert_eq!(read.encode(), data);
    }
    let _ = status::decode(data).map_err(|error| error.to_string());
    pedestal(data);
}

/// Those of the Active Pedestal.
fn pedestal(data: &[u8]) {
    if let Ok(read) = CommandLayout::decode(data) {
        assert_eq!(CommandLayout::decode(&CommandLayout::encode(&read)), Ok(read));
    }
    if let Ok(read) = pedestal_status::Status::decode(data) {
        assert_eq!(pedestal_status::Status::decode(&read.encode()), Ok(read));
    }
    if let Ok(read) = GripperLayout::decode(data) {
        assert_eq!(GripperLayout::encode(&read).len(), data.len());
    }
    if let Ok(read) = TableLayout::decode(data) {
        assert_eq!(TableLayout::decode(&TableLayout::encode(&read)), Ok(read));
    }
    if let Ok(read) = SensorsLayout::decode(data) {
        assert_eq!(SensorsLayout::decode(&SensorsLayout::encode(&read)), Ok(read));
    }
    if let Ok(read) = OrdersLayout::decode(data) {
        assert_eq!(OrdersLayout::decode(&OrdersLayout::encode(&read)), Ok(read));
    }
}

/// A session of a controller takes any bytes, and has at most one error.
fn session(data: &[u8]) {
    let now = Instant::now();
    let mut session = Session::controller(ClockKind::Fast, now);
    let mut errors = 0;
    for piece in data.chunks(100) {
        session.receive(piece, now);
        loop {
            match session.event(now) {
                Ok(Some(Event::Hello(_))) => session.admit(),
                Ok(Some(_)) => {}
                Ok(None) => break,
                Err(_) => errors += 1,
            }
        }
    }
    assert!(errors <= 1);
}

fuzz_target!(|data: &[u8]| {
    layouts(data);
    session(data);
    let mut boxes: Vec<Mailbox> = Role::ALL
        .iter()
        .flat_map(|role| role.to_controller().iter().chain(role.from_controller()))
        .map(|&place| Mailbox::initialized(place))
        .collect();
    let mut gate = Gate::default();
    let mut line = data;
    while let Ok(Some(frame)) = Frame::first(line) {
        line = &line[frame.bytes().len()..];
        layouts(frame.data());
        let Some(mailbox) = boxes.iter_mut().find(|mailbox| mailbox.place().address == frame.address())
        else {
            continue;
        };
        let before = mailbox.clone();
        match mailbox.receive(frame.mailbox()) {
            Ok(()) => assert_eq!(mailbox.data(), frame.data()),
            Err(_) => assert_eq!(*mailbox, before),
        }
        if mailbox.place() == HWSC_COMMAND {
            let command = *gate.command();
            if gate.read(mailbox, &neighbours::workstation::Unchecked).is_some() {
                assert_eq!(*gate.command(), command);
            }
        }
    }
});
