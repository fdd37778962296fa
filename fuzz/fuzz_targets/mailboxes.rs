//! What neighbours send: frames of any bytes, and mailboxes with any data.
//!
//! What is read is written as bytes that read the same; a mailbox takes a mailgram whole or not at all; a command that is
//! refused changes nothing.

#![no_main]

use libfuzzer_sys::fuzz_target;
use neighbours::{
    data_system::{command as das_command, statement, status as das_status},
    mailbox::{HWSC_COMMAND, Mailbox},
    network::{Role, frame::Frame},
    pedestal::{cell as pedestal_cell, command as pedestal_command, gripper, status as pedestal_status, table},
    vision::{Areas, Picture, request},
    workstation::{
        Gate,
        cell::{self, CellStatus},
        command, status,
    },
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
    if let Ok(read) = pedestal_command::decode(data) {
        assert_eq!(pedestal_command::decode(&pedestal_command::encode(&read)), Ok(read));
    }
    if let Ok(read) = pedestal_status::Status::decode(data) {
        assert_eq!(pedestal_status::Status::decode(&read.encode()), Ok(read));
    }
    if let Ok((hand, command)) = gripper::decode(data) {
        assert_eq!(gripper::decode(&gripper::encode(&hand, &command)), Ok((hand, command)));
    }
    if let Ok((turned, command)) = table::decode(data) {
        assert_eq!(table::decode(&table::encode(&turned, &command)), Ok((turned, command)));
    }
    if let Ok(read) = pedestal_cell::decode_sensors(data) {
        assert_eq!(pedestal_cell::decode_sensors(&pedestal_cell::encode_sensors(&read)), Ok(read));
    }
    if let Ok((valves, motor)) = pedestal_cell::decode_orders(data) {
        assert_eq!(
            pedestal_cell::decode_orders(&pedestal_cell::encode_orders(valves, &motor)),
            Ok((valves, motor))
        );
    }
}

fuzz_target!(|data: &[u8]| {
    layouts(data);
    let mut boxes: Vec<Mailbox> = Role::ALL
        .iter()
        .flat_map(|role| role.to_controller().iter().chain(role.from_controller()))
        .map(|&place| Mailbox::initialized(place))
        .collect();
    let mut gate = Gate::default();
    let mut line = data;
    while let Ok(frame) = Frame::read(&mut line) {
        let again = Frame::from_bytes(frame.bytes()).expect("it was read before");
        assert_eq!(again, frame);
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
            if gate.read(mailbox).is_some() {
                assert_eq!(*gate.command(), command);
            }
        }
    }
});
